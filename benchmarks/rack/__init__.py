"""Breaks of a touching rack by several models: ``python -m benchmarks.rack``."""
