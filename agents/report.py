"""The command ``python -m agents.report``; see ``agents/evaluation/report.py``."""

from .evaluation.report import main

if __name__ == "__main__":
    raise SystemExit(main())
