"""How are the visits of an evaluation split into parts and joined again?

A player's strokes depend only on positions and seeds, and the seeds only on the table and the decision. Together,
the parts therefore equal the result of one machine.
"""

from typing import Any

import numpy as np

from agents._lib.physics_option import physics_option
from snooker_env.benchmark.playing import PlayedStrokes, play_visits

from .travel import unpack

SIZE = 100
"""Visits per part."""
COLUMNS = ("visit", "number", "points", "foul", "ball_on", "cleared", "cue", "tolerance", "luck")


def parts_of(sent, k, condition, seeds) -> list[tuple[dict, dict[str, Any]]]:
    """The parts of run ``k`` of an agent, from ``travel.pack``, under a condition."""
    same = {"k": k, "condition": condition}
    return [(sent, same | {"seeds": list(seeds[n : n + SIZE])}) for n in range(0, len(seeds), SIZE)]


def play(shared, args, threads):
    """Run a part: the strokes of some visits as a dict of arrays."""
    k, seeds = args["k"], args["seeds"]
    options = args["condition"] | {"physics": physics_option(args["condition"]["physics"])}
    options |= {"first_seed": seeds, "seed": k, "threads": threads}
    strokes = play_visits(unpack(shared), len(seeds), **options)
    columns = {name: getattr(strokes, name) for name in COLUMNS}
    return columns | {"seconds": np.float64(strokes.decision_seconds)}


def join_parts(results, total):
    """Join the parts to the ``PlayedStrokes`` of all visits, in the order in which one machine plays them."""
    columns = {name: np.concatenate([one[name] for one in results]) for name in COLUMNS}
    columns["visit"] = np.concatenate([one["visit"] + SIZE * n for n, one in enumerate(results)])
    order = np.lexsort((columns["visit"], columns["number"]))
    seconds = sum(one["seconds"].item() for one in results)
    return PlayedStrokes(total, *(columns[name][order] for name in COLUMNS), decision_seconds=seconds)
