"""What is the reward? Named rewards of a stroke in a visit, or of a step in a frame."""

from .._lib.jit import kernel

REWARDS = ("points", "points_and_fouls", "pots", "legal")
"""Rewards of a visit: points scored, 0 for a miss or foul, in [0, 15]; the same minus the penalty, in [-7,
15]; 1 for a scoring stroke, else 0; 1 for a stroke without a foul, else 0, as for escaping from a snooker."""


@kernel
def reward_of(kind, points, penalty):
    """The reward of a visit's stroke; ``kind`` is the index into ``REWARDS``."""
    if kind == 3:
        return 0.0 if penalty else 1.0
    if kind == 2:
        return 1.0 if points else 0.0
    return float(points - penalty) if kind == 1 else float(points)


FRAME_REWARDS = ("points", "win")
"""Rewards of a frame. ``"points"``: the growth of the player's lead, pots and penalties of both, since it was
last paid, in all the final difference: the first reward includes a first visit of the opponent. ``"win"``: +1
or -1 when the frame ends, else 0."""
MATCH_REWARDS = (*FRAME_REWARDS, "frames")
"""Of a match: points added up over the frames; +1 or -1 when the match ends; +1 or -1 when a frame ends."""
(POINTS_PAID, WIN_PAID, FRAMES_PAID) = range(3)


@kernel
def frame_reward_of(kind, gained, winner, player):
    """A step's reward; ``kind``: of ``MATCH_REWARDS``, ``gained``: not paid yet, ``winner``: or -1."""
    if kind != WIN_PAID:
        return float(gained)
    return 0.0 if winner < 0 else 1.0 if winner == player else -1.0
