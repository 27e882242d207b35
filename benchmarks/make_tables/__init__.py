"""The stored tables of three layouts: ``python -m benchmarks.make_tables``."""
