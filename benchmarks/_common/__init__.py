"""What several benchmarks share: their command line, the shots they play, invariants, and changed copies of
the package."""
