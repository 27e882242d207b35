"""What do agents observe? The pots on the table, simulated afterstates, and the simulation's noise samples."""
