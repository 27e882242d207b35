"""What the commands of the repository share: how they start and stop, how they write files, what they say of physics and provenance."""
