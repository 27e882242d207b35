"""How is a trained model published? The command ``python -m agents.publish``, which is in
``agents/evaluation/publish.py``."""

import sys

from .evaluation.publish import main

if __name__ == "__main__":
    sys.exit(main())
