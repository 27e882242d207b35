"""What happens to balls on a table? Pure kernels on float64 arrays; no Gymnasium, no rules, no objects inside kernels.

Symbols: ``docs/symbols.md`` in the repository.
"""
