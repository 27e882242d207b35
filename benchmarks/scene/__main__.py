"""Which models of the physics does a scene require? Each is left out in turn: where balls stop, whether they
drop, the cost.

    python -m benchmarks.scene [--shots 600] [--repeats 5] [--models NAME ...] [--seed 0]
    [--json FILE]
        [--out FOLDER]

The same strokes are played at ``standard`` with every model and without one; each shot's time is the least of
the repeats, in which the ways take turns (``speed/clock.py``). A shot ends otherwise if other balls drop, or
if the ball aimed at is hit in one case only. The cost is that of the whole shot: a ball that goes another way
meets other things, which counts too; a model's own cost shows best where it does nothing. The first run
compiles a copy of the package (``_common/variants.py``). Two rows give the scale: a professional's execution
errors (the stroke again with others) and the aim turned by 1e-9 rad, which shows how much of an effect is
chaos.

Balls that fly are off by default: there the row says what adding them changes, and its cost is the time with them over
the time without.
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import snooker_env as sn
from agents._lib import provenance
from snooker_env import simulation
from snooker_env.physics.engine import EventKind, Status

from .._common import variants
from .._common.command import Command, at_least, run, save_figures
from ..speed.clock import Way, time_ways
from .models import MODELS, SCENES, STANDARD, head_on_stun
from .picture import draw
from .verdicts import CHAOS, ERRORS, FULL, reasons, verdict

FILE, PHYSICS = "scene.png", "match"


def play_batch(way, start):
    """The batch played to the end: positions, potted, on table.

    Between the points of the table without jaw arcs a ball can leave it: that shot ends otherwise than any.
    """
    state = [a.copy() for a in (*start, np.zeros(start[0].shape))]
    out = way.simulation._run(state, way.physics, way.table, way.solver, 100_000)
    astray = out.status == Status.ASTRAY
    out.potted[astray], state[3][astray] = 0, False
    if (out.status[~astray] != Status.OK).any():
        raise RuntimeError(f"shots {np.flatnonzero(out.status)} did not come to rest")
    return state[0], out.potted, state[3]


def effect(end, truth, start, ball):
    """Median and 95 % of the shifts [mm] of the cue ball and of the ball aimed at, and the share of shots
    that end otherwise."""
    rows = np.arange(len(ball))
    found = {}
    for name, b in (("cue_mm", 0 * ball), ("ball_mm", ball)):
        shift = 1e3 * np.hypot(*(end[0] - truth[0])[rows, b].T)[end[2][rows, b] & truth[2][rows, b]]
        found[name] = np.quantile(shift, [0.5, 0.95, 1.0]).tolist() if len(shift) else [0.0] * 3
        found[name[:-2] + "shots"] = len(shift)
    hit = [(x[0] != start[0]).any(-1)[rows, ball] for x in (end, truth)]
    found["changed"] = float((((end[1] >= 0) != (truth[1] >= 0)).any(1) | (hit[0] != hit[1])).mean())
    return found


def counts(starts, physics, most=40):
    """What runs in the first shots of each scene, by ``_common.counts`` in a process without numba."""
    with tempfile.TemporaryDirectory() as folder:
        files = [Path(folder) / f"{k}.npz" for k in range(len(starts))]
        for file, (positions, velocities, spins, *_) in zip(files, starts, strict=True):
            np.savez(file, positions=positions[:most], velocities=velocities[:most], spins=spins[:most])
        command = [
            sys.executable,
            "-c",
            "from benchmarks._common import counts; counts.main()",
            physics,
            *map(str, files),
        ]
        root = Path(__file__).parents[2]
        done = subprocess.run(
            command,
            cwd=root,
            env=os.environ | {"NUMBA_DISABLE_JIT": "1"},
            check=True,
            capture_output=True,
            text=True,
        )
    return json.loads(done.stdout)


def study(make, n, repeats, physics, chosen, seed):
    """Everything about one scene, and its strokes."""
    constants, match = sn.Physics.preset(physics), sn.Table.preset("match")
    shots = make(n, constants, seed)
    its = variants.load() if any(MODELS[m].code != STANDARD for m in chosen) else simulation
    here = np.ones(shots.positions.shape[:2], bool)

    def start_strokes(**how):
        v, w = shots.struck(**how)
        return shots.positions, v, w, here

    # with a professional's errors no shot is exactly head-on
    errors = {} if make is head_on_stun else {"seed": seed + 1}
    start = start_strokes(**errors)
    full = Way(constants, (STANDARD, 0), match, its)
    ways = {FULL: full}
    for name in chosen:
        m = MODELS[name]
        changed = sn.Physics.preset(physics, **m.physics) if m.physics else constants
        ways[name] = Way(changed, (m.code, 0), m.table or match, its)
    ends = {name: play_batch(way, start) for name, way in ways.items()}
    truth = ends.pop(FULL)
    rows = {name: effect(end, truth, start, shots.ball) for name, end in ends.items()}
    for name, how in ((ERRORS, {"seed": seed + 2}), (CHAOS, {**errors, "aim": 1e-9})):
        rows[name] = effect(play_batch(full, start_strokes(**how)), truth, start, shots.ball)
    times = time_ways(ways, start[:3], repeats)
    took = {name: float(of.min(0).mean()) for name, of in times.items()}
    for name in chosen:
        rows[name]["cost"] = took[name] / took[FULL] if MODELS[name].added else took[FULL] / took[name]
    log = sn.simulate_batch(start[0], start[1], start[2], physics=constants, events=True).events
    assert log is not None
    kinds = np.concatenate([events["kind"] for events in log])
    ran = {k.name.lower().replace("_", "-"): float((kinds == k).sum() / n) for k in EventKind}
    return {"us": took[FULL], "rows": rows, "ran": ran}, start


def main():
    """Command line."""
    parser = Command("scene", __doc__, pictures=(FILE,), seed=0, redraws=True)
    parser.add_argument("--shots", type=at_least(2), default=600, help="shots in each scene")
    parser.add_argument(
        "--repeats", type=at_least(1), default=5, help="timed runs of every shot; the best counts"
    )
    parser.add_argument("--models", nargs="+", choices=list(MODELS), default=list(MODELS), help="only these")
    options = parser.options()
    figures = measure(options) if options.figures is None else options.figures
    if options.pictures:
        draw(figures, options.folder / FILE)
        print(f"\n{options.folder / FILE}")


def measure(options):
    """Measure and print everything; the figures."""
    print(
        f"{provenance.line(options.made)}\n{options.shots} shots a scene, physics {PHYSICS!r}, fidelity 'standard'; * where it matters"
    )
    scenes, starts = {}, []
    for scene, make in SCENES.items():
        s, start = study(make, options.shots, options.repeats, PHYSICS, options.models, options.seed)
        scenes[scene] = s
        starts.append(start)
        print(f"\n{scene}: {s['us']:.1f} us a shot")
        print(
            "  without                         cue ball off by [mm]: median, 95 %   ball aimed at: the same   end otherwise   cost"
        )
        for name, row in s["rows"].items():
            mm = "          ".join(
                " ".join(f"{e:9.3f}" if e < 10 else f"{e:9.0f}" for e in row[k][:2])
                for k in ("cue_mm", "ball_mm")
            )
            star = "*" if name not in (ERRORS, CHAOS) and reasons(row, s["rows"]) else " "
            changed = f"{row['changed']:9.1%}" if "changed" in row else f"{'-':>9s}"
            cost = f"{row['cost']:.2f} x" if "cost" in row else "-"
            print(f"{star} {name:30s}     {mm}     {changed}      {cost:>7s}")
    for s, counted in zip(scenes.values(), counts(starts, PHYSICS), strict=True):
        s["ran"].update(counted)
    print("\nWhat ran, per shot (integrations and jaw arcs: counted in the first 40 shots)")
    print(" " * 26 + "".join(f"{scene:>16s}" for scene in scenes))
    for what in next(iter(scenes.values()))["ran"]:
        print(f"  {what:24s}" + "".join(f"{s['ran'][what]:16.2f}" for s in scenes.values()))
    stun = scenes["head-on stun"]["ran"]
    solved, tested = stun["ball-ball integrations"], stun["jaw arcs tested"]
    paid = "neither costs it any time" if solved + tested == 0 else "it spends time on what it does not need"
    lines = [
        f"A head-on stun shot far from every jaw integrates {solved:.2g} ball-ball impacts and tests {tested:.3g} jaw arcs: {paid}."
    ]
    lines += [verdict(name, scenes) for name in options.models]
    print("\nWhat follows")
    for sentence in lines:
        print(f"* {sentence}")
    figures = {
        "physics": PHYSICS,
        "shots": options.shots,
        "scenes": scenes,
        "says": lines,
    }
    return save_figures(options, figures)


if __name__ == "__main__":
    run(main)
