"""How good is a learned value? The command ``python -m agents.value_quality``, which is in
``agents/evaluation/value_quality.py``."""

import sys

from .evaluation.value_quality import main

if __name__ == "__main__":
    sys.exit(main())
