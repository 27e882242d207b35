"""The paper's tables and figures, other models and other data: ``python -m benchmarks.paper``."""
