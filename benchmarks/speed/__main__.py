"""How fast is the engine? Measures impacts, two-ball pots, random 22-ball shots and break-offs, whole steps, and the
start.

    python -m benchmarks.speed [--shots 1000] [--repeats 7] [--parts impacts shots steps start]
        [--seed 0] [--json FILE] [--out FOLDER]
    python -m benchmarks.speed --against COMMIT

Times are kernel times on one core, with each shot (or impact) timed separately: one kernel plays the whole set in
order, each shot once, and reads the processor's cycle counter before and after each (``clock.py``). The set is
played ``--repeats`` times after an uncounted pass; a shot's time is its median over these passes. "set" (a set of
impacts in one call, without reading the counter), batches and threads are the fastest of their repeats. Without an
x86 counter, each shot is called from Python ``--repeats`` times, and its time is the best one minus the cost of the
call. An event is one entry of the shot's log. Errors are relative to ``reference``, in units of the incoming speed.

``steps.py``, ``first_shot.py`` and ``against_commit.py`` explain steps, the start and ``--against COMMIT``. With
``--against`` and no ``--parts``, the command does only this comparison.
"""

import time

import numpy as np

import snooker_env as sn
from agents._lib import provenance
from agents._lib.tables import text_table
from snooker_env._lib.jit import entry
from snooker_env.game.balls import SPOTS
from snooker_env.physics.arrays import Law
from snooker_env.physics.columns import P_E_B
from snooker_env.physics.engine import EventKind
from snooker_env.physics.impact import contact
from snooker_env.physics.impact.polynomial import WORK

from .._common.command import Command, at_least, run, save_figures
from . import against_commit, clock, first_shot, steps
from .clock import time_shots

R = 0.02625
IMPACT_FIDELITIES = ("fast", "standard", "reference", "euler:200", "euler:1000", "euler:10000")
SHOT_FIDELITIES = ("fast", "standard", "reference")
KINDS = ("two-ball pot", "random 22 balls", "break-off")
GOALS = {
    "impact": (1.0, 0.5),
    "two-ball pot": (6.0, 4.0),
    "random 22 balls": (25.0, 14.0),
    "break-off": (450.0, 250.0),
}
"""Microseconds at ``standard``: requirement and target."""
PARTS = ("impacts", "shots", "steps", "start")
TABLES = 1024
"""Tables of a vector environment."""


@entry(what="the benchmark of an impact", seconds=10)
def _same_impact(x, normal, times, phys, code, n_steps):
    v1, w1, still, total = (x[0], x[1], 0.0), (x[2], x[3], x[4]), (0.0, 0.0, 0.0), 0.0
    law, work = Law(phys, code, n_steps), np.empty(WORK)
    for _ in range(times):
        out = contact.collide_balls(v1, w1, still, still, (normal[0], normal[1]), law, phys[P_E_B], work)
        total += out[0][0]
    return total


def median_impact(x, normals, phys, code, n_steps, times):
    """Median over impacts of the time of each [us], played ``times`` times in a row; the best of three."""
    _same_impact(x[0], normals[0], 1, phys, code, n_steps)
    best = np.full(len(x), np.inf)
    for _ in range(3):
        for k in range(len(x)):
            t = time.perf_counter()
            _same_impact(x[k], normals[k], times, phys, code, n_steps)
            best[k] = min(best[k], (time.perf_counter() - t) / times * 1e6)
    return float(np.median(best))


def results(x, normals, fidelity, physics):
    """Velocities and R * spins after each impact, (n, 12)."""
    out = np.zeros((len(x), 12))
    for k in range(len(x)):
        args = (*x[k, :2], 0.0), x[k, 2:], (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (*normals[k], 0.0)
        v1, w1, v2, w2 = sn.collide_balls(*args, physics, fidelity)
        out[k] = np.concatenate([v1, w1 * R, v2, w2 * R])
    return out


def impacts(n, seed=0):
    """Realistic impacts: cue speeds 0.3 to 6 m/s, cuts up to 80 degrees, cue ball anywhere from full draw to
    full follow, side to 0.4 R."""
    rng = np.random.default_rng(seed)
    speed, cut = rng.uniform(0.3, 6, n), np.radians(rng.uniform(-80, 80, n))
    x = np.zeros((n, 5))
    x[:, 0] = speed
    x[:, 3] = rng.uniform(-1, 1, n) * speed / R
    x[:, 4] = rng.uniform(-1, 1, n) * speed / R
    return x, np.column_stack([np.cos(cut), np.sin(cut)])


def shots(kind, n, seed=0):
    """Draw n seeded shots of "two-ball pot", "break-off" or "random N balls": positions (n, b, 2), velocities,
    spins."""
    rng = np.random.default_rng(seed)
    balls = {"two-ball pot": 2, "break-off": 22}.get(kind) or int(kind.split()[1])
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
                p[k] = rng.uniform([-0.84, -1.73], [0.84, 1.73], (balls, 2))
                far = np.hypot(*(p[k][:, None] - p[k][None]).transpose(2, 0, 1)) + 9 * np.eye(balls)
                if far.min() > 2 * R + 1e-3 and (np.abs(p[k, :, 1]) > 0.1).all():
                    break
            speed, aim, tip = rng.uniform(0.5, 6), rng.uniform(-np.pi, np.pi), rng.uniform(-0.35, 0.35, 2)
        v3, w[k, 0] = sn.strike(speed, aim, tip[0], tip[1])
        v[k, 0] = v3[:2]
    return p, v, w


def summary(times):
    """Figures of a set; times (passes, items). An item's time is its median over the passes, so that interruptions do
    not affect a mean."""
    each, medians = np.median(times, axis=0), np.median(times, axis=1)
    found = {"median": float(np.median(each)), "mean": float(each.mean())}
    found |= {f"p{q}": float(np.percentile(each, q)) for q in (5, 25, 75, 95, 99)}
    return found | {"median_low": float(medians.min()), "median_high": float(medians.max())}


def print_goals(name, us):
    """A line that compares a median with its goal."""
    must, aim = GOALS[name]
    print(f"  {'':16s} must {must:g}, aim {aim:g}: {us / must:.2f} of what must be reached")


def measure_impacts(n, repeats, seed=0):
    """Table of impacts."""
    physics = sn.Physics.preset("paper")
    phys = physics.packed_for((1, 0))
    x, normals = impacts(n, seed)
    truth, found = results(x, normals, "reference", physics), {}
    print(
        f"\n{n} impacts, us: median (lowest, highest of {repeats} passes), 5 %, 95 %, set; error: median, 99 %, worst"
    )
    for fidelity in IMPACT_FIDELITIES:
        code, n_steps = contact.parse_fidelity(fidelity)
        whole = clock.time_impact_set(x, normals, phys, fidelity, repeats)
        if clock.HAS_COUNTER:
            row: dict = summary(clock.time_impacts(x, normals, phys, fidelity, repeats))
        else:
            row = {"median": median_impact(x, normals, phys, code, n_steps, max(2, int(50 / whole)))}
        error = np.abs(results(x, normals, fidelity, physics) - truth).max(1) / x[:, 0]
        row |= {"set": whole, "error": np.quantile(error, [0.5, 0.99, 1.0]).tolist()}
        found[fidelity] = row
        spread = (
            f"({row['median_low']:.3f}, {row['median_high']:.3f})  {row['p5']:9.3f} {row['p95']:9.3f}"
            if "p5" in row
            else ""
        )
        print(
            f"  {fidelity:12s} {row['median']:9.3f} {spread} {whole:9.3f}   "
            + "  ".join(f"{e:.1e}" for e in row["error"])
        )
        if fidelity == "standard":
            print_goals("impact", row["median"])
    return found


def measure_shots(n, repeats, seed=0):
    """Table of shots."""
    found = {}
    print(
        f"\n{n} shots, us a shot: median (lowest, highest of {repeats} passes), percentiles, mean; a shot: events, ball-ball impacts;"
    )
    print(
        "ns an event: mean time over mean events; 1 and 2 threads: mean us a shot of the set as one batch, quickest"
    )
    print(
        f"  {'':27s}  median {'':20s} 5 %     25 %     75 %     95 %     99 %     mean  events  hits ns/event  1 thread 2 threads"
    )
    for kind in KINDS:
        shots_ = shots(kind, n, seed)
        for fidelity in SHOT_FIDELITIES:
            row = summary(time_shots(*shots_, fidelity, repeats))
            batch = sn.simulate_batch(*shots_, fidelity=fidelity, threads=1, events=True)
            assert batch.events is not None
            row["events"] = float(np.mean(batch.event_count))
            row["ball_ball"] = float(
                np.mean([(e["kind"] == EventKind.BALL_BALL).sum() for e in batch.events])
            )
            row["ns_event"] = 1e3 * row["mean"] / row["events"]
            for threads in (1, 2):
                row[f"threads_{threads}"] = clock.time_batch(*shots_, fidelity, threads, repeats)
            found[f"{kind} {fidelity}"] = row
            print(
                f"  {kind:16s} {fidelity:10s} {row['median']:7.1f} ({row['median_low']:7.1f}, {row['median_high']:7.1f})"
                + "".join(f" {row[q]:8.1f}" for q in ("p5", "p25", "p75", "p95", "p99", "mean"))
                + f" {row['events']:7.1f} {row['ball_ball']:5.1f} {row['ns_event']:8.0f}  {row['threads_1']:8.1f}  {row['threads_2']:8.1f}"
            )
            if fidelity == "standard":
                print_goals(kind, row["median"])
    return found


def measure_start():
    """Table of cold and warm starts."""
    found = first_shot.start()
    print(
        "\nStart of a fresh process, seconds of wall clock (of processor); goals: import 0.6, first shot 15 cold and 1 warm"
    )
    for state, of in found.items():
        print(
            f"  {state:5s} cache  "
            + "   ".join(f"{step} {of[step][0]:.2f} ({of[step][1]:.2f})" for step in first_shot.STEPS)
        )
    return found


def measure_against_commit(commit, n, repeats, seed=0):
    """Play the same shots with the code of a commit and of this tree, in turn."""
    found = against_commit.compare(commit, n, repeats, seed)
    print(
        f"\n{commit} and this tree in turn, {against_commit.ROUNDS} times; medians over {n} shots, one core; `standard`"
    )
    rows = [
        [name, f"{row['before']:.2f}", f"{row['now']:.2f}", f"{row['ratio']:.3f}"]
        for name, row in found.items()
    ]
    print("\n".join(text_table(["", "before", "now", "ratio"], rows)))
    return found


def main():
    """Command line."""
    parser = Command("speed", __doc__, seed=0)
    parser.add_argument("--shots", type=at_least(2), default=1000, help="shots (and impacts) in a set")
    parser.add_argument("--repeats", type=at_least(1), default=7, help="passes over a set")
    parser.add_argument("--parts", nargs="+", choices=PARTS, help="only these")
    parser.add_argument(
        "--against", metavar="COMMIT", help="play the same shots with a commit and this tree, in turn"
    )
    options = parser.options()
    parts = options.parts or (() if options.against else PARTS)
    figures: dict[str, object] = {}
    print(
        provenance.line(options.made) + ("" if clock.HAS_COUNTER else "; no cycle counter: best of the calls")
    )
    if "impacts" in parts:
        figures["impacts"] = measure_impacts(options.shots, options.repeats, options.seed)
    if "shots" in parts:
        figures["shots"] = measure_shots(options.shots, options.repeats, options.seed)
    if "steps" in parts:
        figures["steps"] = steps.measure(TABLES, options.repeats, options.seed)
    if "start" in parts:
        figures["start"] = measure_start()
    if options.against:
        found = measure_against_commit(options.against, options.shots, options.repeats, options.seed)
        figures[f"against {options.against}"] = found
    save_figures(options, figures)


if __name__ == "__main__":
    run(main)
