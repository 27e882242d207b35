"""Is a touching rack resolved rightly by pairwise impacts in sequence? Breaks by three models of the touching
balls, compared.

    python -m benchmarks.rack [--shots 100] [--orders 100] [--racks 30] [--physics paper] [--seed 0]
        [--json FILE] [--out FOLDER]

* **Sequence**: this engine. Touching balls collide two by two at one instant, ties in the order of ball ids.
* **Simultaneous**: one linear complementarity problem over all touching contacts, no friction, solved by
  projected Gauss-Seidel: the compression impulses L >= 0 with closing speeds u <= 0 and L u = 0, times 1 + e.
  With one e for all contacts and no friction this is both Newton's law in Moreau's form (u+ + e u-
  complementary to L) and Poisson's (L grows by e L in restitution). Then the engine.
* **Compliant**: the reference. All balls, contacts as springs with dampers, in micro-steps of 0.1 us for 10
  ms; then the engine. F = k d^p + c d^q d', never pulling, d the overlap. Hertz: p = 3/2, k = (4/3) (E / (2
  (1 - nu^2))) sqrt(R / 2), the resin's E = 5 GPa and nu = 0.34: round figures, and what twice the stiffness
  changes is printed. q = 1/4 (Tsuji 1992) loses the same share at every speed; q = 1/2 (Kuwabara & Kono 1987)
  loses more at speed. Linear: p = 1, q = 0, with Hertz's contact time at 5 m/s. c is set so that one pair has
  the engine's restitution (q = 1/2: at 5 m/s). Friction between balls and on the cloth is Coulomb's, its
  impulse in a step at most what stops the slip. As in the engine's impact, friction may lift a ball or press
  it into the cloth, which answers with friction, and the vertical speed is dropped afterwards.

Energies are kinetic, spin included, 10 ms after the cue ball met the rack, over the cue ball's own before.
"Misplaced": how much of it a model has on other balls than Hertz does, or has lost: half the sum of the
differences, the lost share included. "Sharers": (sum E)^2 / sum E^2 over the reds, how many share their
energy.
"""

import os
import time
from concurrent.futures import ThreadPoolExecutor
from math import sqrt

import numpy as np

import snooker_env as sn
from snooker_env.game.balls import SPOTS
from snooker_env.physics.engine import EventKind

from .._common.command import Command, at_least, run, save_json
from .breaks import apex_break, break_off
from .checks import checks
from .compliant import LAWS, STEP, R, compliant
from .models import Models, misplaced, sharers, shares
from .picture import picture
from .simultaneous import contacts, gauss_seidel, simultaneous

FILE = "rack.png"
CORNERS = (11, 15)
MIRRORED = np.array(
    [0, *(1 + k for row in range(5) for k in range(row * (row + 1) // 2 + row, row * (row + 1) // 2 - 1, -1))]
)
"""Which ball is the mirror image of ball i in the rack."""
CENTRE = SPOTS[1:16].mean(0)
NEAR = 0.25
"""A red within this distance [m] of the rack's centre has hardly left it."""


def cradle(models):
    """Lines of 2 to 5 touching balls, the first at 1 m/s, no spin."""
    print(f"Newton's cradle: speeds after it, the first ball at 1 m/s (e = 1, then {models.physics.e_b:g})")
    figures = {}
    for e in (1.0, models.physics.e_b):
        floating = sn.Physics.preset("paper", e_b=e, g=1e-9)
        for n in (2, 3, 4, 5):
            r = np.column_stack([np.zeros(n), 2 * R * np.arange(n)])
            v, w = np.zeros((n, 2)), np.zeros((n, 3))
            v[0, 1] = 1.0
            row = {
                "sequence": sn.simulate(r, v, w, "match", sn.Physics.preset("paper", e_b=e)).at(1e-9)[1][
                    :, 1
                ],
                "simultaneous": simultaneous(r, v, e)[:, 1],
                **{
                    name: compliant(r, v, w, floating, law, span=5e-3)[1][:, 1]
                    for name, law in LAWS.items()
                    if law.q != 0.5
                },
            }
            figures[f"{n} balls, e {e:g}"] = {name: x.tolist() for name, x in row.items()}
            for name, x in row.items():
                print(f"  {n if name == 'sequence' else ' '}  {name:14s}" + "".join(f"{s:8.4f}" for s in x))
    print()
    return figures


def head_on(models, speed=5.0):
    """A break on the rack's axis."""
    print(
        f"Head-on at {speed:g} m/s, touching rack: energies [% of the cue ball's]; momentum, mirror error of velocities [of its speed]"
    )
    print(
        " " * 28
        + "  cue   apex  corners (left, right)  back 3  other 9   lost   sharers  momentum  mirror   misplaced"
    )
    r, v, w = apex_break(speed, 0.0)
    figures, states = {}, {}
    cases = [(name, models.physics) for name in models.names] + [
        ("Hertz", models.slippery),
        ("sequence", models.slippery),
    ]
    reference = {}
    for name, physics in cases:
        _, v1, w1 = models.after(name, r, v, w, physics)
        v1, x = v1[:, :2], shares(v1, w1, speed)
        reference.setdefault(id(physics), x)
        label = name if physics is models.physics else f"{name}, no ball friction"
        mirror = float(np.abs(v1 - v1[MIRRORED] * [-1, 1]).max() / speed)
        other = x[2:11].sum()
        row = {
            "cue": x[0],
            "apex": x[1],
            "left": x[11],
            "right": x[15],
            "back": x[12:15].sum(),
            "other": other,
            "lost": 1 - x.sum(),
            "sharers": sharers(x),
            "momentum": v1[:, 1].sum() / speed,
            "mirror": mirror,
            "misplaced": misplaced(x, reference[id(physics)]),
        }
        figures[label] = {key: float(value) for key, value in row.items()}
        states[label] = v1, x
        print(
            f"  {label:26s}{100 * x[0]:5.1f}  {100 * x[1]:5.1f}       {100 * x[11]:5.1f}  {100 * x[15]:5.1f}"
            f"         {100 * row['back']:5.1f}    {100 * other:5.1f}  {100 * row['lost']:5.1f}   {row['sharers']:5.2f}"
            f"     {row['momentum']:6.3f}   {mirror:.1e}"
            f"   {100 * row['misplaced']:5.1f}"
        )
    print("  misplaced: against Hertz with the same friction between the balls\n")
    return figures, states


def offsets(models):
    """Breaks at several speeds and offsets."""
    print("Touching rack, other breaks: energy misplaced against Hertz [%]; sharers")
    others = models.names[1:]
    print(
        "  m/s  offset R"
        + "".join(f"{name:>16s}" for name in others)
        + "     sharers: "
        + ", ".join(models.names)
    )
    figures = []
    for speed in (2.0, 5.0, 8.0):
        for offset in (0.0, 0.05, 0.1, 0.25, 0.5, 1.0, 1.5):
            q = apex_break(speed, offset)
            x = {name: models.energy(name, *q) for name in models.names}
            row = {name: misplaced(x[name], x["Hertz"]) for name in others}
            share = {name: sharers(x[name]) for name in models.names}
            figures.append({"speed": speed, "offset": offset, "misplaced": row, "sharers": share})
            print(
                f"  {speed:3g}  {offset:8g}"
                + "".join(f"{100 * row[name]:16.1f}" for name in others)
                + "     "
                + "  ".join(f"{x:5.2f}" for x in share.values())
            )
    print()
    return figures


def gaps(models, racks, rng, workers):
    """Racks that do not quite touch."""
    print(
        f"Loose racks ({racks} at random for each mean gap; 5 m/s, offset 0.1 R): the corner balls' energy, mean (deviation) [%]"
    )
    print(
        "   gap m     Hertz: left      right     sequence: left    right     misplaced: each rack, mean racks   lost: Hertz, sequence"
    )
    figures = []
    for gap in (0.0, 1e-9, 1e-6, 1e-5, 1e-4, 1e-3):
        layouts = [apex_break(5.0, 0.1, gap, rng) for _ in range(racks if gap else 1)]
        a = np.array(list(workers.map(lambda q: models.energy("Hertz", *q), layouts)))
        b = np.array(list(workers.map(lambda q: models.energy("sequence", *q), layouts)))
        row = {
            "gap": gap,
            "hertz": a[:, CORNERS].mean(0).tolist(),
            "hertz_sd": a[:, CORNERS].std(0).tolist(),
            "sequence": b[:, CORNERS].mean(0).tolist(),
            "sequence_sd": b[:, CORNERS].std(0).tolist(),
            "misplaced": float(np.mean([misplaced(x, y) for x, y in zip(a, b, strict=True)])),
            "misplaced_means": misplaced(a.mean(0), b.mean(0)),
            "lost": [1 - float(x.sum(1).mean()) for x in (a, b)],
        }
        figures.append(row)
        text = "   ".join(
            f"{100 * m:5.1f} ({100 * s:4.1f})"
            for model in ("hertz", "sequence")
            for m, s in zip(row[model], row[model + "_sd"], strict=True)
        )
        print(
            f"  {gap:6g}    {text}    {100 * row['misplaced']:12.1f} {100 * row['misplaced_means']:12.1f}"
            f"            {100 * row['lost'][0]:5.1f}  {100 * row['lost'][1]:5.1f}"
        )
    print()
    return figures


def orders(models, n, rng):
    """The same touching rack with its balls numbered otherwise, or seen in a mirror."""
    print(
        f"Order of ties ({n} random numberings of the reds, 5 m/s): corner balls' share, left and right [%]; energy misplaced [%]"
    )
    print(
        "  offset R                 as shipped     mean          deviation      each against as shipped   mean against Hertz   mirrored"
    )
    figures = []
    for offset in (0.0, 0.1, 0.5):
        r, v, w = apex_break(5.0, offset)
        image = apex_break(5.0, -offset)
        for name in ("sequence", "Hertz"):
            base = models.energy(name, r, v, w)
            found = []
            for _ in range(n if name == "sequence" else min(n, 5)):
                ids = np.concatenate([[0], 1 + rng.permutation(15)])
                x = np.zeros(16)
                x[ids] = models.energy(name, r[ids], v, w)
                found.append(x)
            found = np.array(found)
            hertz = base if name == "Hertz" else models.energy("Hertz", r, v, w)
            row = {
                "offset": offset,
                "model": name,
                "shipped": base[list(CORNERS)].tolist(),
                "mean": found.mean(0)[list(CORNERS)].tolist(),
                "sd": found.std(0)[list(CORNERS)].tolist(),
                "misplaced": float(np.mean([misplaced(x, base) for x in found])),
                "mean_misplaced": misplaced(found.mean(0), hertz),
                "mirrored": misplaced(models.energy(name, *image)[MIRRORED], base),
            }
            figures.append(row)
            text = "   ".join(
                f"{100 * row[key][0]:5.1f} {100 * row[key][1]:5.1f}" for key in ("shipped", "mean", "sd")
            )
            print(
                f"  {offset:8g}  {name:12s}  {text}    {100 * row['misplaced']:18.1e}   {100 * row['mean_misplaced']:18.1f}"
                f"   {100 * row['mirrored']:12.1e}"
            )
    print()
    return figures


def spread(shot):
    """Of a shot at rest: mean distance [m] of the reds left from the rack's centre, reds near it, balls at a
    cushion, balls potted."""
    far = np.hypot(*(shot.positions[1:16][shot.on_table[1:16]] - CENTRE).T)
    rail = shot.events["i"][np.isin(shot.events["kind"], (EventKind.CUSHION, EventKind.JAW))]
    return far.mean(), (far < NEAR).sum(), len(np.unique(rail)), (shot.potted >= 0).sum()


def whole_shots(models, n, rng, workers):
    """Where everything ends."""
    kinds = {
        "apex, touching": lambda: apex_break(rng.uniform(3, 8), rng.uniform(-1, 1)),
        "apex, gaps of 20 um": lambda: apex_break(rng.uniform(3, 8), rng.uniform(-1, 1), 2e-5, rng),
        "apex, gaps of 2 mm": lambda: apex_break(rng.uniform(3, 8), rng.uniform(-1, 1), 2e-3, rng),
        "break-off": lambda: break_off(rng),
    }
    print(f"Whole shots to rest ({n} of each kind, the same for all models): mean and standard error")
    print(
        f"  {'':20s} {'':15s} reds' distance m   reds within {NEAR:g} m  balls at a cushion  potted              energy misplaced %"
    )
    figures, samples = {}, {}
    for kind, make in kinds.items():
        layouts = [make() for _ in range(n)]
        hertz = []
        for name in models.names:
            shots, energies = zip(*workers.map(lambda q, m=name: models.to_rest(m, *q), layouts), strict=True)
            hertz = hertz or energies
            wrong = [100 * misplaced(x, y) for x, y in zip(energies, hertz, strict=True)]
            x = np.array([(*spread(shot), m) for shot, m in zip(shots, wrong, strict=True)], float)
            mean, error = x.mean(0), x.std(0) / sqrt(n)
            figures[f"{kind}; {name}"] = {"mean": mean.tolist(), "error": error.tolist()}
            samples[kind, name] = x[:, 0]
            cells = "   ".join(f"{m:6.3f} +- {s:.3f}" for m, s in zip(mean, error, strict=True))
            print(f"  {kind if name == 'Hertz' else '':20s} {name:15s} {cells}")
    print()
    return figures, samples


def cost(models, repeats=5):
    """What does each take?"""
    r, v, w = apex_break(5.0, 0.1)

    def median(work):
        found = []
        for _ in range(repeats):
            t = time.perf_counter()
            work()
            found.append(time.perf_counter() - t)
        return float(np.median(found)) * 1e6

    pairs = contacts(r)
    shot = sn.simulate(r, v, w, "match", models.physics)
    at_once = int((shot.events["time"] < 1e-9).sum())
    sweeps = gauss_seidel(*pairs, v.copy(), models.physics.e_b, 5e-13)
    figures: dict = {
        "sequence, the whole shot": median(lambda: sn.simulate(r, v, w, "match", models.physics)),
        "simultaneous": median(lambda: gauss_seidel(*pairs, v.copy(), models.physics.e_b, 5e-13)),
    }
    print("Cost of one break at 5 m/s, offset 0.1 R, one core")
    print(
        f"  sequence, the whole shot to rest, {at_once} impacts of it at once  {figures['sequence, the whole shot']:9.0f} us"
    )
    print(
        f"  simultaneous, {len(pairs[0])} contacts, {sweeps} sweeps                    {figures['simultaneous']:9.0f} us"
    )
    fine = compliant(r, v, w, models.physics, dt=STEP / 2, span=2e-3)
    fine = shares(fine[1], fine[2], 5.0)
    for dt in (1e-5, 5e-6, 2e-6, 1e-6, STEP):
        us = median(lambda dt=dt: compliant(r, v, w, models.physics, dt=dt, span=2e-3))
        x = compliant(r, v, w, models.physics, dt=dt, span=2e-3)
        error = misplaced(shares(x[1], x[2], 5.0), fine)
        figures[f"compliant {dt:g}"] = {"us": us, "misplaced": error}
        print(
            f"  compliant, 2 ms in steps of {dt * 1e6:4.1f} us: misplaces {100 * error:.4f} %   {us:9.0f} us"
        )
    print()
    return figures


def verdict(models, figures):
    """The choice, in words that the figures make."""
    rows = figures["offsets"]
    mean = {name: float(np.mean([row["misplaced"][name] for row in rows])) for name in models.names[1:]}
    own = max(mean[name] for name in LAWS if name != "Hertz")
    nearer = sum(row["misplaced"]["sequence"] < row["misplaced"]["simultaneous"] for row in rows)
    shots = figures["whole shots"]
    lines = [
        f"Over {len(rows)} breaks of a touching rack the sequence misplaces {100 * mean['sequence']:.0f} % of the energy on average, the "
        f"simultaneous solution {100 * mean['simultaneous']:.0f} %, another contact law at most {100 * own:.0f} %. Of the two rigid rules "
        f"the sequence is the nearer to Hertz in {nearer} of {len(rows)}.",
    ]
    on_axis = figures["head-on"]
    a, b = on_axis["sequence"], on_axis["Hertz"]
    lines.append(
        f"Head-on the corner balls get {100 * a['left']:.0f} and {100 * a['right']:.0f} % from the sequence, {100 * b['left']:.0f} and "
        f"{100 * b['right']:.0f} % from Hertz; {a['sharers']:.1f} reds share the energy, by Hertz {b['sharers']:.1f}."
    )
    for row in figures["gaps"]:
        if row["gap"] in (1e-6, 1e-3):
            lines.append(
                f"In racks with gaps of {row['gap'] * 1e6:g} um the sequence misplaces {100 * row['misplaced']:.0f} % in each, "
                f"{100 * row['misplaced_means']:.0f} % on the average of racks."
            )
    for kind in dict.fromkeys(key.split(";")[0] for key in shots):
        of = {name: shots[f"{kind}; {name}"]["mean"] for name in models.names}
        laws = [of[name][0] for name in LAWS]
        lines.append(
            f"{kind}: reds end {of['sequence'][0]:.2f} m from the rack's centre by the sequence, {of['simultaneous'][0]:.2f} m by the "
            f"simultaneous solution, {min(laws):.2f} to {max(laws):.2f} m by contact laws; energy misplaced {of['sequence'][-1]:.0f}, "
            f"{of['simultaneous'][-1]:.0f} and at most {max(of[name][-1] for name in LAWS):.0f} %."
        )
    micro, shot = figures["cost"]["compliant 5e-06"], figures["cost"]["sequence, the whole shot"]
    lines.append(
        f"Choice: of the rigid rules {min(('sequence', 'simultaneous'), key=lambda name: mean[name])}. "
        + (
            "The sequence is as near to Hertz as contact laws are to each other: good enough."
            if mean["sequence"] <= own
            else f"The sequence is {mean['sequence'] / own:.1f} times as far from Hertz as contact laws are from each other: "
            "micro-steps are better."
        )
        + f" In steps of 5 us they misplace {100 * micro['misplaced']:.2f} % and take {micro['us'] / shot:.2f} times as long as "
        "the whole shot by the sequence."
    )
    print("\n".join(lines))
    return lines


def main():
    """Command line."""
    parser = Command("rack", __doc__, pictures=(FILE,), seed=0, redraws=True)
    parser.add_argument("--shots", type=at_least(1), default=100, help="whole shots of each kind")
    parser.add_argument("--orders", type=at_least(1), default=100, help="numberings of the rack")
    parser.add_argument("--racks", type=at_least(1), default=30, help="loose racks for each gap")
    parser.add_argument(
        "--physics", choices=("paper", "match"), default="paper", help="restitution and friction"
    )
    options = parser.options()
    figures = measure(options) if options.figures is None else options.figures
    if options.pictures:
        picture(options.folder / FILE, figures)


def measure(options):
    """Measure and print everything; the figures."""
    models = Models(sn.Physics.preset(options.physics))
    rng = np.random.default_rng(options.seed)
    figures: dict = {
        "physics": options.physics,
        "seed": options.seed,
        "checks": checks(models),
        "cradle": cradle(models),
    }
    figures["head-on"], states = head_on(models)
    figures["after"] = {
        name: {"velocities": v.tolist(), "shares": x.tolist()} for name, (v, x) in states.items()
    }
    figures["offsets"] = offsets(models)
    with ThreadPoolExecutor(os.cpu_count()) as workers:
        figures["gaps"] = gaps(models, options.racks, rng, workers)
        figures["orders"] = orders(models, options.orders, rng)
        figures["whole shots"], samples = whole_shots(models, options.shots, rng, workers)
    figures["distances"] = {f"{kind}; {name}": x.tolist() for (kind, name), x in samples.items()}
    figures["cost"] = cost(models)
    figures["verdict"] = verdict(models, figures)
    save_json(options.json, figures)
    return figures


if __name__ == "__main__":
    run(main)
