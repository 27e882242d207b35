"""How many lengths of the table does a stroke travel? The engine plays the cue ball alone, up and down the long axis,
with several sets of constants.

Measurements on full-size tables: I. Stevenage, The Amateur Billiard Player, October 1996
(https://www.eaba.co.uk/?p=4149). A ball thrown from the baulk end as hard as possible travels 4.25 to 4.75 lengths
on nine tables, and 4.75 on a heated one with new cloth and steel-block cushions. On that table, a ball from a test
ramp 3.5 inches high returns from the top cushion to 6 inches past the pink's spot. Players report about five lengths
for the hardest stroke. A thrown ball starts without spin, like one struck at its middle; its speed was not measured.
Two experienced players near their maximum stayed below 13.4 m/s (Carroll and Stevenage, Billiards Quarterly Review,
July 1993).
"""

from math import pi, sqrt

import numpy as np

import snooker_env as sn

LENGTH = 3.569
BAULK_END = -LENGTH / 2.0
PINK = LENGTH / 4.0
SPEEDS = (2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 13.0)
START = 0.05
"""Start of a ball, from the baulk cushion's nose [m]."""
RAMP = sqrt(10.0 / 7.0 * 9.81 * 3.5 * 0.0254)
"""Speed [m/s] of a ball after rolling down 3.5 inches."""


def path(speed, physics, rolling=False):
    """Heights y [m] of the cue ball at the start, at each event and at rest."""
    v, w = sn.strike(speed, pi / 2.0, physics=physics)
    if rolling:
        w = np.array((-speed / physics.R, 0.0, 0.0))
    shot = sn.simulate([(0.0, BAULK_END + START)], [v[:2]], [w], physics=physics)
    return shot.at(np.concatenate(([0.0], shot.events["time"], [shot.duration])))[0][:, 0, 1]


def lengths(speed, physics, rolling=False):
    """Distance travelled divided by the table's length, for a stroke at the middle of the ball at this speed [m/s],
    or for a rolling ball."""
    return float(np.abs(np.diff(path(speed, physics, rolling))).sum()) / LENGTH


def print_lengths(others):
    """Print and return the table of lengths, {speed: {constants: lengths}}; others: physics by name."""
    laws = {"match": sn.Physics.preset("match"), "paper": sn.Physics(), **others}
    print(f"\nlengths of the table travelled ({LENGTH} m each), struck at the middle, along the long axis")
    print("m/s   " + "".join(f"{name:>22s}" for name in laws))
    table = {speed: {name: lengths(speed, physics) for name, physics in laws.items()} for speed in SPEEDS}
    for speed, row in table.items():
        print(f"{speed:4.0f}  " + "".join(f"{value:22.2f}" for value in row.values()))
    return table
