"""How do other libraries train on this environment? RLlib here; TorchRL and a single file: ``examples/``."""
