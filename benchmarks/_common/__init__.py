"""What do several benchmarks share? Their command line, sets of shots, invariants, and changed copies of the
package."""
