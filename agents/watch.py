"""The command ``python -m agents.watch``; see ``agents/evaluation/watch.py``."""

import sys

from .evaluation.watch import main

if __name__ == "__main__":
    sys.exit(main())
