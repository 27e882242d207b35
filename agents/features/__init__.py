"""What do agents observe? The table and its pots."""
