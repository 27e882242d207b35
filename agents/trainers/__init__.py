"""How do other libraries train on this environment? RLlib here; TorchRL and a loop of one's own are single
files in ``examples/``."""
