"""How are the visits of an evaluation cut into parts, and put together again?

Every player is made anew for each part and told which of all tables it has, so that whatever it draws is what it would draw with all
tables at once. The parts always have ``SIZE`` visits: the last bits of a network's product depend on how many rows it has, and one
machine and many are to agree to the last bit.
"""

from typing import Any

import numpy as np

from commands.physics_option import physics_option
from snooker_env.benchmark import Strokes, play_visits

from ..cluster.job import Part
from .travel import arrived

SIZE = 100
"""Visits of a part."""
COLUMNS = ("visit", "number", "points", "foul", "ball_on", "cleared", "cue", "tolerance")


def parts_of(shared, k, condition, seeds, budget, rekey):
    """The parts of the run ``k`` of an agent, whose data are named ``shared``, under a condition."""
    same = {"k": k, "condition": condition, "budget": budget, "rekey": rekey, "total": len(seeds)}
    return [Part(f"{__name__}:play", shared, same | {"first": n, "seeds": list(seeds[n : n + SIZE])}) for n in range(0, len(seeds), SIZE)]


def play(shared, args, threads):
    """The task: the strokes of some visits, a dict of arrays."""
    k, seeds, first = args["k"], args["seeds"], args["first"]
    player: Any = arrived(shared, args["budget"], k)
    if hasattr(player, "tables_of"):  # it draws for all tables at once, and must know which of them it has
        player.tables_of(first, args["total"])
    if args["rekey"]:
        player = Rekeyed(player, k, first, args["total"])
    options = args["condition"] | {"physics": physics_option(args["condition"]["physics"])}
    strokes = play_visits(player, len(seeds), first_seed=seeds, threads=threads, **options)
    columns = {name: getattr(strokes, name) for name in COLUMNS}
    return columns | {"seconds": np.float64(strokes.decision_seconds), "simulated": np.int64(strokes.simulated)}


def joined(results, total):
    """The ``Strokes`` of all visits from the results of their parts, in the order in which one machine plays them at once."""
    columns = {name: np.concatenate([one[name] for one in results]) for name in COLUMNS}
    columns["visit"] = np.concatenate([one["visit"] + SIZE * n for n, one in enumerate(results)])
    order = np.lexsort((columns["visit"], columns["number"]))
    seconds, simulated = (sum(one[name].item() for one in results) for name in ("seconds", "simulated"))
    return Strokes(total, *(columns[name][order] for name in COLUMNS), decision_seconds=seconds, simulated=simulated)


class Rekeyed:
    """A player whose tables get new random streams after each of its decisions: whoever saw its errors coming would lose by it.

    ``seed``: of the new streams; ``first``, ``total``: which of all tables these are.
    """

    def __init__(self, player, seed, first, total):
        self._player, self.options, self._rng = player, player.options, np.random.default_rng(seed)
        self._first, self._total = first, total

    def act(self, tables, observations, going):
        """The player's own actions."""
        actions = self._player.act(tables, observations, going)
        streams = tables.tables.streams
        drawn = self._rng.integers(0, 2**63, (self._total, streams.shape[1]), dtype=np.uint64)
        streams[:] = drawn[self._first : self._first + len(streams)]
        return actions
