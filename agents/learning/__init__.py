"""How agents learn: hyper-parameters, networks, imitation of the search, runs that can be interrupted, and the files of trained models."""
