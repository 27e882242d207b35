"""What is counted in the visits that an agent played, and which figures follow? Each with its interval, and relative to another agent's."""

import zlib
from dataclasses import dataclass

import numpy as np

from snooker_env.game import POT_WINDOWS, BallOn

from .entrants import Entrant
from .rollouts import CENTURY, MAXIMUM, Strokes
from .statistics import Resamples, interval, iqm

EASY = POT_WINDOWS["easy"][0]
HIGH = 6
"""Pink and black are colours of high value."""
FIGURES = {
    "points_a_visit": ("points", "visits"),
    "pots_a_visit": ("pots", "visits"),
    "fouls_a_visit": ("fouls", "visits"),
    "centuries": ("centuries", "visits"),
    "maximums": ("maximums", "visits"),
    "clearances": ("clearances", "visits"),
    "pot_rate": ("pots", "strokes"),
    "next_pot_after_a_pot": ("followed", "goes_on"),
    "easy_pot_left_by_a_pot": ("easy", "goes_on"),
    "colour_value": ("colour_points", "colours"),
    "high_colours": ("high", "colours"),
    "high_colour_after_a_red": ("high_after_red", "reds"),
}
"""Each is a ratio of two sums over visits, see ``counts``."""
BELOW = sorted({below for _, below in FIGURES.values()})
"""What figures are a share or a mean of: how often there was any, a run, is kept with them."""
SCORES = ("points", "pots")
"""Of these there are inter-quartile means and ratios to other agents, too."""


def counts(s: Strokes):
    """What is counted in each visit: name -> (visits,)."""
    next_points = np.append(s.points, 0.0)[s.following]  # of the stroke after; 0 after the last
    red = s.made & (s.ball_on == BallOn.RED)
    colour = s.made & s.colour
    entries = {
        "points": s.points, "pots": s.made, "strokes": np.ones(len(s.points)), "fouls": s.foul, "goes_on": s.goes_on,
        "followed": s.goes_on & (next_points > 0), "easy": s.goes_on & (s.tolerance >= EASY), "colours": colour,
        "colour_points": colour * s.points, "high": colour & (s.points >= HIGH), "reds": red, "high_after_red": red & (next_points >= HIGH),
        "clearances": s.clears,
    }  # fmt: skip
    sums = {name: s.a_visit(values) for name, values in entries.items()}
    breaks = {"centuries": sums["points"] >= CENTURY, "maximums": sums["points"] >= MAXIMUM}
    return sums | {"visits": np.ones(s.visits)} | {name: made.astype(float) for name, made in breaks.items()}


def figure(value, samples):
    """A figure with its interval; None where there is none."""
    low, high = interval(samples)
    return {"value": _number(value), "low": _number(low), "high": _number(high)}


def _number(x):
    return float(x) if np.isfinite(x) else None


def _quotient(above, below):
    return above / below if below else float("nan")


@dataclass
class EntrantMetrics:
    """What one agent did under one condition: the counts of every run and visit, name -> (runs, visits)."""

    agent: Entrant
    counted: dict
    strokes: list
    """The ``Strokes`` of every run."""
    resamples: int

    @property
    def _samples(self):
        runs, visits = self.counted["points"].shape
        return Resamples(runs, visits, self.resamples, zlib.crc32(self.agent.label.encode()))

    def figures(self):
        """All figures of this agent alone."""
        samples, c = self._samples, self.counted
        found = {
            name: figure(_quotient(c[a].sum(), c[b].sum()), samples.ratios(c[a], c[b])) for name, (a, b) in FIGURES.items()
        }  # fmt: skip
        for name in SCORES:
            found[f"{name}_a_visit_iqm"] = figure(iqm(c[name]), samples.iqms(c[name]))
        return found

    def ratios(self, other):
        """This agent's scores over another's on the same tables."""
        mine, its, found = self._samples, other._samples, {}
        for name in SCORES:
            a, b = self.counted[name], other.counted[name]
            above, below = mine.sums(a) / mine.sums(np.ones_like(a)), its.sums(b) / its.sums(np.ones_like(b))
            drawn = np.divide(above, below, out=np.full(len(above), np.nan), where=below != 0)
            found[f"{name}_a_visit"] = figure(_quotient(a.mean(), b.mean()), drawn)
        return found

    def result(self, others):
        """Everything for the JSON file; ``others``: whom to compare with."""
        strokes = sum(len(s.points) for s in self.strokes)
        return {
            "figures": self.figures(), "ratios": {other.agent.label: self.ratios(other) for other in others},
            "counted": {name: float(self.counted[name].sum(axis=1).mean()) for name in BELOW},
            "longest_break": int(self.counted["points"].max()),
            "by_run": {f"{name}_a_visit": self.counted[name].mean(axis=1).tolist() for name in SCORES},
            "strokes": strokes, "ms_a_decision": 1e3 * sum(s.decision_seconds for s in self.strokes) / strokes,
        }  # fmt: skip
