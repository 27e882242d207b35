"""Where can the cue ball go? A fan: its paths for the same pot with every top and side of a range."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .._check import array, integer, number, refuse, refuse_what
from .._types import Flags, Floats
from ..game.balls import CUE, N_BALLS
from ..impacts import strike
from ..physics.engine import EventKind
from ..physics.parameters import Physics, PhysicsLike
from ..physics.table import Table, TableLike
from ..render.shot_diagram import SLIDES, View, places_of, region_of
from ..render.shot_paths import contacts, cue_ball, paths
from ..render.sketch import CAPTIONS, Sketch, rgb
from ..shot import Shot
from ..simulation import simulate, simulate_batch

if TYPE_CHECKING:
    from matplotlib.axes import Axes
else:  # matplotlib is loaded at its first use
    Axes = Any

TOPS, SIDES = (-0.4, -0.2, 0.0, 0.2, 0.4), (-0.25, 0.0, 0.25)  # default tip offsets over R
SHADES = ((58, 132, 240), (150, 205, 255), (255, 255, 255), (255, 190, 120), (240, 84, 46))
"""Colours of the tops from lowest to highest: screw is blue, follow is red."""
_MARKS = ("<", "o", ">")  # of side: left, none, right
_SHIFTS = np.radians(np.linspace(-4.0, 4.0, 321))


class Strokes(NamedTuple):
    """The strokes of a fan: every pair of a top and a side."""

    speed: float
    tops: Sequence[float]
    sides: Sequence[float]
    elevation: float = 0.0
    aim: float | None = None


class Option(NamedTuple):
    """One stroke of a fan."""

    top: float
    side: float
    aim: float  # direction of the cue [rad]
    shot: Shot


def fan(
    position: Any,
    ball: int | None = None,
    pocket: int | None = None,
    ax: Axes | None = None,
    *,
    speed: float = 2.0,
    tops: Sequence[float] = TOPS,
    sides: Sequence[float] = SIDES,
    elevation: float = 0.0,
    aim: float | None = None,
    table: TableLike = "match",
    physics: PhysicsLike = None,
    on_table: Flags | None = None,
    view: View = "shot",
    labels: bool = False,
    title: str = "",
) -> Axes:
    """Draw the cue ball's paths of one pot, played with every pair of a top and a side.

    As in Fig. 1 of the paper. Of the aims that pot the ball, which squirt and throw change, the middle one is
    played. A path's colour is its top, from screw (blue) to follow (red); the sign at its end is its side.

    Parameters
    ----------
    position : Position, or array_like, float (n, 2)
        Positions of the balls [m], the cue ball first.
    ball : int, optional
        The ball to pot; None: the other one of two.
    pocket : int, optional
        The pocket, an index of the table's falls; None: the one with the smallest cut.
    ax : matplotlib.axes.Axes, optional
        Axes to draw on; None makes a new figure.
    speed : float
        Speed that the cue gives [m/s].
    tops, sides : sequence of float
        Tip offsets over R, up and to the right; ValueError if one of the strokes cannot pot the ball.
    elevation, aim : float
        Of the cue [rad]; direction of every stroke [rad], if it is given: then no ball needs to be potted.
    table, physics, on_table
        As in ``snooker_env.simulate``; ``on_table``, bool (n,): False for balls of an array to leave out.
    view, labels, title
        As in ``plot``.

    Returns
    -------
    matplotlib.axes.Axes
        The axes of the diagram.

    Examples
    --------
    >>> from snooker_env.advice import fan
    >>> ax = fan([(0.45, 0.85), (0.62, 1.45)], tops=(-0.3, 0.3), sides=(0.0,))
    >>> len([line for line in ax.get_lines() if line.get_gid() == "fan"])
    2
    """
    table, physics = Table.of(table), Physics.of(physics)
    r, here = _places(position, on_table)
    drawn = fan_options(r, here, ball, pocket, Strokes(speed, tops, sides, elevation, aim), table, physics)
    shots = [option.shot for option in drawn]
    region = region_of(view, np.concatenate([*map(_way, shots), _ends(shots)]), table)
    sketch = Sketch(table, physics.R, region, ax, strip=0.8 * CAPTIONS["full"])
    sketch.title(title)
    for k in np.flatnonzero(here).tolist():
        sketch.ball(k, r[k], label=labels)
    ranked = sorted(set(tops))
    for option in drawn:
        path, met = _way(option.shot), _met(option.shot)
        colour = shade(option.top, ranked)
        sketch.line(path, colour, width=1.5, gid="fan")
        mark = _MARKS[1 + int(np.sign(round(option.side, 9)))]
        sketch.mark(path[-1], mark, colour, 7.0, gid="end")
        if met is not None and option is drawn[len(drawn) // 2]:
            sketch.line(np.array([r[CUE], met.centre]), "text", width=1.5, ls=(0, (4, 2)), gid="approach")
            sketch.ghost(CUE, met.centre)
            gone = np.concatenate([piece.points for piece in paths(option.shot)[met.other]])
            sketch.line(gone, SLIDES, width=1.2, ls=(0, (4, 2)), gid="object")
    _write(sketch, drawn, ranked, speed)
    return sketch.ax


def fan_options(
    r: Floats, here: Any, ball: Any, pocket: Any, strokes: Strokes, table: Table, physics: Physics
) -> list[Option]:
    """The strokes of a fan: for each top and side the aim (or one that pots the ball) and the shot."""
    speed, tops, sides, elevation, aim = strokes
    tops, sides = array("tops", tops, (-1,)).tolist(), array("sides", sides, (-1,)).tolist()
    if not tops or not sides:
        raise refuse("(tops, sides)", (tops, sides), "must each hold at least one number")
    if aim is not None:
        aims = np.array([number("aim", aim)])
    else:
        ball = _object(ball, here)
        pocket, line = _line(r, ball, pocket, table, physics.R)
        aims = line + _SHIFTS
    drawn, b = [], len(aims)
    for top in tops:
        for side in sides:
            struck = [strike(speed, one, side, top, elevation, physics) for one in aims]
            v, w = np.zeros((b, len(r), 2)), np.zeros((b, len(r), 3))
            v[:, CUE], w[:, CUE] = [one[:2] for one, _ in struck], [spin for _, spin in struck]
            k = 0
            if aim is None:
                tiled = np.tile(r, (b, 1, 1)), v, w
                batch = simulate_batch(*tiled, table, physics, on_table=np.tile(here, (b, 1)))
                good = np.flatnonzero(batch.potted[:, ball] == pocket)
                if not len(good):
                    near = f"no aim within {np.degrees(_SHIFTS[-1]):.0f} degrees of the ghost ball does"
                    allowed = f"must pot ball {ball} into pocket {pocket}, and {near}"
                    raise refuse("(top, side, speed)", (top, side, speed), allowed)
                k = int(good[len(good) // 2])
            shot = simulate(r, v[k], w[k], table, physics, on_table=here)
            drawn.append(Option(top, side, float(aims[k]), shot))
    return drawn


def _places(position, on_table):
    """Positions (n, 2) and flags (n,) of a Position or of an array."""
    own = hasattr(position, "arrays")
    if own and on_table is not None:
        raise refuse_what("on_table", "given", "must be left out with a Position, which has its own")
    r, here = places_of(position, 2)
    here = here if on_table is None else np.array(on_table)
    if not own and (here.shape != (len(r),) or here.dtype != np.bool_ or not here[CUE]):
        raise refuse("on_table", on_table, f"must be bool of shape ({len(r)},), True for the cue ball")
    return r, here


def _object(ball, here):
    others = np.flatnonzero(here)[1:].tolist()
    if ball is None and len(others) == 1:
        return others[0]
    if ball is None or integer("ball", ball, 0, N_BALLS - 1) not in others:
        raise refuse("ball", ball, f"must be one of those on the table, {others}")
    return ball


def _line(r, ball, pocket, table, R):
    """The pocket, and the direction from the cue ball to the ghost ball for it [rad]."""
    if not len(table.falls):
        raise refuse("aim", None, "must be given: the table has no pockets")
    to_pocket = table.falls[:, :2] - r[ball]
    units = to_pocket / np.hypot(*to_pocket.T)[:, None]
    ways = r[ball] - 2 * R * units - r[CUE]
    if pocket is None:
        pocket = int(np.argmax((units * ways).sum(axis=1) / np.hypot(*ways.T)))
    k = integer("pocket", pocket, 0, len(table.falls) - 1)
    return k, float(np.arctan2(ways[k, 1], ways[k, 0]))


def _met(shot):
    """The cue ball's first meeting with another ball, or None."""
    first = cue_ball(shot)
    meetings = () if first is None else contacts(shot, first)
    return next((one for one in meetings if one.kind == EventKind.BALL_BALL), None)


def _way(shot):
    """The cue ball's path after it has met a ball, or all of it if it meets none: (m, 2) [m]."""
    met = _met(shot)
    since = -np.inf if met is None else met.time
    pieces = [piece for piece in paths(shot).get(CUE, []) if piece.times[-1] > since]
    points = [piece.points[piece.times >= since] for piece in pieces]
    return np.concatenate(points) if points else shot.positions[[CUE]]


def _ends(shots):
    """Where the cue ball starts, where it meets the ball, and where that ball stops: (m, 2) [m]."""
    places = []
    for shot in shots:
        met = _met(shot)
        places.append(shot.at(0.0)[0][CUE, :2])
        if met is not None:
            places += [met.centre, shot.positions[met.other]]
    return np.array(places)


def shade(top: float, tops: Sequence[float]) -> tuple[int, ...]:
    """The colour of one of the tops, from ``SHADES``; white for no top."""
    place = len(SHADES) // 2 * (1.0 + top / (max(map(abs, tops)) or 1.0))
    parts = zip(*SHADES, strict=True)
    return tuple(round(float(np.interp(place, range(len(SHADES)), part))) for part in parts)


def _write(sketch, options, tops, speed):
    """Write the legend of colours and signs."""
    w, depth = sketch.region, sketch.depth
    if not depth:
        return
    rows = sketch.rows(2)
    y = w.low_y + 0.03 * w.width
    sketch.text(y, rows[0], f"{speed:.2f} m/s, tip offsets in R", weight="bold")
    sketch.text(y, rows[1], "the sign at the end is the side:")
    sides = sorted({option.side for option in options})
    for k, side in enumerate(sides):
        at = y + (0.36 + 0.17 * k) * w.width
        sketch.mark((rows[1], at), _MARKS[1 + int(np.sign(round(side, 9)))], "text", 6.5, 9.5)
        words = "none" if side == 0 else f"{'right' if side > 0 else 'left'} {abs(side):.2f}"
        sketch.text(at + 0.018 * w.width, rows[1], words)
    step = 0.68 / max(len(tops), 4)
    for k, top in enumerate(tops):
        at = y + (0.285 + step * k) * w.width
        ends, ink = [at, at + 0.028 * w.width], rgb(shade(top, tops))
        sketch.ax.plot(ends, [rows[0]] * 2, color=ink, lw=3.0, zorder=9.5)
        words = "centre" if top == 0 else f"{'top' if top > 0 else 'screw'} {abs(top):.2f}"
        sketch.text(at + 0.036 * w.width, rows[0], words)
