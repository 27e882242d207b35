"""Which rows can be of one episode? What the rules of snooker allow: points with so many pots, and limits of a frame."""

from functools import lru_cache

from ..tasks.options import MAX_STROKES
from .tasks import Task

SEQUENCE = (0, 2, 5, 9, 14, 20, 27)
"""Points of the first colours from yellow on, when the reds are gone."""
MOST_PENALTY, LEAST_PENALTY = 7, 4
MOST_OF_POTS = 155 + 7
"""Points that the pots of both players can make in one frame: a free ball and 147, and a black spotted again."""
FEWEST_IF_STOPPED = 20
"""Fewest strokes of the agent in a frame of ``MAX_STROKES``: between two of them the opponent has one visit, of at most 40 strokes."""


def faults_of_row(k: int, r: dict[str, int], task: Task) -> list[str]:
    """What cannot be of one episode, a line each.

    Parameters
    ----------
    k : int
        Index of the row, for the lines.
    r : dict of int
        The row by column.
    task : Task

    Returns
    -------
    list of str
    """
    said = []

    def must(sound, name, what):
        if not sound:
            said.append(f"rows[{k}].{name} = {r[name]}: must be {what}")

    must(r["strokes"] >= 1, "strokes", "at least 1")
    must(0 <= r["pots"] <= r["strokes"], "pots", "between 0 and the strokes")
    must(r["ended"] in (0, 1), "ended", "0 or 1")
    (_faults_of_frame if task.frame else _faults_of_visit)(r, task, must)
    return said


def _faults_of_frame(r, task, must):
    must(r["strokes"] <= MAX_STROKES, "strokes", f"at most {MAX_STROKES:,}: then the referee stops the frame")
    must(0 <= r["fouls"] <= r["strokes"] - r["pots"], "fouls", "between 0 and the strokes that scored nothing")
    most = MOST_OF_POTS + MOST_PENALTY * (MAX_STROKES - r["pots"] - r["fouls"])
    must(r["pots"] <= r["points"] <= most, "points", f"between the pots and {most:,}")
    least, most = LEAST_PENALTY * r["fouls"], MOST_OF_POTS + MOST_PENALTY * r["fouls"]
    must(least <= r["opponent_points"] <= most, "opponent_points", f"between {least:,} and {most:,} with these fouls")
    must(r["cleared"] == 0, "cleared", "0 in a frame")
    if r["ended"] == 0:
        must(
            r["strokes"] >= FEWEST_IF_STOPPED, "ended", f"1: no frame has {MAX_STROKES:,} strokes of both players with so few of the agent"
        )
    elif r["ended"] == 1:
        must(r["points"] != r["opponent_points"], "ended", "0: no frame ends at equal points")
    won = int(r["ended"] == 1 and r["points"] > r["opponent_points"])
    must(r["score"] == won, "score", f"{won}, as the frame ended")


def _faults_of_visit(r, task, must):
    must(r["opponent_points"] == 0, "opponent_points", "0 in a visit")
    must(r["ended"] == 1, "ended", "1 in a visit")
    must(r["fouls"] in (0, 1), "fouls", "0 or 1: a visit ends with its first foul")
    must(r["cleared"] in (0, 1 - r["fouls"]) and r["cleared"] <= r["pots"], "cleared", "1 only after a pot, without a foul")
    ways = _ways(task.judged_layout)
    possible = [low <= r["points"] <= high for pots, cleared, low, high in ways if (pots, cleared) == (r["pots"], r["cleared"])]
    must(possible, "cleared", "possible with these pots")
    must(not possible or any(possible), "points", "possible with these pots")
    if task.changes.get("one_stroke"):
        must(r["strokes"] == 1, "strokes", "1: the task is one stroke")
        must(r["pots"] + r["fouls"] <= 1, "fouls", "0 after a pot")
    else:
        must(r["strokes"] == r["pots"] + 1 - r["cleared"], "strokes", "the pots, and the stroke that ended the visit")
    want = {"points": r["points"], "pots": r["pots"], "legal": 1 - r["fouls"]}[task.score]
    must(r["score"] == want, "score", f"{want}, the {task.score} of the row")


@lru_cache(maxsize=8)
def _ways(layout):
    """What a visit can be: (pots, cleared, fewest points, most points).

    A stroke on a red scores as many as there fall, and 15 is enough for all; after each a colour of 2 to 7 points; then the six in order.
    """
    if layout == "pots:hard":  # one red, no colours
        return [(0, 0, 0, 0), (1, 1, 1, 1)]
    if layout == "colours":
        return [(j, int(j == 6), points, points) for j, points in enumerate(SEQUENCE)]
    among_reds = [(r + c, 0, r + 2 * c, min(15, 15 * r) + 7 * c) for r in range(16) for c in (r - 1, r) if c >= 0]
    after = [
        (2 * r + j, int(j == 6), 15 + 2 * r + points, 15 + 7 * r + points) for r in range(1, 16) for j, points in enumerate(SEQUENCE) if j
    ]
    return among_reds + after
