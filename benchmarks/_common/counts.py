"""What runs in a shot? This counts calls inside the engine by playing the shots as plain Python.

    NUMBA_DISABLE_JIT=1 python -m benchmarks._common.counts PHYSICS SHOTS.npz ...

A file holds positions, velocities and spins. The command prints JSON: for each file, the numbers per shot of
integrated impacts (ball-ball and cushion), of jaw arcs tested, and of jaw arcs whose quartic was solved.
``benchmarks.scene`` starts this in a separate process.
"""

import json
import sys
from collections import Counter
from pathlib import Path

import numpy as np

import snooker_env as sn
from snooker_env.physics import detection
from snooker_env.physics.impact import contact, impulse
from snooker_env.simulation import _run

FOLDER = str(Path(contact.__file__).parent)
SOLVE, CROSSING, QUARTIC = (
    f.__code__ for f in (impulse.solve, detection.distance_crossing, detection.quartic_crossing)
)
OF_BALLS, OF_CUSHION = contact.collide_balls.__code__, contact.collide_cushion.__code__


def count_per_shot(positions, velocities, spins, physics):
    """Counts per shot."""
    table, physics, code = (
        sn.Table.preset("match"),
        sn.Physics.preset(physics),
        contact.parse_fidelity("standard"),
    )
    jaws = set((table.jaws[:, 2] + physics.R).tolist())
    counts = Counter(
        {"ball-ball integrations": 0, "cushion integrations": 0, "jaw arcs tested": 0, "jaw arcs solved": 0}
    )

    def watch(frame, event, _):
        if event != "call":
            return
        here = frame.f_code
        if here is SOLVE:
            while frame.f_code is not OF_BALLS and frame.f_code is not OF_CUSHION:
                frame = frame.f_back
            counts["ball-ball integrations" if frame.f_code is OF_BALLS else "cushion integrations"] += 1
        elif here is CROSSING and frame.f_locals["d"] in jaws:
            counts["jaw arcs tested"] += 1
        elif here is QUARTIC and frame.f_back.f_code is CROSSING and frame.f_back.f_locals["d"] in jaws:
            counts["jaw arcs solved"] += 1

    state = positions, velocities, spins, np.ones(positions.shape[:2], bool)
    sys.setprofile(watch)
    _run(state, physics, table, code, 100_000)
    sys.setprofile(None)
    return {name: count / len(positions) for name, count in counts.items()}


def main():
    """Command line."""
    found = []
    physics, *files = sys.argv[1:]
    for file in files:
        with np.load(file) as shots, np.errstate(all="ignore"):
            found.append(count_per_shot(shots["positions"], shots["velocities"], shots["spins"], physics))
    print(json.dumps(found))
