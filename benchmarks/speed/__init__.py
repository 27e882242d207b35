"""How long do impacts, shots and starts take? ``python -m benchmarks.speed``."""
