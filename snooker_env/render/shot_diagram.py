"""How are shots drawn as diagrams? Paths, impacts, speeds, the cut and the tip, on a ``Sketch`` for each."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, Protocol, TypeAlias, runtime_checkable

import numpy as np

from .._check import array, choice, number, refuse, refuse_what, truth
from .._types import Bools, Floats, Ints, Place, Vectors
from ..game.balls import N_BALLS, NAMES
from ..physics.engine import EventKind
from ..physics.table import Table
from .palette import PALE, Colour
from .shot_paths import Piece, Tip, arrow_places, contacts, cue_ball, paths, tip_of
from .sketch import CAPTIONS, PATH_WIDTH, WIDTH, Region, Sketch, flip, is_closed, pyplot, rgb

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..shot import Shot
else:  # a shot draws itself: its module stands above this one
    Shot = Any

View: TypeAlias = Literal["table", "shot"] | Sequence[Sequence[float]]
"""The part to show: all, as much as the shot needs, or ((lowest x, highest x), (lowest y, highest y)) [m]."""


@runtime_checkable
class Placed(Protocol):
    """Balls on a table, such as ``snooker_env.Position``."""

    def arrays(self) -> tuple[Floats, Bools, Ints]:
        """Places (22, 2) [m], which of them are on the table, and the state of the game."""
        ...


SLIDES = (255, 168, 36)  # colour of the stripes of a path on which the ball slides
DASHES = (0, (2.0, 1.6))  # lengths of these stripes, in widths of the path
MOST_PATHS = 7  # if more balls move, only those of cue ball, first object ball and potted balls are wide

_SIGNS: dict[EventKind, tuple[str, Colour, float, str]] = {
    EventKind.BALL_BALL: ("o", "text", 4.5, "ball"),
    EventKind.CUSHION: ("D", SLIDES, 4.5, "cushion"),
    EventKind.JAW: ("^", SLIDES, 5.5, "jaw"),
    EventKind.POT: ("X", "text", 7.0, "pocket"),
}  # marker, colour, size and name of each kind of impact


def plot(
    shot: Shot,
    ax: "Axes | None" = None,
    *,
    cue: Mapping[str, float] | None = None,
    view: View = "table",
    labels: bool = False,
    speeds: bool = True,
    caption: Literal["full", "short", "none"] = "full",
    title: str = "",
) -> "Axes":
    """Draw a shot from above, baulk left and black right.

    Balls are drawn where they were before the shot; faded ones show them when they meet another, and at rest.
    If many moved, the paths of the less important ones are thin. Paths have the balls' colours, striped where
    the ball slides and plain where it rolls. Signs mark impacts: a disc with a ball, a diamond with a cushion, a
    triangle with a jaw, a cross in a pocket. Under the table: the tip, speeds and the cut.

    Parameters
    ----------
    shot : Shot
        The shot, with its path and at most 22 balls; else ValueError.
    ax : matplotlib.axes.Axes, optional
        Axes to draw on; None makes a new figure. Axes with an earlier diagram keep their table and limits.
        The horizontal axis is y [m], the vertical one x [m] downwards: ``ax.plot(y, x)``.
    cue : mapping, optional
        How the cue ball was struck: "side" and "top" (tip offset over R, right and up), and if known "speed"
        [m/s], "elevation" and "aim" [rad]. None: computed from velocity and spin, level without side.
    view : "table", "shot" or ((float, float), (float, float))
        The part of the table to show: all of it (if it has cushions on all sides), as much as the shot needs,
        or a range of x and one of y [m].
    labels : bool
        Whether balls carry their letters.
    speeds : bool
        Whether the cue ball's speeds and the cut are written beside the path.
    caption : {"full", "short", "none"}
        The strip of text under the table. "short" is for axes of half the width, and omits the legend.
    title : str
        Title at the top left.

    Returns
    -------
    matplotlib.axes.Axes
        The axes of the diagram.

    Examples
    --------
    >>> import snooker_env as sn
    >>> v, w = sn.strike(speed=2.0, aim=1.5708, top=-0.3)
    >>> shot = sn.simulate([(0.0, 0.5), (0.02, 1.2)], [v[:2], (0.0, 0.0)], [w, (0.0, 0.0, 0.0)])
    >>> ax = shot.plot(view="shot", title="Screw")
    >>> ax.texts[0].get_text(), bool(ax.yaxis_inverted())
    ('Screw', True)
    """
    if len(shot.positions) > N_BALLS:
        raise refuse("balls of the shot", len(shot.positions), f"must be at most {N_BALLS}")
    truth("labels", labels)
    truth("speeds", speeds)
    choice("caption", caption, CAPTIONS)
    table, moved = shot.table or Table.of(None), paths(shot)
    first = cue_ball(shot)
    tip = _tip(cue, shot, first)
    sketch = Sketch(table, shot.physics.R, region_of(view, area(shot), table), ax, strip=CAPTIONS[caption])
    sketch.title(title)
    start, present = shot.at(0.0)[0][:, :2], shot.on_table | (shot.potted != -1)
    for ball in np.flatnonzero(present).tolist():
        sketch.ball(ball, start[ball], label=labels)
    _draw_paths(sketch, shot, moved, first)
    if speeds and first is not None:
        _write_speeds(sketch, shot, first, start)
    if sketch.depth:
        _write_strip(sketch, shot, first, tip, cue is not None, short=caption == "short")
    return sketch.ax


def region_of(view: View, points: Floats, table: Table) -> Region:
    """The part of the table that a view shows, for a shot with these points (m, 2) [m]."""
    if isinstance(view, str) and view in ("table", "shot"):
        whole = view == "table" and is_closed(table)
        return Region.of_table(table) if whole else Region.around(points, table)
    if isinstance(view, str) or np.shape(view) != (2, 2):
        allowed = 'must be "table", "shot" or ((lowest x, highest x), (lowest y, highest y))'
        raise refuse("view", view, allowed)
    (low_x, high_x), (low_y, high_y) = array("view", view, (2, 2)).tolist()
    if low_x >= high_x or low_y >= high_y:
        raise refuse("view", view, "must have its lower ends first")
    return Region(low_x, high_x, low_y, high_y)


def places_of(position: Placed | Vectors) -> tuple[Floats, Bools]:
    """Places (n, 2) [m] and flags (n,) of a ``Position`` or of an array."""
    if isinstance(position, Placed):
        return position.arrays()[:2]
    r = array("position", position, (-1, 2))
    if len(r) > N_BALLS:
        raise refuse_what("position", f"{len(r)} places", f"must be at most {N_BALLS}")
    return r, np.ones(len(r), bool)


def area(shot: Shot) -> Floats:
    """Points of the important paths of a shot: (m, 2) [m]."""
    moved = paths(shot)
    main = principals(shot, moved, cue_ball(shot))
    points = [piece.points for ball in main for piece in moved.get(ball, [])]
    return np.concatenate(points) if points else shot.positions[shot.on_table]


def principals(shot: Shot, moved: Mapping[int, Sequence[Piece]], first: int | None) -> set[int]:
    """The balls that matter: all that move, or if many do, cue ball, its first object ball, potted balls."""
    if len(moved) <= MOST_PATHS or first is None:
        return set(moved)
    met = [contact.other for contact in contacts(shot, first) if contact.kind == EventKind.BALL_BALL]
    return {first, *met[:1], *np.flatnonzero(shot.potted >= 0).tolist()} & set(moved)


def _draw_paths(sketch, shot, moved, first):
    """The paths of all balls that moved, their impacts and where they stopped; thin if they matter less."""
    main, start = principals(shot, moved, first), shot.at(0.0)[0][:, :2]
    for ball in sorted(moved, reverse=True):  # the cue ball last, on top
        if ball in main:
            _draw_path(sketch, moved[ball], ball)
            _draw_impacts(sketch, shot, ball, start)
        else:
            thin = np.concatenate([piece.points for piece in moved[ball]])
            sketch.ax.plot(*flip(thin).T, color=rgb(PALE[ball], 0.75), lw=0.8, zorder=4.0, gid="thin path")
        if shot.on_table[ball]:
            sketch.ghost(ball, shot.positions[ball], 0.62 if ball in main else 0.3)


def _draw_path(sketch: Sketch, path: Sequence[Piece], ball: int) -> None:
    """A ball's path in its colour: striped while it slides, plain while it rolls, dotted while it falls or flies."""
    for piece in path:
        style: dict[str, Any] = {"gid": f"{piece.kind}-{ball}"}
        if piece.kind == "slide":
            style |= {"ls": DASHES, "gapcolor": rgb(SLIDES)}
            style |= {"dash_capstyle": "butt", "solid_capstyle": "butt"}
        elif piece.kind in ("fall", "fly"):
            style |= {"ls": ":"}
        sketch.line(piece.points, PALE[ball], level=5.0 + 0.3 * (ball == 0), **style)
    points = np.concatenate([piece.points for piece in path])
    points = points[np.append(True, np.hypot(*np.diff(points, axis=0).T) > 0)]
    for place, direction in arrow_places(points, 0.085 * sketch.region.width):
        sketch.arrow(place, direction, PALE[ball])


def _draw_impacts(sketch, shot, ball, start):
    """Signs at the impacts of a ball, and a ghost of the ball at each if it has moved."""
    for contact in contacts(shot, ball):
        *sign, _ = _SIGNS[contact.kind]
        sketch.mark(contact.place, *sign, gid=f"{contact.kind.name.lower()}-{ball}")
        if contact.kind == EventKind.BALL_BALL and np.hypot(*(contact.centre - start[ball])) > 0.2 * sketch.R:
            sketch.ghost(ball, contact.centre)


def _write_speeds(sketch, shot, first, start):
    """The cue ball's speeds at the start and at its impacts, and the cut."""
    v = shot.at(0.0)[1][first, :2]
    sketch.label(start[first], f"{np.hypot(*v):.2f} m/s")
    for k, contact in enumerate(contacts(shot, first)):
        if k < 6 and contact.kind != EventKind.POT and contact.speed > 0.02:
            words = f"{contact.speed:.2f} m/s"
            if contact.kind == EventKind.BALL_BALL:
                words += f", cut {np.degrees(contact.cut):.0f}°"
                _draw_cut(sketch, contact)
            sketch.label(contact.place, words)


def _draw_cut(sketch, contact):
    """The cut, if balls are large enough: the old direction, the line of centres, and an arc between them."""
    if sketch.R * sketch.points_per_metre < 5.0:
        return
    v, line = contact.velocity, contact.place - contact.centre
    angles = np.arctan2(line[1], line[0]), np.arctan2(v[1], v[0])
    turn = (angles[1] - angles[0] + np.pi) % (2 * np.pi) - np.pi
    rays = angles[0] + turn * np.linspace(0.0, 1.0, 17)
    long = 7.0 * sketch.R
    for far, ray in ((long, rays[[0, 0]]), (long, rays[[-1, -1]]), (0.85 * long, rays)):
        points = contact.centre + far * np.stack([np.cos(ray), np.sin(ray)], axis=1)
        if ray is not rays:
            points[0] = contact.centre
        ls = "-" if ray is rays else (0, (3, 2))
        sketch.ax.plot(*flip(points).T, color=rgb("aim"), lw=1.0, ls=ls, zorder=6.5, gid="cut")


# the strip under the table


def _tip(cue: Mapping[str, float] | None, shot: Shot, first: int | None) -> Tip | None:
    """The strike of the tip, as given or computed from the spin; None if no cue gives such a spin."""
    if cue is not None:
        known = ("speed", "side", "top", "aim", "elevation")
        for key in cue:
            if key not in known:
                raise refuse("keys of cue", key, "must be of " + ", ".join(map(repr, known)))
        for key in ("side", "top"):
            if key not in cue:
                raise refuse("keys of cue", list(cue), f"must hold {key!r}")
        speed = cue.get("speed", 0.0 if first is None else float(np.hypot(*shot.at(0.0)[1][first, :2])))
        side, top = number("cue.side", cue["side"], -1, 1), number("cue.top", cue["top"], -1, 1)
        elevation = number("cue.elevation", cue.get("elevation", 0.0), 0, 1.5)
        return Tip(side, top, number("cue.speed", speed, 0), elevation)
    if first is None:
        return None
    _, v, w = shot.at(0.0)
    tip = tip_of(v[first, :2], w[first], shot.physics)
    return tip if np.hypot(tip.side, tip.top) <= 1.0 else None


def tip_words(tip: Tip) -> str:
    """The strike in words: "top 0.30 R, right side 0.20 R"."""
    words = []
    if abs(tip.top) >= 0.005:
        words.append(f"{'top' if tip.top > 0 else 'screw'} {abs(tip.top):.2f} R")
    if abs(tip.side) >= 0.005:
        words.append(f"{'right' if tip.side > 0 else 'left'} side {abs(tip.side):.2f} R")
    return ", ".join(words) or "centre ball"


def draw_tip(sketch: Sketch, tip: Tip | None, middle: Place, radius: float, limit: float) -> None:
    """Where the tip struck the cue ball; ``middle``: (y, x) [m]; ``limit``: offset of a miscue over R."""
    (y, x), disc = middle, sketch.disc
    disc((y, x), radius, fc=rgb((252, 248, 234)), ec=rgb("bar_edge"), lw=0.8, zorder=9.3, gid="inset")
    disc((y, x), limit * radius, fc="none", ec=rgb("text_quiet"), lw=0.7, ls=(0, (3, 2)), zorder=9.35)
    for line in ([(y - radius, y + radius), (x, x)], [(y, y), (x - radius, x + radius)]):
        sketch.ax.plot(*line, color=rgb("text_quiet", 0.6), lw=0.6, zorder=9.35)
    if tip is not None:
        place = (y + tip.side * radius, x - tip.top * radius)
        disc(place, 0.13 * radius, fc=rgb("bar_accent"), ec="none", zorder=9.4, gid="tip")


def _write_strip(sketch, shot, first, tip, known, *, short):
    rows, left = sketch.rows(4 if short else 3), sketch.region.low_y + 0.12 * sketch.depth
    facts = summary(shot, first)
    if first is not None:
        radius = (0.32 if short else 0.40) * sketch.depth
        middle = (left + radius, sketch.region.high_x + sketch.depth / 2)
        draw_tip(sketch, tip, middle, radius, shot.physics.max_offset)
        left += 2 * radius + 0.16 * sketch.depth
        if tip is None:
            lines = ["a spin that no tip gives"]
        else:
            raised = f", butt raised {np.degrees(tip.elevation):.0f}°" if tip.elevation > 0.005 else ""
            source = "worked out from the spin" + ("" if tip.elevation else ", cue level")
            source = "as it was struck" if known else source
            lines = [tip_words(tip), f"{tip.speed:.2f} m/s{raised}", *([] if short else [source])]
        sketch.text(left, rows[0], lines[0], weight="bold")
        for x, words in zip(rows[1:], lines[1:] + (facts[::2] if short else []), strict=False):
            sketch.text(left, x, words, "text_quiet" if words == lines[-1] and len(lines) == 3 else "text")
    if not short:
        for x, words in zip(rows, facts, strict=False):
            sketch.text(sketch.region.low_y + 0.425 * sketch.region.width, x, words)
        _write_legend(sketch, shot, rows)


def summary(shot: Shot, first: int | None) -> list[str]:
    """The result of a shot, in up to three lines."""
    if first is None:
        return ["nothing moves"]
    lines = []
    met = next((contact for contact in contacts(shot, first) if contact.kind == EventKind.BALL_BALL), None)
    if met is not None:
        back = (met.time, met.ball)  # the same meeting from the side of the other ball
        other = next(one for one in contacts(shot, met.other) if (one.time, one.other) == back)
        words = f"cut {np.degrees(met.cut):.0f}°, leaves with {other.after:.2f} m/s"
        lines.append(f"{_name(met.other)}: {words}")
        lines.append(f"cue ball: {met.speed:.2f} m/s before, {met.after:.2f} after")
    down = np.flatnonzero(shot.potted >= 0).tolist()
    names = shot.table.pockets if shot.table else ()
    into = [names[k] if names else f"pocket {k}" for k in shot.potted[down[:2]].tolist()]
    pots = "; ".join(f"{_name(ball)} into {pocket}" for ball, pocket in zip(down, into, strict=False))
    end = pots + (" ..." if len(down) > 2 else "") if pots else f"at rest after {shot.duration:.1f} s"
    return [*lines, end]


def _name(ball):
    return "cue ball" if ball == 0 else NAMES[ball]


def _write_legend(sketch, shot, row):
    """The legend of stripes and signs, with the signs that the diagram has."""
    w, long = sketch.region, 0.035 * sketch.region.width
    y = w.low_y + 0.735 * w.width
    line = {"lw": PATH_WIDTH, "zorder": 9.5}
    sketch.ax.plot([y, y + long], [row[0]] * 2, color=rgb(PALE[0]), ls=DASHES, gapcolor=rgb(SLIDES), **line)
    sketch.ax.plot([y, y + long], [row[1]] * 2, color=rgb(PALE[0]), **line)
    sketch.text(y + 1.35 * long, row[0], "slides")
    sketch.text(y + 1.35 * long, row[1], "rolls")
    sketch.ghost(0, (row[2], y + long / 2), radius=0.095 * sketch.depth, level=9.5)
    sketch.text(y + 1.35 * long, row[2], "at contact, at rest")
    y = w.low_y + 0.90 * w.width
    kinds = [kind for kind in _SIGNS if (shot.events["kind"] == int(kind)).any()]
    for x, kind in zip(row[:2], [kind for kind in kinds if kind != EventKind.POT], strict=False):
        *sign, words = _SIGNS[kind]
        sketch.mark((x, y), *sign, 9.5)
        sketch.text(y + 0.4 * long, x, words)


_GAP = 0.015  # between two diagrams, as a part of the figure's width


def compare(
    shots: Sequence[Shot],
    labels: Sequence[str] = (),
    axes: "Sequence[Axes] | None" = None,
    *,
    cues: Sequence[Mapping[str, float] | None] | None = None,
    view: View = "shot",
    **options: Any,
) -> "tuple[Axes, ...]":
    """Draw shots side by side, each as ``plot`` does, with the same part of the table.

    Parameters
    ----------
    shots : sequence of Shot
        The shots, all on the same table; else ValueError.
    labels : sequence of str
        A title for each shot, or () for none.
    axes : sequence of matplotlib.axes.Axes, optional
        Axes for each shot; None makes a new figure.
    cues : sequence of mapping or None, optional
        How each cue ball was struck, as ``cue`` in ``plot``.
    view, **options
        As in ``plot``; "shot": as much of the table as all shots need.

    Returns
    -------
    tuple of matplotlib.axes.Axes
        The axes of the diagrams.

    Examples
    --------
    >>> import snooker_env as sn
    >>> from snooker_env.render.diagrams import compare
    >>> struck = [sn.strike(speed=2.0, aim=1.5708, top=top) for top in (-0.3, 0.3)]
    >>> balls, still = [(0.0, 0.5), (0.02, 1.2)], (0.0, 0.0, 0.0)
    >>> shots = [sn.simulate(balls, [v[:2], (0.0, 0.0)], [w, still]) for v, w in struck]
    >>> len(compare(shots, ["screw", "follow"]))
    2
    """
    shots = list(shots)
    if not shots:
        raise refuse("shots", shots, "must hold at least one shot")
    for field, values in (("labels", labels), ("axes", axes), ("cues", cues)):
        if values is not None and len(values) not in ({0, len(shots)} if field == "labels" else {len(shots)}):
            raise refuse_what(field, f"{len(values)} of them", f"must be {len(shots)}, one for each shot")
    table = shots[0].table
    for k, shot in enumerate(shots):
        if shot.table is not table:
            raise refuse_what(f"shots[{k}].table", "another table", "must be that of shots[0]")
    points = np.concatenate([area(shot) for shot in shots])
    region = region_of(view, points, Table.of(None) if table is None else table)
    caption = options.pop("caption", "full" if len(shots) == 1 else "short")
    if axes is None:
        n = len(shots)
        wide = (1.0 - (n - 1) * _GAP) / n
        high = wide * (region.height / region.width + CAPTIONS.get(caption, 0.0))
        figure = pyplot().figure(figsize=(WIDTH, WIDTH * high), facecolor=rgb("floor"))
        axes = [figure.add_axes((k * (wide + _GAP), 0.0, wide, 1.0)) for k in range(n)]
    over = options | {"view": np.array(region).reshape(2, 2), "caption": caption}
    each = zip(shots, axes, labels or [""] * len(shots), cues or [None] * len(shots), strict=True)
    return tuple(plot(shot, ax, cue=cue, title=title, **over) for shot, ax, title, cue in each)
