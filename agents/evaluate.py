"""The command ``python -m agents.evaluate``; see ``agents/evaluation/protocol.py``."""

from .evaluation.protocol import main

if __name__ == "__main__":
    raise SystemExit(main())
