"""What every room stands on and knows nothing of snooker: checks, files, types, and how kernels are compiled."""
