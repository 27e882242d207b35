"""What do the commands of this repository share? Start and stop, writing of files, the option --physics, and provenance."""
