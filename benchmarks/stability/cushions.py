"""How far is a cushion's impact from an independent solution, with constants anywhere in their ranges?

    python -m benchmarks.stability.cushions [--impacts 3000] [--seed 0] [--json FILE]

Balls that roll and balls with any spin, half each. Frictions, restitution and the nose's height are drawn from their ranges,
without tables. Truth: Moreau's implicit steps (``tests/oracles/moreau.py``), which share nothing with the package; their
error of the first order is taken out by a second solution with half as many steps. What both differ by in a
third, with twice as many, is the doubt of the truth: impacts where it is more than ``DOUBT`` are left out and counted.
"""

from typing import Any

import numpy as np

import snooker_env as sn
from tests.oracles.moreau import moreau_cushion

from .._common.command import Command, at_least, run, save_json
from ..fuzz import R

DOUBT = 1e-7
"""Of the truth, over the largest incoming speed."""
STEPS = 1_000, 10_000
"""Of the first solution: more where the truth of fewer is in doubt."""
PLAY = 0.25
"""The cloth's friction in play is below this."""
KINDS = ("rolling", "any spin")


def truth(v, w, constants):
    """Velocity and R w after the impact with a nose at +x, and its doubt."""
    names = {"e": constants["e_c"], "mu_w": constants["mu_c"], "mu_s": constants["mu_s"]}
    names |= {"R": R, "sin_theta": constants["sin_theta"]}
    doubt, last = np.inf, np.full(6, np.nan)
    for steps in STEPS:
        solved = (moreau_cushion(v, w, (1, 0, 0), steps=k * steps, **names) for k in (1, 2, 4))
        one, two, four = (np.concatenate([a, R * b]) for a, b in solved)
        last, doubt = 2.0 * four - two, float(np.abs((2.0 * four - two) - (2.0 * two - one)).max())
        if doubt <= DOUBT * max(float(np.linalg.norm(v)), R * float(np.linalg.norm(w))):
            break
    return last, doubt


def measure(n, seed):
    """Rows: rolls, mu_s, doubt, error of standard, error of reference; over the largest incoming speed."""
    rng, rows = np.random.default_rng(seed), []
    for k in range(n):
        constants: dict[str, Any] = {
            "mu_s": rng.uniform(0.0, 1.0),
            "mu_c": rng.uniform(0.0, 1.0),
            "e_c": rng.uniform(0.0, 1.0),
            "sin_theta": rng.uniform(0.0, 0.9),
        }
        if k % 4 < 2:  # as in play, or not much beyond it
            constants["mu_s"], constants["mu_c"] = rng.uniform(0.0, PLAY, 2)
        speed, angle = rng.uniform(0.05, 7.0), rng.uniform(-1.5, 1.5)
        v = speed * np.array([np.cos(angle), np.sin(angle), 0.0])
        spin = 10.0 ** rng.uniform(-1.0, 2.0) * speed / R
        w = np.array([-v[1] / R, v[0] / R, rng.normal() * spin]) if k % 2 else rng.normal(size=3) * spin
        unit = max(speed, R * float(np.linalg.norm(w)))
        after, doubt = truth(v, w, constants)
        physics, errors = sn.Physics(R=R, tables=False, **constants), []
        for fidelity in ("standard", "reference"):
            try:
                a, b = sn.collide_cushion(v, w, (1, 0, 0), physics, fidelity)
                errors.append(float(np.abs(np.concatenate([a, R * b]) - after).max()) / unit)
            except sn.SimulationError:
                errors.append(np.inf)
        rows.append((k % 2, constants["mu_s"], doubt / unit, *errors))
    return np.array(rows)


def main():
    """Command line."""
    parser = Command("stability.cushions", __doc__, seed=0)
    parser.add_argument("--impacts", type=at_least(8), default=3000, help="[3000]")
    options = parser.options()
    rows, found = measure(options.impacts, options.seed), {}
    sure = rows[:, 2] <= DOUBT
    print(f"{len(rows):,d} impacts; of {(~sure).sum()} the truth is in doubt by more than {DOUBT:g}")
    print(
        "error over the largest incoming speed    impacts  standard: 50 %    99 %   worst   reference: 99 %   worst"
    )
    for rolls, kind in ((1, KINDS[0]), (0, KINDS[1])):
        for name, most in ((f"mu_s below {PLAY}", PLAY), ("any mu_s", 1.0)):
            some = rows[sure & (rows[:, 0] == rolls) & (rows[:, 1] <= most)]
            standard, reference = (np.quantile(some[:, c], [0.5, 0.99, 1.0]).tolist() for c in (3, 4))
            found[f"{kind}, {name}"] = {"impacts": len(some), "standard": standard, "reference": reference}
            print(
                f"{kind + ', ' + name:38s} {len(some):9,d} {standard[0]:15.1e} {standard[1]:7.1e} {standard[2]:7.1e}"
                f" {reference[1]:17.1e} {reference[2]:7.1e}"
            )
    save_json(options.json, {"impacts": len(rows), "in doubt": int((~sure).sum()), "found": found})


if __name__ == "__main__":
    run(main)
