"""What an agent sees: the pots on the table, the positions that strokes lead to, and the errors that these are tried under."""
