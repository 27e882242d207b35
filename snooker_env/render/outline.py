"""Where are the fixed parts of a table? Cushions, falls, holes and lines [m]."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from .._lib.types import Floats
from ..game.balls import NAMES, VALUES
from ..geometry import BALL_RADIUS, BAULK_Y, COLOUR_SPOTS, D_RADIUS, HALF_LENGTH, HALF_WIDTH
from ..physics.columns import JAW_RADIUS
from ..physics.table import Table, TableLike
from .palette import COLOURS, LETTERS, PALETTE

RAIL, CUSHION = 0.155, 0.050  # from the nose line to the table's outer edge, and to the wood [m]
BAULK_LINE = np.array([(-HALF_WIDTH, BAULK_Y), (HALF_WIDTH, BAULK_Y)])  # its ends [m]
_TURN = np.linspace(np.pi, 2 * np.pi, 65)
D_ARC = np.stack([D_RADIUS * np.cos(_TURN), BAULK_Y + D_RADIUS * np.sin(_TURN)], axis=1)  # (65, 2) [m]
_SNOOKER = np.array([(-HALF_WIDTH, HALF_WIDTH), (-HALF_LENGTH, HALF_LENGTH)])

for _constant in (BAULK_LINE, D_ARC):
    _constant.setflags(write=False)


@dataclass(frozen=True, eq=False)
class Outline:
    """The fixed parts of a table [m], all empty for unbounded cloth."""

    cushions: tuple[
        Floats, ...
    ]  # (m, 2): closed polygons of nose, jaws and the cushion's back under the wood
    noses: tuple[Floats, ...]  # (m, 2): the line that balls meet at each cushion, jaw - nose - jaw
    falls: Floats  # (k, 3): centre and radius of the slate's holes
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
    return Outline(tuple(cushions), tuple(noses), table.falls, np.array(throats).reshape(-1, 5))


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
        "falls": _round(parts.falls),
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
