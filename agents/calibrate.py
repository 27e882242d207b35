"""The command ``python -m agents.calibrate``; see ``agents/evaluation/calibrate.py``."""

from .evaluation.calibrate import main

if __name__ == "__main__":
    raise SystemExit(main())
