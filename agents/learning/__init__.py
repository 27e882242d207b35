"""How do agents learn? Hyperparameters, networks, imitation of the search, runs that resume, and model files."""
