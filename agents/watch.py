"""How does an agent play? The command ``python -m agents.watch``, which is in
``agents/evaluation/watch.py``."""

import sys

from .evaluation.watch import main

if __name__ == "__main__":
    sys.exit(main())
