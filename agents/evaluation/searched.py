"""What does a search do in positions of its own visits? A task: tables are played, each decision is noted."""

from typing import Any

import numpy as np

from commands.physics_option import physics_option
from snooker_env import SnookerVectorEnv
from snooker_env.planning import Positions
from snooker_env.players import VISITS, Strokes, decision_seeds

from ..cluster.job import Part
from .travel import arrived

TABLES, ROUNDS = 16, 8
"""Tables of a part and decisions on each: a part has the product of them as positions."""
KEPT = 10
"""The most strokes of a decision that are kept, best first; where there are fewer, the rest is NaN."""


def parts_of(positions, seed, condition):
    """Parts with so many positions, rounded up; ``condition``: layout, noise, fidelity and physics."""
    many = -(-positions // (TABLES * ROUNDS))
    same = {"condition": condition, "seed": seed}
    return [Part(f"{__name__}:play", "search", same | {"first": k * TABLES}) for k in range(many)]


def play(shared, args, threads):
    """The task.

    Returns of n positions "positions" float64 (n, 22, 2) [m], "on_table" bool (n, 22) and "game" int64, as of
    ``Positions``; "strokes" float32 (n, KEPT, 5), as ``Strokes.values``; "scores" float32 (n, KEPT) [points].
    """
    first: int = args["first"]
    options = args["condition"] | {"physics": physics_option(args["condition"]["physics"])}
    tables = SnookerVectorEnv(TABLES, threads=threads, autoreset_mode="Disabled", **VISITS, **options)
    player: Any = arrived(shared).at(tables)
    seeds = np.random.SeedSequence([args["seed"], first]).generate_state(TABLES).tolist()
    tables.reset(seed=seeds)
    rounds = []
    again: list[int | None] = [None] * TABLES
    for decision in range(ROUNDS):
        at = Positions.of(tables)
        ranked = player.rank(at, decision_seeds(args["seed"], first + np.arange(TABLES), decision))
        strokes = np.full((TABLES, KEPT, 5), np.nan, np.float32)
        scores = strokes[..., 0].copy()
        for k, one in enumerate(ranked):
            m = min(KEPT, len(one.strokes))
            strokes[k, :m], scores[k, :m] = one.strokes.values[:m], one.scores[:m]
        seen = {"positions": at.positions, "on_table": at.on_table, "game": at.game}
        rounds.append(seen | {"strokes": strokes, "scores": scores})
        played = Strokes.join([one.strokes[:1] for one in ranked]).actions(tables.options, at)
        _, _, ended, stopped, _ = tables.step(played.astype(np.float32))
        if (done := ended | stopped).any():
            tables.reset(seed=again, options={"reset_mask": done})
    tables.close()
    return {name: np.concatenate([one[name] for one in rounds]) for name in rounds[0]}
