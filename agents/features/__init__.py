"""What do agents observe? The pots on the table, simulated afterstates, and the noise samples of the
simulation."""
