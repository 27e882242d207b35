"""The levels of ``noise`` beside what is published of players: ``python -m benchmarks.hand``."""
