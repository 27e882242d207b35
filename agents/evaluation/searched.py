"""What does a search do in positions of its own visits? A task: some tables are played for some rounds, each decision is written down."""

from typing import Any

import numpy as np

from commands.physics_option import physics_option
from snooker_env import SnookerVectorEnv
from snooker_env.planning import Positions

from ..cluster.job import Part
from .travel import arrived

TABLES, ROUNDS = 16, 8
"""Tables of a part and decisions on each: a part has the product of them as positions."""
KEPT = 10
"""The most strokes of a decision that are kept, best first; where there are fewer, the rest is NaN."""


def parts_of(positions, seed, condition, budget):
    """Parts with so many positions, rounded up to whole ones. ``condition``: layout, noise, fidelity and physics."""
    many = -(-positions // (TABLES * ROUNDS))
    same = {"condition": condition, "budget": budget, "seed": seed}
    return [Part(f"{__name__}:play", "search", same | {"first": k * TABLES}) for k in range(many)]


def play(shared, args, threads):
    """The task.

    Returns of n positions "positions" float64 (n, 22, 2) [m], "on_table" bool (n, 22) and "game" int64, as of ``Positions``; "actions"
    float32 (n, KEPT, 4) of ``aim="absolute"`` and "scores" float32 (n, KEPT) [points].
    """
    player: Any = arrived(shared, args["budget"], args["seed"])
    first: int = args["first"]
    player.tables_of(first, first + TABLES)
    options = args["condition"] | {"physics": physics_option(args["condition"]["physics"])}
    tables = SnookerVectorEnv(TABLES, threads=threads, autoreset_mode="Disabled", **player.options, **options)
    seeds = np.random.SeedSequence([args["seed"], first]).generate_state(TABLES).tolist()
    seen, _ = tables.reset(seed=seeds)
    everyone, rounds = np.ones(TABLES, bool), []
    again: list[int | None] = [None] * TABLES
    for _ in range(ROUNDS):
        at = Positions.of(tables).copy()
        actions, scores = np.full((TABLES, KEPT, 4), np.nan, np.float32), np.full((TABLES, KEPT), np.nan, np.float32)
        for k, (some, worth) in enumerate(player.rank(tables, seen, everyone)):
            actions[k, : len(some[:KEPT])], scores[k, : len(some[:KEPT])] = some[:KEPT], worth[:KEPT]
        rounds.append({"positions": at.positions, "on_table": at.on_table, "game": at.game, "actions": actions, "scores": scores})
        seen, _, ended, stopped, _ = tables.step(actions[:, 0])
        if (done := ended | stopped).any():
            seen, _ = tables.reset(seed=again, options={"reset_mask": done})
    tables.close()
    return {name: np.concatenate([one[name] for one in rounds]) for name in rounds[0]}
