"""How are stored figures reported again? The command ``python -m agents.report``, which is in
``agents/evaluation/report.py``."""

import sys

from .evaluation.report import main

if __name__ == "__main__":
    sys.exit(main())
