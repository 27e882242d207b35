"""Which agents come with the repository? Players, training and evaluation; not in the installed package."""
