"""The command ``python -m agents.noise_samples``; see ``agents/features/noise_samples.py``."""

from .features.noise_samples import main

if __name__ == "__main__":
    raise SystemExit(main())
