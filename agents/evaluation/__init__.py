"""How well agents play: rollouts on held-out tables, metrics with intervals, reports, pictures, and the
publishing of models."""
