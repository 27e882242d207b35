"""Does a shot cost more work than it did? Events, root searches and impacts of fixed shots, counted and held
under ceilings.

No time is measured. The shots of ``benchmarks.speed`` are played as plain Python in a process of its own
(this file, as a script), where every call can be seen. A ceiling lies about 10 % above what the engine needed
when it was written: a change that crosses it makes the engine work harder, and should say why; after one that
saves work, lower it.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SHOTS = {"two-ball pot": 40, "random 22 balls": 20, "break-off": 4}
CEILINGS = """
events             |  341 |  289 |  428
balls predicted    |  384 |  341 |  623
pairs near         |  162 |  571 | 2437
boundaries         |  341 |  291 |  535
quartics           |  173 |  127 | 1236
rescans            |   44 |   40 |  248
ball-ball impacts  |   44 |   35 |  182
cushion impacts    |   47 |   73 |   17
impacts solved     |   10 |   32 |  170
"""
"""Of each kind of ``SHOTS``, in that order."""


def counted():
    """{kind: {what: calls}}, in all over the shots of the kind."""
    import numpy as np

    import snooker_env as sn
    from benchmarks.speed.__main__ import shots
    from snooker_env.physics import detection, engine, roots
    from snooker_env.physics.impact import contact, impulse
    from snooker_env.simulation import MAX_EVENTS, _run

    watched = {
        engine._predict: "balls predicted",
        detection.pair_time: "pairs near",
        detection.boundary_event: "boundaries",
        roots.quartic_crossing: "quartics",
        engine._rescan: "rescans",
        contact.collide_balls: "ball-ball impacts",
        contact.collide_cushion: "cushion impacts",
        impulse.solve: "impacts solved",
    }
    names, found = {function.__code__: name for function, name in watched.items()}, {}
    for kind, n in SHOTS.items():
        counts = dict.fromkeys(watched.values(), 0)

        def watch(frame, event, _, counts=counts):
            if event == "call" and frame.f_code in names:
                counts[names[frame.f_code]] += 1

        p, v, w = shots(kind, n)
        state = p, v, w, np.ones(p.shape[:2], bool)
        sys.setprofile(watch)
        with np.errstate(all="ignore"):
            out = _run(
                state,
                sn.Physics.preset("paper"),
                sn.Table.preset("match"),
                contact.parse_fidelity("standard"),
                MAX_EVENTS,
            )
        sys.setprofile(None)
        found[kind] = {"events": int(out.n_events.sum())} | counts
    return found


@pytest.fixture(scope="module")
def work():
    env = os.environ | {"NUMBA_DISABLE_JIT": "1", "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, __file__], cwd=ROOT, env=env, capture_output=True, text=True, timeout=280, check=True
    )
    return json.loads(done.stdout)


def test_a_shot_costs_no_more_work_than_it_did(work):
    lines = [[cell.strip() for cell in line.split("|")] for line in CEILINGS.strip().splitlines()]
    most = {(kind, name): int(n) for name, *row in lines for kind, n in zip(SHOTS, row, strict=True)}
    counts = {(kind, name): n for kind, found in work.items() for name, n in found.items()}
    assert counts.keys() == most.keys()
    assert {key: (n, most[key]) for key, n in counts.items() if not 0 < n <= most[key]} == {}


if __name__ == "__main__":
    print(json.dumps(counted()))
