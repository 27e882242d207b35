"""The command ``python -m agents.curves``; see ``agents/evaluation/learning_curves.py``."""

from .evaluation.learning_curves import main

if __name__ == "__main__":
    raise SystemExit(main())
