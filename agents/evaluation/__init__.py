"""How well do agents play? Visits on held-out tables, tournaments, figures with intervals, reports, models."""
