"""What is there to draw? A table, its lines, balls and overlays, in metres and without a drawing library.

World frame: origin at the table's centre, +x to the yellow side, +y to the black end. ``scene`` says what lies on the table now,
``outline`` gives the parts of a table that never move, ``shot_scenes`` cuts a shot into the pictures of a film, and ``scene_data`` is
all that a drawing in another language needs, as JSON types. Colours are in ``palette``.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._check import array, number, refuse
from .._types import Flags, Floats, Ints, Vector, Vectors
from ..game.balls import CUE, N_BALLS, NAMES, VALUES
from ..geometry import BALL_RADIUS, BAULK_Y, COLOUR_SPOTS, D_RADIUS, HALF_LENGTH, HALF_WIDTH
from ..physics.columns import JAW_RADIUS
from ..physics.engine import EventKind
from ..physics.table import Table, TableLike
from ..simulation import Shot
from .palette import COLOURS, LETTERS, PALETTE

RAIL = 0.155
"""From the nose line to the outer edge of the table [m]: cushion and wood."""
CUSHION = 0.050
"""From the nose line to the wood [m]."""

BAULK_LINE = np.array([(-HALF_WIDTH, BAULK_Y), (HALF_WIDTH, BAULK_Y)])
_TURN = np.linspace(np.pi, 2 * np.pi, 65)
D_ARC = np.stack([D_RADIUS * np.cos(_TURN), BAULK_Y + D_RADIUS * np.sin(_TURN)], axis=1)
SPOT_MARKS = COLOUR_SPOTS

for _constant in (BAULK_LINE, D_ARC):
    _constant.setflags(write=False)


@dataclass(frozen=True, eq=False)
class Outline:
    """The parts of a table that never move. All empty for unbounded cloth.

    Attributes
    ----------
    cushions : tuple of float64
        Closed polygons (m, 2): nose, the jaws at its two ends, and the cushion's back under the wood.
    noses : tuple of float64
        Polylines (m, 2): the part of each cushion that balls meet, jaw - nose - jaw.
    falls : float64
        (k, 3) centre x, y and radius of the slate circles over which balls drop.
    throats : float64
        (k, 5) the hole in the wood: from x, y (middle of the mouth) to x, y, half as wide as the fifth number says.
    """

    cushions: tuple[Floats, ...]
    noses: tuple[Floats, ...]
    falls: Floats
    throats: Floats


@dataclass(frozen=True, eq=False)
class Scene:
    """One picture. Only balls on the table are in it; k of them.

    Attributes
    ----------
    table : Table
        What it lies on.
    ids : int64
        (k,) ball ids: 0 the cue ball, 1 to 15 reds, 16 to 21 yellow to black.
    positions : float64
        (k, 2) [m].
    ball_radius : float
        [m].
    paths : dict of int to float64
        Ball id -> (m, 2) [m]: where that ball ran.
    aim : float64, or None
        (m, 2) [m]: line of aim.
    ghost : float64, or None
        (2,) [m]: where the cue ball should meet its object ball.
    text : str
        One line of status.
    """

    table: Table
    ids: Ints
    positions: Floats
    ball_radius: float
    paths: dict[int, Floats]
    aim: Floats | None
    ghost: Floats | None
    text: str

    @property
    def colours(self) -> NDArray[np.uint8]:
        """(k, 3) uint8."""
        return COLOURS[self.ids]

    @property
    def labels(self) -> tuple[str, ...]:
        """One letter a ball."""
        return tuple(LETTERS[i] for i in self.ids)


def scene(
    table: TableLike,
    positions: Vectors,
    on_table: Flags | None = None,
    *,
    ball_radius: float | None = None,
    paths: Mapping[int, Vectors] | None = None,
    aim: Vectors | None = None,
    ghost: Vector | None = None,
    text: str = "",
) -> Scene:
    """What to draw: n <= 22 balls with the ids 0 .. n-1 at ``positions`` (n, 2) [m], and what to lay over them.

    table: as in ``snooker_env.simulate``; on_table (n,) bool, None for all; ball_radius [m]: None for that of the table, or snooker's;
    paths: {ball id: (m, 2) points}, e.g. of ``ball_paths``; aim: (m, 2) points of a line; ghost: (2,) a ball's outline; text: one line
    of status. Arrays are copied. Raises ValueError.
    """
    r = array("positions", positions, (-1, 2))
    if len(r) > N_BALLS:
        raise refuse("positions", f"array of shape {r.shape}", f"must hold at most {N_BALLS} balls")
    here = np.ones(len(r), bool) if on_table is None else np.array(on_table)
    if here.shape != (len(r),) or here.dtype != bool:
        raise refuse("on_table", f"{here.dtype} array of shape {here.shape}", f"must be bool of shape ({len(r)},)")
    paths = {} if paths is None else paths
    for ball in paths:
        if ball not in range(N_BALLS):
            raise refuse("paths", ball, f"must have ball ids 0 to {N_BALLS - 1} as keys")
    ids, table = np.flatnonzero(here), Table.of(table)
    radius = (table.ball_radius or BALL_RADIUS) if ball_radius is None else number("ball_radius", ball_radius, 1e-3, 1)
    return Scene(
        table, ids, r[ids], radius, {int(ball): array(f"paths[{ball}]", points, (-1, 2)) for ball, points in paths.items()},
        None if aim is None else array("aim", aim, (-1, 2)), None if ghost is None else array("ghost", ghost, (2,)), str(text),
    )  # fmt: skip


def ball_paths(shot: Shot, balls: Iterable[int] = (CUE,), until: float | None = None, step: float = 0.02) -> dict[int, Floats]:
    """{ball: (m, 2) points [m]} of a ``Shot`` from its start to the time ``until`` [s] (None: to its end), every ``step`` seconds.

    Times of impacts are added, so that corners are sharp; a ball that did not move has no path.
    """
    until = shot.duration if until is None else min(number("until", until, 0.0), shot.duration)
    times = np.append(np.arange(0.0, until, number("step", step, 0.0, open_low=True)), until)
    impacts = shot.events["time"][shot.events["kind"] <= EventKind.POT]
    times = np.union1d(times, impacts[impacts < until])
    r = shot.at(times)[0]
    paths = {}
    for ball in balls:
        points = r[:, ball]
        moved = np.append(True, np.any(np.abs(np.diff(points, axis=0)) > 1e-5, axis=1))
        if moved.sum() > 1:
            paths[int(ball)] = points[moved]
    return paths


def shot_scenes(
    table: TableLike, shot: Shot, *, fps: float = 30.0, speed: float = 1.0, trail: Iterable[int] = (CUE,), **overlays: Any
) -> Iterator[Scene]:
    """The film of a ``Shot``: one ``Scene`` every speed / fps seconds of the shot's own time, and one of its end.

    A potted ball leaves the picture when it drops. trail: balls whose path grows as they run; overlays: as in ``scene``.
    """
    step = number("speed", speed, 0.0, open_low=True) / number("fps", fps, 0.0, open_low=True)
    drops = shot.events[shot.events["kind"] == EventKind.POT]
    gone_at = np.where(shot.on_table, np.inf, -1.0)  # -1: not on the table when the shot began
    gone_at[drops["i"]] = drops["time"]
    for t in np.append(np.arange(0.0, shot.duration, step), shot.duration):
        paths = ball_paths(shot, trail, until=t)
        yield scene(table, shot.at(t)[0], gone_at > t, **{"ball_radius": shot.physics.R, "paths": paths, **overlays})


def extent(table: Table) -> Floats:
    """(2, 2) [m] what a picture of a ``Table`` shows between its rails: its bounds, and snooker's bed where it has none."""
    snooker = np.array([(-HALF_WIDTH, HALF_WIDTH), (-HALF_LENGTH, HALF_LENGTH)])
    return np.where(np.isfinite(table.bounds), table.bounds, snooker)


def is_marked(table: Table) -> bool:
    """Are snooker's lines and spots drawn on a ``Table``? On its bed, and on unbounded cloth."""
    ends = (HALF_WIDTH, HALF_LENGTH)
    return all(np.allclose(bounds, (-end, end), rtol=0.0, atol=1e-9) for bounds, end in zip(extent(table), ends, strict=True))


@lru_cache(maxsize=16)
def outline(table: Table) -> Outline:
    """The parts of a table that never move, put together from its noses, jaws and falls.

    Parameters
    ----------
    table : Table

    Returns
    -------
    Outline
    """
    cushions, noses = [], []
    ends = [(_point(axis, side * level, end), _point(axis, side, 0.0)) for axis, side, level, *low_high in table.noses for end in low_high]
    for axis, side, level, low, high in table.noses:
        out = _point(axis, side, 0.0)  # from the nose into the wood
        left, right = (_jaw(table.jaws, _point(axis, side * level, end)) for end in (low, high))
        nose = np.concatenate([left[::-1], right])
        depth = max(CUSHION + 0.017, *(nose @ out - level))  # some way under the wood
        backs = [_onward(jaw, out, level + depth, ends) for jaw in (left, right)]
        noses.append(nose)
        cushions.append(np.concatenate([backs[:1], nose, backs[1:]]))
    throats = [_throat(fall, noses, [place for place, _ in ends]) for fall in table.falls] if noses else []
    return Outline(tuple(cushions), tuple(noses), table.falls, np.array(throats).reshape(-1, 5))


def _point(axis, across, along):
    return np.array([across, along] if axis == 0 else [along, across])


def _jaw(jaws, start):
    """(m, 2) the jaw that begins at ``start`` on a nose, arc after arc to its end in the pocket; only ``start`` if there is none."""
    points, left = [start], list(jaws)
    while (found := _arc_from(points[-1], left)) is not None:
        k, arc = found
        if left.pop(k)[JAW_RADIUS] > 0.0:  # else a point: the next arc begins there, too
            points += list(arc[1:])
    return np.array(points)


def _arc_from(place, jaws):
    """The index of an arc of which one end is at ``place``, and its points (25, 2) from there on; None if there is none."""
    for k, (x, y, radius, ux, uy, cos_half) in enumerate(jaws):
        angles = np.arctan2(uy, ux) + np.arccos(cos_half) * np.linspace(-1.0, 1.0, 25)
        arc = np.array([x, y]) + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        for points in (arc, arc[::-1]):
            if np.hypot(*(points[0] - place)) < 1e-6:
                return k, points
    return None


def _onward(jaw, out, level, ends):
    """Where a jaw, run on straight behind its last arc, meets the line ``level`` behind the nose; two noses that meet share a mitre."""
    if len(jaw) > 1:
        onward = jaw[-1] - jaw[-2]
    else:
        onward = out + sum((other for place, other in ends if abs(other @ out) < 0.5 and np.hypot(*(place - jaw[0])) < 1e-6), np.zeros(2))
    return jaw[-1] + onward * ((level - jaw[-1] @ out) / (onward @ out))


def _throat(fall, noses, mouths):
    """The hole in the wood: from the middle of the pocket's mouth to the centre of its fall, as wide as its jaws' ends are apart."""
    jaw_ends = [end for nose in noses for end in (nose[0], nose[-1])]
    (a, b), (c, d) = (sorted(points, key=lambda point: np.hypot(*(point - fall[:2])))[:2] for points in (mouths, jaw_ends))
    return [*(a + b) / 2, *fall[:2], np.hypot(*(c - d)) / 2]


def scene_data(table: TableLike) -> dict[str, Any]:
    """A table, its lines, the balls and all colours as JSON types: the one description that pygame, matplotlib and a browser draw.

    Parameters
    ----------
    table : str, Table or None
        As in ``snooker_env.simulate``.

    Returns
    -------
    dict
        Lengths in metres, to 1e-6. ``cushions``, ``noses``, ``falls``, ``throats``: as in ``Outline``, lists in place of arrays; ``extent``:
        [[lowest x, highest x], [lowest y, highest y]] of the bed; ``rail``, ``cushion``: ``RAIL``, ``CUSHION``; ``lines``: {"baulk", "d",
        "spots"}, or None on a table without snooker's marks; ``ball_radius``; ``palette``: {name: [red, green, blue]}; ``balls``: by id
        {"name", "letter", "value", "rgb"}.

    Examples
    --------
    >>> from snooker_env.render.scene import scene_data
    >>> data = scene_data("pool9")
    >>> data["lines"], len(data["cushions"]), data["balls"][21]["name"]
    (None, 6, 'black')
    """
    table = Table.of(table)
    parts = outline(table)
    marks = {"baulk": _rounded(BAULK_LINE), "d": _rounded(D_ARC), "spots": _rounded(SPOT_MARKS)} if is_marked(table) else None
    return {
        "cushions": [_rounded(polygon) for polygon in parts.cushions],
        "noses": [_rounded(nose) for nose in parts.noses],
        "falls": _rounded(parts.falls),
        "throats": _rounded(parts.throats),
        "extent": _rounded(extent(table)),
        "rail": RAIL,
        "cushion": CUSHION,
        "lines": marks,
        "ball_radius": float(table.ball_radius or BALL_RADIUS),
        "palette": {name: list(rgb) for name, rgb in PALETTE.items()},
        "balls": [
            {"name": NAMES[ball], "letter": LETTERS[ball], "value": int(VALUES[ball]), "rgb": COLOURS[ball].tolist()}
            for ball in range(N_BALLS)
        ],
    }


def _rounded(points):
    return (np.round(points, 6) + 0.0).tolist()  # + 0.0: no "-0.0"
