"""Where does the cue ball stop after a red, and what does that bring? A picture of agents side by side.

    python -m agents.evaluate --agent planner ghost_ball --layouts held_out --noise professional
    --picture

Maps: how densely the cue ball came to rest after first strokes that potted a red. Only first strokes count,
since all agents play these from the same positions. Bars: what followed any pot, with 95 % intervals.
"""

from functools import partial

import numpy as np
from matplotlib.backend_bases import FigureCanvasBase

from commands import picture_style
from snooker_env import Table
from snooker_env.game import BallOn
from snooker_env.geometry import BALL_RADIUS, HALF_LENGTH, HALF_WIDTH
from snooker_env.render import BAULK_LINE, COLOURS, CUSHION, D_ARC, SPOT_MARKS, outline

from .metrics import main_condition

CELL = 0.01
"""Size of the cells of the maps [m]."""
MOST = 3
"""Agents side by side."""
DENSEST = 4.0
"""The end of the colours: times the density of places spread evenly over the table."""
BARS = (picture_style.BLUE, picture_style.ORANGE, picture_style.GREY)
FIGURES = (
    ("next_pot_after_a_pot", "Next pot\nafter a pot", 100, "{:.0f} %"),
    ("easy_pot_left_by_a_pot", "A pot leaves\nan easy pot", 100, "{:.0f} %"),
    ("high_colour_after_a_red", "Pink or black\nafter a red", 100, "{:.0f} %"),
    ("colour_value", "Mean value of\ncolours potted", 1, "{:.2f}"),
    ("points_a_visit", "Points\na visit", 1, "{:.1f}"),
)


def formats():
    """Suffixes of the files that matplotlib can write."""
    return [f".{name}" for name in FigureCanvasBase.get_supported_filetypes()]


def first_reds(strokes):
    """Where the cue ball lay after first strokes that potted a red, (n, 2) [m]; whether the next scored."""
    chosen = (strokes.number == 0) & strokes.made & (strokes.ball_on == BallOn.RED)
    return strokes.cue[chosen], strokes.made[strokes.following[chosen]]


def bandwidth_of(points):
    """The bandwidth [m] by Scott's rule: standard deviation times m^(-1/6), at least 1 cm and at most 15 cm."""
    spread = float(np.sqrt(points.var(axis=0).mean()))
    return float(np.clip(spread * len(points) ** (-1 / 6), 0.01, 0.15))


def density_of(points, low, high, bandwidth):
    """A density (nx, ny) [1/m^2] with Gaussian kernels from corner ``low`` to ``high``, in cells of 1 cm."""
    # tails beyond the corners are folded back: the sum is the share of points inside
    n = np.maximum(1, np.round((high - low) / CELL).astype(int))
    size = (high - low) / n
    counts, _, _ = np.histogram2d(*points.T, bins=n.tolist(), range=[(low[0], high[0]), (low[1], high[1])])
    values = counts / (len(points) * size.prod())
    for axis in range(2):
        half = int(min(np.ceil(3.0 * bandwidth / size[axis]), n[axis]))
        bell = np.exp(-0.5 * (np.arange(-half, half + 1) * size[axis] / bandwidth) ** 2)
        wide = np.pad(values, [(half, half) if k == axis else (0, 0) for k in range(2)], mode="symmetric")
        values = np.apply_along_axis(partial(np.convolve, v=bell / bell.sum(), mode="valid"), axis, wide)
    return values


def level_of(values, share):
    """The density above which a share of the total lies."""
    ranked = np.sort(values.ravel())[::-1]
    return float(ranked[min(np.searchsorted(np.cumsum(ranked), share * ranked.sum()), len(ranked) - 1)])


def figures_of(report, strokes):
    """What is drawn, JSON-able, of the first agents; ``strokes``: label -> ``Strokes`` of each run."""
    at = main_condition(report)
    rows = {r["agent"]: r for r in report["results"] if all(r[key] == value for key, value in at.items())}
    agents = {}
    for agent in report["agents"][:MOST]:
        places, scored = first_reds(strokes[agent["label"]][0])  # of one run each: the same chances
        figures = {name: rows[agent["label"]]["figures"][name] for name, *_ in FIGURES}
        drawn = {"places": np.round(places, 3).tolist(), "next_scores": scored.tolist()}
        agents[agent["label"]] = drawn | {"figures": figures}
    visits = next(iter(rows.values()))["visits"]
    return {"version": report["version"], "visits": visits, "noise": at["noise"], "agents": agents}


def draw(report, strokes, file):
    """Draw the first agents of the report; ``strokes``: as in ``figures_of``, in the main condition."""
    found = figures_of(report, strokes)
    agents, visits = found["agents"], found["visits"]
    note = (
        f"First strokes that potted a red, from the same {visits:,} held-out tables, with {found['noise']} execution errors.\n"
        "Colour: how often the cue ball stops there; line: the densest area, which holds half of all. Below: all strokes of these\n"
        "visits (an easy pot: the aim may err by 0.23° or more), black lines: 95 % intervals."
    )
    foot = f"python -m agents.evaluate --picture, snooker_env {found['version']}"
    with picture_style.drawing() as plt:
        title = "Where the cue ball stops after a potted red"
        figure, _ = picture_style.page(plt, 8.6, title, note, foot=foot)
        upper, lower = figure.subfigures(2, 1, height_ratios=(4.9, 1.1 + 0.22 * len(agents)))
        axes, shown = upper.subplots(1, len(agents), squeeze=False)[0], None
        for ax, (label, of) in zip(axes, agents.items(), strict=True):
            shown = table(ax, label, np.array(of["places"]).reshape(-1, 2), np.array(of["next_scores"], bool))
        ticks, label = range(int(DENSEST) + 1), "times the density of an even spread"
        picture_style.colour_bar(upper, shown, list(axes), label, ticks, extend="max")
        panels = zip(lower.subplots(1, len(FIGURES)), FIGURES, strict=True)
        for k, (ax, (name, title, scale, form)) in enumerate(panels):
            names = list(agents) if k == 0 else [""] * len(agents)
            bars(ax, names, [of["figures"][name] for of in agents.values()], title, scale, form)
        picture_style.save(figure, file)
        plt.close(figure)


def table(axes, label, places, went_in):
    """One agent's table, its black end up, with the density of its places; what is drawn in colour."""
    from matplotlib.patches import Circle, Polygon, Rectangle

    parts, high = outline(Table.preset("match")), np.array([HALF_WIDTH, HALF_LENGTH])
    outer, frame = high + CUSHION, {"fc": picture_style.GRID, "ec": picture_style.GREY}
    axes.add_patch(Rectangle(tuple(-outer), *(2 * outer), lw=1.0, **frame))
    axes.add_patch(Rectangle(tuple(-high), *(2 * high), fc="white", lw=0))
    inner, shown = high - BALL_RADIUS, None
    if len(places):
        density = density_of(np.clip(places, -inner, inner), -inner, inner, bandwidth_of(places))
        times = density * 4 * inner.prod()
    else:
        times = np.zeros((2, 2))
    edges = (-inner[0], inner[0], -inner[1], inner[1])
    colours = {"vmin": 0, "vmax": DENSEST, "cmap": picture_style.HEAT}
    shown = axes.imshow(times.T, extent=edges, origin="lower", zorder=1, aspect="equal", **colours)
    if len(places):
        line = {"levels": [level_of(times, 0.5)], "colors": [picture_style.INK], "linewidths": 1.0}
        axes.contour(times.T, extent=edges, zorder=2, **line)
    for polygon in parts.cushions:
        axes.add_patch(Polygon(polygon, fc=picture_style.GREY, lw=0, zorder=3))
    for x, y, radius in parts.falls:
        axes.add_patch(Circle((x, y), radius, fc=picture_style.INK, lw=0, zorder=3.5))
    for line in (BAULK_LINE, D_ARC):
        axes.plot(*line.T, color=picture_style.GREY, lw=0.9, zorder=2.5)
    for spot, colour in zip(SPOT_MARKS, COLOURS[16:], strict=True):
        axes.plot(*spot, "o", color=colour / 255, ms=6.5, mec="white", mew=1.0, zorder=4)
    reach = high + CUSHION + 0.02
    axes.set(xlim=(-reach[0], reach[0]), ylim=(-reach[1], reach[1]), aspect="equal")
    axes.axis("off")
    axes.set_title(label, loc="center")
    share = f"{100 * went_in.mean():.0f} %" if len(went_in) else "none"
    below = {"transform": axes.transAxes, "ha": "center", "va": "top", "size": picture_style.TEXT}
    axes.text(0.5, -0.01, f"the next stroke scores: {share}", **below)
    return shown


def bars(axes, labels, figures, title, scale, form):
    """One figure of every agent, with its interval."""
    largest = max([scale * (f["high"] or f["value"] or 0) for f in figures] + [1e-9])
    for k, f in enumerate(figures):
        if f["value"] is None:
            continue
        axes.barh(-k, scale * f["value"], color=BARS[k], height=0.72)
        if f["low"] is not None:
            axes.plot([scale * f["low"], scale * f["high"]], [-k, -k], color=picture_style.INK, lw=1.4)
        at = scale * (f["high"] if f["high"] is not None else f["value"]) + 0.05 * largest
        axes.text(at, -k, form.format(scale * f["value"]), va="center", size=picture_style.SMALL)
    axes.set_title(title, size=picture_style.TEXT)
    axes.set_xlim(0, 1.6 * largest)
    axes.set_ylim(-len(figures) + 0.4, 0.6)
    axes.set_yticks([-k for k in range(len(labels))], labels)
    axes.tick_params(length=0, labelcolor=picture_style.INK)
    axes.set_xticks([])
    axes.grid(False)
    axes.spines["bottom"].set_visible(False)
    axes.patch.set_visible(False)
