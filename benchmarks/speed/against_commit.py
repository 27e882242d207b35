"""Is this tree faster than a commit? Both are measured in turn on this machine, in fresh processes; only ratios are
compared.

``python -m benchmarks.speed --against COMMIT`` runs this. It extracts the commit into a temporary folder. Each side
plays its own copy of the same seeded shots, so that kernels, `simulate` and compiling come from its own source.
"""

import json
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[2]
ROUNDS = 3
_CHILD = """
import json, sys, time
import numpy as np
shots, repeats, seed = map(int, sys.argv[1:])
began = time.process_time()
import snooker_env as sn
sn.simulate([(0.0, 0.0), (0.5, 0.01)], [(2.0, 0.0), (0.0, 0.0)], [(0.0, 0.0, 0.0)] * 2)
found = {"first shot, cold cache [s of processor]": time.process_time() - began}
sn.warmup()
found["all kernels, cold cache [s of processor]"] = time.process_time() - began
from benchmarks.speed.clock import time_shots
try:
    from benchmarks.speed.command import KINDS, shots as shots_of
except ModuleNotFoundError:  # before 1.0 it is there, and importing __main__ would run it
    from benchmarks.speed.__main__ import KINDS, shots as shots_of
for kind in KINDS:
    found[f"{kind} [us]"] = float(np.median(np.min(time_shots(*shots_of(kind, shots, seed), "standard", repeats), axis=0)))
p, v, w = shots_of(KINDS[0], shots, seed)
best = np.full(shots, np.inf)
for _ in range(repeats):
    for k in range(shots):
        t = time.perf_counter()
        sn.simulate(p[k], v[k], w[k])
        best[k] = min(best[k], time.perf_counter() - t)
found[f"sn.simulate, {KINDS[0]} [us]"] = float(np.median(best)) * 1e6
try:
    from benchmarks.speed.steps import FRAME, native, rate, stepper
except ModuleNotFoundError:  # until November 2026
    from benchmarks.vector import FRAME, native, rate, stepper
for name, options in ("visits", {}), ("frames", FRAME):
    step = stepper(native(1024, 1, **options), seed)
    found[f"a step of 1,024 tables, {name} [us]"] = min(1e6 / rate(step, 1024, 1.0) for _ in range(repeats))
print(json.dumps(found))
"""


class CommitError(RuntimeError):
    """The commit cannot be extracted or measured; the message says why in one line."""


def _take_out(commit, folder):
    """Extract the files of a commit into a folder."""
    packed = subprocess.run(["git", "archive", "--format=tar", commit], cwd=ROOT, capture_output=True)
    if packed.returncode:
        raise CommitError(
            f"against = {commit!r}: must be a commit of this repository ({packed.stderr.decode().strip()})"
        )
    subprocess.run(["tar", "-x", "-C", folder], input=packed.stdout, check=True)


def _measure(tree, arguments):
    with tempfile.TemporaryDirectory() as cache:
        environment = os.environ | {
            "PYTHONPATH": str(tree),
            "NUMBA_CACHE_DIR": cache,
            "SNOOKER_ENV_QUIET": "1",
        }
        command = [sys.executable, "-c", _CHILD, *map(str, arguments)]
        done = subprocess.run(command, cwd=tree, env=environment, capture_output=True, text=True)
    if done.returncode:
        raise CommitError(f"{tree} cannot be measured: {done.stderr.strip().splitlines()[-1]}")
    return json.loads(done.stdout)


def compare(commit, shots, repeats, seed, rounds=ROUNDS):
    """Returns {figure: {"before", "now", "ratio"}}: medians over rounds in which the two sides take turns, and the
    median of their ratios."""
    with tempfile.TemporaryDirectory() as folder:
        _take_out(commit, folder)
        both = [
            [_measure(tree, (shots, repeats, seed)) for tree in (Path(folder), ROOT)] for _ in range(rounds)
        ]
    found = {}
    for name in both[0][0]:
        before, now = ([one[side][name] for one in both] for side in (0, 1))
        ratios = [b / a for a, b in zip(before, now, strict=True)]
        found[name] = {
            "before": statistics.median(before),
            "now": statistics.median(now),
            "ratio": statistics.median(ratios),
        }
    return found
