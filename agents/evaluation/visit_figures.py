"""What do the strokes of many visits say of a player? Counts of each visit, and figures that are ratios of their sums."""

from typing import Any

import numpy as np

from snooker_env.benchmark.playing import PlayedStrokes
from snooker_env.benchmark.statistics import adjust
from snooker_env.game import POT_WINDOWS, VALUES, BallOn, layout

CENTURY, MAXIMUM = 100, 147
"""Points of a century break, and of the largest with 15 reds."""
EASY = POT_WINDOWS["easy"][0]
HIGH = 6
"""Pink and black are colours of high value."""
FIGURES = {
    **{f"{name}_a_visit": (name, "visits") for name in ("points", "adjusted", "pots", "fouls")},
    **{name: (name, "visits") for name in ("centuries", "maximums", "clearances")},
    "pot_rate": ("pots", "strokes"),
    "next_pot_after_a_pot": ("followed", "goes_on"),
    "easy_pot_left_by_a_pot": ("easy", "goes_on"),
    "colour_value": ("colour_points", "colours"),
    "high_colours": ("high", "colours"),
    "high_colour_after_a_red": ("high_after_red", "reds"),
}
"""Each is a ratio of two sums over visits, see ``counts``. "adjusted": points less luck."""


def find_next(s: PlayedStrokes):
    """Index of the next stroke of the same visit; -1 after its last: int64 (n,)."""
    order = np.lexsort((s.number, s.visit))
    same = np.diff(s.visit[order]) == 0
    following = np.full(len(order), -1)
    following[order[:-1][same]] = order[1:][same]
    return following


def counts(s: PlayedStrokes) -> dict[str, Any]:
    """Points, pots, fouls and more of each visit (visits,): both terms of every ratio of ``FIGURES``."""
    scored = s.points > 0
    goes_on, next_points = scored & ~s.cleared, np.append(s.points, 0.0)[find_next(s)]  # 0 after the last
    red, colour = scored & (s.ball_on == BallOn.RED), scored & (s.ball_on == BallOn.ANY_COLOUR)
    entries = {
        "points": s.points,
        "pots": scored,
        "strokes": np.ones(len(s.points)),
        "fouls": s.foul,
        "goes_on": goes_on,
        "followed": goes_on & (next_points > 0),
        "easy": goes_on & (s.tolerance >= EASY),
        "colours": colour,
        "colour_points": colour * s.points,
        "high": colour & (s.points >= HIGH),
        "reds": red,
        "high_after_red": red & (next_points >= HIGH),
        "clearances": scored & s.cleared,  # a foul clears no table
    }
    sums = {name: s.a_visit(values) for name, values in entries.items()}
    sums["adjusted"] = adjust(sums["points"][None], s.a_visit(s.luck)[None])[0]
    for name, least in (("centuries", CENTURY), ("maximums", MAXIMUM)):
        sums[name] = (sums["points"] >= least).astype(float)
    return sums | {"visits": np.ones(s.visits)}


def summary(strokes: PlayedStrokes) -> dict[str, Any]:
    """Mean figures of visits by name, None where a mean has no cases. Names that end in "_se" are standard errors over visits."""
    each = counts(strokes)
    totals = {name: float(values.sum()) for name, values in each.items()}
    means: dict[str, Any] = {
        name: totals[above] / totals[below] if totals[below] else None
        for name, (above, below) in (FIGURES | {"foul_rate": ("fouls", "strokes")}).items()
        if name not in ("maximums", "easy_pot_left_by_a_pot", "high_colour_after_a_red")
    }
    for name in ("pots", "points", "adjusted", "fouls"):
        spread = float(np.std(each[name], ddof=1) / np.sqrt(strokes.visits)) if strokes.visits > 1 else None
        means[f"{name}_a_visit_se"] = spread
    longest = int(each["points"].max())
    return {"visits": strokes.visits, "strokes": len(strokes.points), **means, "longest_break": longest}


def most_points(name: str) -> int:
    """The most points of a visit on a layout."""
    _, on_table = layout(name, np.random.default_rng(0))
    reds, colours = int(on_table[1:16].sum()), int(VALUES[16:] @ on_table[16:])
    return colours + reds * (8 if colours else 1)
