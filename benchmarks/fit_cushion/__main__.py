"""Where do the constants of ``physics="match"`` for cushions and cloth at speed come from? They are fitted together to
all known measurements.

    python -m benchmarks.fit_cushion [--steps 60000] [--seed 0] [--json FILE] [--out FOLDER]

Measurements: rebounds of a ball that rolls straight into a snooker cushion (Mathavan 2010, Fig. 7a: 19 speeds up
to 3.4 m/s, each with an error of 0.037 m/s, the residual of the best fit to them alone), and the rows of
``benchmarks/data/hard_strokes.csv``: the distance that balls thrown as hard as possible and balls off a ramp run on
full-size tables, a snooker cloth's rolling deceleration, and the drop of restitution on a carom table.
Free parameters: the knee and the power of e(v) = e_c (v / knee)^(-power), mu_r, and two nuisance parameters, the
speed of the throw and roll_drag (the growth of the rolling resistance). e_c stays at the authors' 0.98 (their fit
below 1.5 m/s), because a free e_c reaches its bound at 1. The command prints the least squares with roll_drag 0 and
free, intervals from Metropolis steps in all five parameters, each measurement with the model's value, and lengths of
strokes.

Alciatore's lengths of pool strokes (TP B.6, "accounting for rail rebound and drag losses") are printed but not
fitted. They appear to be calculated: the shortest equals a rolling resistance of 0.010 to within 0.001 lengths. They
therefore add nothing about the dependence on speed.
"""

import csv
from math import inf
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares

import snooker_env as sn

from .._common.command import Command, at_least, run, save_figures
from . import line
from .lengths import LENGTH, RAMP, START, print_lengths

DATA = Path(__file__).parents[1] / "data" / "cushion_rebound.csv"
STROKES = DATA.with_name("hard_strokes.csv")
E_C, REBOUND_ERROR = 0.98, 0.037
NAMES = ("e_c_knee", "e_c_power", "mu_r", "thrown at", "roll_drag")
LOW, HIGH = np.array((0.5, 0.0, 0.005, 4.0, 0.0)), np.array((3.4, 0.8, 0.02, 13.4, 0.03))
START_AT = np.array((2.1, 0.25, 0.0115, 10.0, 0.002))
STEP = np.array((0.12, 0.04, 0.0007, 0.8, 0.002))
BEFORE = {"e_c_knee": 2.17, "e_c_power": 0.31, "mu_r": 0.0127}
"""The preset before this fit: the cushion fitted only to its rebounds, the cloth of one table."""
RADIUS = sn.Physics().R
ALONG = LENGTH - 2.0 * RADIUS
MPH, POOL_LENGTH, POOL_BALL = 0.44704, 2.54, 0.028575


def read_measurements():
    """(incident speeds, rebound speeds [m/s], {(quantity, setting): (value, error or None)})."""
    speed, rebound = np.loadtxt(DATA, delimiter=",", skiprows=1).T
    with STROKES.open(encoding="utf-8", newline="") as file:
        rows = csv.DictReader(file)
        found = {
            (row["quantity"], row["setting"]): (float(row["value"]), float(row["error"] or "nan"))
            for row in rows
        }
    return speed, rebound, found


def restitution(v, knee, power):
    """The package's law."""
    return E_C * np.maximum(1.0, v / knee) ** -power


class Misfit:
    """(model - measured) / error of every measurement, for values in the order of ``NAMES``."""

    def __init__(self):
        self.speed, self.rebound, self.known = read_measurements()
        self.table = line.impacts()
        self._rolling = self.table[:, np.searchsorted(line.SPINS, 1.0 - 1e-9), 0]
        strokes = [name for (name, _), (_, error) in self.known.items() if error > 0]
        self.names = [*(f"rebound at {v:.2f} m/s" for v in self.speed), *strokes]

    def model(self, values):
        """The model's values of the measurements: rebounds [m/s], then the rows with an error."""
        knee, power, mu_r, thrown, drag = values
        constants = (E_C, knee, power, mu_r, drag)
        rebound = self.speed * np.interp(restitution(self.speed, knee, power), line.SHARES, self._rolling)
        lengths = line.travels(thrown, 0.0, START - RADIUS, ALONG, constants, self.table) / LENGTH
        back = 1.25 * LENGTH - START - 2.0 * RADIUS  # to the top cushion and on to the pink's spot
        ramp = line.travels(RAMP, RAMP, START - RADIUS, ALONG, constants, self.table) - back
        slows = mu_r * line.G + 0.25 * drag
        fall = restitution(3.0, knee, power) / restitution(2.15, knee, power)
        return np.array((*rebound, lengths, thrown, ramp, slows, fall))

    def __call__(self, values):
        """Total sum of squares."""
        known = np.array([pair for pair in self.known.values() if pair[1] > 0])
        want = np.concatenate((self.rebound, known[:, 0]))
        errors = np.concatenate((np.full(len(self.speed), REBOUND_ERROR), known[:, 1]))
        return (self.model(values) - want) / errors


def fit_constants(misfit, free):
    """Least squares over the values named ``free``, with the others at ``START_AT`` and roll_drag at 0. It starts from
    several knees, because the kink creates local minima."""
    which = [NAMES.index(name) for name in free]

    def whole(x):
        values = START_AT * np.array((1, 1, 1, 1, 0.0))
        values[which] = x
        return values

    found = []
    for knee in (1.5, 1.8, 2.1, 2.4):
        start = START_AT.copy()
        start[0] = knee
        bounds = (LOW[which], HIGH[which])
        found.append(
            least_squares(
                lambda x: misfit(whole(x)), start[which], bounds=bounds, x_scale=STEP[which], diff_step=1e-3
            )
        )
    return whole(min(found, key=lambda one: one.cost).x)


def random_walk(misfit, steps, seed):
    """Metropolis steps: (steps, 5) values sampled by their squares, with uniform priors within their bounds."""
    rng = np.random.default_rng(seed)
    here, out = START_AT.copy(), np.empty((steps, len(NAMES)))
    square = np.sum(misfit(here) ** 2)
    for k in range(steps):
        there = here + 0.6 * STEP * rng.normal(size=len(NAMES))
        inside = ((there > LOW) & (there < HIGH)).all()
        other = np.sum(misfit(there) ** 2) if inside else inf
        if other < square - 2.0 * np.log(rng.random()):
            here, square = there, other
        out[k] = here
    return out[steps // 10 :]


def print_constants(misfit, fits, walk):
    """One line for each set of constants, its squares, and the intervals."""
    print(f"{'':28s}" + "".join(f"{name:>11s}" for name in NAMES) + "    squares: all  rebounds  throw")
    for name, values in fits.items():
        r = misfit(values) ** 2
        row = "".join(f"{value:11.4g}" for value in values)
        n = len(misfit.speed)
        print(f"{name:28s}{row}{r.sum():16.1f}{r[:n].sum():10.1f}{r[n : n + 2].sum():7.1f}")
    for share in (0.025, 0.5, 0.975):
        row = "".join(f"{value:11.4g}" for value in np.quantile(walk, share, axis=0))
        print(f"{f'{100 * share:g} % of the steps below':28s}{row}")
    far = (5.0, 7.0, 10.0)
    print("e at m/s  match  95 %")
    match = sn.Physics.preset("match")
    left_open = {}
    for v in far:
        left_open[v] = np.quantile(restitution(v, walk[:, 0], walk[:, 1]), (0.025, 0.975)).tolist()
        low, high = left_open[v]
        print(f"{v:8g}{restitution(v, match.e_c_knee, match.e_c_power):7.2f}  {low:.2f} to {high:.2f}")
    return left_open


def print_measurements(misfit, values):
    """Print each measurement with the model's value."""
    print(f"\n{'measurement':28s}   model   off by, in errors")
    for name, model, off in zip(misfit.names, misfit.model(values), misfit(values), strict=True):
        print(f"{name:28s}{model:8.3f}{off:+8.1f}")


def print_pool(misfit):
    """Print Alciatore's calculated lengths and those of match's law of e on a pool table with his cloth."""
    physics = {"R": POOL_BALL, "sin_theta": 0.27}
    table, match = line.impacts(**physics), sn.Physics.preset("match")
    print(
        "\npool, lengths of 100 in: TP B.6 (a calculation), match's e(v) and a constant e_c, each with mu_r 0.010"
    )
    for (name, setting), (value, _) in misfit.known.items():
        if name == "pool_lengths":
            v = float(setting.split()[0]) * MPH
            ours = [
                line.travels(
                    v, v, 0.0, POOL_LENGTH - 2 * POOL_BALL, (E_C, match.e_c_knee, power, 0.010, 0.0), table
                )
                for power in (match.e_c_power, 0.0)
            ]
            print(f"{setting:>8s}{value:8.3f}" + "".join(f"{way / POOL_LENGTH:8.3f}" for way in ours))


def main():
    """Command line: fit and print the tables."""
    parser = Command("fit_cushion", __doc__, seed=0)
    parser.add_argument("--steps", type=at_least(100), default=60_000, help="Metropolis steps [60000]")
    options = parser.options()
    misfit, match = Misfit(), sn.Physics.preset("match")
    fits = {
        "fitted, roll_drag 0": fit_constants(misfit, NAMES[:4]),
        "fitted, roll_drag free": fit_constants(misfit, NAMES),
    }
    shipped = {name: getattr(match, name) for name in (*BEFORE, "roll_drag")}
    for name, constants in (("shipped", shipped), ("before", {**BEFORE, "roll_drag": 0.0})):
        values = fits["fitted, roll_drag 0"].copy()
        for field, value in constants.items():
            values[NAMES.index(field)] = value
        values[3] = min(
            np.arange(4.0, HIGH[3], 0.05), key=lambda v, at=values: np.sum(misfit((*at[:3], v, at[4])) ** 2)
        )
        fits[name] = values
    walk = random_walk(misfit, options.steps, options.seed)
    left_open = print_constants(misfit, fits, walk)
    print_measurements(misfit, fits["shipped"])
    print_pool(misfit)
    before = sn.Physics.preset("match", **BEFORE)
    travelled = print_lengths({"before": before})
    low, high = np.quantile(walk, (0.025, 0.975), axis=0)
    save_figures(
        options,
        {
            "fits": {name: values.tolist() for name, values in fits.items()},
            "interval": dict(zip(NAMES, zip(low.tolist(), high.tolist(), strict=True), strict=True)),
            "e": left_open,
            "lengths": travelled,
        },
    )


if __name__ == "__main__":
    run(main)
