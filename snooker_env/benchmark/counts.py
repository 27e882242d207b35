"""What is counted in the visits that an agent played, and which figures follow? Each a ratio of two sums over visits, with its interval."""

from typing import Any

import numpy as np

from .._types import Floats
from ..game.balls import BallOn
from ..game.layouts import POT_WINDOWS
from .rollouts import CENTURY, MAXIMUM, Strokes
from .statistics import interval

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


def counts(s: Strokes) -> dict[str, Floats]:
    """Count points, pots, strokes, fouls and more in each visit.

    Parameters
    ----------
    s : Strokes
        All strokes of the visits.

    Returns
    -------
    dict of str to float64 (visits,)
        The numbers of each visit, among them both terms of every ratio of ``FIGURES``.

    Examples
    --------
    >>> import numpy as np
    >>> from snooker_env.benchmark import counts, play_visits
    >>> class Soft:
    ...     options = {}
    ...     def act(self, tables, observations, going):
    ...         return np.full((len(going), 4), -1.0)
    >>> counts(play_visits(Soft(), 2, layout="colours"))["visits"].tolist()
    [1.0, 1.0]
    """
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


def figure(value: float, samples: Any) -> dict[str, float | None]:
    """A figure with its 95 % bootstrap interval.

    Parameters
    ----------
    value : float
        The figure.
    samples : array_like, float (n,)
        Bootstrap samples of it.

    Returns
    -------
    dict
        "value", "low" and "high"; None where a number is not finite.

    Examples
    --------
    >>> from snooker_env.benchmark import figure
    >>> figure(0.5, [0.5, 0.5])
    {'value': 0.5, 'low': None, 'high': None}
    """
    low, high = interval(samples)
    return {"value": _number(value), "low": _number(low), "high": _number(high)}


def _number(x):
    return float(x) if np.isfinite(x) else None
