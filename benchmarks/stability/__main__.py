"""What breaks at the extremes? Impacts and shots at the edge of what can be asked for, each with its
invariants; then a fuzz of a million.

    python -m benchmarks.stability [--fuzz 1000000] [--seed 0] [--json FILE] [--out FOLDER]
    python -m benchmarks.stability --replay SEED BATCH INDEX

Exit code 1 if an invariant fails. ``--fuzz 0`` plays the extremes alone (10 s). Impacts are played at "fast",
"standard" and "reference", shots at these in turn; figures are the worst of all. The paper's Euler scheme has
a table of its own.
"""

import numpy as np

from agents._lib.tables import text_table

from .. import fuzz
from .._common.command import Command, at_least, run, save_figures
from .euler import euler_lines, euler_table
from .impacts import IMPACT_LIMITS, impact_extremes
from .shots import SHOT_LIMITS, shot_extremes
from .symmetry import growth, growth_lines, mirrored_fuzz, order_lines, order_matters, symmetry_growth
from .worst import verdict


def format_worst(x):
    """A figure in a cell: counts whole, "-" where nothing of the kind happened."""
    return str(x) if isinstance(x, int) else "-" if x == -np.inf else f"{x:.2g}"


def table_of(title, results, limits):
    """Lines: an extreme a row, an invariant a column, the worst figure in each; below zero there is no
    violation at all."""
    rows = [["(allowed)", "", *(f"{x:.3g}" for x in limits.values()), ""]]
    for name, (played, figures) in results.items():
        failed = verdict(figures, limits)
        passed = f"FAIL: {', '.join(failed)}" if failed else "pass"
        rows.append([name, str(played), *(format_worst(figures[c]) for c in limits), passed])
    return text_table([title, "played", *limits, "verdict"], rows)


def main():
    """Command line; the exit code."""
    parser = Command("stability", __doc__, seed=0)
    parser.add_argument("--fuzz", type=at_least(0), default=1_000_000, help="random shots; 0 for none")
    parser.add_argument(
        "--replay",
        type=int,
        nargs=3,
        metavar=("SEED", "BATCH", "INDEX"),
        help="play one shot of the fuzz again",
    )
    options = parser.options()
    if options.replay:
        return int(not fuzz.replay(*options.replay))
    return int(bool(measure(options)["failed"]))


def measure(options):
    """Measure and print everything; the figures."""
    impacts, shots = impact_extremes(), shot_extremes()
    print("\n".join(table_of("impacts (worst figures)", impacts, IMPACT_LIMITS)), end="\n\n")
    print("\n".join(table_of("shots (worst figures)", shots, SHOT_LIMITS)), end="\n\n")
    euler, symmetry, fuzzed, order = euler_table(), symmetry_growth(), mirrored_fuzz(), order_matters()
    print(
        "\n".join([*euler_lines(euler), "", *growth_lines(*symmetry, fuzzed), "", *order_lines(order)]),
        end="\n\n",
        flush=True,
    )
    found = None
    if options.fuzz:
        found = fuzz.fuzz(options.fuzz, options.seed, 2)
        print("\n".join(fuzz.lines(found, options.seed)))
    failed = [
        f"{name}: {bad}"
        for results, limits in ((impacts, IMPACT_LIMITS), (shots, SHOT_LIMITS))
        for name, (_, f) in results.items()
        for bad in verdict(f, limits)
    ]
    failed += ["mirror symmetry"] * bool(symmetry[1].max() > 0 or fuzzed.any()) + ["fuzz"] * bool(
        found and found.failures
    )
    print("\nall invariants hold" if not failed else "\nFAILED: " + "; ".join(failed))
    contacts, mirror, turned = symmetry
    figures = {
        "impacts": {
            k: f | {"played": n, "failed": verdict(f, IMPACT_LIMITS)} for k, (n, f) in impacts.items()
        },
        "shots": {k: f | {"played": n, "failed": verdict(f, SHOT_LIMITS)} for k, (n, f) in shots.items()},
        "allowed": {"impacts": IMPACT_LIMITS, "shots": SHOT_LIMITS},
        "euler": euler,
        "three at once": order,
        "symmetry": {
            "mirror": float(max(mirror.max(), fuzzed.max())),
            "mirrored": len(mirror) + len(fuzzed),
            "factor a contact": growth(contacts, turned),
            "contacts": contacts.tolist(),
            "turned": turned.tolist(),
        },
        "fuzz": fuzz.figures_of(found, options.seed) if found else None,
        "failed": failed,
    }
    save_figures(options, figures)
    return figures


if __name__ == "__main__":
    run(main)
