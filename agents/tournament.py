"""Who is the better player of frames? The command ``python -m agents.tournament``, which is in
``agents/evaluation/tournament.py``."""

import sys

from .evaluation.tournament import main

if __name__ == "__main__":
    sys.exit(main())
