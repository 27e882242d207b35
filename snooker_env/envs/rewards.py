"""What is a stroke worth to the learner? Named rewards, each a function of the referee's verdict."""

REWARDS = {
    "points": lambda verdict: float(verdict.points),
    "points_and_fouls": lambda verdict: float(verdict.points - verdict.penalty),
    "pots": lambda verdict: 1.0 if verdict.points else 0.0,
}
"""``"points"``: points scored, 0 for a miss or foul, range [0, 15]. ``"points_and_fouls"``: less the penalty, [-7, 15]. ``"pots"``: 1 for a
scoring stroke, else 0."""
