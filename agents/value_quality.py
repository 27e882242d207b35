"""The command ``python -m agents.value_quality``; see ``agents/evaluation/value_quality.py``."""

from .evaluation.value_quality import main

if __name__ == "__main__":
    raise SystemExit(main())
