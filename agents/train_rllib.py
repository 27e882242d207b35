"""The command ``python -m agents.train_rllib``; see ``agents/trainers/rllib_run.py``."""

from .trainers.rllib_run import main

if __name__ == "__main__":
    raise SystemExit(main())
