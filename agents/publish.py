"""The command ``python -m agents.publish``; see ``agents/evaluation/publish.py``."""

import sys

from .evaluation.publish import main

if __name__ == "__main__":
    sys.exit(main())
