"""What do learned players compute while they play? A policy over strokes, a value of positions."""
