"""The windows of the pockets: ``python -m benchmarks.pockets``."""
