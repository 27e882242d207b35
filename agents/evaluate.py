"""How well do agents play? The command ``python -m agents.evaluate``, which is in
``agents/evaluation/protocol.py``."""

import sys

from .evaluation.protocol import main

if __name__ == "__main__":
    sys.exit(main())
