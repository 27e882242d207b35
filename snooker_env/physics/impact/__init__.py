"""What does one impact do? Two balls, or ball and cushion, pressed together and slipping: the model of Mathavan, Jackson & Parkin."""
