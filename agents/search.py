"""The command ``python -m agents.search``; see ``agents/evaluation/search_data.py``."""

from .evaluation.search_data import main

if __name__ == "__main__":
    raise SystemExit(main())
