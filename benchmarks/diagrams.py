"""Which diagrams are there? One of each kind: a shot, two ways to play it, a fan over top and side, and where
the cue ball stops.

    python -m benchmarks.diagrams [--noise amateur] [--shots 2000] [--seed 0] [--no-pictures] [--json FILE]
    [--out FOLDER]

A red is potted into the corner, and the stroke is meant to leave the cue ball for the blue. Every aim is
solved, so that side and throw are made up for. The density is that of the same stroke, played with the errors
of a player; a cue ball that is potted stops nowhere.
"""

from typing import Any

import numpy as np

import snooker_env as sn
from snooker_env.advice import destinations, fan
from snooker_env.advice.fan import Strokes, fan_options
from snooker_env.render.diagrams import compare, density
from snooker_env.tasks import LEVELS

from ._common.command import Command, at_least, run, save_figure, save_json

SHOT, COMPARE, FAN, DENSITY = FILES = (
    "diagram_shot.png",
    "diagram_compare.png",
    "diagram_fan.png",
    "diagram_density.png",
)
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
PLAYED, OTHER = (0.30, 0.30), (-0.35, 0.0)
"""Top and side of the stroke, and of another way to pot the ball."""
TABLE, PHYSICS = "match", sn.Physics.preset("match")


def option(top, side):
    """The stroke that pots the ball with this top and side, solved as ``fan`` does."""
    places, there, _ = sn.Position(**PLACES).arrays()
    return fan_options(
        places, there, BALL, POCKET, Strokes(SPEED, [top], [side]), sn.Table.preset(TABLE), PHYSICS
    )[0]


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
    played, other = option(*PLAYED), option(*OTHER)
    v = sn.strike(SPEED, played.aim, played.side, played.top, physics=PHYSICS)[
        0
    ]  # squirt turns it from the cue
    stroke = {"speed": SPEED, "aim": float(np.arctan2(v[1], v[0])), "side": played.side, "top": played.top}
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
            SHOT: played.shot.plot(title="A red, and on to the blue"),
            COMPARE: compare([played.shot, other.shot], ["A: follow with right side", "B: screw"])[0],
            FAN: fan(
                sn.Position(**PLACES),
                BALL,
                POCKET,
                speed=SPEED,
                table=TABLE,
                physics=PHYSICS,
                title="One pot, fifteen tips",
            ),
            DENSITY: density(there, played.shot.plot(speeds=False, title=said)),
        }
        for name, ax in drawn.items():
            save_figure(ax.figure, options.folder / name, dpi=100)
            print(options.folder / name)


if __name__ == "__main__":
    run(main)
