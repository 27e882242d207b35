"""Impacts and shots at the extremes: ``python -m benchmarks.stability``."""
