"""What breaks at the extremes? Impacts and shots at the edge of what can be asked for, each with its invariants; then a fuzz of a million.

    python -m benchmarks.stability [--fuzz 1000000] [--seed 0] [--threads 2] [--json FILE] [--out FILE]
    python -m benchmarks.stability --replay SEED BATCH INDEX

Exit code 1 if an invariant fails. ``--fuzz 0`` plays the extremes alone (10 s). Impacts are played at "fast", "standard" and
"reference", shots at these in turn; figures are the worst of all. The paper's Euler scheme has a table of its own.
"""

import argparse
import json
import sys
from collections import Counter
from pathlib import Path

import numpy as np

from snooker_env.physics.engine import Status

from . import fuzz, invariants
from ._command import at_least, pyplot
from ._stability_euler import euler_lines, euler_table
from ._stability_impacts import IMPACT_LIMITS, impact_extremes
from ._stability_picture import draw
from ._stability_shots import SHOT_LIMITS, shot_extremes
from ._stability_symmetry import growth, growth_lines, order_lines, order_matters, symmetry_growth
from ._stability_worst import verdict

FILE = Path(__file__).parent / "pictures" / "stability.png"


def shown(x):
    """A figure in a cell: counts whole, "-" where nothing of the kind happened."""
    return str(x) if isinstance(x, int) else "-" if x == -np.inf else f"{x:.2g}"


def table_of(title, results, limits):
    """Lines: an extreme a row, an invariant a column, the worst figure in each; below zero there is no violation at all."""
    head = "".join(f"{name:>12}" for name in limits)
    lines = [f"{title:36}{'played':>8}{head}   verdict", f"{'(allowed)':36}{'':>8}" + "".join(f"{x:>12.3g}" for x in limits.values())]
    for name, (played, figures) in results.items():
        cells = "".join(f"{shown(figures[c]):>12}" for c in limits)
        failed = verdict(figures, limits)
        lines.append(f"{name:36}{played:>8}{cells}   {'FAIL: ' + ', '.join(failed) if failed else 'pass'}")
    return lines


def fuzz_lines(found, seed):
    """The fuzz's table, and its failures by kind with one to replay."""
    most = ", ".join(f"{scene} {n:,}" for scene, n in found.events.items())
    lines = [f"fuzz: {found.shots:,} shots in {found.seconds:.0f} s, seed {seed}; most events: {most}"]
    names = invariants.NAMES
    lines.append(f"{'worst of':14}" + "".join(f"{name:>17}" for name in names))
    for fidelity in sorted(found.worst):
        lines.append(f"{fidelity:14}" + "".join(f"{'-' if x == -np.inf else f'{x:.1e}':>17}" for x in found.worst[fidelity]))
    lines.append(f"{'(standard may)':14}" + "".join(f"{x:>17.0e}" for x in fuzz.allowed("standard")))
    kinds = Counter((what, world, fidelity) for _, _, what, _, _, world, fidelity in found.failures)
    lines.append(f"{len(found.failures)} failures")
    for kind, n in kinds.most_common():
        number, index, _, figure, scene, _, _ = next(f for f in found.failures if (f[2], f[5], f[6]) == kind)
        what, world, fidelity = kind
        lines.append(f"  {n:>6} {what} ({fidelity}, physics {world}), as --replay {seed} {number} {index} ({scene}, {figure:.3g})")
    return lines


def replay(seed, number, index):
    """Play one shot of the fuzz again and print what it breaks; True if nothing."""
    drawn = fuzz.batch(seed, number)
    found = fuzz.play(drawn)
    print(f"seed {seed}, batch {number}, shot {index}: {drawn.scene}, {drawn.fidelity}, table {drawn.table.name}, {drawn.physics}")
    print(
        f"positions {drawn.positions[index].tolist()}\nvelocities {drawn.velocities[index].tolist()}\nspins {drawn.spins[index].tolist()}"
    )
    print(f"{Status(found.status[index]).name} after {found.n_events[index]} events, {found.duration[index]:.6f} s")
    broken = found.worst[index] > fuzz.allowed(drawn.fidelity)
    for name, x, limit, bad in zip(invariants.NAMES, found.worst[index], fuzz.allowed(drawn.fidelity), broken, strict=True):
        print(f"  {name:18}{x:>12.3g}  allowed {limit:.1g}  {'FAIL' if bad else 'pass'}   {invariants.WHAT[name]}")
    return found.status[index] == Status.OK and not broken.any()


def main():
    """Command line; the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fuzz", type=at_least(0), default=1_000_000, help="random shots; 0 for none")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--threads", type=at_least(1), default=2)
    parser.add_argument("--replay", type=int, nargs=3, metavar=("SEED", "BATCH", "INDEX"), help="play one shot of the fuzz again")
    parser.add_argument("--json", type=Path, help="also write every figure there")
    parser.add_argument("--out", type=Path, default=FILE, help="the picture")
    options = parser.parse_args()
    pyplot()  # before the work: can the picture be drawn?
    if options.replay:
        return int(not replay(*options.replay))
    impacts, shots = impact_extremes(), shot_extremes()
    print("\n".join(table_of("impacts (worst figures)", impacts, IMPACT_LIMITS)), end="\n\n")
    print("\n".join(table_of("shots (worst figures)", shots, SHOT_LIMITS)), end="\n\n")
    euler, symmetry, order = euler_table(), symmetry_growth(), order_matters()
    print("\n".join([*euler_lines(euler), "", *growth_lines(*symmetry), "", *order_lines(order)]), end="\n\n", flush=True)
    found = None
    if options.fuzz:
        found = fuzz.run(options.fuzz, options.seed, options.threads, lambda line: print("\r" + line, end="", file=sys.stderr, flush=True))
        print(file=sys.stderr)
        print("\n".join(fuzz_lines(found, options.seed)))
    failed = [
        f"{name}: {bad}"
        for results, limits in ((impacts, IMPACT_LIMITS), (shots, SHOT_LIMITS))
        for name, (_, f) in results.items()
        for bad in verdict(f, limits)
    ]
    failed += ["mirror symmetry"] * bool(symmetry[1].max() > 0) + ["fuzz"] * bool(found and found.failures)
    print("\nall invariants hold" if not failed else "\nFAILED: " + "; ".join(failed))
    if options.json:
        figures = {
            "impacts": {k: f | {"played": n, "failed": verdict(f, IMPACT_LIMITS)} for k, (n, f) in impacts.items()},
            "shots": {k: f | {"played": n, "failed": verdict(f, SHOT_LIMITS)} for k, (n, f) in shots.items()},
            "allowed": {"impacts": IMPACT_LIMITS, "shots": SHOT_LIMITS}, "euler": euler, "three at once": order,
            "symmetry": {"mirror": float(symmetry[1].max()), "factor a contact": growth(symmetry[0], symmetry[2])},
        }  # fmt: skip
        if found:
            worst = {k: dict(zip(invariants.NAMES, x.tolist(), strict=True)) for k, x in found.worst.items()}
            figures["fuzz"] = {
                "shots": found.shots, "seconds": found.seconds, "seed": options.seed, "worst": worst, "events": found.events,
                "failures": found.failures,
            }  # fmt: skip
        options.json.write_text(json.dumps(figures, indent=1) + "\n")
    draw(options.out, impacts, shots, euler, symmetry, found)
    return int(bool(failed))


if __name__ == "__main__":
    sys.exit(main())
