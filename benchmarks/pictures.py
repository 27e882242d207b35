"""How is the README's picture made? One pot with side and screw on an opened table, the paths drawn.

python -m benchmarks.pictures [--seed 6] [--json FILE] [--out FOLDER]
"""

import numpy as np

import snooker_env as sn
from snooker_env.game.layouts import opened
from snooker_env.game.pots import GHOST_X, GHOST_Y, POT_BALL, pots
from snooker_env.render.pygame_view import rgb_array
from snooker_env.render.scene import ball_paths, contacts, scene

from ._common.command import Command, run, save_image, save_json

FILE = "shot.png"
SIZE = 1200, 675


def pot(seed):
    """The first table from ``seed`` on with a red that goes in with screw and side, the cue ball coming back; the ball and the shot."""
    while True:
        positions, on_table = opened(np.random.default_rng(seed))
        for candidate in pots(positions, on_table, 0xFFFE, most=3):
            ball, ghost = int(candidate[POT_BALL]), candidate[[GHOST_X, GHOST_Y]] - positions[0]
            for error in np.radians(np.linspace(-2, 2, 41)):
                v, w = sn.strike(2.8, np.arctan2(ghost[1], ghost[0]) + error, side=0.2, top=-0.45)
                velocities, spins = np.zeros((22, 2)), np.zeros((22, 3))
                velocities[0], spins[0] = v[:2], w
                shot = sn.simulate(positions, velocities, spins)
                back = (shot.positions[0] - positions[0] - ghost) @ ghost / np.hypot(*ghost)
                hits = shot.events["kind"] == sn.EventKind.BALL_BALL
                if shot.potted[ball] >= 0 and shot.potted[0] < 0 and back < -0.5 and hits.sum() == 1 and 0.3 < np.hypot(*ghost) < 1.0:
                    return positions, ball, shot
        seed += 1


def main():
    """Command line."""
    options = Command("pictures", __doc__, files=(FILE,), seed=6).options()
    positions, ball, shot = pot(options.seed)
    text = "a red potted with screw and right-hand side: the table before the shot, and where the two balls went"
    paths, ghosts = ball_paths(shot, balls=(0, ball)), {0: contacts(shot)}
    picture = rgb_array(scene("match", positions, paths=paths, ghosts=ghosts, text=text), size=SIZE)
    save_json(options.json, {"seed": options.seed, "ball": ball, "before": positions.tolist(), "after": shot.positions.tolist()})
    save_image(options.folder / FILE, picture)
    print(options.folder / FILE)


if __name__ == "__main__":
    run(main)
