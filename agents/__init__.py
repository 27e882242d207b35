"""Which agents come with the repository? Players, training and evaluation. The installed package does not include them."""
