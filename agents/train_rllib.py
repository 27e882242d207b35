"""How is an agent trained with RLlib? The command ``python -m agents.train_rllib``, which is in
``agents/trainers/rllib_run.py``."""

import sys

from .trainers.rllib_run import main

if __name__ == "__main__":
    sys.exit(main())
