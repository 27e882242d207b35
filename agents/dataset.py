"""The command ``python -m agents.dataset``, see ``agents.evaluation.dataset``."""

from .evaluation.dataset import main

if __name__ == "__main__":
    raise SystemExit(main())
