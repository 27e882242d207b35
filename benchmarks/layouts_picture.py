"""What do the layouts look like? One picture of them all, as the README shows it.

python -m benchmarks.layouts_picture [--seed 4] [--json FILE] [--out FOLDER]
"""

from typing import Any

import numpy as np

from snooker_env.game.balls import NAMES, REDS_MASK
from snooker_env.game.layouts import layout
from snooker_env.game.pots import GHOST_X, GHOST_Y, pots
from snooker_env.geometry import BALL_RADIUS
from snooker_env.render.pygame_view import rgb_array
from snooker_env.render.scene import scene

from ._common.command import Command, run, save_image, save_json

FILE = "layouts.png"
HEIGHT, COLUMNS, GAP = 330, 3, 6
"""Pixels of one table's height, tables a line, and pixels between them."""

SHOWN = {
    "break_off": "the start of a frame",
    "opened": "opened by real simulated play",
    "line_up": "the practice line-up",
    "colours": "the six colours on their spots",
    "random:6": "six reds sprinkled",
    "snookered": "no red can be struck at both edges",
    "pots:easy": "its line may err by 0.23 degrees or more",
    "pots:medium": "by 0.06 to 0.23 degrees",
    "pots:hard": "by 0.02 to 0.06 degrees",
}


def picture(name, says, seed):
    """One layout with its name; a single pot with its line and ghost ball."""
    positions, on_table = layout(name, np.random.default_rng(seed))
    overlay: dict[str, Any] = {}
    if name.startswith("pots:"):
        ghost = pots(positions, on_table, REDS_MASK, most=1)[0, [GHOST_X, GHOST_Y]]
        overlay = {"aim": np.array([positions[0], ghost]), "ghost": ghost}
    elif name == "snookered":
        overlay = {"paths": sight(positions, on_table)}
    return rgb_array(scene("match", positions, on_table, text=f'layout="{name}": {says}', **overlay), HEIGHT)


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


def sheet(seed):
    """All of them: uint8 (H, W, 3)."""
    tables = [picture(name, says, seed) for name, says in SHOWN.items()]
    rows, (height, width, _) = -(-len(tables) // COLUMNS), tables[0].shape
    image = np.full((rows * (height + GAP) - GAP, COLUMNS * (width + GAP) - GAP, 3), 255, np.uint8)
    for k, one in enumerate(tables):
        top, left = k // COLUMNS * (height + GAP), k % COLUMNS * (width + GAP)
        image[top : top + height, left : left + width] = one
    return image


def main():
    """Command line."""
    options = Command("layouts_picture", __doc__, files=(FILE,), seed=4).options()
    save_json(options.json, {"seed": options.seed, "layouts": {name: placed(name, options.seed) for name in SHOWN}})
    save_image(options.folder / FILE, sheet(options.seed))
    print(options.folder / FILE)


if __name__ == "__main__":
    run(main)
