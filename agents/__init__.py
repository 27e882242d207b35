"""Who plays? Agents and what they share; not part of the wheel."""
