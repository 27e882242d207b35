"""The command ``python -m agents.evaluate``; see ``agents/evaluation/protocol.py``."""

import sys

from .evaluation.protocol import main

if __name__ == "__main__":
    sys.exit(main())
