"""The time of impacts, shots and starts: ``python -m benchmarks.speed``."""
