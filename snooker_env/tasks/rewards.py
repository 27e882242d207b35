"""What is a stroke worth to the learner? Named rewards, of the referee's verdict on a visit's stroke, or of a step in a frame."""

from .._jit import kernel

REWARDS = ("points", "points_and_fouls", "pots")
"""``"points"``: points scored, 0 for a miss or foul, range [0, 15]. ``"points_and_fouls"``: less the penalty, [-7, 15]. ``"pots"``: 1 for a
scoring stroke, else 0."""


@kernel
def reward_of(kind, points, penalty):
    """The reward of a visit's stroke; ``kind`` is the place in ``REWARDS``."""
    if kind == 2:
        return 1.0 if points else 0.0
    return float(points - penalty) if kind == 1 else float(points)


def _points(before, after, player):
    gained = [b - a for a, b in zip(before.scores, after.scores, strict=True)]
    return float(gained[player] - gained[1 - player])


def _win(before, after, player):
    return 0.0 if after.winner is None else 1.0 if after.winner == player else -1.0


FRAME_REWARDS = {"points": _points, "win": _win}
"""Of a whole frame, by the ``Frame`` before and after a step and the player: ``"points"``: his points less the other's since his last
step, pots and penalties of both, so that the sum of a frame is its final difference. ``"win"``: +1 or -1 when the frame ends, else 0."""
