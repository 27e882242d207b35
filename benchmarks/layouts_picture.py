"""Which layouts are there? One picture of them all.

python -m benchmarks.layouts_picture [--seed 4] [--json FILE] [--out FOLDER]
"""

import numpy as np

from commands import picture_style
from snooker_env import Table
from snooker_env.game.balls import NAMES, REDS_MASK
from snooker_env.game.layouts import layout
from snooker_env.game.pots import GHOST_X, GHOST_Y, POT_BALL, POT_POCKET, pots
from snooker_env.geometry import BALL_RADIUS, HALF_LENGTH, HALF_WIDTH, POCKET_AIMS
from snooker_env.render.palette import PALE
from snooker_env.render.shot_diagram import draw_ball, draw_path, draw_table

from ._common.command import Command, run, save_json

FILE = "layouts.png"
COLUMNS = 2
LARGER = 1.5
"""Balls are drawn so many times their size: a table is small here."""
RIM = 0.075
"""So much of the rails is shown [m]."""

SHOWN = {
    "break_off": "the start of a frame",
    "opened": "opened by simulated play",
    "held_out": "the same, kept for evaluation",
    "line_up": "the practice line-up",
    "colours": "the six colours on their spots",
    "random:6": "six reds at random",
    "snookered": "no red can be hit on both edges",
    "safety": "no pot is on",
    "pots:easy": "aim may err by 0.23° or more",
    "pots:medium": "aim may err by 0.06 to 0.23°",
    "pots:hard": "aim may err by 0.02 to 0.06°",
}


def table(ax, name, seed):
    """Draw one layout; a single pot with its line and ghost ball, a snooker with the lines to the red's
    edges."""
    positions, on_table = layout(name, np.random.default_rng(seed))
    draw_table(Table.preset("match"), ax)
    high, wide = HALF_WIDTH + RIM, HALF_LENGTH + RIM
    ax.set(xlim=(-wide, wide), ylim=(high, -high))
    if name.startswith("pots:"):
        pot = pots(positions, on_table, REDS_MASK, most=1)[0]
        place, goal = positions[int(pot[POT_BALL])], POCKET_AIMS[int(pot[POT_POCKET]), :2]
        draw_path(ax, np.array([positions[0], pot[[GHOST_X, GHOST_Y]]]), PALE[0])
        draw_path(ax, np.array([place, goal]), PALE[1])
    elif name == "snookered":
        for red, points in sight(positions, on_table).items():
            draw_path(ax, points, PALE[red], width=1.0)
    for ball in np.flatnonzero(on_table):
        draw_ball(ax, int(ball), positions[ball], LARGER * BALL_RADIUS)


def placed(name, seed):
    """{ball: its place (2,) [m]} of one layout."""
    positions, on_table = layout(name, np.random.default_rng(seed))
    return {NAMES[k]: positions[k].tolist() for k in np.flatnonzero(on_table)}


def sight(positions, on_table):
    """{red: the two tangents from the cue ball to its edges}: lines that something bars, as (3, 2) points."""
    lines = {}
    for red in np.flatnonzero(on_table[1:16]) + 1:
        d = positions[red] - positions[0]
        side = BALL_RADIUS * np.array([-d[1], d[0]]) / np.hypot(*d)
        lines[int(red)] = np.array([positions[red] + side, positions[0], positions[red] - side])
    return lines


def draw(seed, file):
    """All of them."""
    note = f"Balls are drawn {LARGER} times their size. Lines: the pot that is dealt; the ways to the edges of a red."
    with picture_style.drawing() as plt:
        rows = -(-len(SHOWN) // COLUMNS)
        figure, axes = picture_style.page(
            plt, 0.95 + 2.5 * rows, "Eleven ways to lay out a table", note, rows=rows, columns=COLUMNS
        )
        figure.get_layout_engine().set(w_pad=0.06, h_pad=0.05, hspace=0.02, wspace=0.02)
        for ax, name in zip(axes.flat, SHOWN, strict=False):
            table(ax, name, seed)
            ax.set_title(f'layout="{name}"', pad=5)
            ax.set_title(
                SHOWN[name],
                loc="right",
                size=picture_style.TEXT,
                weight="normal",
                color=picture_style.QUIET,
                pad=5,
            )
        for ax in axes.flat[len(SHOWN) :]:
            ax.set_axis_off()
        picture_style.save(figure, file)


def main():
    """Command line."""
    options = Command("layouts_picture", __doc__, pictures=(FILE,), seed=4).options()
    save_json(
        options.json, {"seed": options.seed, "layouts": {name: placed(name, options.seed) for name in SHOWN}}
    )
    if options.pictures:
        draw(options.seed, options.folder / FILE)
        print(options.folder / FILE)


if __name__ == "__main__":
    run(main)
