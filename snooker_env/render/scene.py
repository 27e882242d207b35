"""What does a picture show? A table's fixed parts, balls, lines and score bar, in metres, for any drawing library."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .._lib.check import number
from .._lib.types import Flags, Floats, Ints, Vectors
from ..game.balls import CUE, NAMES, VALUES
from ..geometry import BALL_RADIUS, BAULK_Y, COLOUR_SPOTS, D_RADIUS, HALF_LENGTH, HALF_WIDTH
from ..physics.columns import JAW_RADIUS
from ..physics.engine import EventKind
from ..physics.table import Table, TableLike
from .palette import COLOURS, LETTERS, PALETTE

if TYPE_CHECKING:
    from ..simulation.shot import Shot
else:  # a shot draws itself: its module stands above this one
    Shot = Any

RAIL, CUSHION = 0.155, 0.050  # from the nose line to the table's outer edge, and to the wood [m]
BAULK_LINE = np.array([(-HALF_WIDTH, BAULK_Y), (HALF_WIDTH, BAULK_Y)])  # its ends [m]
_TURN = np.linspace(np.pi, 2 * np.pi, 65)
D_ARC = np.stack([D_RADIUS * np.cos(_TURN), BAULK_Y + D_RADIUS * np.sin(_TURN)], axis=1)  # (65, 2) [m]
_SNOOKER = np.array([(-HALF_WIDTH, HALF_WIDTH), (-HALF_LENGTH, HALF_LENGTH)])


@dataclass(frozen=True, eq=False)
class Outline:
    """The fixed parts of a table [m], all empty for unbounded cloth."""

    cushions: list[Floats]  # (m, 2): closed polygons of nose, jaws and the cushion's back under the wood
    noses: list[Floats]  # (m, 2): the line that balls meet at each cushion, jaw - nose - jaw
    throats: Floats  # (k, 5): the holes in the wood: the mouth's middle, the fall's centre, half the width


def extent(table: Table) -> Floats:
    """The bed that a picture shows: a table's bounds or, where it has none, snooker's bed, (2, 2) [m]."""
    return np.where(np.isfinite(table.bounds), table.bounds, _SNOOKER)


def has_lines(table: Table) -> bool:
    """Whether snooker's lines and spots are drawn: on a snooker bed, and on unbounded cloth."""
    return np.allclose(extent(table), _SNOOKER, rtol=0.0, atol=1e-9)


@lru_cache(maxsize=16)
def outline(table: Table) -> Outline:
    """The fixed parts of a table, from its noses, jaws and falls. They are cached: do not change them."""
    cushions, noses, ends = [], [], []
    for axis, side, level, *low_high in table.noses:
        ends += [(_point(axis, side * level, end), _point(axis, side, 0.0)) for end in low_high]
    for axis, side, level, low, high in table.noses:
        out = _point(axis, side, 0.0)  # from the nose into the wood
        left, right = (_jaw(table.jaws, _point(axis, side * level, end)) for end in (low, high))
        nose = np.concatenate([left[::-1], right])
        depth = max(CUSHION + 0.017, *(nose @ out - level))  # a little way under the wood
        backs = [_onward(jaw, out, level + depth, ends) for jaw in (left, right)]
        noses.append(nose)
        cushions.append(np.concatenate([backs[:1], nose, backs[1:]]))
    throats = [_throat(fall, noses, [place for place, _ in ends]) for fall in table.falls] if noses else []
    return Outline(cushions, noses, np.array(throats).reshape(-1, 5))


def _point(axis, across, along):
    return np.array([across, along] if axis == 0 else [along, across])


def _jaw(jaws, start):
    """The jaw (m, 2) that begins at ``start`` on a nose, arc after arc; ``start`` alone without a jaw."""
    points, left = [start], list(jaws)
    while (step := _arc_from(points[-1], left)) is not None:
        k, arc = step
        if left.pop(k)[JAW_RADIUS] > 0.0:  # else a point, where the next arc begins too
            points += list(arc[1:])
    return np.array(points)


def _arc_from(place, jaws):
    """The index of an arc with an end at ``place``, and its points (25, 2) from there on, or None."""
    for k, (x, y, radius, ux, uy, cos_half) in enumerate(jaws):
        angles = np.arctan2(uy, ux) + np.arccos(cos_half) * np.linspace(-1.0, 1.0, 25)
        arc = np.array([x, y]) + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        for points in (arc, arc[::-1]):
            if np.hypot(*(points[0] - place)) < 1e-6:
                return k, points
    return None


def _onward(jaw, out, level, ends):
    """Where a jaw, continued straight, meets the line at ``level``; two noses that meet share a mitre."""
    if len(jaw) > 1:
        onward = jaw[-1] - jaw[-2]
    else:
        onward = out + sum(
            (other for place, other in ends if abs(other @ out) < 0.5 and np.hypot(*(place - jaw[0])) < 1e-6),
            np.zeros(2),
        )
    return jaw[-1] + onward * ((level - jaw[-1] @ out) / (onward @ out))


def _throat(fall, noses, mouths):
    """The hole in the wood, from the mouth's middle to the fall's centre, as wide as its jaws' ends."""
    jaw_ends = [end for nose in noses for end in (nose[0], nose[-1])]

    def far(point):
        return np.hypot(*(point - fall[:2]))

    (a, b), (c, d) = (sorted(points, key=far)[:2] for points in (mouths, jaw_ends))
    return [*(a + b) / 2, *fall[:2], np.hypot(*(c - d)) / 2]


def scene_data(table: TableLike) -> dict[str, Any]:
    """A table, its lines, the balls and the colours as JSON types, for drawing with any library.

    Parameters
    ----------
    table : str, Table or None
        As in ``snooker_env.simulate``.

    Returns
    -------
    dict
        Lengths in metres, rounded to 1e-6. ``cushions``: closed polygons of the nose, the jaws at its ends and the
        cushion's back under the wood. ``noses``: the lines that balls meet, jaw - nose - jaw. ``falls``: centre and
        radius of the slate's holes. ``throats``, the holes in the wood: the mouth's middle, the fall's centre, half the
        width. ``extent``: [[lowest x, highest x], [lowest y, highest y]] of the bed. ``rail``, ``cushion``: from the
        nose line to the outer edge, and to the wood. ``lines``: {"baulk", "d", "spots"}, or None on a table without
        them. ``ball_radius``. ``palette``: {name: [red, green, blue]}. ``balls``: by id {"name", "letter", "value", "rgb"}.

    Examples
    --------
    >>> from snooker_env.render import scene_data
    >>> data = scene_data("pool9")
    >>> data["lines"], len(data["cushions"]), data["balls"][21]["name"]
    (None, 6, 'black')
    """
    table = Table.of(table)
    parts = outline(table)
    marks = {"baulk": _round(BAULK_LINE), "d": _round(D_ARC), "spots": _round(COLOUR_SPOTS)}
    keys = ("name", "letter", "value", "rgb")
    balls = zip(NAMES, LETTERS, VALUES.tolist(), COLOURS.tolist(), strict=True)
    return {
        "cushions": [_round(polygon) for polygon in parts.cushions],
        "noses": [_round(nose) for nose in parts.noses],
        "falls": _round(table.falls),
        "throats": _round(parts.throats),
        "extent": _round(extent(table)),
        "rail": RAIL,
        "cushion": CUSHION,
        "lines": marks if has_lines(table) else None,
        "ball_radius": float(table.ball_radius or BALL_RADIUS),
        "palette": {name: list(rgb) for name, rgb in PALETTE.items()},
        "balls": [dict(zip(keys, ball, strict=True)) for ball in balls],
    }


def _round(points):
    return (np.round(points, 6) + 0.0).tolist()  # + 0.0: no "-0.0"


LEAD = 0.6  # how long a cue is shown before the stroke [s]
FOLLOW = 0.35  # and after it, fading
TURN_STEP = 1 / 240  # time between stored rotations [s]: at 100 rad/s a quarter of a right angle
UNTURNED = np.eye(3)


def turns_of(shot: Shot) -> list[Floats]:
    """The rotation of the cue ball since the start of a shot, a matrix (3, 3), every ``TURN_STEP``."""
    spins = shot.at((np.arange(int(shot.duration / TURN_STEP) + 1) + 0.5) * TURN_STEP)[2][:, CUE]
    turns = [UNTURNED]
    for turn in spins * TURN_STEP:
        turns.append(rotate(turn) @ turns[-1])
    return turns


def rotate(turn: Floats) -> Floats:
    """The matrix (3, 3) of a rotation about the axis ``turn`` (3,) by its length [rad]."""
    x, y, z = turn.tolist()
    angle = (x * x + y * y + z * z) ** 0.5
    across = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])  # of the axis: across @ v is its product with v
    once, twice = np.sinc(angle / np.pi), np.sinc(angle / (2 * np.pi)) ** 2 / 2
    return UNTURNED + once * across + twice * across @ across


@dataclass(frozen=True)
class ScoreBar:
    """The content of a score bar under the table. None, "" and () leave a part out."""

    players: tuple[str, ...] = ()
    scores: tuple[int, ...] = ()
    striker: int | None = None  # an index of players
    break_points: int | None = None  # of the visit so far
    points_on: int | None = None  # that can still be scored
    ball_on: str = ""  # "red", "any colour", "free ball", ...
    words: str = ""  # what just happened, as the referee would say it
    win_chance: float | None = None  # how likely the first player wins the frame


class Cue(NamedTuple):
    """A cue as a picture shows it."""

    ball: Floats  # (2,) the middle of the ball that it strikes [m]
    aim: float  # direction of the stroke [rad]
    elevation: float  # of its butt [rad]
    pull: float  # from the ball's edge back to the tip [m]; negative after the stroke
    alpha: float  # 1 opaque, 0 invisible


@dataclass(frozen=True, eq=False)
class Scene:
    """One picture, with the k balls that are on the table."""

    table: Table
    ids: Ints  # (k,): 0 the cue ball, 1 to 15 reds, 16 to 21 yellow to black
    positions: Floats  # (k, 2) [m]
    heights: Floats  # (k,) above the bed [m]
    ball_radius: float
    paths: dict[int, Floats]  # ball -> (m, 2) points [m]
    ghosts: Floats  # (m, 2) earlier places of the cue ball [m], drawn faded
    turn: Floats | None  # of the cue ball since the start (3, 3); with one it has spots
    text: str  # one line of status, shown without a bar
    bar: ScoreBar | None
    cue: Cue | None = None


def scene(
    table: TableLike,
    positions: Vectors,
    on_table: Flags | None = None,
    *,
    paths: Mapping[int, Vectors] | None = None,
    ghosts: Vectors | None = None,
    turn: Floats | None = None,
    text: str = "",
    bar: ScoreBar | None = None,
) -> Scene:
    """One picture of n <= 22 balls, ids 0 to n-1, at positions (n, 2), or (n, 3) with heights; the rest as in ``Scene``."""
    r, table = np.array(positions, np.float64), Table.of(table)
    heights = r[:, 2] if r.shape[1] == 3 else np.zeros(len(r))
    ids = np.arange(len(r)) if on_table is None else np.flatnonzero(np.array(on_table))
    radius = table.ball_radius or BALL_RADIUS
    lines = {int(ball): np.array(points, np.float64) for ball, points in (paths or {}).items()}
    faded = np.array(() if ghosts is None else ghosts, np.float64).reshape(-1, 2)
    return Scene(table, ids, r[ids, :2], np.maximum(heights[ids], 0.0), radius, lines, faded, turn, text, bar)


def trace_paths(shot: Shot, balls: Iterable[int], step: float = 0.02) -> dict[int, tuple[Floats, Floats]]:
    """Paths {ball: (points (m, 2) [m], times (m,) [s])} of the balls that move, with a point at every impact."""
    times = np.append(np.arange(0.0, shot.duration, step), shot.duration)
    impacts = shot.events["time"][shot.events["kind"] <= EventKind.POT]
    times = np.union1d(times, impacts[impacts < shot.duration])
    r = shot.at(times)[0][..., :2]
    paths = {}
    for ball in balls:
        points = r[:, ball]
        moved = np.append(True, np.any(np.abs(np.diff(points, axis=0)) > 1e-5, axis=1))
        if moved.sum() > 1:
            paths[int(ball)] = points[moved], times[moved]
    return paths


def find_contacts(shot: Shot, ball: int = CUE) -> tuple[Floats, Floats]:
    """Places (m, 2) [m] and times (m,) [s] where a ball met others, each at least a radius from the last."""
    met = shot.events[shot.events["kind"] == EventKind.BALL_BALL]
    met = met[(met["i"] == ball) | (met["j"] == ball)]
    places, kept = shot.at(met["time"])[0][:, ball, :2].reshape(-1, 2), []
    for k, place in enumerate(places):
        if not kept or np.hypot(*(place - places[kept[-1]])) > shot.physics.R:
            kept.append(k)
    return places[kept], met["time"][kept]


class Film:
    """The pictures of a ``Shot`` at any time: the cue ball with spots and ghosts, its path and those of potted balls.

    With ``strike`` ("speed", "aim", "elevation") a cue is drawn, and the film begins ``LEAD`` before the shot."""

    def __init__(
        self,
        table: TableLike,
        shot: Shot,
        *,
        strike: Mapping[str, float] | None = None,
        bar: ScoreBar | None = None,
        text: str = "",
    ):
        self.duration: float = shot.duration
        self.begin: float = -LEAD if strike else 0.0
        self._table, self._shot, self._strike = Table.of(table), shot, strike
        self._bar, self._text = bar, text
        drops = shot.events[np.isin(shot.events["kind"], (EventKind.POT, EventKind.OFF))]
        potted = shot.events["i"][shot.events["kind"] == EventKind.POT]
        self._paths = trace_paths(shot, dict.fromkeys((CUE, *potted.tolist())))
        self._turns, self._met = turns_of(shot), find_contacts(shot)
        self._gone_at = np.where(shot.on_table, np.inf, -1.0)  # -1: not on the table when the shot began
        self._gone_at[drops["i"]] = drops["time"]

    def at(self, t: float) -> Scene:
        """The picture at a time [s] from the start of the shot."""
        cue, t = self._cue(t), max(t, 0.0)
        r = self._shot.at(t)[0]
        paths = {}
        for ball, (points, times) in self._paths.items():
            so_far = int(np.searchsorted(times, t, side="right"))
            done = points[:so_far]
            if np.any(np.abs(done[-1] - r[ball, :2]) > 1e-5):
                done = np.concatenate([done, r[ball : ball + 1, :2]])
            if len(done) > 1:
                paths[ball] = done
        places, times = self._met
        over = {"ghosts": places[times <= t], "turn": self._turns[round(t / TURN_STEP)]}
        made = scene(self._table, r, self._gone_at > t, paths=paths, bar=self._bar, text=self._text, **over)
        return replace(made, ball_radius=self._shot.physics.R, cue=cue)

    def _cue(self, t):
        """The cue at a time: drawn back, then forward to the ball and through it; None after ``FOLLOW``."""
        if not self._strike or t >= FOLLOW:
            return None
        speed, aim, elevation = (self._strike[name] for name in ("speed", "aim", "elevation"))
        back = 0.02 + (0.06 + 0.02 * min(5.0, speed)) * np.sin(np.pi * (max(-t, 0.0) / LEAD) ** 0.6)
        pull = min(back, -t) if t < 0 else -min(0.16, 0.4 * t * speed)
        ball = self._shot.at(0.0)[0][CUE, :2]
        return Cue(ball, aim, elevation, pull, 1.0 if t < 0 else 1.0 - t / FOLLOW)

    def scenes(self, fps: float = 30.0, speed: float = 1.0) -> Iterator[Scene]:
        """A picture every speed / fps seconds of the shot, and one of its end."""
        step = number("speed", speed, 0.0, open_low=True) / number("fps", fps, 0.0, open_low=True)
        first = round(self.begin / step)  # so that one picture is that of the stroke
        for t in np.append(np.arange(first, self.duration / step) * step, self.duration):
            yield self.at(float(t))
