"""What does a scene require? Each model left out in turn: where balls stop, whether they drop, what it costs; what runs in which scene.

    python -m benchmarks.scene [--shots 600] [--repeats 5] [--physics match] [--models NAME ...] [--seed 0] [--json FILE]
        [--out FOLDER]

The same strokes are played at ``standard`` with every model and without one; times are taken in turn, each shot's best of the repeats.
A shot ends otherwise if other balls drop, or if the ball aimed at is hit in one case only. The cost is that of the whole shot: a ball that
goes another way meets other things, which counts too; a model's own cost shows best where it does nothing. The first run compiles a copy
of the package (``_common/variants.py``). Two rows measure the measure: a professional's errors (the stroke played again with others)
and the aim turned by 1e-9 rad, which shows how much of an effect is chaos.

The hop is not modelled, so its effect is computed. Friction at an impact throws the upper ball up at v_z. In the air nothing slows it;
where it lands the cloth stops v_z, and friction comes all at once. However often it bounces, the cloth's normal impulse falls short of the
ball's weight by M v_z in all, so friction falls short by mu_s M v_z: the ball slides v_z / g longer, and all its later path is shifted by
v v_z / g (twice that, v times the time of flight, if landing had no friction). Left out: a ball that meets another ball or a cushion in
the air, the speed lost in rolling, and what the shift changes later.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import snooker_env as sn
from commands import provenance
from snooker_env import geometry, simulation
from snooker_env.physics.engine import EventKind
from snooker_env.physics.impact import contact
from snooker_env.physics.meetings import PART

from ._common import shot_sets, variants
from ._common.command import Command, at_least, pyplot, run, save_figure, save_json

STANDARD = contact.parse_fidelity("standard")[0]
FULL, ERRORS, CHAOS, HOP = "everything", "a professional's errors", "aim turned by 1e-9 rad", "hop of the lifted ball"
SHARE = 0.1
"""A model matters in a scene if it moves balls or changes outcomes by more than this share of what a professional's errors do."""
VISIBLE = 1.0
"""... by more than this [mm] in the middle case ..."""
ENOUGH = 20
"""... over at least so many shots that leave the ball on the table."""
NOTHING = 1e-3
"""A model that moves no ball by more than this [mm] did nothing in the scene."""
FREE = 0.05
"""Costs within this share of 1 cannot be distinguished from none on a shared machine."""
FILE = "scene.png"


def head_on_stun(n, w, seed):
    """Full-ball shots without spin at the impact, far from every cushion and jaw, played without errors."""
    return shot_sets.head_on(n, w, seed)


SCENES = {
    "head-on stun": head_on_stun,
    "straight pots": lambda n, w, seed: shot_sets.two_ball(n, w, seed, cut=(0.0, 1.0), speed=(1.0, 3.0)),
    "cut pots, soft": lambda n, w, seed: shot_sets.two_ball(n, w, seed, cut=(10.0, 60.0), speed=(1.0, 2.0)),
    "cut pots, firm": lambda n, w, seed: shot_sets.two_ball(n, w, seed, cut=(10.0, 60.0), speed=(3.0, 5.0)),
    "cushion first": lambda n, w, seed: shot_sets.kicks(n, w, seed),
    "by the rail": lambda n, w, seed: shot_sets.two_ball(
        n, w, seed, place=shot_sets.by_the_rail, run=(0.15, 0.65), cut=(5.0, 50.0), speed=(1.0, 3.0)
    ),
    "full tables": lambda n, w, seed: shot_sets.full_table(n, w, seed),
}


def sharp_jaws():
    """The match table with each jaw's two arcs shrunk to the points of its throat: straight noses on to the same opening."""
    match, noses = sn.Table.preset("match"), []
    corner, middle = throats()
    for axis, side, level, low, high in match.noses:
        half = geometry.HALF_LENGTH if axis == 0 else geometry.HALF_WIDTH
        ends = [np.sign(e) * (half - corner if abs(e) > half / 2 else middle) for e in (low, high)]
        noses.append((axis, side, level, *ends))
    points = [(sx * (geometry.HALF_WIDTH - corner), sy * geometry.HALF_LENGTH) for sx in (-1, 1) for sy in (-1, 1)]
    points += [(sx * geometry.HALF_WIDTH, sy * (geometry.HALF_LENGTH - corner)) for sx in (-1, 1) for sy in (-1, 1)]
    points += [(sx * geometry.HALF_WIDTH, sy * middle) for sx in (-1, 1) for sy in (-1, 1)]
    return sn.Table("sharp", np.array(noses), np.array([(x, y, 0.0, 1.0, 0.0, -1.0) for x, y in points]), match.falls)


def throats():
    """Distances [m] from the corner, and from a middle pocket's axis, of the points as far apart as the throats are wide."""
    jaws = sn.Table.preset("match").jaws
    arcs = jaws[np.hypot(jaws[:, 0] - geometry.HALF_WIDTH, jaws[:, 1] - geometry.HALF_LENGTH).argsort()[:2], :3]
    corner = (np.hypot(*(arcs[0, :2] - arcs[1, :2])) - 2 * arcs[0, 2]) / np.sqrt(2)
    middle = jaws[np.abs(jaws[:, 1]).argmin()]
    return corner, abs(middle[1]) - middle[2]


@dataclass(frozen=True)
class LeftOut:
    """One model, and what a shot is played with when it is left out."""

    instead: str
    product: str
    """What snooker_env does today."""
    code: int = STANDARD
    physics: dict | None = None
    table: sn.Table | None = None


EVERY, ALWAYS = "snooker_env has it at standard and reference", "snooker_env has it at every fidelity"
MODELS = {
    "cloth in a ball-ball impact": LeftOut("two free spheres, closed form", f"{EVERY}, not at fast", variants.FREE_BALLS),
    "cushion: tight tolerance": LeftOut("the loose tolerance of fast", f"{EVERY}, not at fast", variants.LOOSE_CUSHION),
    "cushion: cloth (the ODE)": LeftOut("a smooth cloth, closed form", ALWAYS, variants.SMOOTH_CLOTH),
    "cushion: friction, nose, ODE": LeftOut("a mirror with e_c", ALWAYS, variants.MIRROR),
    "jaw arcs": LeftOut("the throat's points", "snooker_env has them on every table", table=sharp_jaws()),
    "jaws at all": LeftOut(
        "no jaws: only noses and falls", "snooker_env has them on every table",
        table=sn.Table("no jaws", sn.Table.preset("match").noses, np.zeros((0, 6)), sn.Table.preset("match").falls),
    ),
    "drop takes time": LeftOut("dropped at once at the edge", ALWAYS, variants.AT_ONCE),
    "Marlow's law": LeftOut("mu_bb 0.05", 'snooker_env has it in "match"; "paper" keeps the paper\'s 0.05', physics={"mu_bb": 0.05}),
    "spin decay": LeftOut("spin about the vertical stays", "snooker_env has it everywhere", physics={"spin_decel": 0.0}),
}  # fmt: skip


def played(run, start, constants, table_, code):
    """The batch played to the end: positions, potted, on table."""
    state = [a.copy() for a in start]
    out = run(state, constants, table_, (code, 0), 100_000, 0, 0)
    if out.status.any():
        raise RuntimeError(f"shots {np.flatnonzero(out.status)} did not come to rest")
    return state[0], out.potted, state[3]


def turned(items, k):
    """The same in another order: who comes first finds the cache cold."""
    k %= len(items)
    return items[k:] + items[:k]


def times(ways, start, repeats):
    """Mean over shots of each one's best time [us], by way, less the call itself; the ways take turns: all see the same machine."""
    best = {name: np.full(len(start[0]), np.inf) for name in ways}

    def one(k, run, constants, table_, code, here=True):
        state = [a[k : k + 1].copy() for a in start]
        state[3] &= here
        t = time.perf_counter()
        run(state, constants, table_, (code, 0), 100_000, 0, 0)
        return time.perf_counter() - t

    call = min(one(0, *next(iter(ways.values())), here=False) for _ in range(200))
    for _ in range(repeats):
        for k in range(len(start[0])):
            for name, way in turned(list(ways.items()), k):
                best[name][k] = min(best[name][k], one(k, *way) - call)
    return {name: float(b.mean()) * 1e6 for name, b in best.items()}


def effect(end, truth, start, ball):
    """Median and 95 % of the shifts [mm] of the cue ball and of the ball aimed at, and the share of shots that end otherwise."""
    rows = np.arange(len(ball))
    found = {}
    for name, b in (("cue_mm", 0 * ball), ("ball_mm", ball)):
        shift = 1e3 * np.hypot(*(end[0] - truth[0])[rows, b].T)[end[2][rows, b] & truth[2][rows, b]]
        found[name] = np.quantile(shift, [0.5, 0.95, 1.0]).tolist() if len(shift) else [0.0] * 3
        found[name[:-2] + "shots"] = len(shift)
    hit = [(x[0] != start[0]).any(-1)[rows, ball] for x in (end, truth)]
    found["changed"] = float((((end[1] >= 0) != (truth[1] >= 0)).any(1) | (hit[0] != hit[1])).mean())
    return found


def hops(shots, v, w, constants):
    """Shift of the cue ball and of the ball aimed at [mm] by the hops of each shot: v v_z / g, summed over its ball-ball impacts."""
    shifts = np.zeros((len(v), 2))
    for k in range(len(v)):
        shot = sn.simulate(shots.positions[k], v[k], w[k], physics=constants)
        for event in shot.events[shot.events["kind"] == EventKind.BALL_BALL]:
            balls = [event["i"], event["j"]]
            r, v0, w0 = (a[balls] for a in shot.at(max(0.0, event["time"] - 1e-9)))
            n = (r[1] - r[0]) / np.hypot(*(r[1] - r[0]))
            if (v0[0] - v0[1]) @ n <= PART:
                continue
            after = sn.collide_balls((*v0[0], 0.0), w0[0], (*v0[1], 0.0), w0[1], (*n, 0.0), constants)
            for i, u in zip(balls, after[::2], strict=True):
                for column, of in enumerate((0, shots.ball[k])):
                    if i == of and shot.on_table[i]:
                        shifts[k, column] += 1e3 * np.hypot(u[0], u[1]) * u[2] / constants.g
    found = {name: np.quantile(shifts[:, c], [0.5, 0.95, 1.0]).tolist() for c, name in enumerate(("cue_mm", "ball_mm"))}
    return {**found, "cue_shots": len(v), "ball_shots": len(v)}


def counts(starts, physics, most=40):
    """What runs in the first shots of each scene, by ``_common.counts`` in a process without numba."""
    with tempfile.TemporaryDirectory() as folder:
        files = [Path(folder) / f"{k}.npz" for k in range(len(starts))]
        for file, (positions, velocities, spins, _here) in zip(files, starts, strict=True):
            np.savez(file, positions=positions[:most], velocities=velocities[:most], spins=spins[:most])
        command = [sys.executable, "-c", "from benchmarks._common import counts; counts.main()", physics, *map(str, files)]
        root = Path(__file__).parent.parent
        done = subprocess.run(command, cwd=root, env=os.environ | {"NUMBA_DISABLE_JIT": "1"}, check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


def study(make, n, repeats, physics, chosen, seed):
    """Everything about one scene, and its strokes."""
    constants, match = sn.Physics.preset(physics), sn.Table.preset("match")
    shots = make(n, constants, seed)
    run = variants.load()._run if any(MODELS[m].code != STANDARD for m in chosen) else simulation._run
    here = np.ones(shots.positions.shape[:2], bool)

    def started(**how):
        v, w = shots.struck(**how)
        return shots.positions, v, w, here

    errors = {} if make is head_on_stun else {"seed": seed + 1}  # with a professional's errors no shot is exactly head-on
    start = started(**errors)
    ways = {FULL: (run, constants, match, STANDARD)}
    for name in chosen:
        m = MODELS[name]
        ways[name] = run, sn.Physics.preset(physics, **m.physics) if m.physics else constants, m.table or match, m.code
    ends = {name: played(way[0], start, *way[1:]) for name, way in ways.items()}
    truth = ends.pop(FULL)
    rows = {name: effect(end, truth, start, shots.ball) for name, end in ends.items()}
    for name, how in ((ERRORS, {"seed": seed + 2}), (CHAOS, {**errors, "aim": 1e-9})):
        rows[name] = effect(played(run, started(**how), constants, match, STANDARD), truth, start, shots.ball)
    took = times(ways, start, repeats)
    for name in chosen:
        rows[name]["cost"] = took[FULL] / took[name]
    rows[HOP] = hops(shots, start[1], start[2], constants)
    log = sn.simulate_batch(start[0], start[1], start[2], physics=constants, events=True).events
    assert log is not None
    kinds = np.concatenate([events["kind"] for events in log])
    ran = {k.name.lower().replace("_", "-"): float((kinds == k).sum() / n) for k in EventKind}
    return {"us": took[FULL], "rows": rows, "ran": ran}, start


def reasons(row, rows):
    """In what a model moves balls or changes outcomes by more than a tenth of what a professional's errors do, and by more than chaos."""
    by_errors, chaos, found = rows[ERRORS], rows[CHAOS], []
    for ball in ("cue", "ball"):
        most = max(SHARE * by_errors[f"{ball}_mm"][0], 2 * chaos[f"{ball}_mm"][0], VISIBLE)
        if row[f"{ball}_mm"][0] > most and row[f"{ball}_shots"] >= ENOUGH:
            found.append(ball)
    if row.get("changed", 0.0) > max(SHARE * by_errors["changed"], 2 * chaos["changed"]):
        found.append("changed")
    return found


def verdict(name, scenes):
    """One model's sentence, from its rows."""
    rows = {scene: s["rows"][name] for scene, s in scenes.items()}
    where = [scene for scene, s in scenes.items() if reasons(rows[scene], s["rows"])]

    def shares(scene):
        """Effect over that of a professional's errors, by what it is an effect on."""
        row, by_errors = rows[scene], scenes[scene]["rows"][ERRORS]
        balls = [b for b in ("cue", "ball") if row[f"{b}_shots"] >= ENOUGH and by_errors[f"{b}_mm"][0]]
        parts = {b: row[f"{b}_mm"][0] / by_errors[f"{b}_mm"][0] for b in balls}
        return {**parts, "changed": row.get("changed", 0.0) / by_errors["changed"] if by_errors["changed"] else 0.0}

    worst = max(where or rows, key=lambda scene: max(shares(scene).values()))
    row, by_errors, share = rows[worst], scenes[worst]["rows"][ERRORS], shares(worst)
    ball = "ball" if share.get("ball", 0.0) > share.get("cue", 0.0) else "cue"
    mm = row[f"{ball}_mm"]
    figures = (
        f"the {'ball aimed at' if ball == 'ball' else 'cue ball'} stops {mm[0]:.3g} mm off in the middle case, 95 % within {mm[1]:.0f}"
        f" (a professional's errors: {by_errors[f'{ball}_mm'][0]:.3g})"
    )
    if name == HOP:
        events = scenes["full tables"]["ran"] if "full tables" in scenes else scenes[worst]["ran"]
        share = events["ball-ball"] / sum(events[k.name.lower().replace("_", "-")] for k in EventKind)
        verb = "is worth modelling" if where else "need not be modelled"
        in_scenes = f" It matters in: {', '.join(where)}." if where else ""
        return (
            f"{name} (not modelled today): {verb} by the {SHARE:.0%} rule. In its worst scene, {worst}, without it {figures}; twice that"
            f" if landing had no friction.{in_scenes} It shifts a ball along its own path: whether the ball aimed at drops, it does not"
            f" decide. It would add one event to each impact, {share:.0%} of events on full tables."
        )
    model = MODELS[name]
    costs = {scene: r["cost"] for scene, r in rows.items()}
    dear = max(costs, key=lambda s: costs[s])
    cost = f"It costs at most {costs[dear]:.2f} x ({dear})" if costs[dear] > 1 + FREE else "Its cost is within the noise"
    changed = f"{row['changed']:.1%} of shots end otherwise (by a professional's errors: {by_errors['changed']:.1%})"
    none = [s for s, r in rows.items() if max(r["cue_mm"][2], r["ball_mm"][2]) < NOTHING and not r["changed"]]
    paid = [f"{s} ({costs[s]:.2f} x)" for s in none]
    idle = f" It does nothing in: {', '.join(paid)}." if paid else ""
    still = [s for s in none if costs[s] > 1 + FREE]
    idle += f" There it is paid for in vain in: {', '.join(still)}." if still else ""
    if where:
        return (
            f"{name}: on by default. With {model.instead} instead, in {worst} {figures} and {changed}; it matters in {len(where)} of"
            f" {len(rows)} scenes. {cost}.{idle} ({model.product}.)"
        )
    return (
        f"{name}: not needed by the {SHARE:.0%} rule. With {model.instead} instead, in its worst scene, {worst}, {figures} and {changed}."
        f" {cost}.{idle} ({model.product}.)"
    )


def draw(scenes, names, out):
    """Three tables in colour: how far the cue ball stops off, how many shots end otherwise, what it costs."""
    plt = pyplot()
    from matplotlib.colors import LogNorm, Normalize

    mixed = [*names, HOP, ERRORS, CHAOS]
    panels = (
        ("cue", "cue ball stops off by, median [mm]", lambda r: r["cue_mm"][0], LogNorm(0.1, 1000), "{:.3g}", "YlOrRd"),
        ("changed", "shots that end otherwise [%]", lambda r: 100 * r.get("changed", np.nan), Normalize(0, 50), "{:.1f}", "YlOrRd"),
        ("cost", "time with it over time without", lambda r: r.get("cost", np.nan), LogNorm(1 / 3, 3), "{:.2f}", "RdBu_r"),
    )
    fig, axes = plt.subplots(1, 3, figsize=(20, 1.6 + 0.45 * len(mixed)), layout="constrained", sharey=True)
    for ax, (reason, title, value, norm, style, colours) in zip(axes, panels, strict=True):
        grid = np.array([[value(s["rows"][name]) for s in scenes.values()] for name in mixed])
        ax.imshow(np.where(np.isfinite(grid), np.maximum(grid, 1e-9), np.nan), norm=norm, cmap=colours, aspect="auto")
        for i, name in enumerate(mixed):
            for j, s in enumerate(scenes.values()):
                x = grid[i, j]
                if np.isfinite(x):
                    text = "0" if x < 5e-4 else style.format(x)
                    bold = name not in (ERRORS, CHAOS) and reason in reasons(s["rows"][name], s["rows"])
                    dark = x > 0 and (norm(x) > 0.7 if colours == "YlOrRd" else abs(norm(x) - 0.5) > 0.35)
                    ax.text(j, i, text, ha="center", va="center", fontsize=9, color="white" if dark else "black",
                            fontweight="bold" if bold else "normal")  # fmt: skip
        ax.axhline(len(names) - 0.5, color="black", lw=1)
        ax.set_title(title, fontsize=11)
        ax.set_xticks(range(len(scenes)), list(scenes), rotation=25, ha="right", fontsize=9)
        ax.set_yticks(range(len(mixed)), mixed, fontsize=9)
        ax.tick_params(length=0)
    fig.suptitle(f"What a scene requires: each model left out in turn; bold where it matters.  {provenance.line()}", fontsize=10)
    save_figure(fig, out, dpi=90)


def main():
    """Command line."""
    parser = Command("scene", __doc__, pictures=(FILE,), seed=0)
    parser.add_argument("--shots", type=at_least(2), default=600, help="shots in each scene")
    parser.add_argument("--repeats", type=at_least(1), default=5, help="timed runs of every shot; the best counts")
    parser.add_argument("--physics", default="match", help="the constants with every model: match or paper [match]")
    parser.add_argument("--models", nargs="+", choices=list(MODELS), default=list(MODELS), help="only these")
    options = parser.options()
    print(f"{provenance.line()}\n{options.shots} shots a scene, physics {options.physics!r}, fidelity 'standard'; * where it matters")
    scenes, starts = {}, []
    for scene, make in SCENES.items():
        s, start = study(make, options.shots, options.repeats, options.physics, options.models, options.seed)
        scenes[scene] = s
        starts.append(start)
        print(f"\n{scene}: {s['us']:.1f} us a shot")
        print("  without                         cue ball off by [mm]: median, 95 %   ball aimed at: the same   end otherwise   cost")
        for name, row in s["rows"].items():
            mm = "          ".join(" ".join(f"{e:9.3f}" if e < 10 else f"{e:9.0f}" for e in row[k][:2]) for k in ("cue_mm", "ball_mm"))
            star = "*" if name not in (ERRORS, CHAOS) and reasons(row, s["rows"]) else " "
            changed = f"{row['changed']:9.1%}" if "changed" in row else f"{'-':>9s}"
            cost = f"{row['cost']:.2f} x" if "cost" in row else "-"
            print(f"{star} {name:30s}     {mm}     {changed}      {cost:>7s}")
    for s, counted in zip(scenes.values(), counts(starts, options.physics), strict=True):
        s["ran"].update(counted)
    print("\nWhat ran, per shot (integrations and jaw arcs: counted in the first 40 shots)")
    print(" " * 26 + "".join(f"{scene:>16s}" for scene in scenes))
    for what in next(iter(scenes.values()))["ran"]:
        print(f"  {what:24s}" + "".join(f"{s['ran'][what]:16.2f}" for s in scenes.values()))
    stun = scenes["head-on stun"]["ran"]
    solved, tested = stun["ball-ball integrations"], stun["jaw arcs tested"]
    paid = "it pays for neither" if solved + tested == 0 else "it pays for what it does not need"
    lines = [f"A head-on stun shot far from every jaw integrates {solved:.2g} ball-ball impacts and tests {tested:.3g} jaw arcs: {paid}."]
    lines += [verdict(name, scenes) for name in (*options.models, HOP)]
    print("\nWhat follows")
    for sentence in lines:
        print(f"* {sentence}")
    figures = {"machine": provenance.machine(), "physics": options.physics, "shots": options.shots, "scenes": scenes, "says": lines}
    save_json(options.json, figures)
    if options.pictures:
        draw(scenes, options.models, options.folder / FILE)
        print(f"\n{options.folder / FILE}")


if __name__ == "__main__":
    run(main)
