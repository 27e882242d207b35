"""How do agents learn? Hyperparameters, networks, the training loop and what runs in it, model files."""
