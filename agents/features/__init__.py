"""What do agents observe? The pots on the table, simulated afterstates, and noise samples for these."""
