"""What do the commands of this repository share? Start and stop, files, tables, locks, the option --physics
and provenance."""
