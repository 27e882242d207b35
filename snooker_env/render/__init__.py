"""How does a table look? ``scene`` says what to draw, in metres; ``pygame_view`` draws it as a picture, ``ascii_view`` as text."""
