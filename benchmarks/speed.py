"""How fast is it? Microseconds an impact at each fidelity, a two-ball pot, a random 22-ball shot, a break-off; one core.

    python -m benchmarks.speed [--shots 1000] [--repeats 7] [--json FILE]

Times are kernel times: of an impact the median over the set, each impact timed by itself, and the mean, the set run as a whole
``--repeats`` times; of a shot each one timed by itself, the call from Python taken off. Errors are against ``reference``, in units of the
incoming speed.
"""

import argparse
import json
import platform
import time
from pathlib import Path

import numba
import numpy as np

import snooker_env as sn
from snooker_env.game.balls import SPOTS
from snooker_env.physics import contact
from snooker_env.physics.engine import EventKind
from snooker_env.physics.parameters import P_E_B
from snooker_env.physics.table import Table
from snooker_env.simulation import _run

R = 0.02625
IMPACT_FIDELITIES = ("fast", "standard", "reference", "euler:200", "euler:1000", "euler:10000")
SHOT_FIDELITIES = ("fast", "standard", "reference")


@numba.njit(nogil=True)
def _impacts(x, normals, phys, code, n_steps):
    total = 0.0
    for k in range(len(x)):
        v1, w1 = (x[k, 0], x[k, 1], 0.0), (x[k, 2], x[k, 3], x[k, 4])
        still = (0.0, 0.0, 0.0)
        out = contact.collide_balls(v1, w1, still, still, normals[k, 0], normals[k, 1], phys, phys[P_E_B], code, n_steps)
        total += out[0][0]
    return total


@numba.njit(nogil=True)
def _same_impact(x, normal, times, phys, code, n_steps):
    v1, w1, still, total = (x[0], x[1], 0.0), (x[2], x[3], x[4]), (0.0, 0.0, 0.0), 0.0
    for _ in range(times):
        out = contact.collide_balls(v1, w1, still, still, normal[0], normal[1], phys, phys[P_E_B], code, n_steps)
        total += out[0][0]
    return total


def median_impact(x, normals, phys, code, n_steps, times):
    """Median over impacts of each one's own time [us], played ``times`` times in a row; the best of three."""
    _same_impact(x[0], normals[0], 1, phys, code, n_steps)
    best = np.full(len(x), np.inf)
    for _ in range(3):
        for k in range(len(x)):
            t = time.perf_counter()
            _same_impact(x[k], normals[k], times, phys, code, n_steps)
            best[k] = min(best[k], (time.perf_counter() - t) / times * 1e6)
    return float(np.median(best))


def results(x, normals, fidelity):
    """(n, 12) velocities and R * spins after each impact."""
    physics = sn.Physics.preset("paper")
    out = np.zeros((len(x), 12))
    for k in range(len(x)):
        args = (*x[k, :2], 0.0), x[k, 2:], (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (*normals[k], 0.0)
        v1, w1, v2, w2 = sn.collide_balls(*args, physics, fidelity)
        out[k] = np.concatenate([v1, w1 * R, v2, w2 * R])
    return out


def impacts(n, seed=0):
    """Impacts of real play: cue speeds 0.3 to 6 m/s, cuts to 80 degrees, cue ball anywhere from full draw to full follow, side to 0.4 R."""
    rng = np.random.default_rng(seed)
    speed, cut = rng.uniform(0.3, 6, n), np.radians(rng.uniform(-80, 80, n))
    x = np.zeros((n, 5))
    x[:, 0] = speed
    x[:, 3] = rng.uniform(-1, 1, n) * speed / R
    x[:, 4] = rng.uniform(-1, 1, n) * speed / R
    return x, np.column_stack([np.cos(cut), np.sin(cut)])


def shots(kind, n, seed=0):
    """n seeded shots: positions (n, b, 2), velocities, spins."""
    rng = np.random.default_rng(seed)
    balls = 2 if kind == "two-ball pot" else 22
    p, v, w = np.zeros((n, balls, 2)), np.zeros((n, balls, 2)), np.zeros((n, balls, 3))
    for k in range(n):
        if kind == "two-ball pot":
            d = rng.uniform(0.3, 1.0)
            pocket = np.array([0.889, 1.7845])
            along = np.array([1, 1]) / np.sqrt(2)
            p[k, 1] = pocket - (0.3 + rng.uniform(0, 0.3)) * along
            cut = rng.uniform(-0.6, 0.6)
            back = np.array([np.cos(np.pi / 4 + cut), np.sin(np.pi / 4 + cut)])
            p[k, 0] = p[k, 1] - 2 * R * along - d * back
            speed, aim, tip = rng.uniform(1, 2.5), np.pi / 4 + cut, (0.0, rng.uniform(-0.3, 0.3))
        elif kind == "break-off":
            p[k] = SPOTS
            p[k, 0] = rng.uniform(0.08, 0.2), -1.0475 - rng.uniform(0, 0.1)
            to = p[k, 15] + [rng.uniform(0.01, 0.04), 0] - p[k, 0]
            speed, aim, tip = rng.uniform(3.5, 6), np.arctan2(to[1], to[0]), (rng.uniform(-0.3, 0.3), 0.0)
        else:
            while True:
                p[k] = rng.uniform([-0.84, -1.73], [0.84, 1.73], (22, 2))
                far = np.hypot(*(p[k][:, None] - p[k][None]).transpose(2, 0, 1)) + 9 * np.eye(22)
                if far.min() > 2 * R + 1e-3 and (np.abs(p[k, :, 1]) > 0.1).all():
                    break
            speed, aim, tip = rng.uniform(0.5, 6), rng.uniform(-np.pi, np.pi), rng.uniform(-0.35, 0.35, 2)
        v3, w[k, 0] = sn.strike(speed, aim, *tip)
        v[k, 0] = v3[:2]
    return p, v, w


def timed(work, repeats, items):
    """Microseconds an item: (median, min, max) over the repeats, after one warm-up."""
    work()
    found = []
    for _ in range(repeats):
        t = time.perf_counter()
        work()
        found.append((time.perf_counter() - t) / items * 1e6)
    return float(np.median(found)), min(found), max(found)


def one_by_one(p, v, w, fidelity, repeats, physics=None):
    """Each shot's own best time [us]: the batch kernel on a slice of one."""
    code = contact.parse_fidelity(fidelity)
    physics, table = sn.Physics.of(physics), Table.preset("match")
    here = np.ones(p.shape[:2], bool)
    best = np.full(len(p), np.inf)
    for _ in range(repeats):
        for k in range(len(p)):
            state = [a[k : k + 1].copy() for a in (p, v, w, here)]
            t = time.perf_counter()
            _run(state, physics, table, code, 100_000, 0, 0)
            best[k] = min(best[k], time.perf_counter() - t)
    empty = [np.zeros((1, 1, 2)), np.zeros((1, 1, 2)), np.zeros((1, 1, 3)), np.ones((1, 1), bool)]
    call = min(_call(empty, physics, table, code) for _ in range(200))
    return (best - call) * 1e6


def _call(state, physics, table, code):
    t = time.perf_counter()
    _run([a.copy() for a in state], physics, table, code, 100_000, 0, 0)
    return time.perf_counter() - t


def main():
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--shots", type=int, default=1000, help="shots (and impacts) in a set")
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--json", type=Path, help="also write every figure there")
    options = parser.parse_args()
    figures = {"machine": f"{platform.machine()} {platform.system()}", "python": platform.python_version(), "numba": numba.__version__}
    phys = sn.Physics.preset("paper").pack()
    x, normals = impacts(options.shots)
    truth = results(x, normals, "reference")
    print(f"{options.shots} impacts, one core     us: median; mean (min, max of {options.repeats} runs); error: median, 99 %, worst")
    for fidelity in IMPACT_FIDELITIES:
        code, n_steps = contact.parse_fidelity(fidelity)
        row = timed(lambda c=code, n=n_steps: _impacts(x, normals, phys, c, n), options.repeats, len(x))
        error = np.abs(results(x, normals, fidelity) - truth).max(1) / x[:, 0]
        spread = np.quantile(error, [0.5, 0.99, 1.0]).tolist()
        middle = median_impact(x, normals, phys, code, n_steps, max(2, int(50 / row[0])))
        figures[f"impact {fidelity}"] = {"us_median": middle, "us_mean": row, "error": spread}
        print(f"  {fidelity:12s} {middle:9.3f}; {row[0]:9.3f} ({row[1]:.3f}, {row[2]:.3f}); " + "  ".join(f"{e:.1e}" for e in spread))
    print(f"\n{options.shots} shots, one core              us a shot: mean over the set; median and 95 % over shots; events; ball-ball")
    for kind in ("two-ball pot", "random 22 balls", "break-off"):
        p, v, w = shots(kind, options.shots)
        for fidelity in SHOT_FIDELITIES:
            single = one_by_one(p, v, w, fidelity, 3)
            batch = sn.simulate_batch(p, v, w, fidelity=fidelity, threads=1, events=True)
            assert batch.events is not None
            hits = np.mean([(e["kind"] == EventKind.BALL_BALL).sum() for e in batch.events])
            row = {
                "mean": float(single.mean()), "median": float(np.median(single)), "p95": float(np.quantile(single, 0.95)),
                "events": float(np.mean(batch.event_count)), "ball_ball": float(hits),
            }  # fmt: skip
            figures[f"{kind} {fidelity}"] = row
            print(
                f"  {kind:16s} {fidelity:10s} mean {row['mean']:8.1f}  median {row['median']:8.1f}  p95 {row['p95']:8.1f}"
                f"  events {row['events']:6.1f}  hits {row['ball_ball']:5.1f}"
            )
    if options.json:
        options.json.write_text(json.dumps(figures, indent=1) + "\n")


if __name__ == "__main__":
    main()
