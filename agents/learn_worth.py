"""The command ``python -m agents.learn_worth``; see ``agents/learning/learn_worth.py``."""

from .learning.learn_worth import main

if __name__ == "__main__":
    raise SystemExit(main())
