"""How is the cushion's restitution fitted to measurements? ``python -m benchmarks.fit_cushion``."""
