"""How does matplotlib draw a shot? On the picture of the table, in metres: a point (x, y) is at ``ax.plot(y, x)``."""

from typing import TYPE_CHECKING, Any

import numpy as np

from .._lib.check import refuse
from .._lib.install import missing
from .._lib.types import Floats, Vector
from ..game.balls import CUE, N_BALLS
from ..physics.cloth import SEGMENT_BALL, SEGMENT_STATE, SLIDE, T0
from ..physics.engine import EventKind
from ..physics.table import Table
from .palette import COLOURS, PALE, PALETTE
from .scene import RAIL, extent, find_contacts, trace_paths
from .table_picture import MARGIN, View, table_picture

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..simulation.shot import Shot
else:  # a shot draws itself: its module stands above this one
    Shot = Any

WIDTH = 8.3  # of a new figure [inches]
PIXELS = (1660, 1000)  # of the table's picture
RIM = RAIL + MARGIN  # shown around the bed [m]
SLIDES = (255, 168, 36)  # colour of the stripes of a path on which the ball slides
MOST_SPEEDS = 6  # written along the cue ball's path
APART = 0.15  # least distance between two of them [m]
NEAR = 0.12  # a cushion nearer than this [m] would be written on


def draw_shot(shot: Shot, ax: "Axes | None" = None) -> "Axes":
    """Draw a shot on axes or a new figure, see ``Shot.plot``."""
    if len(shot.positions) > N_BALLS:
        raise refuse("balls of the shot", len(shot.positions), f"must be at most {N_BALLS}")
    start, R = shot.at(0.0)[0][:, :2], shot.physics.R
    ax = draw_table(shot.table or Table.of(None), ax)
    for ball in np.flatnonzero(shot.on_table | (shot.potted != -1)).tolist():
        draw_ball(ax, ball, start[ball], R)
    paths = trace_paths(shot, range(len(shot.positions)))
    for ball in sorted(paths, reverse=True):  # the cue ball last, on top
        points, times = paths[ball]
        draw_path(ax, points, PALE[ball])
        rows = shot.segments[shot.segments[:, SEGMENT_BALL] == ball]
        here = np.searchsorted(rows[:, T0], (times[1:] + times[:-1]) / 2, side="right") - 1
        slides = np.append(rows[here, SEGMENT_STATE] == SLIDE, False)
        for part in np.split(np.arange(len(times)), np.flatnonzero(np.diff(slides)) + 1):
            if slides[part[0]]:
                stripe = _flip(points[part[0] : part[-1] + 2]).T
                ax.plot(*stripe, color=_rgb(SLIDES), lw=2.2, ls=(0, (2, 2)), zorder=5.1, gid="slides")
        stops = [shot.positions[ball]] if shot.on_table[ball] else []
        for place in (*find_contacts(shot, ball)[0], *stops):
            draw_ball(ax, ball, place, R, 0.5)
    if paths:  # all of it is seen, where a table is open too
        every = _flip(np.concatenate([points for points, _ in paths.values()]))
        (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
        (low_y, low_x), (high_y, high_x) = every.min(axis=0) - 2 * R, every.max(axis=0) + 2 * R
        ax.set(xlim=(min(left, low_y), max(right, high_y)), ylim=(max(bottom, high_x), min(top, low_x)))
    if CUE in paths:
        _write_speeds(ax, shot)
    return ax


def draw_table(table: Table, ax: "Axes | None" = None) -> "Axes":
    """Show a table on axes, or on a new figure: y [m] to the right and x [m] down."""
    try:
        from matplotlib import pyplot as plt
    except ImportError as error:
        raise missing("diagrams need matplotlib", "plot") from error
    (low_x, high_x), (low_y, high_y) = extent(table) + np.array([-RIM, RIM])
    if ax is None:
        size = WIDTH, WIDTH * (high_x - low_x) / (high_y - low_y)
        ax = plt.figure(figsize=size, layout="constrained").add_subplot()
    view = View.of(table, PIXELS)
    picture = table_picture(table, view)[: view.height - view.bar]
    (high, wide), far = picture.shape[:2], view.scale
    edges = -view.x / far, (wide - view.x) / far, (high - view.y) / far, -view.y / far
    ax.imshow(picture, extent=edges, zorder=0.0)
    ax.set(xlim=(low_y, high_y), ylim=(high_x, low_x), xticks=[], yticks=[], facecolor=_rgb(PALETTE["cloth"]))
    ax.grid(False)
    return ax


def draw_ball(ax: "Axes", ball: int, place: Vector, radius: float, alpha: float = 1.0) -> None:
    """A ball at a place [m]; a faint ball shows a contact or where it stops."""
    from matplotlib.patches import Circle

    inks = {"fc": _rgb(COLOURS[ball], alpha), "ec": _rgb(0.5 * COLOURS[ball], alpha)}
    y, x = _flip(place)
    ax.add_patch(Circle((y, x), radius, zorder=6.0 + (alpha == 1.0), gid=f"ball-{ball}", lw=0.6, **inks))


def draw_path(ax: "Axes", points: Floats, colour: Vector, width: float = 2.2) -> None:
    """A line (m, 2) [m] with a dark outline."""
    edge = _edge(1.6 + width)
    ax.plot(*_flip(points).T, color=_rgb(colour), lw=width, zorder=5.0, path_effects=edge, gid="path")


def _write_speeds(ax: "Axes", shot: Shot) -> None:
    """Write the cue ball's speed at the start and just before its impacts, and the cut at balls."""
    events = shot.events
    balls = (events["kind"] == EventKind.BALL_BALL) & ((events["i"] == CUE) | (events["j"] == CUE))
    rails = np.isin(events["kind"], (EventKind.CUSHION, EventKind.JAW)) & (events["i"] == CUE)
    bed = extent(shot.table or Table.of(None))
    style: dict[str, Any] = {"textcoords": "offset points", "weight": "bold", "size": 9, "zorder": 8.0}
    style |= {"color": _rgb(PALETTE["text"]), "path_effects": _edge(2.4)}
    written: list[Floats] = []
    for time, kind, i, j in [
        (0.0, -1, CUE, CUE),
        *events[["time", "kind", "i", "j"]][balls | rails].tolist(),
    ]:
        r, v = shot.at(time)[0][:, :2], shot.at(max(0.0, np.nextafter(time, -1.0)))[1][CUE, :2]
        place, words = r[CUE], f"{np.hypot(*v):.2f} m/s"
        if kind == EventKind.BALL_BALL:
            line = r[j if i == CUE else i] - place
            cut = np.arctan2(abs(v[0] * line[1] - v[1] * line[0]), v @ line)
            words += f", cut {np.degrees(cut):.0f}°"
        if len(written) < MOST_SPEEDS and all(np.hypot(*(place - other)) > APART for other in written):
            written.append(place)
            (above, _), (left, right) = np.abs(bed - place[:, None]).tolist()  # how far the cushions are
            side, va = (1, "top") if above < NEAR else (-1, "bottom")  # below the ball, or above it
            ha = "left" if left < 2 * NEAR else "right" if right < 2 * NEAR else "center"
            at = tuple(_flip(place + np.array([side * shot.physics.R, 0.0])))
            ax.annotate(words, at, (0, -3 * side), ha=ha, va=va, **style)


def _flip(points: object) -> Floats:
    """Points (..., 2) in the order for matplotlib: y to the right, x down."""
    return np.asarray(points, np.float64)[..., ::-1]


def _rgb(colour: object, alpha: float = 1.0) -> Any:
    """Red, green and blue up to 255, in matplotlib's form."""
    return (*np.asarray(colour, np.float64) / 255, alpha)


def _edge(width: float) -> list[Any]:
    """The ``path_effects`` of lines and words with a dark outline, ``width`` [points] wide."""
    from matplotlib.patheffects import withStroke

    return [withStroke(linewidth=width, foreground=_rgb(PALETTE["path_edge"]))]
