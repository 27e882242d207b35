"""What drops along a rail? A ball frozen to the cushion or a little off it, its path parallel to the rail,
into the corner pocket."""

from math import pi

import numpy as np

from .windows import CORNER, NEAR, Paths, alone, along, drops, reach, windows

OFF = (0.0, 0.005, 0.010, 0.020)
"""How far the path runs from where the ball would be frozen to the cushion [m]."""
RUNS = (0.5, 1.5)
"""From how far before the aim point [m]."""
SPEEDS = (0.5, 1.0, 2.0, 4.0, 6.0, 8.0, 10.0)
MOST, SCAN = np.radians(8.0), 641
"""The scan of angles goes so far to either side of the parallel, in so many steps."""


def down_the_rail(table, physics, engine, offs=OFF, runs=RUNS, speeds=SPEEDS):
    """Potted or not, and the ends of the widest range of angles that pot [rad, + towards the rail], by (off,
    run, speed, rolling).

    Where a ball does not get there: not potted, and no range.
    """
    here = alone(table, CORNER)
    level = float(here.table.noses[here.table.noses[:, 0] == 0, 2][0])
    run, speed, rolling = np.array(runs)[:, None, None], np.array(speeds)[:, None], np.array([True, False])
    potted, low, high = [], [], []
    for off in offs:
        path = along(here, level - physics.R - off, here.aim[1], pi / 2)
        potted.append(drops(path, 0.0, run, speed, rolling, physics, engine, 0.0))
        found = windows(path, Paths(0.0, run, speed, rolling, True), physics, engine, MOST, SCAN)
        low.append(-found.high)
        high.append(-found.low)
    arrives = np.broadcast_to(reach(speed, rolling, physics) > run + NEAR, potted[0].shape)
    return {
        "potted": np.array(potted) & arrives,
        "arrives": np.array([arrives] * len(offs)),
        "low": np.array(low),
        "high": np.array(high),
    }
