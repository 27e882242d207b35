"""Which players are there? The built-in ones, those that search, and trained models by name."""
