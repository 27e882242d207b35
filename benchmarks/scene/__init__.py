"""Which models of the physics does a scene require? ``python -m benchmarks.scene``."""
