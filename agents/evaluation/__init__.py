"""How well do agents play? Held-out visits, tournaments, figures with intervals and reports."""
