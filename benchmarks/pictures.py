"""How does a pot with side and screw go? A picture of one on an opened table, its paths drawn.

python -m benchmarks.pictures [--seed 6] [--json FILE] [--out FOLDER]
"""

import numpy as np

import snooker_env as sn
from commands import picture_style
from snooker_env.game.layouts import layout
from snooker_env.game.pots import GHOST_X, GHOST_Y, POT_BALL, pots

from ._common.command import Command, run, save_json

FILE = "shot.png"
SHOWN = (-0.30, 0.08), (1.05, 1.96)
"""Two corners of the part that is shown [m]."""
STRIP = 0.36
"""Height of the words below [inches]."""


def pot(seed):
    """The first table from ``seed`` on with a red that goes in with screw and side, the cue ball coming back;
    the ball and the shot."""
    while True:
        positions, on_table = layout("opened", np.random.default_rng(seed))
        for candidate in pots(positions, on_table, 0xFFFE, most=3):
            ball, ghost = int(candidate[POT_BALL]), candidate[[GHOST_X, GHOST_Y]] - positions[0]
            for error in np.radians(np.linspace(-2, 2, 41)):
                v, w = sn.strike(2.8, np.arctan2(ghost[1], ghost[0]) + error, side=0.2, top=-0.45)
                velocities, spins = np.zeros((22, 2)), np.zeros((22, 3))
                velocities[0], spins[0] = v[:2], w
                shot = sn.simulate(positions, velocities, spins)
                back = (shot.positions[0] - positions[0] - ghost) @ ghost / np.hypot(*ghost)
                hits = shot.events["kind"] == sn.EventKind.BALL_BALL
                if (
                    shot.potted[ball] >= 0
                    and shot.potted[0] < 0
                    and back < -0.5
                    and hits.sum() == 1
                    and 0.3 < np.hypot(*ghost) < 1.0
                ):
                    return positions, ball, shot
        seed += 1


def draw(shot, file):
    """The part of the table where the shot is, large; the words below."""
    words = "A red potted with screw and right-hand side: the balls before the shot, faint at a contact and at rest"
    with picture_style.drawing() as plt:
        (top, left), (bottom, right) = SHOWN
        inches = picture_style.WIDTH * (bottom - top) / (right - left)
        figure = plt.figure(figsize=(picture_style.WIDTH, inches + STRIP))
        axes = shot.plot(figure.add_axes((0, STRIP / (inches + STRIP), 1, inches / (inches + STRIP))))
        axes.set(xlim=(left, right), ylim=(bottom, top))
        axes.set_axis_off()
        figure.text(
            0.016, 0.5 * STRIP / (inches + STRIP), words, size=picture_style.PANEL, va="center_baseline"
        )
        picture_style.save(figure, file)


def main():
    """Command line."""
    options = Command("pictures", __doc__, pictures=(FILE,), seed=6).options()
    positions, ball, shot = pot(options.seed)
    save_json(
        options.json,
        {"seed": options.seed, "ball": ball, "before": positions.tolist(), "after": shot.positions.tolist()},
    )
    if options.pictures:
        draw(shot, options.folder / FILE)
        print(options.folder / FILE)


if __name__ == "__main__":
    run(main)
