"""Which diagrams are there? One of each kind: a shot, two ways to play it, and where the cue ball stops.

    python -m benchmarks.diagrams [--noise amateur] [--shots 2000] [--seed 0] [--no-pictures] [--json FILE]
    [--out FOLDER]

A red is potted into the corner, and the stroke is meant to leave the cue ball for the blue. Every aim is
solved, so that side and throw are made up for. The density is that of the same stroke, played with the errors
of a player; a cue ball that is potted stops nowhere.
"""

from typing import Any

import numpy as np

import snooker_env as sn
from snooker_env.advice import destinations
from snooker_env.render.diagrams import compare, density
from snooker_env.tasks import LEVELS

from ._common.command import Command, at_least, run, save_figure, save_json

SHOT, COMPARE, DENSITY = FILES = "diagram_shot.png", "diagram_compare.png", "diagram_density.png"
PLACES: Any = dict(
    cue=(0.30, 0.62),
    reds=[(0.52, 1.30), (-0.34, 1.12), (-0.20, 1.32), (-0.30, 1.58), (-0.52, 0.74), (-0.12, 0.55)],
    yellow=(0.292, -1.0475),
    green=(-0.292, -1.0475),
    brown=(0.0, -1.0475),
    blue=(0.0, 0.0),
    pink=(0.0, 0.89225),
    black=(0.0, 1.4605),
)
"""What ``Position`` is made of; made late, since its checks compile."""
BALL, POCKET, SPEED = 1, 3, 3.0
SHIFTS = np.radians(np.linspace(-4.0, 4.0, 321))  # of the aims tried, from that of the ghost ball
PLAYED, OTHER = (0.30, 0.30), (-0.35, 0.0)
"""Top and side of the stroke, and of another way to pot the ball."""
TABLE, PHYSICS = "match", sn.Physics.preset("match")


def pot(top, side):
    """The aim [rad] and the shot that pot the ball with this top and side: the middle one of the aims that do."""
    places, there, _ = sn.Position(**PLACES).arrays()
    to_pocket = sn.Table.preset(TABLE).falls[POCKET, :2] - places[BALL]
    way = places[BALL] - 2 * PHYSICS.R * to_pocket / np.hypot(*to_pocket) - places[0]
    aims = np.arctan2(way[1], way[0]) + SHIFTS
    v, w = np.zeros((len(aims), len(places), 2)), np.zeros((len(aims), len(places), 3))
    for k, aim in enumerate(aims):
        struck, w[k, 0] = sn.strike(SPEED, aim, side, top, physics=PHYSICS)
        v[k, 0] = struck[:2]
    same = {"table": TABLE, "physics": PHYSICS}
    tiled = np.tile(places, (len(aims), 1, 1)), v, w
    potted = sn.simulate_batch(*tiled, **same, on_table=np.tile(there, (len(aims), 1))).potted[:, BALL]
    good = np.flatnonzero(potted == POCKET)
    k = good[len(good) // 2]
    return float(aims[k]), sn.simulate(places, v[k], w[k], **same, on_table=there)


def main():
    """Command line."""
    command = Command("diagrams", __doc__, pictures=FILES, seed=0)
    command.add_argument(
        "--noise", choices=sorted(LEVELS), default="amateur", help="whose errors the density shows [amateur]"
    )
    command.add_argument(
        "--shots", type=at_least(10), default=2000, metavar="N", help="strokes of the density [2000]"
    )
    options = command.options()
    (top, side), (aim, played), (_, other) = PLAYED, pot(*PLAYED), pot(*OTHER)
    v, _ = sn.strike(SPEED, aim, side, top, physics=PHYSICS)  # squirt turns it from the cue
    stroke = {"speed": SPEED, "aim": float(np.arctan2(v[1], v[0])), "side": side, "top": top}
    stops = destinations(
        sn.Position(**PLACES),
        stroke,
        noise=options.noise,
        samples=options.shots,
        seed=options.seed,
        options={"table": TABLE, "physics": PHYSICS},
    )
    there, potted = stops.cue, stops.potted
    spread = float(np.sqrt(there.var(axis=0).sum()))
    print(
        f"{options.shots} strokes of a player ({options.noise}): the red goes in {100 * potted:.1f} % of the time;"
    )
    print(
        f"the cue ball stops {1e3 * spread:.0f} mm (rms) about ({there[:, 0].mean():.3f}, {there[:, 1].mean():.3f}) m"
    )
    figures = {
        "noise": options.noise,
        "shots": options.shots,
        "potted": potted,
        "spread_m": spread,
        "mean_m": there.mean(axis=0).tolist(),
    }
    save_json(options.json, figures)
    if options.pictures:
        said = f"Where it stops: {options.shots:,} strokes, {options.noise}"
        drawn = {
            SHOT: played.plot(title="A red, and on to the blue"),
            COMPARE: compare([played, other], ["A: follow with right side", "B: screw"])[0],
            DENSITY: density(there, played.plot(speeds=False, title=said)),
        }
        for name, ax in drawn.items():
            save_figure(ax.figure, options.folder / name, dpi=100)
            print(options.folder / name)


if __name__ == "__main__":
    run(main)
