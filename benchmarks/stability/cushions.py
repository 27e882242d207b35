"""How far is a cushion's impact from an independent solution, with constants anywhere in their ranges?

    python -m benchmarks.stability.cushions [--impacts 3000] [--seed 0] [--json FILE]

Rolling balls with side and balls with any spin, half each. Frictions, restitution and the nose's height are drawn from
their ranges, without tables; every second pair has frictions as in play. Truth: Moreau's implicit steps
(``tests/oracles/moreau.py``), which share nothing with the package, their error of the first order taken out by half as many
steps. The steps are doubled until three such results agree within ``DOUBT``. That alone is not enough: where a slip all
but ends, coarse steps can agree on what is wrong. So where the truth is not that of ``reference`` the steps go on to the most;
what then is left is an error of ``reference``. Impacts that have no end (a ball wedged between nose and cloth), and those where
three results never agree, are left out and counted.
"""

import numpy as np

import snooker_env as sn
from tests.oracles.moreau import moreau_cushion

from .._common.command import Command, at_least, run, save_json
from ..fuzz import R

DOUBT = 1e-7
"""Of the truth, over the largest incoming speed."""
STEPS = 500, 8_192_000
"""The first number of steps in the closing speed, and the most."""
PLAY = 0.25
"""The cloth's friction in play is below this."""
KINDS = ("rolling", "any spin")


def truth(v, w, constants, reference):
    """Velocity and R w after the impact with a nose at +x, and their doubt; nan: no end. Over the largest incoming speed."""
    names = {"e": constants["e_c"], "mu_w": constants["mu_c"], "mu_s": constants["mu_s"]}
    unit = max(float(np.linalg.norm(v)), R * float(np.linalg.norm(w)))
    steps, most = STEPS
    coarse, found, doubt = None, [], np.inf
    while steps <= most and (doubt > DOUBT or np.abs(found[-1] - reference).max() > DOUBT):
        a, b = moreau_cushion(
            v / unit, w / unit, (1, 0, 0), R=R, sin_theta=constants["sin_theta"], steps=steps, **names
        )
        fine = np.concatenate([a, R * b])
        if np.isnan(fine).any():
            return fine, np.nan
        if coarse is not None:
            found.append(2.0 * fine - coarse)
        if len(found) > 2:
            doubt = float(np.ptp(found[-3:], axis=0).max())
        coarse, steps = fine, 2 * steps
    return found[-1], doubt


def measure(n, seed):
    """Rows: rolls, mu_s, doubt, error of standard, error of reference; over the largest incoming speed."""
    rng, rows = np.random.default_rng(seed), []
    for k in range(n):
        constants = {
            "mu_s": rng.uniform(0.0, 1.0),
            "mu_c": rng.uniform(0.0, 1.0),
            "e_c": rng.uniform(0.0, 1.0),
            "sin_theta": rng.uniform(0.0, 0.9),
        }
        if k % 4 < 2:  # as in play, or not much beyond it
            constants["mu_s"], constants["mu_c"] = rng.uniform(0.0, PLAY, 2)
        speed, angle = rng.uniform(0.05, 7.0), rng.uniform(-1.5, 1.5)
        v = speed * np.array([np.cos(angle), np.sin(angle), 0.0])
        if k % 2:
            w = np.array([-v[1], v[0], rng.uniform(-1.5, 1.5) * speed]) / R
        else:
            w = rng.normal(size=3) * 10.0 ** rng.uniform(-1.0, 2.0) * speed / R
        rows.append((k % 2, constants["mu_s"], *errors(v, w, constants)))
    return np.array(rows)


def errors(v, w, constants):
    """Doubt of the truth, errors of standard and of reference, over the largest incoming speed."""
    physics, found = sn.Physics(R=R, tables=False, **constants), []
    unit = max(float(np.linalg.norm(v)), R * float(np.linalg.norm(w)))
    for fidelity in ("standard", "reference"):
        a, b = sn.collide_cushion(v, w, (1, 0, 0), physics, fidelity)
        found.append(np.concatenate([a, R * np.array(b)]) / unit)
    after, doubt = truth(v, w, constants, found[1])
    return doubt, *(float(np.abs(one - after).max()) for one in found)


def main():
    """Command line."""
    parser = Command("stability.cushions", __doc__, seed=0)
    parser.add_argument("--impacts", type=at_least(8), default=3000, help="[3000]")
    options = parser.options()
    rows, found = measure(options.impacts, options.seed), {}
    sure, endless = rows[:, 2] <= DOUBT, int(np.isnan(rows[:, 2]).sum())
    doubtful = len(rows) - endless - int(sure.sum())
    print(
        f"{len(rows):,d} impacts; left out: {endless} without end, {doubtful} whose truth is in doubt by more than {DOUBT:g}"
    )
    print(
        f"error over the largest incoming speed    impacts  standard: 50 %    99 %   worst   reference: worst  over {DOUBT:g}"
    )
    for rolls, kind in ((1, KINDS[0]), (0, KINDS[1])):
        for name, most in ((f"mu_s below {PLAY}", PLAY), ("any mu_s", 1.0)):
            some = rows[sure & (rows[:, 0] == rolls) & (rows[:, 1] <= most)]
            standard, worst = np.quantile(some[:, 3], [0.5, 0.99, 1.0]).tolist(), float(some[:, 4].max())
            more = int((some[:, 4] > DOUBT).sum())
            found[f"{kind}, {name}"] = {
                "impacts": len(some),
                "standard": standard,
                "reference": worst,
                "over": more,
            }
            print(
                f"{kind + ', ' + name:38s} {len(some):9,d} {standard[0]:15.1e} {standard[1]:7.1e} {standard[2]:7.1e}"
                f" {worst:18.1e} {more:11d}"
            )
    save_json(options.json, {"impacts": len(rows), "endless": endless, "doubtful": doubtful, "found": found})


if __name__ == "__main__":
    run(main)
