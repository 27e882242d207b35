"""Does a decision take no more than its own thread? Measured is the processor time of all other threads.

Matrix products of NumPy and torch wake a thread for each core: a small network then takes several times the
time. Players are asked in a fresh process, in which both libraries are told to use two threads."""

import json
import os

import pytest

from tests.processes import ROOT, python

PLAYERS = [f"planner{kind}_60" for kind in ("", "_value", "_policy")]
PLAYERS += [f"ppo_{kind}" for kind in ("mask", "value", "foresight", "absolute")]
MEASURE = """if True:
    import json, os, sys, time
    import numpy as np, torch
    import snooker_env as sn
    from snooker_env.planning import Positions

    os.sched_setaffinity(0, [min(os.sched_getaffinity(0))])  # of this thread: the libraries have made theirs

    def share(act):  # of the processor time that other threads took
        act(), act()  # compiled and loaded
        time.sleep(0.2)  # a library's threads look for more work before they rest
        whole, own = time.process_time(), time.thread_time()
        while time.thread_time() - own < 0.15:
            act()
        return (time.process_time() - whole) / (time.thread_time() - own) - 1.0

    def decisions(name, tables):
        env = sn.SnookerVectorEnv(tables, noise="professional", threads=1)
        env.reset(seed=3)
        player, at = sn.player(name).at(env), Positions.of(env)
        return lambda: player.play(at, np.arange(tables))

    rows, weight = np.ones((2, 256, 256), np.float32)
    tensor = torch.from_numpy(rows)
    found = {"numpy": share(lambda: rows @ weight), "torch": share(lambda: tensor @ tensor)}
    for name in sys.argv[1:]:
        for tables in (1, 64):
            found[f"{name} {tables}"] = share(decisions(name, tables))
    print(json.dumps(found))
"""


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="on Linux alone threads can be bound")
def test_a_decision_takes_one_thread():
    code = f"import sys; sys.argv[1:] = {PLAYERS!r}\n{MEASURE}"
    libraries = {name: "2" for name in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS")}
    found = json.loads(python(code, at=ROOT, **libraries)[0])
    seen = [found.pop(library) for library in ("numpy", "torch")]
    if min(seen) < 0.2:
        pytest.skip(f"the libraries use no second thread here: {seen}")
    assert len(found) == 2 * len(PLAYERS)
    assert not {what: round(share, 2) for what, share in found.items() if share > 0.05}
