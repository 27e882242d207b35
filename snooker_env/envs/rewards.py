"""What is a stroke worth to the learner? Named rewards, of the referee's verdict on a visit's stroke, or of a step in a frame."""

REWARDS = {
    "points": lambda verdict: float(verdict.points),
    "points_and_fouls": lambda verdict: float(verdict.points - verdict.penalty),
    "pots": lambda verdict: 1.0 if verdict.points else 0.0,
}
"""``"points"``: points scored, 0 for a miss or foul, range [0, 15]. ``"points_and_fouls"``: less the penalty, [-7, 15]. ``"pots"``: 1 for a
scoring stroke, else 0."""


def _points(before, after, player):
    gained = [b - a for a, b in zip(before.scores, after.scores, strict=True)]
    return float(gained[player] - gained[1 - player])


def _win(before, after, player):
    return 0.0 if after.winner is None else 1.0 if after.winner == player else -1.0


FRAME_REWARDS = {"points": _points, "win": _win}
"""Of a whole frame, by the ``Frame`` before and after a step and the player: ``"points"``: his points less the other's since his last
step, pots and penalties of both, so that the sum of a frame is its final difference. ``"win"``: +1 or -1 when the frame ends, else 0."""
