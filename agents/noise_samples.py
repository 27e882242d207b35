"""Which noise samples does the lookahead use? The command ``python -m agents.noise_samples``, in
``agents/features/noise_samples.py``."""

import sys

from .features.noise_samples import main

if __name__ == "__main__":
    sys.exit(main())
