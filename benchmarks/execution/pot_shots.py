"""Which pots show how well a level of ``noise`` plays, how often is each made, and where does the cue ball
stop? Two balls, Monte Carlo."""

from dataclasses import dataclass
from math import degrees, erf, hypot, radians, sqrt

import numpy as np

import snooker_env as sn
from snooker_env.game.balls import BLACK, BLUE, SPOTS
from snooker_env.geometry import POCKET_AIMS
from snooker_env.physics.table import UNBOUNDED
from snooker_env.tasks.noise import POT_SPEED, Noise

from .._common.shot_sets import R, Shots, _settle, _turn

FIRM = 4.5
"""Cue speed [m/s] of the same pot struck firmly."""
HALF_WINDOW = 0.022
"""Half of the effective window of a corner pocket [m] from which the published sizes of aim errors were
derived."""
FAN, REACH = 1201, radians(0.6)
"""So many aims, up to so far to either side, are tried for where a pot begins and ends."""


@dataclass(frozen=True)
class Pot:
    """One pot of a ball on an otherwise empty table."""

    name: str
    pocket: int
    run: float
    """From the object ball to the pocket's aim point [m]."""
    off: float
    """The object ball's path off the pocket's axis [deg], anticlockwise."""
    far: float
    """From centre to centre of the two balls [m]."""
    cut: float
    """[deg]"""
    speed: float
    """Of the cue [m/s], as played: the object ball arrives at about 1 m/s."""

    @property
    def positions(self):
        """(2, 2) [m]: cue ball, object ball."""
        way = _turn(POCKET_AIMS[self.pocket, 2:4], radians(self.off))
        ball, turn = POCKET_AIMS[self.pocket, :2] - self.run * way, radians(self.cut)
        path = sqrt(self.far**2 - (2 * R * np.sin(turn)) ** 2) - 2 * R * np.cos(turn)
        return np.array([ball - 2 * R * way - path * _turn(way, turn), ball])

    @property
    def gain(self):
        """Lateral error at the pocket over the error of the cue ball's direction [m / rad], by geometry."""
        turn = radians(self.cut)
        path = sqrt(self.far**2 - (2 * R * np.sin(turn)) ** 2) - 2 * R * np.cos(turn)
        return path * self.run / (2 * R * np.cos(turn))

    def rate(self, deg, half=HALF_WINDOW):
        """Share of pots by geometry, if the direction errs by ``deg`` (standard deviation) and half the
        pocket's window is ``half``."""
        return erf(half / (self.gain * radians(deg) * sqrt(2.0)))


def _spot(ball):
    """(run, off) of a ball on its spot, for the top right corner pocket."""
    dx, dy = POCKET_AIMS[3, :2] - SPOTS[ball]
    return float(hypot(dx, dy)), degrees(np.arctan2(dy, dx)) - 45.0


LONG = (
    Pot("long: baulk line, 1 m to go, straight", 3, 1.0, 27.5, 1.95, 0, 2.5),
    Pot("long: baulk line, 1 m to go, 15 deg", 3, 1.0, 10.0, 1.9, 15, 2.5),
    Pot("long: 2.4 m, 1.2 m to go, straight", 3, 1.2, 29.0, 2.4, 0, 3.0),
)
"""The cue ball near the baulk line or below it; three such pots, the easiest along the pocket's axis."""
_BLUE = Pot("blue off its spot, 1.0 m, straight", 3, *_spot(BLUE), 1.0, 0, 2.3)
_BLACK = Pot("black off its spot, 0.35 m, 30 deg", 3, *_spot(BLACK), 0.35, 30, 1.5)
_RED = Pot("red 0.6 m, 20 deg, 1.1 m to go", 3, 1.1, 0.0, 0.6, 20, 2.0)
_HALF = Pot("half ball 1.2 m, 30 deg, 1.0 m to go", 3, 1.0, 10.0, 1.2, 30, 2.3)
_MIDDLE = Pot("middle pocket 0.8 m, 15 deg, 0.6 m", 2, 0.6, 20.0, 0.8, 15, 1.6)
MODERATE = (_BLUE, _BLACK, _RED, _HALF, _MIDDLE)
"""What a player plays most: the robot is held against these."""
DERIVED = (_BLACK, _RED, _BLUE, LONG[2])
"""The pots for which the published sizes of aim errors were derived, with ``HALF_WINDOW``."""
BY_DISTANCE = tuple(
    Pot(f"from {far} m, 15 deg, 0.5 m to go", 3, 0.5, 5.0, float(far), 15, speed)
    for far, speed in ((1, 1.8), (2, 2.2), (3, 2.6))
)
"""The ball half a metre from the corner pocket, a cut at which the cue ball does not follow it: what each level pots."""
THIN = (
    Pot("thin 0.8 m, 60 deg, 0.8 m to go", 3, 0.8, 0.0, 0.8, 60, 2.3),
    Pot("thin 0.5 m, 70 deg, 0.5 m to go", 3, 0.5, 0.0, 0.5, 70, 2.3),
)
POTS = (*LONG, *MODERATE, *THIN, *BY_DISTANCE)


@dataclass(frozen=True, eq=False)
class Aimed:
    """A pot with its stroke: aimed at the middle of all the aims that pot it without errors."""

    pot: Pot
    stroke: np.ndarray
    """Speed [m/s], aim [rad], side, top."""
    half: float
    """Half the width of those aims [rad]."""
    stops: np.ndarray
    """Where the cue ball stops without errors [m]; NaN in a pocket."""
    meets: np.ndarray
    """Where it lies as it meets the ball [m]."""


@dataclass(frozen=True, eq=False)
class Rolls:
    """A pot played many times."""

    made: np.ndarray
    """Which times the ball went into its pocket and the cue ball into none."""
    shift: np.ndarray
    """Of those: how far the cue ball stopped from where it would have without errors [m], along its way from
    the impact and across."""

    @property
    def rate(self):
        return float(self.made.mean())

    @property
    def placement(self):
        """Root mean square of the distance, along, across [m]."""
        squares = (self.shift**2).mean(axis=0)
        return sqrt(squares.sum()), *np.sqrt(squares).tolist()


def played(pot, stroke, turns, physics, table, *, level: str | Noise = "none", seed=0):
    """(made (n,), where the cue ball stops (n, 2)) of n strokes at a pot, turned by ``turns`` [rad], with the
    errors of a ``level``."""
    n = len(turns)
    strokes = np.repeat(stroke[None], n, 0)
    strokes[:, 1] += turns
    shots = Shots(np.repeat(pot.positions[None], n, 0), strokes, np.ones(n, int), physics)
    state = shots.struck(seed, errors=level)
    end = sn.simulate_batch(shots.positions, *state, table=table, physics=physics)
    cue = np.where(end.on_table[:, :1], end.positions[:, 0], np.nan)
    return (end.potted[:, 1] == pot.pocket) & end.on_table[:, 0], cue


def aimed(pot, physics, table, speed=None):
    """The pot with its stroke: no spin, ``speed`` [m/s] or as played."""
    start, aim_point = pot.positions, POCKET_AIMS[pot.pocket, :2]
    stroke = np.array([pot.speed if speed is None else speed, 0.0, 0.0, 0.0])
    settled = _settle(start[None], stroke[None].copy(), np.ones(1, int), aim_point[None], physics)
    if len(settled.ball) == 0:
        raise RuntimeError(f"no aim sends the ball of {pot.name!r} to its pocket")
    stroke, fan = settled.stroke[0], np.linspace(-REACH, REACH, FAN)
    made, _ = played(pot, stroke, fan, physics, table)
    first, last = _widest(made)
    stroke[1] += 0.5 * (fan[first] + fan[last])
    _, stops = played(pot, stroke, np.zeros(1), physics, table)
    way = aim_point - start[1]
    half = 0.5 * (fan[last] - fan[first] + fan[1] - fan[0])
    return Aimed(pot, stroke, half, stops[0], start[1] - 2 * R * way / hypot(*way))


def _widest(made):
    """First and last index of the longest run."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], made, [False]])))
    starts, ends = edges[::2], edges[1::2]
    if len(starts) == 0:
        raise RuntimeError("no aim pots the ball")
    k = int(np.argmax(ends - starts))
    return starts[k], ends[k] - 1


def rolls(shot, level, n, seed, physics, table):
    """The ``Rolls`` of n strokes with the errors of a level (any ``noise``)."""
    made, cue = played(shot.pot, shot.stroke, np.zeros(n), physics, table, level=level, seed=seed)
    way = shot.stops - shot.meets
    way = way / max(hypot(*way), 1e-12)
    shift = (cue - shot.stops)[made]
    return Rolls(made, np.column_stack([shift @ way, shift @ _turn(way, np.pi / 2)]))


def directions(level, n, seed, physics, speed=POT_SPEED):
    """Standard deviations [deg] of the cue ball's direction at a level stroke without spin: of aim, of
    squirt, of swerve, of all together.

    Squirt is seen where the ball leaves, swerve where it rolls: as the ball alone ends on unbounded cloth.
    """
    errors = Noise.of(level)
    aim, tip = (
        Noise(aim_deg=errors.aim_deg, growth=errors.growth),
        Noise(offset_mm=errors.offset_mm, elevation_deg=errors.elevation_deg, growth=errors.growth),
    )
    shots = Shots(np.zeros((n, 1, 2)), np.tile([speed, 0.0, 0.0, 0.0], (n, 1)), np.zeros(n, int), physics)

    def angles(noise):
        v, w = shots.struck(seed, errors=noise)
        end = sn.simulate_batch(shots.positions, v, w, table=UNBOUNDED, physics=physics)  # pyright: ignore[reportArgumentType]
        return [np.degrees(np.arctan2(*way[:, 0].T[::-1])) for way in (v, end.positions)]

    squirt, bent = angles(tip)
    parts = angles(aim)[0], squirt, bent - squirt, angles(errors)[1]
    return dict(zip(("aim", "squirt", "swerve", "all"), (float(np.std(x)) for x in parts), strict=True))


def wilson(share, n):
    """Ends of the 95 % interval of a share seen in n tries."""
    z = 1.96
    middle, reach = share + z * z / (2 * n), z * sqrt(share * (1 - share) / n + z * z / (4 * n * n))
    return (middle - reach) / (1 + z * z / n), (middle + reach) / (1 + z * z / n)
