"""How do agents learn? Hyperparameters, networks, the training loop with its parts, and model files."""
