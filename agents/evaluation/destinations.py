"""Where does the cue ball stop after a red, and what does that bring? A picture of agents side by side, on the same tables.

    python -m agents.evaluate --agent learned=runs/ppo_mask-0 ghost_ball --layouts held_out --noise professional --picture

Each dot is a visit: where the cue ball came to rest after its first stroke had potted a red, light if the colour after it went in, dark
if not. Only first strokes, since these are played from the same positions by everyone. Beside the tables: what followed any pot.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.backend_bases import FigureCanvasBase
from matplotlib.patches import Circle, Polygon, Rectangle
from matplotlib.patheffects import withStroke

from commands.files import save_figure
from snooker_env import Table
from snooker_env.game import BallOn
from snooker_env.geometry import HALF_LENGTH, HALF_WIDTH
from snooker_env.render import BAULK_LINE, COLOURS, CUSHION, D_ARC, RAIL, SPOT_MARKS, outline

from .report import main_condition

mpl.use("Agg")
import matplotlib.pyplot as plt

MOST = 3
"""Agents side by side."""
CLOTH, RUBBER, WOOD, LINE = "#1d6b4c", "#154f38", "#4a2f22", "#7fb49c"
WENT_IN, MISSED = "#ffe9a8", "#06130d"
BARS = ("#c8963e", "#3f6f8f", "#8a8f98")
INK, LEAST, LARGEST = 14_000.0, 2.0, 20.0
"""All dots of the fullest table together, the smallest and the largest dot [points squared]."""
FIGURES = (
    ("next_pot_after_a_pot", "next pot after a pot", 100, "{:.0f} %"),
    ("easy_pot_left_by_a_pot", "an easy pot is left by a pot", 100, "{:.0f} %"),
    ("colour_value", "value of the colour potted", 1, "{:.2f}"),
    ("high_colour_after_a_red", "pink or black after a red", 100, "{:.0f} %"),
    ("points_a_visit", "points a visit", 1, "{:.1f}"),
)


def formats():
    """Suffixes of the files that matplotlib can write."""
    return [f".{name}" for name in FigureCanvasBase.get_supported_filetypes()]


def first_reds(strokes):
    """Where the cue ball lay after first strokes that potted a red, (n, 2) [m], and whether the next stroke scored, (n,)."""
    chosen = (strokes.number == 0) & strokes.made & (strokes.ball_on == BallOn.RED)
    return strokes.cue[chosen], strokes.made[strokes.following[chosen]]


def draw(report, strokes, file):
    """Draw the first agents of the report; ``strokes``: label -> list of the ``Strokes`` of each run in the main condition."""
    labels = [agent["label"] for agent in report["agents"]][:MOST]
    at = main_condition(report)
    rows = {r["agent"]: r for r in report["results"] if all(r[key] == value for key, value in at.items())}
    names = 0.2 + 0.08 * max(map(len, labels))  # inches, as wide as the longest name beside its bar
    width = 2.75 * len(labels) + names + 2.5
    figure = plt.figure(figsize=(width, 6.6), facecolor="white")
    grid = figure.add_gridspec(
        len(FIGURES), len(labels) + 2, width_ratios=[2.6] * len(labels) + [names, 2.4], left=0.015, right=0.985, top=0.79, bottom=0.03,
        wspace=0.05, hspace=0.7,
    )  # fmt: skip
    dots = [first_reds(strokes[label][0]) for label in labels]  # of one run each: as many dots as there were chances
    size = float(np.clip(INK / max(1, *(len(places) for places, _ in dots)), LEAST, LARGEST))
    for k, (label, (places, went_in)) in enumerate(zip(labels, dots, strict=True)):
        table(figure.add_subplot(grid[:, k]), label, places, went_in, size)
    for k, (name, title, scale, form) in enumerate(FIGURES):
        bars(figure.add_subplot(grid[k, -1]), labels, [rows[label]["figures"][name] for label in labels], title, scale, form)
    visits = rows[labels[0]]["visits"]
    figure.text(0.2 / width, 0.95, "Where the cue ball stops after a potted red", fontsize=15, weight="bold")
    figure.text(
        0.2 / width, 0.908, f"First strokes on the same {visits:,} held-out tables, noise {at['noise']}", fontsize=10
    )  # fmt: skip
    for x, colour, text in ((0.2 / width, WENT_IN, "the colour after it went in"), (2.5 / width, MISSED, "it did not")):
        figure.text(x, 0.873, "●", color=colour, fontsize=11, va="center", path_effects=[withStroke(linewidth=1.0, foreground="#555555")])
        figure.text(x + 0.22 / width, 0.873, text, fontsize=10, va="center")
    edge = 1 - (names + 2.4) / width
    figure.text(edge, 0.908, "All strokes of these visits", fontsize=10)
    figure.text(edge, 0.873, "easy: its line may err by 4 mrad; lines: 95 % intervals", fontsize=8, va="center", color="#555555")
    save_figure(figure, file, dpi=110)
    plt.close(figure)


def table(axes, label, places, went_in, size):
    """One agent's table, its black end up, with its dots."""
    parts = outline(Table.preset("match"))
    for margin, colour in ((RAIL, WOOD), (CUSHION, CLOTH)):
        hx, hy = HALF_WIDTH + margin, HALF_LENGTH + margin
        axes.add_patch(Rectangle((-hx, -hy), 2 * hx, 2 * hy, color=colour, lw=0))
    for polygon in parts.cushions:
        axes.add_patch(Polygon(polygon, color=RUBBER, lw=0))
    for x, y, radius in parts.falls:
        axes.add_patch(Circle((x, y), radius, color="#0a0a0a", lw=0))
    for line in (BAULK_LINE, D_ARC):
        axes.plot(*line.T, color=LINE, lw=0.8)
    for spot, colour in zip(SPOT_MARKS, COLOURS[16:], strict=True):
        axes.plot(*spot, "o", color=colour / 255, ms=6.5, mec="white", mew=0.6, zorder=4)
    shuffled = np.random.default_rng(0).permutation(len(places))  # neither colour always on top
    colours = np.where(went_in, WENT_IN, MISSED)
    axes.scatter(
        *places[shuffled].T,
        s=size,
        c=colours[shuffled],
        lw=0,
        alpha=0.85,
        zorder=3,
    )
    axes.set(xlim=(-HALF_WIDTH - RAIL, HALF_WIDTH + RAIL), ylim=(-HALF_LENGTH - RAIL, HALF_LENGTH + RAIL), aspect="equal")
    axes.axis("off")
    share = 100 * went_in.mean() if len(went_in) else float("nan")
    axes.set_title(f"{label}\nthe colour follows in {share:.0f} %", fontsize=11)


def bars(axes, labels, figures, title, scale, form):
    """One figure of every agent, with its interval."""
    for k, f in enumerate(figures):
        if f["value"] is None:
            continue
        value = scale * f["value"]
        axes.barh(-k, value, color=BARS[k], height=0.72)
        if f["low"] is not None:
            axes.plot([scale * f["low"], scale * f["high"]], [-k, -k], color="#222222", lw=1.2)
        high = scale * (f["high"] if f["high"] is not None else f["value"])
        axes.text(high, -k, "  " + form.format(value), va="center", fontsize=9)
    axes.set_title(title, fontsize=10, loc="left")
    axes.set_xlim(0, 1.25 * max([scale * (f["high"] or f["value"] or 0) for f in figures] + [1e-9]))
    axes.set_yticks([-k for k in range(len(labels))], labels)
    axes.tick_params(labelsize=9, length=0)
    axes.set_xticks([])
    for side in ("top", "right", "bottom"):
        axes.spines[side].set_visible(False)
