"""The command ``python -m agents.publish``; see ``agents/evaluation/publish.py``."""

from .evaluation.publish import main

if __name__ == "__main__":
    raise SystemExit(main())
