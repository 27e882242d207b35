"""Who plays a visit with the discrete action? The yardsticks: random play and the widest pot; and how well any player does on given tables.

A player is an object with ``act(tables, going) -> int64 (n,)``: a choice (``envs.choices``) for each of the n tables of a
``SnookerVectorEnv`` made with action="discrete". Only the tables ``going`` matter, the others get 0.

python -m agents.players ghost_ball --visits 200
"""

import argparse
import json
import time

import gymnasium
import numpy as np

from snooker_env._check import choice
from snooker_env.envs.choices import SIDES, SIZE, SPEEDS, STROKES, TOPS

CENTURY = 100
"""Points of a visit that count as a century break."""


def choice_of(pot, speed, side, top):
    """The choice with these indices into ``POTS`` widest pots, ``SPEEDS``, ``SIDES`` and ``TOPS``."""
    return pot * STROKES + (speed * len(SIDES) + side) * len(TOPS) + top


class Random:
    """Any choice of the mask, each as likely."""

    def __init__(self, seed=0):
        self._rng = np.random.default_rng(seed)

    def act(self, tables, going):
        """A random choice for each table that is going."""
        order = self._rng.random((tables.num_envs, SIZE))
        return np.where(going, np.argmax(np.where(tables.action_masks(), order, -1.0), axis=1), 0)


class GhostBall:
    """The widest direct pot, without spin, at one speed: no thought of where the cue ball goes."""

    def __init__(self, speed=2.3):
        self._stroke = choice_of(0, SPEEDS.index(speed), SIDES.index(0.0), TOPS.index(0.0))

    def act(self, tables, going):
        """The same stroke at every table's widest pot."""
        return np.where(going, self._stroke, 0).astype(np.int64)


def play(player, visits, *, layout="held_out", noise="professional", first_seed=1_000_000, fidelity="standard"):
    """Figures of ``visits`` visits played side by side, seeds ``first_seed`` and on: the same tables for every player.

    What is played on a table after its visit has ended does not count.
    """
    env = gymnasium.make_vec(
        "Snooker-v0", visits, vectorization_mode="vector_entry_point", action="discrete", layout=layout, noise=noise, fidelity=fidelity
    )
    env.reset(seed=first_seed)
    played = np.zeros((visits, 4))  # strokes, pots, points, fouls
    going = np.ones(visits, bool)
    while going.any():
        _, _, ended, _, info = env.step(player.act(env.unwrapped, going))
        played[going] += np.column_stack([going, info["points"] > 0, info["points"], info["foul"]])[going]
        going &= ~ended
    env.close()
    strokes, pots, points, fouls = played.T
    error = lambda x: float(np.std(x, ddof=1) / np.sqrt(visits)) if visits > 1 else float("nan")  # noqa: E731
    return {
        "visits": visits, "pots_a_visit": float(pots.mean()), "pots_a_visit_se": error(pots), "points_a_visit": float(points.mean()),
        "points_a_visit_se": error(points), "pot_rate": float(pots.sum() / strokes.sum()), "fouls_a_visit": float(fouls.mean()),
        "centuries": float(np.mean(points >= CENTURY)), "longest_break": int(points.max()), "strokes": int(strokes.sum()),
    }  # fmt: skip


def player_of(name, *, budget=2000, seed=0):
    """The player of that name."""
    from .search import Search  # it knows choice_of

    makers = {"random": lambda: Random(seed), "ghost_ball": GhostBall, "search": lambda: Search(budget, seed=seed)}
    return makers[choice("player", name, makers)]()


def main():
    """Play and print the figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("player", choices=("random", "ghost_ball", "search"))
    parser.add_argument("--visits", type=int, default=100)
    parser.add_argument("--budget", type=int, default=2000, help="shots that search may simulate for a decision")
    parser.add_argument("--noise", default="professional")
    parser.add_argument("--layout", default="held_out")
    parser.add_argument("--first-seed", type=int, default=1_000_000)
    parser.add_argument("--seed", type=int, default=0)
    args = parser.parse_args()
    began = time.perf_counter()
    figures = play(
        player_of(args.player, budget=args.budget, seed=args.seed), args.visits, layout=args.layout, noise=args.noise,
        first_seed=args.first_seed,
    )  # fmt: skip
    print(json.dumps(figures | {"seconds": round(time.perf_counter() - began, 1)}))


if __name__ == "__main__":
    main()
