"""The command ``python -m agents.watch``; see ``agents/evaluation/watch.py``."""

from .evaluation.watch import main

if __name__ == "__main__":
    raise SystemExit(main())
