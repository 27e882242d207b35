"""The motion and the impacts of balls on a table: pure kernels on float64 arrays; no Gymnasium, no rules, no
objects inside kernels.

Symbols: ``docs/develop/symbols.md`` in the repository.
"""
