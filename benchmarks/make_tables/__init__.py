"""How are the stored tables of three layouts made? ``python -m benchmarks.make_tables``."""
