"""Where do the cushion constants of ``physics="match"`` come from? Fits e(v) to the measured rebounds of
Mathavan 2010, Fig. 7a.

    python -m benchmarks.fit_cushion [--seed 0] [--json FILE] [--out FOLDER]

The model is this project's own cushion impact for a rolling ball at right angles, with e(v) = e_c up to a
knee and e_c (v / knee)^(-power) above it. e_c stays at the authors' own 0.98 (their fit below 1.5 m/s): left
free it runs into its bound at 1, a cushion without loss. Printed beside it: a constant, the straight line of
version 0.1 and an exponential, which follow the same 19 points as well and go elsewhere beyond them; the
interval of the power (95 %: profile with an F test, and a bootstrap of the points) and what it leaves open at
5 to 10 m/s; the rebound speeds to 15 m/s; and how many lengths of the table a stroke travels.
"""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import f as f_distribution

import snooker_env as sn

from .._common.command import Command, save_json
from .lengths import print_lengths

DATA = Path(__file__).parents[1] / "data" / "cushion_rebound.csv"
E_C = 0.98
SHARES = np.linspace(0.0, 1.0, 201)
FAR = np.array((5.0, 7.0, 10.0))
"""Speeds [m/s] beyond the data at which the laws are compared."""
KNEES, POWERS = np.arange(1.0, 3.4, 0.02), np.arange(0.05, 0.8, 0.005)


def power_law(v, knee, power, e_c=E_C):
    """Restitution at v [m/s]: the package's law."""
    return e_c * np.maximum(1.0, v / knee) ** -power


def line(v, knee, slope, e_c=E_C):
    """The law of version 0.1, for comparison: ``slope`` in s/m."""
    return np.maximum(0.0, e_c - slope * np.maximum(0.0, v - knee))


def exponential(v, knee, rate, e_c=E_C):
    """For comparison: ``rate`` in s/m."""
    return e_c * np.exp(-rate * np.maximum(0.0, v - knee))


LAWS = {"power": power_law, "line": line, "exponential": exponential}


def impact(speed, physics, rolling=True):
    """Rebound speed [m/s] of a ball that meets a cushion at right angles, rolling or sliding without spin."""
    v, _ = sn.collide_cushion((0, speed, 0), (-rolling * speed / 0.02625, 0, 0), (0, 1, 0), physics)
    return -float(v[1])


class Ratios(NamedTuple):
    """Rebound over incident speed for each restitution of ``SHARES``: for a given e the impact scales with
    its speed."""

    rolling: np.ndarray
    sliding: np.ndarray

    @classmethod
    def measured(cls):
        """By the package's impact."""
        constants = [sn.Physics.preset("match", e_c=float(e), e_c_power=0.0, tables=False) for e in SHARES]
        return cls(
            *(np.array([impact(1.0, physics, rolling) for physics in constants]) for rolling in (True, False))
        )


class Interval(NamedTuple):
    """What the data leave open, 95 %: (low, high) of the power and of e at ``FAR`` by the profile and by the
    bootstrap; ends: the (knee, power) of the two ends of the power's profile."""

    power: tuple
    power_bootstrap: np.ndarray
    e: np.ndarray
    e_bootstrap: np.ndarray
    ends: list


def fitted(law, residuals, free):
    """(knee, x[, e_c]) of least squares. The kink makes the problem bumpy: it starts from several knees and
    keeps the best."""
    low, high = [0.5, 0.0] + [0.5] * free, [3.4, 0.9] + [1.0] * free
    starts = [(knee, 0.2, 0.97)[: 2 + free] for knee in (1.0, 1.5, 2.0, 2.5)]
    fits = [
        least_squares(lambda x: residuals(law, *x), start, bounds=(low, high), diff_step=1e-4)
        for start in starts
    ]
    return min(fits, key=lambda found: found.cost).x


def interval(residuals, points, draws=2000, seed=0):
    """The ``Interval`` of the power law from the squares of its residuals on a grid of knees and powers."""
    squares = np.array([[residuals(power_law, knee, power) ** 2 for knee in KNEES] for power in POWERS])
    misfit = squares.sum(axis=2)
    allowed = misfit <= misfit.min() * (1.0 + f_distribution.ppf(0.95, 1, points - 2) / (points - 2))
    inside = np.flatnonzero(allowed.any(axis=1))[[0, -1]]
    knees, powers = (a.ravel() for a in np.meshgrid(KNEES, POWERS))
    e = power_law(FAR[:, None], knees, powers)
    counts = np.random.default_rng(seed).multinomial(points, np.full(points, 1.0 / points), size=draws)
    flat = squares.reshape(-1, points)
    best = np.concatenate([(flat @ part.T).argmin(axis=0) for part in np.array_split(counts, draws // 100)])
    within = e[:, allowed.ravel()]
    return Interval(
        tuple(POWERS[inside]),
        np.quantile(powers[best], (0.025, 0.975)),
        np.stack((within.min(axis=1), within.max(axis=1))),
        np.quantile(e[:, best], (0.025, 0.975), axis=1),
        [(float(KNEES[misfit[k].argmin()]), float(POWERS[k])) for k in inside],
    )


def print_fits(fits, residuals, shipped, preset):
    """One line for each law: its constants, its residuals, e beyond the data."""
    rows = [(name, x, residuals(law, *x), law(FAR, *x)) for name, law, x in fits]
    kept = (preset.e_c_knee, preset.e_c_power, preset.e_c)
    rows.insert(0, ("shipped (power)", kept, shipped, power_law(FAR, *kept)))
    print(
        f"{'':22s}    e_c  knee m/s  power, or s/m  rms m/s  largest m/s  e at {FAR[0]:g}, {FAR[1]:g}, {FAR[2]:g} m/s"
    )
    for name, x, r, e in rows:
        e_c = x[2] if len(x) == 3 else E_C
        rms, largest = np.sqrt(np.mean(np.square(r))), np.abs(r).max()
        far = "  ".join(f"{value:.2f}" for value in e)
        print(f"{name:22s} {e_c:6.3f}  {x[0]:8.3f}  {x[1]:13.4f}  {rms:7.4f}  {largest:11.4f}  {far}")


def print_points(speed, measured, shipped):
    """The data beside the preset."""
    print("\nspeed  measured  ratio  model  ratio  residual")
    for s, m, r in zip(speed, measured, shipped, strict=True):
        print(f"{s:5.2f}  {m:8.3f}  {m / s:5.3f}  {m + r:5.3f}  {(m + r) / s:5.3f}  {r:+8.3f}")


def print_interval(found, fastest):
    """The power's interval and what it means beyond the data."""
    low, high = found.power
    print(
        f"\n95 % interval of the power: {low:.2f} to {high:.2f} (profile), {found.power_bootstrap[0]:.2f} to "
        f"{found.power_bootstrap[1]:.2f} (bootstrap); the data end at {fastest:.2f} m/s.\nIf the power law goes on:"
    )
    for v, e, b in zip(FAR, found.e.T, found.e_bootstrap.T, strict=True):
        print(f"  e({v:2g} m/s) = {e[0]:.2f} to {e[1]:.2f} (profile), {b[0]:.2f} to {b[1]:.2f} (bootstrap)")


def print_rebounds(ratios, old, preset):
    """Rebound against incident speed, at right angles: the preset's law and the line that it replaces."""
    print("\nrebound speed [m/s]   power law (shipped)    line of version 0.1")
    print("incident [m/s]        rolling   sliding     rolling   sliding")
    for v in (0.5, 1.0, 2.0, 3.0, 3.4, 4.0, 5.0, 6.0, 7.0, 8.0, 10.0, 12.0, 15.0):
        new = [impact(v, preset, rolling) for rolling in (True, False)]
        was = [v * max(0.0, np.interp(line(v, *old), SHARES, ratio)) for ratio in ratios]
        print(f"{v:14.1f}  {new[0]:13.2f} {new[1]:9.2f}  {was[0]:10.2f} {was[1]:9.2f}")


def main():
    """Command line: fit, print the tables."""
    options = Command("fit_cushion", __doc__, seed=0).options()
    speed, measured = np.loadtxt(DATA, delimiter=",", skiprows=2).T
    ratios, preset = Ratios.measured(), sn.Physics.preset("match")

    def residuals(law, *x):
        return speed * np.interp(law(speed, *x), SHARES, ratios.rolling) - measured

    fits = [(name, law, fitted(law, residuals, free=False)) for name, law in LAWS.items()]
    fits += [
        (f"{name}, e_c free", LAWS[name], fitted(LAWS[name], residuals, free=True))
        for name in ("power", "line")
    ]
    old = fits[1][2]
    fits.append(("constant", power_law, (0.5, 0.0)))
    shipped = np.array([impact(float(s), preset) for s in speed]) - measured
    print_fits(fits, residuals, shipped, preset)
    print_points(speed, measured, shipped)
    found = interval(residuals, len(speed), seed=options.seed)
    print_interval(found, speed.max())
    print_rebounds(ratios, old, preset)
    travelled = print_lengths(found.ends)
    laws = {name: [float(value) for value in x] for name, _, x in fits}
    left_open = {name: np.asarray(value).tolist() for name, value in found._asdict().items()}
    save_json(options.json, {"seed": options.seed, "laws": laws, "interval": left_open, "lengths": travelled})
