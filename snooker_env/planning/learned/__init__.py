"""What do learned players compute while they play? A policy over strokes and a value of positions, in NumPy
and compiled kernels."""
