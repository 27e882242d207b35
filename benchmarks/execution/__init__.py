"""How large are the execution errors of each level of ``noise``, beside what is published?
``python -m benchmarks.execution``."""
