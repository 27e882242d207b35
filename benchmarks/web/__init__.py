"""How fluently the browser plays: ``python -m benchmarks.web``."""
