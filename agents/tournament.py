"""The command ``python -m agents.tournament``; see ``agents/evaluation/tournament.py``."""

from .evaluation.tournament import main

if __name__ == "__main__":
    raise SystemExit(main())
