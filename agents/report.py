"""The command ``python -m agents.report``; see ``agents/evaluation/report.py``."""

import sys

from .evaluation.report import main

if __name__ == "__main__":
    sys.exit(main())
