"""What shot does an action mean? A vector in [-1, 1]^k as speed, tip offset, aim, elevation, place."""

from collections.abc import Collection
from math import atan2, exp, hypot, log, pi, radians, sqrt

import numpy as np
from gymnasium import spaces

from .._lib.check import choice, number, refuse, refuse_what, truth
from .._lib.jit import kernel
from .._lib.types import Floats
from ..game.pots import GHOST_X, GHOST_Y, find_pots
from ..geometry import BALL_RADIUS, BAULK_Y, D_RADIUS, HALF_LENGTH, HALF_WIDTH
from ..physics.cue import squirt
from .declarations import A_AIM, A_ELEVATION, DECLARES, SAYS
from .lines import aim_along, aim_on, find_lines, list_lines
from .pot_aim import swerved_aim

AIMS = ("pot", "absolute", "target")  # what the aim of a box action can mean
_POT, _TARGET = AIMS.index("pot"), AIMS.index("target")
MIN_SPEED, MAX_SPEED = 0.2, 7.0
"""Cue speeds [m/s] for -1 and +1 of an action: from a ball just rolled to the hardest power shot."""
SLOWEST, FASTEST = 0.8, 4.6  # the same with ``aim="pot"``, in equal ratios: 0 means 1.92 m/s
MOST_SIDE, MOST_TOP = 0.2, 0.4  # tip offsets over R for 1 with ``aim="pot"``: what a player uses
TARGET_SPAN = radians(3.0)
"""With ``aim="target"``: angle off the target line for +-1 [rad], more than any throw or error."""
ROUNDING = 1e-6  # how far outside [-1, 1] a component may be, and is clipped: float rounding of a policy's own limits
MAX_ELEVATION, STEEPEST = radians(30.0), radians(70.0)
"""The highest elevation of an action, by default and at the most that a person can do [rad]."""
_RATIO = log(FASTEST / SLOWEST)
_BOUNDS = "must be finite and within [-1, 1]; gymnasium.wrappers.ClipAction clips what a policy draws outside"


@kernel
def tip_on_disc(side, top, max_offset):
    """A tip offset over R, moved back to the disc of the miscue limit if it lies outside."""
    far = hypot(side, top) / max_offset
    return (side / far, top / far) if far > 1.0 else (side, top)


@kernel
def place_of(a, options, anywhere):
    """The place (x, y) [m] in the D or, ``anywhere``, on the bed, that the two placement components of an action mean."""
    at = 5 if options[A_ELEVATION] else 4
    x, back = a[at], 0.5 * (a[at + 1] + 1.0)
    if anywhere:
        return HALF_WIDTH * x, HALF_LENGTH * a[at + 1]
    return D_RADIUS * x, BAULK_Y - D_RADIUS * sqrt(max(0.0, 1.0 - x * x)) * back


@kernel
def _target_line(positions, on_table, on, stroke, law, work):
    """Direction [rad] from which ``aim="target"`` is measured: the widest pot's line, else the first line."""
    lines = work.lines
    if find_pots(positions, on_table, on, BALL_RADIUS, lines[:1]):
        dx, dy = lines[0, GHOST_X] - positions[0, 0], lines[0, GHOST_Y] - positions[0, 1]
        return swerved_aim(atan2(dy, dx), hypot(dx, dy), stroke, positions, on_table, law, work)
    find_lines(positions, on_table, on, lines, False)
    return aim_along(lines[0], stroke, positions, on_table, on, law, work)


@kernel
def shot_of(a, positions, on_table, on, options, law, work):
    """(speed, side, top, aim of the cue, elevation) of an action (k,); ``options``: of ``Actions.pack``."""
    elevation = 0.5 * (a[4] + 1.0) * options[A_ELEVATION] if options[A_ELEVATION] else 0.0
    if options[A_AIM] == _POT:
        speed = SLOWEST * exp(0.5 * (a[0] + 1.0) * _RATIO)
        side, top = tip_on_disc(MOST_SIDE * a[1], MOST_TOP * a[2], law.max_offset)
        many, pots = list_lines(positions, on_table, on, work.lines)
        k, stroke = min(int(abs(a[3]) * many), many - 1), (speed, side, top, elevation)
        aim = aim_on(k, pots, stroke, positions, on_table, on, law, work)
        return speed, side, top, aim - squirt(side, law.end_mass_ratio), elevation
    speed = MIN_SPEED + 0.5 * (a[0] + 1.0) * (MAX_SPEED - MIN_SPEED)
    side, top = tip_on_disc(0.5 * a[1], 0.5 * a[2], law.max_offset)
    direction = pi * a[3]
    if options[A_AIM] == _TARGET:
        # without rails a line is aimed as for a level cue
        stroke = speed, side, top, elevation if law.rails.shape[0] else 0.0
        direction = _target_line(positions, on_table, on, stroke, law, work) + TARGET_SPAN * a[3]
    return speed, side, top, direction - squirt(side, law.end_mass_ratio), elevation


class Actions:
    """The box action space: speed, side, top, aim, then elevation, place in the D (two), nomination, decision, declaration."""

    steepest: float  # the elevation that 1 means [rad]

    def __init__(
        self, aim: str, elevation: bool | float = False, placement: bool = False, says: Collection[str] = ()
    ):
        self.aim: str = choice("aim", aim, AIMS)
        self.placement: bool = truth("placement", placement)
        if isinstance(elevation, (bool, np.bool_)):
            self.steepest = MAX_ELEVATION if elevation else 0.0
        else:
            try:
                self.steepest = radians(number("elevation", elevation, 5.0, 70.0))
            except ValueError:
                raise refuse("elevation", elevation, "must be True or False, or degrees in [5, 70]") from None
        self.elevation: bool = self.steepest > 0.0
        self.says: tuple[str, ...] = tuple(name for name in SAYS if name in says)
        self.declares: bool = any(name in self.says for name in DECLARES)  # by the last component
        said = ("nominate" in says) + ("decision" in says) + self.declares
        self.size: int = 4 + self.elevation + 2 * self.placement + said  # components of an action
        self.space: spaces.Box = spaces.Box(-1.0, 1.0, (self.size,), np.float32)

    def check(self, actions: object, n: int | None = None) -> Floats:
        """One action (size,), or those of n tables (n, size): float64, clipped if up to ``ROUNDING`` outside; ValueError for others."""
        field, shape = ("action", (self.size,)) if n is None else ("actions", (n, self.size))
        allowed = f"must have shape {shape}, real numbers"
        try:
            a = np.asarray(actions)
        except ValueError:
            raise refuse(field, actions, allowed) from None
        if a.dtype.kind not in "iuf":
            raise refuse(field, actions, allowed)
        if a.shape != shape:
            raise refuse_what(field, f"array of shape {a.shape}", allowed)
        a = a.astype(np.float64, order="C")  # from any type: the kernels are compiled for float64 only
        far = np.abs(a)
        if not (most := far.max(initial=0.0)) <= 1.0 + ROUNDING:  # NaN is not, either
            k = int(np.argmin((far <= 1.0 + ROUNDING).all(axis=-1)))
            bad = ("action", a) if n is None else (f"actions[{k}]", a[k])
            raise refuse(bad[0], bad[1].tolist(), _BOUNDS)
        return a.clip(-1.0, 1.0, out=a) if most > 1.0 else a

    def pack(self) -> Floats:
        """The options for the kernels: float64, in the columns ``A_*`` of ``declarations``."""
        where, at = [], self.size - self.declares - ("decision" in self.says) - ("nominate" in self.says)
        for holds in ("nominate" in self.says, "decision" in self.says, self.declares):
            where.append(at if holds else -1)
            at += holds
        kind = AIMS.index(self.aim), self.steepest, self.placement
        declares = (name in self.says for name in DECLARES)
        return np.array([*kind, False, *where, *declares], np.float64)
