"""Diagrams of tables in the documentation: ``layouts.png``, all layouts, and ``shot.png``, a pot with screw and side."""

import numpy as np

import snooker_env as sn
from agents._lib import picture_style as style
from snooker_env.game.balls import REDS_MASK
from snooker_env.game.layouts import layout
from snooker_env.game.pots import GHOST_X, GHOST_Y, POT_BALL, POT_POCKET, pots
from snooker_env.geometry import BALL_RADIUS, HALF_LENGTH, HALF_WIDTH, POCKET_AIMS
from snooker_env.render.palette import PALE, PALETTE
from snooker_env.render.shot_diagram import draw_ball, draw_path, draw_table

LARGER = 1.6
"""Balls are drawn so many times their size: a table is small here."""
RIM = 0.075
"""So much of the rails is shown [m]."""
LAYOUTS = {
    "break_off": "the start of a frame",
    "opened": "opened by simulated play",
    "held_out": "the same, kept for evaluation",
    "line_up": "the practice line-up",
    "colours": "the six colours on their spots",
    "random:6": "six reds at random",
    "snookered": "no red can be hit on both edges",
    "escape": "snookers that fixed choices fail",
    "safety": "no pot is likely",
    "pots:easy": "the aim may err by more than 0.23°",
    "pots:medium": "the aim may err by 0.06 to 0.23°",
    "pots:hard": "the aim may err by 0.02 to 0.06°",
}
SHOWN = (-0.30, 0.08), (1.05, 1.951)
"""Two corners of the part of the table that ``shot.png`` shows [m]."""


def draw_layouts(file, seed=4):
    """A tile for each layout."""
    note = f"Balls are drawn {LARGER} times their size. Lines: the pot that is dealt, or the ways to the edges of a snookered red."
    with style.drawing() as plt:
        figure, axes = style.page(plt, 8.75, "Twelve ways to lay out a table", note, rows=4, columns=3)
        figure.get_layout_engine().set(w_pad=0.05, h_pad=0.04, hspace=0.02, wspace=0.02)
        for ax, (name, words) in zip(axes.flat, LAYOUTS.items(), strict=True):
            _tile(ax, name, np.random.default_rng(seed))
            ax.set_title(f'"{name}"', pad=4)
            ax.set_xlabel(words, size=style.SMALL, color=style.QUIET, labelpad=3)
        style.save(figure, file)


def _tile(ax, name, rng):
    positions, on_table = layout(name, rng)
    draw_table(sn.Table.preset("match"), ax)
    if name.startswith("pots:"):
        pot = pots(positions, on_table, REDS_MASK, most=1)[0]
        draw_path(ax, np.array([positions[0], pot[[GHOST_X, GHOST_Y]]]), PALETTE["text"], 1.4)
        goal = POCKET_AIMS[int(pot[POT_POCKET]), :2]
        draw_path(ax, np.array([positions[int(pot[POT_BALL])], goal]), PALE[1], 1.4)
    elif name == "snookered":
        for red in np.flatnonzero(on_table[1:16]) + 1:
            way = positions[red] - positions[0]
            side = BALL_RADIUS * np.array([-way[1], way[0]]) / np.hypot(*way)
            draw_path(
                ax, np.array([positions[red] + side, positions[0], positions[red] - side]), PALE[1], 0.8
            )
    for ball in np.flatnonzero(on_table).tolist():
        draw_ball(ax, ball, positions[ball], LARGER * BALL_RADIUS)
    ax.set(xlim=(-HALF_LENGTH - RIM, HALF_LENGTH + RIM), ylim=(HALF_WIDTH + RIM, -HALF_WIDTH - RIM))


def _screw_shot(seed):
    """From the first table of ``seed`` or later: a red potted with screw and side, the cue ball coming back."""
    while True:
        positions, on_table = layout("opened", np.random.default_rng(seed))
        for pot in pots(positions, on_table, REDS_MASK, most=3):
            ghost = pot[[GHOST_X, GHOST_Y]] - positions[0]
            for error in np.radians(np.linspace(-2, 2, 41)):
                v, w = sn.strike(2.8, np.arctan2(ghost[1], ghost[0]) + error, side=0.2, top=-0.45)
                velocities, spins = np.zeros((22, 2)), np.zeros((22, 3))
                velocities[0], spins[0] = v[:2], w
                shot = sn.simulate(positions, velocities, spins)
                back = (shot.positions[0] - positions[0] - ghost) @ ghost / np.hypot(*ghost)
                once = (shot.events["kind"] == sn.EventKind.BALL_BALL).sum() == 1
                potted = shot.potted[int(pot[POT_BALL])] >= 0 and shot.potted[0] < 0
                if potted and once and back < -0.5 and 0.3 < np.hypot(*ghost) < 1.0:
                    return shot
        seed += 1


def draw_shot(file, seed=6):
    """The part of the table where the shot is, large; the words below."""
    words = "A red potted with screw and right-hand side: the balls before the shot, faint at a contact and at rest"
    shot, strip = _screw_shot(seed), 0.36
    with style.drawing() as plt:
        (top, left), (bottom, right) = SHOWN
        inches = style.WIDTH * (bottom - top) / (right - left)
        figure = plt.figure(figsize=(style.WIDTH, inches + strip))
        axes = shot.plot(figure.add_axes((0, strip / (inches + strip), 1, inches / (inches + strip))))
        axes.set(xlim=(left, right), ylim=(bottom, top))
        axes.set_axis_off()
        figure.text(0.016, 0.5 * strip / (inches + strip), words, size=style.PANEL, va="center_baseline")
        style.save(figure, file)


def make(folder):
    """Draw both."""
    for name, draw in (("layouts", draw_layouts), ("shot", draw_shot)):
        draw(folder / f"{name}.png")
        print(folder / f"{name}.png", flush=True)
