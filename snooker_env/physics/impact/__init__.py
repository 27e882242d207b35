"""The frictional impact of two balls, or of ball and cushion [Mathavan, Jackson & Parkin], integrated."""
