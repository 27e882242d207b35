"""The motion and impacts of balls, in pure kernels on float64 arrays. Symbols: docs/develop/symbols.md."""
