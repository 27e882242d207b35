"""How do I fit the physics to my own measurements? Pass a CSV file of throws, rebounds or roll-outs and get constants
with intervals.

    python examples/fit_your_data.py throw benchmarks/data/throw_domenech2023.csv --column speed_m_s=0.8 --fix
    R=0.0305 e_b=0.968 python examples/fit_your_data.py cushion benchmarks/data/cushion_rebound.csv --fix
    e_c=0.98 python examples/fit_your_data.py cloth my_rolls.csv

Needs scipy: pip install -e ".[test]". ``docs/physics/fit_your_data.md`` describes the columns and the
results.
"""

import argparse
import csv
import dataclasses
import math
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

try:
    from scipy.optimize import least_squares
    from scipy.stats import t as student
except ImportError:
    raise SystemExit("fit_your_data.py needs scipy: pip install scipy") from None

import snooker_env as sn
from snooker_env.checks import choice, integer, number, refuse, refuse_what


class Column(NamedTuple):
    """One column of a file: its bounds, and the error of one measurement if the column is measured."""

    low: float
    high: float
    error: float = 0.0


class Constant(NamedTuple):
    """One constant to fit: its bounds and starting value."""

    low: float
    high: float
    starts: tuple[float, ...]


class Kind(NamedTuple):
    """One kind of measurement: the columns of a file, the constants to fit, and the model's prediction."""

    inputs: dict[str, Column]
    """Columns set by the experimenter. The first is required; the others have defaults."""
    measured: dict[str, Column]
    """Measured columns, at least one of them required."""
    constants: dict[str, Constant]
    predict: Callable[[dict, "sn.Physics"], dict]
    """(columns, physics) -> the measured columns according to the model."""


class Fit(NamedTuple):
    """The result of a fit."""

    values: dict[str, float]
    intervals: dict[str, tuple[float, float] | None]
    """95 % intervals; None if the data do not determine the constant."""
    residuals: dict[str, np.ndarray]
    """Model minus measurement for each measured column."""
    physics: "sn.Physics"


def _topspin(columns, speed, radius):
    """Spins [rad/s]; without a given topspin, the ball rolls."""
    return columns.get("topspin_rad_s", speed / radius)


def predict_throw(columns, physics):
    """Throw [deg] and speed [m/s] of the object ball just after the impact of a cue ball that moves along
    +x."""
    cut, speed = np.radians(columns["cut_deg"]), columns["speed_m_s"]
    topspin, side = _topspin(columns, speed, physics.R), columns.get("side_rad_s", 0.0 * speed)
    after = [
        sn.collide_balls((v, 0, 0), (0, w, s), (0, 0, 0), (0, 0, 0), (math.cos(c), math.sin(c), 0), physics)[
            2
        ]
        for c, v, w, s in zip(cut, speed, topspin, side, strict=True)
    ]
    x, y, _ = np.array(after).T
    return {"throw_deg": np.degrees(cut - np.arctan2(y, x)), "object_speed_m_s": np.hypot(x, y)}


def predict_rebound(columns, physics):
    """Speed [m/s] and angle from the normal [deg] just after a cushion along x. The ball comes from -y and,
    at an angle, from -x."""
    angle, speed = (
        np.radians(columns.get("incident_deg", 0.0 * columns["incident_m_s"])),
        columns["incident_m_s"],
    )
    topspin, side = _topspin(columns, speed, physics.R), columns.get("side_rad_s", 0.0 * speed)
    after = [
        sn.collide_cushion(
            (v * math.sin(a), v * math.cos(a), 0), (-w * math.cos(a), w * math.sin(a), s), (0, 1, 0), physics
        )[0]
        for a, v, w, s in zip(angle, speed, topspin, side, strict=True)
    ]
    x, y, _ = np.array(after).T
    return {"rebound_m_s": np.hypot(x, y), "rebound_deg": np.degrees(np.arctan2(x, -y))}


def predict_roll_out(columns, physics):
    """Distance [m] and time [s] to rest on the cloth: the ball slides, then rolls out
    (docs/physics/model.md)."""
    speed = columns["speed_m_s"]
    slip = speed - physics.R * _topspin(columns, speed, physics.R)
    sliding = 2.0 * np.abs(slip) / (7.0 * physics.mu_s * physics.g)
    rolling = speed - slip * 2.0 / 7.0
    distance = 0.5 * (speed + rolling) * sliding + rolling * np.abs(rolling) / (
        2.0 * physics.mu_r * physics.g
    )
    return {"distance_m": distance, "time_s": sliding + np.abs(rolling) / (physics.mu_r * physics.g)}


SPEED, SPIN = Column(1e-3, 20.0), Column(-2000.0, 2000.0)
KINDS = {
    "throw": Kind(
        {"cut_deg": Column(0.0, 89.9), "speed_m_s": SPEED, "topspin_rad_s": SPIN, "side_rad_s": SPIN},
        {"throw_deg": Column(-45.0, 45.0, 0.5), "object_speed_m_s": Column(0.0, 20.0, 0.01)},
        {
            "mu_bb": Constant(0.0, 1.0, (0.06,)),
            "a": Constant(0.0, 0.5, (0.02,)),
            "b": Constant(0.0, 0.5, (0.08,)),
            "c": Constant(0.0, 20.0, (0.5, 2.0)),
            "e_b": Constant(0.0, 1.0, (0.92,)),
        },
        predict_throw,
    ),
    "cushion": Kind(
        {
            "incident_m_s": SPEED,
            "incident_deg": Column(-89.0, 89.0),
            "topspin_rad_s": SPIN,
            "side_rad_s": SPIN,
        },
        {"rebound_m_s": Column(0.0, 20.0, 0.02), "rebound_deg": Column(-89.9, 89.9, 0.5)},
        {
            "e_c": Constant(0.0, 1.0, (0.95,)),
            "e_c_knee": Constant(0.1, 10.0, (1.0, 1.5, 2.0, 2.5)),
            "e_c_power": Constant(0.0, 0.8, (0.2,)),
            "mu_c": Constant(0.0, 1.0, (0.15,)),
        },
        predict_rebound,
    ),
    "cloth": Kind(
        {"speed_m_s": SPEED, "topspin_rad_s": SPIN},
        {"distance_m": Column(0.0, 100.0, 0.01), "time_s": Column(0.0, 200.0, 0.05)},
        {"mu_r": Constant(1e-4, 0.2, (0.012,)), "mu_s": Constant(0.01, 1.0, (0.2,))},
        predict_roll_out,
    ),
}


def read(file, kind, filled=None):
    """Read the columns of a CSV file as arrays. ``filled``: columns with one value for every row. ValueError
    for an invalid file."""
    known = {**KINDS[kind].inputs, **KINDS[kind].measured}
    try:
        text = Path(file).read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise refuse("file", str(file), f"must be a CSV file in UTF-8 ({error})") from None
    lines = [
        (n, line)
        for n, line in enumerate(text.splitlines(), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if not lines:
        raise refuse_what(
            f"{file}", "no line", f"must have a line of names ({', '.join(known)}), then numbers"
        )
    names = [name.strip() for name in next(csv.reader([lines[0][1]]))]
    for name in names:
        choice(f"{file}, line {lines[0][0]}, column", name, known)
    columns = {name: [] for name in names}
    if len(columns) < len(names):
        raise refuse(f"{file}, line {lines[0][0]}, columns", names, "must be different")
    for n, line in lines[1:]:
        row = next(csv.reader([line]))
        if len(row) != len(names):
            raise refuse_what(
                f"{file}, line {n}", f"{len(row)} values", f"must be {len(names)}: {', '.join(names)}"
            )
        for name, value in zip(names, row, strict=True):
            field = f"{file}, line {n}, {name}"
            try:
                value = float(value)
            except ValueError:
                raise refuse(field, value.strip(), "must be a number") from None
            columns[name].append(number(field, value, known[name].low, known[name].high))
    for name, value in (filled or {}).items():
        if name in columns:
            raise refuse("--column", name, "must not be a column of the file")
        columns[name] = [number(f"--column {name}", value, known[name].low, known[name].high)] * (
            len(lines) - 1
        )
    for name in needed(kind):
        if name not in columns:
            raise refuse_what(
                f"{file}, columns", ", ".join(columns), f"must hold {name}, or --column {name}=VALUE"
            )
    if not any(name in columns for name in KINDS[kind].measured):
        raise refuse_what(
            f"{file}, columns", ", ".join(columns), f"must hold one of {', '.join(KINDS[kind].measured)}"
        )
    arrays = {name: np.array(values) for name, values in columns.items()}
    if (
        "throw_deg" in arrays
        and "side_rad_s" not in arrays
        and len(lines) > 1
        and np.median(arrays["throw_deg"]) < 0
    ):
        allowed = (
            "must be positive for most rows without side: positive means in the direction in which the cue "
            "ball moved"
        )
        raise refuse(f"{file}, median of throw_deg", float(np.median(arrays["throw_deg"])), allowed)
    return arrays


def needed(kind):
    """Check the columns that every prediction needs."""
    return ("cut_deg", "speed_m_s") if kind == "throw" else tuple(KINDS[kind].inputs)[:1]


def to_fit(kind, columns, fixed, law="constant"):
    """The constants that these columns determine, without the fixed ones."""
    if kind == "throw":
        names = list("abc") if law == "marlow" else ["mu_bb"] if "throw_deg" in columns else []
        names += ["e_b"] if "object_speed_m_s" in columns else []
    elif kind == "cushion":
        names = ["e_c", "e_c_knee", "e_c_power"] + (["mu_c"] if "rebound_deg" in columns else [])
        if fixed.get("e_c_power") == 0:
            names.remove("e_c_knee")
    else:
        names = ["mu_r"] + (["mu_s"] if "topspin_rad_s" in columns else [])
    return [name for name in names if name not in fixed]


def fit(kind, columns, preset="match", fixed=None, law="constant", bootstrap=0, seed=0):
    """Fit the model to the columns of ``read`` by least squares."""
    fixed, what = dict(fixed or {}), KINDS[kind]
    if law == "marlow" and "throw_deg" not in columns:
        raise refuse("law", law, "must be constant where no throw_deg was measured")
    names = to_fit(kind, columns, fixed, law)
    measured = [name for name in what.measured if name in columns]
    rows = len(columns[measured[0]])
    if not names:
        raise refuse_what("constants", "all fixed", "must leave something to fit")
    if rows <= len(names):
        raise refuse("rows", rows, f"must be more than the {len(names)} constants to fit: {', '.join(names)}")
    if kind == "cushion" and "e_c_power" not in names and "e_c_power" not in fixed:
        fixed["e_c_power"] = 0.0

    def physics(x, **others):
        fields = fixed | dict(zip(names, (float(value) for value in x), strict=True))
        if "a" in fields:
            fields["mu_bb"] = tuple(fields.pop(name) for name in "abc")
        return sn.Physics.preset(preset, **fields, **others)

    def residuals(x, rows=slice(None)):
        picked = {name: values[rows] for name, values in columns.items()}
        model = what.predict(picked, physics(x, tables=False))  # of constants that are used once
        return np.concatenate([(model[name] - picked[name]) / what.measured[name].error for name in measured])

    low, high = (np.array([getattr(what.constants[name], end) for name in names]) for end in ("low", "high"))

    def best(starts, *args):
        fits = [
            least_squares(residuals, start, bounds=(low, high), diff_step=1e-4, args=args) for start in starts
        ]
        return min(fits, key=lambda fitted: fitted.cost)

    grid = np.array(np.meshgrid(*(what.constants[name].starts for name in names))).reshape(len(names), -1).T
    fitted = best(grid)
    x = fitted.x
    if bootstrap:
        rng = np.random.default_rng(seed)
        draws = np.array([best([x], rng.integers(rows, size=rows)).x for _ in range(bootstrap)])
        ends = [tuple(q) for q in np.quantile(draws, (0.025, 0.975), axis=0).T.tolist()]
    else:
        ends = _by_covariance(fitted, low, high)
    apart = np.split(fitted.fun, len(measured))
    off = {name: part * what.measured[name].error for name, part in zip(measured, apart, strict=True)}
    return Fit(
        dict(zip(names, x.tolist(), strict=True)), dict(zip(names, ends, strict=True)), off, physics(x)
    )


def _by_covariance(fitted, low, high):
    """95 % intervals from the Jacobian, cut at the bounds; None for a constant at a bound or not determined by
    the data."""
    inside = ~(np.isclose(fitted.x, low, atol=1e-4) | np.isclose(fitted.x, high, atol=1e-4))
    jacobian, freedom = fitted.jac[:, inside], len(fitted.fun) - int(inside.sum())
    lengths = np.linalg.norm(jacobian, axis=0)
    if not inside.any() or not lengths.all() or np.linalg.cond(jacobian / lengths) > 1e4:
        return [None] * len(inside)
    covariance = np.linalg.inv(jacobian.T @ jacobian) * 2.0 * fitted.cost / freedom
    half = np.full(len(inside), np.nan)
    half[inside] = student.ppf(0.975, freedom) * np.sqrt(np.diag(covariance))
    below, above = np.maximum(low, fitted.x - half).tolist(), np.minimum(high, fitted.x + half).tolist()
    return [(a, b) if known else None for a, b, known in zip(below, above, inside, strict=True)]


def preset_line(fitted, preset, fixed):
    """A line of Python that uses the constants."""
    values = {name: float(f"{value:.4g}") for name, value in (fixed | fitted.values).items()}
    if "a" in values:
        values["mu_bb"] = tuple(values.pop(name) for name in "abc")
    fields = ", ".join(f"{name}={value}" for name, value in values.items())
    return f'physics = sn.Physics.preset("{preset}", {fields})'


def report(fitted, preset, fixed):
    """The printed report."""
    for name, value in fitted.values.items():
        ends = fitted.intervals[name]
        says = (
            f"95 %: {ends[0]:.4g} to {ends[1]:.4g}"
            if ends
            else "not determined by these data, or at the end of its range: fix it"
        )
        print(f"{name:10s} {value:9.4g}   {says}")
    print(f"\n{'model less measurement':24s}{'mean':>10s}{'rms':>10s}{'largest':>10s}  in row")
    for name, off in fitted.residuals.items():
        worst = int(np.abs(off).argmax())
        print(
            f"{name:24s}{off.mean():10.3g}{np.sqrt(np.mean(off**2)):10.3g}"
            f"{abs(off[worst]):10.3g}  {worst + 1}"
        )
    print(f"\n{preset_line(fitted, preset, fixed)}")


def _pairs(option, words):
    """Parse NAME=VALUE ... into a dict of numbers."""
    out = {}
    for pair in words:
        name, _, value = pair.partition("=")
        try:
            out[name] = float(value)
        except ValueError:
            raise refuse(option, pair, "must be NAME=VALUE with a number") from None
    return out


def main(arguments=None):
    """Command line."""
    parser = argparse.ArgumentParser(description="Fit the physics of snooker_env to measurements.")
    parser.add_argument("kind", choices=KINDS, help="kind of measurement")
    parser.add_argument("file", help="a CSV file")
    parser.add_argument(
        "--preset", default="match", help="preset of all other constants: paper or match [match]"
    )
    parser.add_argument(
        "--fix",
        nargs="+",
        default=[],
        metavar="NAME=VALUE",
        help="fields of Physics to fix at your own values",
    )
    parser.add_argument(
        "--column",
        nargs="+",
        default=[],
        metavar="NAME=VALUE",
        help="columns with one value for every row",
    )
    parser.add_argument(
        "--law",
        default="constant",
        choices=("constant", "marlow"),
        help="throw: mu_bb, or mu(s) = a + b exp(-c s)",
    )
    parser.add_argument(
        "--bootstrap",
        type=int,
        default=0,
        metavar="N",
        help="intervals from N resamples of the rows [0: from the covariance]",
    )
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="seed of the resamples [0]")
    args = parser.parse_args(arguments)
    try:
        fixed, filled = _pairs("--fix", args.fix), _pairs("--column", args.column)
        for name in filled:
            choice("--column", name, KINDS[args.kind].inputs)
        for name in fixed:
            choice(
                "--fix",
                name,
                [f.name for f in dataclasses.fields(sn.Physics)] + list("abc") * (args.law == "marlow"),
            )
        draws, seed = (
            integer(f"--{name}", getattr(args, name), 0, 100_000) for name in ("bootstrap", "seed")
        )
        columns = read(args.file, args.kind, filled)
        fitted = fit(args.kind, columns, args.preset, fixed, args.law, draws, seed)
    except ValueError as error:
        raise SystemExit(str(error)) from None
    print(f"{args.file}: {len(next(iter(columns.values())))} rows, {args.kind}\n")
    report(fitted, args.preset, fixed)


if __name__ == "__main__":
    main()
