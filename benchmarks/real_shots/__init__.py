"""How close does the engine come to the paths of real balls? ``python -m benchmarks.real_shots FILE``."""
