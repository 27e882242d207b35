"""How do agents learn? Hyperparameters, networks, imitation of the search, runs that can be resumed, and the
files of trained models."""
