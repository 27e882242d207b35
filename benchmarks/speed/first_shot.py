"""How long until the first shot? This measures fresh processes with an empty and with a filled cache of compiled
kernels."""

import json
import os
import subprocess
import sys
import tempfile

_CHILD = """
import json, time
found = {}
def note(name, since):
    found[name] = [time.perf_counter() - since[0], time.process_time() - since[1]]
def now():
    return time.perf_counter(), time.process_time()
since = now()
import snooker_env as sn
note("import", since)
since = now()
sn.simulate([(0.0, 0.0), (0.5, 0.01)], [(2.0, 0.0), (0.0, 0.0)], [(0.0, 0.0, 0.0)] * 2)
note("first shot", since)
since = now()
sn.warmup()
note("warmup() after it", since)
print(json.dumps(found))
"""
STEPS = ("import", "first shot", "warmup() after it")


def start(warm_starts=5):
    """Returns {"cold", "warm"}: {step: [wall s, processor s]}. "cold" is one start with an empty cache; "warm" is the
    median by wall time of later starts."""
    with tempfile.TemporaryDirectory() as folder:
        environment = os.environ | {"NUMBA_CACHE_DIR": folder}
        runs = []
        for _ in range(1 + warm_starts):
            done = subprocess.run(
                [sys.executable, "-c", _CHILD], env=environment, capture_output=True, text=True, check=True
            )
            runs.append(json.loads(done.stdout))
    warm = {step: sorted(run[step] for run in runs[1:])[warm_starts // 2] for step in STEPS}
    return {"cold": runs[0], "warm": warm}
