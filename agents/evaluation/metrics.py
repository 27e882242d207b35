"""How good is an agent under one condition? It has figures with intervals, and ratios to those of other agents."""

import zlib
from dataclasses import dataclass

import numpy as np

from snooker_env.benchmark.statistics import Resamples, bound_if_none, figure, iqm

from .entrants import Entrant
from .visit_figures import FIGURES

BELOW = sorted({below for _, below in FIGURES.values()})
"""Denominators of shares and means, whose counts per run are kept as well."""
AXES = ("noise", "fidelity", "physics", "cue")
USUAL = {
    "layout": "held_out",
    "noise": "professional",
    "fidelity": "standard",
    "physics": "paper",
    "cue": "real",
}
"""Conditions shown first, if they were played."""
SCORES = ("points", "pots")
"""Figures that also have inter-quartile means and ratios to other agents."""


def main_condition(report):
    """The condition of comparison and picture: the default values if they were played, otherwise the first ones."""
    p = report["protocol"]
    return {
        name: USUAL[name] if USUAL[name] in p[key] else next(iter(p[key]))
        for name, key in (("layout", "layouts"), *zip(AXES, AXES, strict=True))
    }


def draw_ratios(samples, above, below):
    """The ratio of the sums of two matrices in each of the ``Resamples``: float64 (n,), NaN where it divides by 0."""
    over = samples.sums(below)
    return np.divide(samples.sums(above), over, out=np.full(len(over), np.nan), where=over != 0)


def _quotient(above, below):
    return above / below if below else float("nan")


def add_bound(share, trials):
    """A share with its interval, or with the exact bound for this many trials if it is 0 or 1."""
    if share["low"] is not None or share["value"] not in (0.0, 1.0) or not trials:
        return share
    most = bound_if_none(trials)
    return share | ({"low": 0.0, "high": most} if share["value"] == 0.0 else {"low": 1.0 - most, "high": 1.0})


@dataclass
class EntrantMetrics:
    """One agent under one condition: the counts of every run and visit, name -> (runs, visits)."""

    agent: Entrant
    counted: dict
    strokes: list
    """Make this from the ``Strokes`` of every run."""
    resamples: int

    @property
    def _samples(self):
        runs, visits = self.counted["points"].shape
        return Resamples(runs, visits, self.resamples, zlib.crc32(self.agent.label.encode()))

    def figures(self):
        """All figures of this agent on its own."""
        samples, c, made = self._samples, self.counted, {}
        for name, (a, b) in FIGURES.items():
            made[name] = figure(_quotient(c[a].sum(), c[b].sum()), draw_ratios(samples, c[a], c[b]))
        return made | {f"{name}_a_visit_iqm": figure(iqm(c[name]), samples.iqms(c[name])) for name in SCORES}

    def ratios(self, other):
        """Ratios of this agent's scores to another's on the same tables."""
        mine, its, found = self._samples, other._samples, {}
        for name in SCORES:
            a, b = self.counted[name], other.counted[name]
            above, below = mine.sums(a) / mine.sums(np.ones_like(a)), its.sums(b) / its.sums(np.ones_like(b))
            drawn = np.divide(above, below, out=np.full(len(above), np.nan), where=below != 0)
            found[f"{name}_a_visit"] = figure(_quotient(a.mean(), b.mean()), drawn)
        return found

    def result(self, others):
        """Everything for the JSON file; ``others``: agents to compare with."""
        strokes = sum(len(s.points) for s in self.strokes)
        return {
            "figures": self.figures(),
            "ratios": {other.agent.label: self.ratios(other) for other in others},
            "counted": {name: float(self.counted[name].sum(axis=1).mean()) for name in BELOW},
            "longest_break": int(self.counted["points"].max()),
            "by_run": {f"{name}_a_visit": self.counted[name].mean(axis=1).tolist() for name in SCORES},
            "strokes": strokes,
            "ms_a_decision": 1e3 * sum(s.decision_seconds for s in self.strokes) / strokes,
        }
