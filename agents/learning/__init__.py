"""How do agents learn? Hyperparameters, networks, imitation of the search, runs that resume, model files."""
