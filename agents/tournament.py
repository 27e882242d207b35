"""The command ``python -m agents.tournament``; see ``agents/evaluation/tournament.py``."""

import sys

from .evaluation.tournament import main

if __name__ == "__main__":
    sys.exit(main())
