"""Who plays: the built-in players, the search, and trained models by name."""
