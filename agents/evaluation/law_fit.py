"""Which law of execution errors fits frames and long pots? Frames are simulated under laws spread over ``RANGES``, and a
quadratic surface is fitted to each figure. These surfaces give the likelihood of the recorded and reported figures."""

from dataclasses import replace
from math import log

import numpy as np

from agents._lib.tables import TextTable
from snooker_env import Position
from snooker_env.geometry import POCKET_AIMS
from snooker_env.planning import Planner, Positions
from snooker_env.tasks import LEVELS

RANGES = {
    "core": (0.025, 0.065),
    "lapse": (0.04, 0.2),
    "lapse_factor": (2.5, 8.0),
    "speed_rel": (0.008, 0.03),
    "growth": (0.5, 2.5),
}
"""Ranges of the direction's standard deviation at 1.5 m/s [deg] and of fields of ``Noise``; laws are spread in the logarithm."""
FITTED = ("visits", "frames_50", "frames_100", "winner")
"""Figures of frames that depend on the law of errors: strokes and fouls depend on tactics; a mean break is points over visits."""
LONG_POTS, STROKES = (57.5, 7.5), 1000
"""Share of long pots that professionals reportedly make, 50 to 65 % [%], and how many times each of ours is tried."""
LONG = (
    ((-0.0133, -1.0442), (0.5731, 0.8155), 2.5),
    ((-0.3624, -0.8306), (0.3002, 0.9501), 2.5),
    ((-0.1185, -1.6913), (0.5430, 0.6157), 3.0),
)
"""The long pots of ``benchmarks.execution`` into the top right pocket: cue ball and red [m], cue speed [m/s]."""
GRID, DRAWN, LEAST_LAWS = 9, 20_000, 12
"""Number of values in a parameter's profile, of laws drawn to find the likeliest, and the minimum number simulated."""


def law_of(core, growth, **fields):
    """A professional's errors with this direction at 1.5 m/s [deg], this growth, and these ``fields`` of ``Noise``."""
    base = replace(LEVELS["professional"], growth=growth)
    times = core / base.direction_deg()
    return replace(base, aim_deg=base.aim_deg * times, offset_mm=base.offset_mm * times, **fields)


def spread_laws(n, seed):
    """Spread n laws evenly over the ranges: the parameters' logarithms (n, 5), and each law as a dict."""
    rng, (low, high) = np.random.default_rng(seed), np.log(np.array(list(RANGES.values())).T)
    places = rng.permuted(np.tile(np.arange(n)[:, None], len(RANGES)), axis=0) + rng.random((n, len(RANGES)))
    logs = low + (high - low) * places / n
    return logs, [dict(zip(RANGES, np.exp(row).tolist(), strict=True)) for row in logs]


def long_pots(noise, seed):
    """The share of long pots made [%]; a pot that the cue ball follows counts as well."""
    made, planner = [], Planner({"noise": noise})
    for cue, red, speed in LONG:
        at = Positions.of(Position(cue=cue, reds=[red], on="red"))
        strokes = np.tile([speed, 0.0, 0.0, 0.0, 0.0], (STROKES, 1))
        strokes[:, 3] = planner.pot_aim(at, [0], [1], [POCKET_AIMS[3, :2]], speed)
        keys = np.arange(STROKES) + seed
        out = planner.play_strokes(at, np.zeros(STROKES, int), strokes, keys)
        made.append(float((out.potted[:, 1] == 3).mean()))
    return 100.0 * float(np.mean(made))


class Surface:
    """Fit a quadratic in the logarithms of the parameters to figures (n,)."""

    def __init__(self, logs, values):
        self._middle = logs.mean(axis=0)
        terms = self._terms(logs)
        self._factors = np.linalg.lstsq(terms, values, rcond=None)[0]
        free = max(1, len(values) - terms.shape[1])
        self.error = float(np.sqrt(((values - terms @ self._factors) ** 2).sum() / free))

    def _terms(self, logs):
        x = logs - self._middle
        pairs = [x[:, [i]] * x[:, [j]] for i, j in ((0, 1), (1, 2), (2, 2), (0, 0))]
        return np.hstack([np.ones((len(x), 1)), x, *pairs])

    def __call__(self, logs):
        return self._terms(logs) @ self._factors


def misfit(surfaces, said, logs):
    """-2 log likelihood (n,) at n laws of the reported mean and standard error of each figure."""
    total = np.zeros(len(logs))
    for name, surface in surfaces.items():
        mean, error = said[name]
        total += ((surface(logs) - mean) / np.hypot(error, surface.error)) ** 2
    return total


def profile(logs, figures, said, seed):
    """Find the likeliest law among those spread like ``logs``, its misfit, and the profile of each parameter: its values, and
    how much the smallest misfit grows with each value. ``figures`` holds those of each law, by name."""
    surfaces = {name: Surface(logs, np.array(figures[name])) for name in said}
    drawn, laws = spread_laws(DRAWN, seed)
    misfits, rows = misfit(surfaces, said, drawn), {}
    for k, (name, ends) in enumerate(RANGES.items()):
        values = np.exp(np.linspace(log(ends[0]), log(ends[1]), GRID))
        least = []
        for value in values:
            there = drawn.copy()
            there[:, k] = log(value)
            least.append(float(misfit(surfaces, said, there).min()))
        rows[name] = (values.tolist(), least)
    lowest = min([float(misfits.min()), *(value for _, least in rows.values() for value in least)])
    rows = {name: (values, [one - lowest for one in least]) for name, (values, least) in rows.items()}
    return laws[int(misfits.argmin())], lowest, rows


def tables_of(best, least, rows):
    """The result of ``profile``, as tables."""
    words = ", ".join(f"{name} {value:.3g}" for name, value in best.items())
    title = f"The likeliest law: {words}; -2 log likelihood {least:.1f}, and the increase with each value of a parameter"
    lines = []
    for name, (values, more) in rows.items():
        lines.append([name, *(f"{value:.3g}" for value in values)])
        lines.append(["", *(f"{value:.1f}" for value in more)])
    return [TextTable(title, ["", *[""] * GRID], lines, 1, 1)]
