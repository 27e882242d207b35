"""The frictional impact of two balls, or of a ball and a cushion: the model of Mathavan, Jackson & Parkin,
and how it is integrated."""
