"""What shot does an action mean? The vector in [-1, 1]^k -> cue speed, tip offset, aim, elevation, place in the D."""

from math import atan2, hypot, pi, radians, sqrt

import numpy as np

from .._check import choice, refuse, refuse_what, truth
from ..game.balls import BAULK_Y, D_RADIUS
from ..game.pots import pots
from ..physics.cue import squirt

AIMS = ("absolute", "target")
MIN_SPEED, MAX_SPEED = 0.2, 7.0
"""Cue speeds [m/s] that -1 and +1 mean: from a ball rolled up to the hardest power shot."""
TARGET_SPAN = radians(3.0)
"""Aim "target": how far +-1 turns the aim off the potting line [rad]. The largest throw and the noise of a club player are within it."""
MAX_ELEVATION = radians(30.0)


class Actions:
    """The action space's meaning.

    ==== ============ =======================================================================
    0    cue speed    0.2 .. 7.0 m/s, linear
    1    side         tip offset / R = 0.5 x, + right; the pair (1, 2) is drawn back onto the
    2    top          disc of radius 0.5 (the miscue limit) when it lies outside; + top, - back
    3    aim          "absolute": angle pi x from +x, anticlockwise, the direction the ball
                      leaves in without noise (squirt is compensated, as a player does);
                      "target": potting line + 3 deg x (see ``line``)
    4    elevation    only with ``elevation=True``: 0 .. 30 deg, linear
    next place in     only with ``placement=True``; used when the cue ball is in hand, else
    two  the D        ignored: across the D, and from the baulk line (-1) back to the D's edge (+1)
    last decision     only with ``decision=True``; used when the other player has just fouled,
                      else ignored: below -1/3 the offender must play again from here, above
                      1/3 the balls are replaced and he plays again (only after a miss was
                      called, else as the middle), in the middle: play, with this same action
    ==== ============ =======================================================================
    """

    def __init__(self, aim, elevation, placement, physics, decision=False):
        self.aim = choice("aim", aim, AIMS)
        self.elevation, self.placement = truth("elevation", elevation), truth("placement", placement)
        self.decision = truth("decision", decision)
        self.physics = physics
        self.size = 4 + self.elevation + 2 * self.placement + self.decision

    def check(self, action):
        """The action as a list of floats; ValueError unless it is finite, of the right shape and within [-1, 1]."""
        allowed = f"must have shape ({self.size},), real numbers"
        try:
            a = np.asarray(action)
        except ValueError:
            raise refuse("action", action, allowed) from None
        if a.dtype.kind not in "iuf":
            raise refuse("action", action, allowed)
        if a.shape != (self.size,):
            raise refuse_what("action", f"array of shape {a.shape}", allowed)
        if not np.all(np.abs(a) <= 1.0):  # NaN fails too
            raise refuse("action", a.tolist(), "must be finite and within [-1, 1]")
        return a.tolist()

    def place(self, a):
        """Where in the D the two components of the placement put the cue ball: (x, y)."""
        at = 4 + self.elevation
        x, back = a[at], 0.5 * (a[at + 1] + 1.0)
        return D_RADIUS * x, BAULK_Y - D_RADIUS * sqrt(max(0.0, 1.0 - x * x)) * back

    def decide(self, a):
        """What an action list says after a foul: "play", "play_again" or "replace"; always "play" without ``decision``."""
        wish = a[-1] if self.decision else 0.0
        return "play_again" if wish < -1.0 / 3.0 else "replace" if wish > 1.0 / 3.0 else "play"

    def shot(self, a, positions, on_table, on):
        """(speed, side, top, aim, elevation) of an action list, the aim being the cue's direction [rad]."""
        speed = MIN_SPEED + 0.5 * (a[0] + 1.0) * (MAX_SPEED - MIN_SPEED)
        side, top = self.tip(0.5 * a[1], 0.5 * a[2])
        elevation = 0.5 * (a[4] + 1.0) * MAX_ELEVATION if self.elevation else 0.0
        direction = pi * a[3] if self.aim == "absolute" else line(positions, on_table, on) + TARGET_SPAN * a[3]
        return speed, side, top, direction - squirt(side, self.physics.end_mass_ratio), elevation

    def tip(self, side, top):
        """A tip offset, drawn back onto the disc of the miscue limit if it lies outside."""
        far = hypot(side, top) / self.physics.max_offset
        return (side / far, top / far) if far > 1.0 else (side, top)


def line(positions, on_table, on):
    """Direction [rad] of the best potting line: from the cue ball to the ghost of the direct pot with the widest tolerance (``game.pots``)
    among the balls on; if there is none, to the centre of the nearest ball on."""
    best = pots(positions, on_table, on, most=1)
    x, y = positions[0]
    if len(best):
        return atan2(best[0, 3] - y, best[0, 2] - x)
    near = min((i for i in range(1, len(positions)) if on >> i & 1), key=lambda i: hypot(positions[i, 0] - x, positions[i, 1] - y))
    return atan2(positions[near, 1] - y, positions[near, 0] - x)
