"""Which players are there? The built-in ones, the search, and trained models by name."""
