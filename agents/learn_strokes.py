"""The command ``python -m agents.learn_strokes``; see ``agents/learning/learn_strokes.py``."""

from .learning.learn_strokes import main

if __name__ == "__main__":
    raise SystemExit(main())
