"""What do tables that differ cost a player, and what is it worth to know them?

    python -m benchmarks.conditions [--players planner best_pot] [--ways fixed known cue average preset]
        [--noise LEVEL] [--physics PRESET] [--visits N] [--seed 0] [--json FILE] [--out FOLDER]

A player is a name or, as in ``agents.evaluate``, NAME=FOLDER of a training: a model, a run's folder, or a pattern
like "drawn=runs/drawn-?" for several seeds of it, whose visits are taken together.

Points a visit on opened tables, the same for all, with 95 % intervals by bootstrap over the visits and the
seeds of a training; beside them what a player makes more than the first one, visit by visit. A player
that knows its table plans with the constants drawn. One that does not plans with those of an average table,
the middle of each range, or with the preset's: aims, all that it foresees and, unless the cue is its own, the
squirt that it allows for. An agent that observes the constants is shown those that it knows.
"""

import copy

import numpy as np

import snooker_env as sn
from agents.evaluation.entrants import Entrant
from snooker_env.benchmark import interval, play_visits
from snooker_env.checks import refuse
from snooker_env.physics import conditions
from snooker_env.physics.parameters import physics_with
from snooker_env.planning import Positions
from snooker_env.planning.planner import options_in
from snooker_env.planning.stroke_columns import AIM, SIDE
from snooker_env.players import Strokes

from ._common.command import Command, at_least, run, save_json

FIRST_SEED = 4_000_000
"""Seed of the first table; ``--seed`` K takes the K-th million after it."""
NAMES = {
    "fixed": "fixed",
    "known": "drawn, knows the table",
    "cue": "drawn, average table, own cue",
    "average": "drawn, takes an average table",
    "preset": "drawn, takes the preset",
}
RESAMPLES = 2000


def squirt(side, ratio):
    """``physics.cue.squirt`` of arrays [rad]."""
    height = 1.0 - side * side
    return np.arctan(2.5 * side * np.sqrt(height) / (1.0 + ratio + 2.5 * height))


class Stranger:
    """A player on a table that it takes for one with the constants ``believed``; ``own``: the cue is its own,
    whose squirt it knows."""

    def __init__(self, player, believed, own):
        self.name, self.believed, self.own = player.name, believed, own
        self._player, self._bound = player, player

    def at(self, rules):
        """Bind it, see ``players.Player``."""
        bound = copy.copy(self)
        bound._bound = self._player.at(options_in(rules).but(conditions="fixed", physics=self.believed))
        return bound

    def play(self, positions, seeds):
        """What it does, see ``players.Player``."""
        at = Positions.of(positions)
        strokes = self._bound.play(at, seeds)
        if self.own:
            return strokes
        values, side = strokes.values.copy(), strokes.values[:, SIDE]
        assert at.conditions is not None  # the tables are drawn
        own = at.conditions[:, conditions.END_MASS_RATIO]
        # environments allow for the squirt of the cue that is held, and it for that of another
        values[:, AIM] += squirt(side, own) - squirt(side, self.believed.end_mass_ratio)
        return Strokes(values, *strokes.parts[1:])


def entrants(words):
    """{label: the players of its seeds, one or more} of the words after ``--players``. ValueError."""
    found = {}
    for word in words:
        one = Entrant.of(word)
        if one.label in found:
            raise refuse("players", word, f"must have a label of its own: {one.label} is another's")
        found[one.label] = [one.player(k) for k in range(len(one.runs))]
    return found


def resampled(made, rng):
    """Means (RESAMPLES,) of points (seeds, visits), over seeds and visits drawn again; visits by ``rng``."""
    runs, visits = made.shape
    which = rng.integers(0, visits, (RESAMPLES, visits))
    seeds = np.random.default_rng(1).integers(0, runs, (RESAMPLES, runs)) if runs > 1 else None
    means = np.stack([row[which].mean(axis=1) for row in made], axis=1)
    return (means if seeds is None else np.take_along_axis(means, seeds, axis=1)).mean(axis=1)


def points(player, way, noise, physics, visits, seed):
    """Points of each visit of a player, in one of the ways of ``NAMES``."""
    base = sn.Physics.preset(physics)
    middle = conditions.drawn(np.full(conditions.COLUMNS, 0.5))
    average = physics_with(base, middle)
    believed = {"cue": average, "average": average, "preset": base}
    if way in believed:
        player = Stranger(player, believed[way], own=way == "cue")
    played = play_visits(
        player,
        visits,
        layout="opened",
        noise=noise,
        first_seed=FIRST_SEED + 1_000_000 * seed,
        physics=physics,
        conditions="fixed" if way == "fixed" else "drawn",
    )
    return played.a_visit(played.points)


def main():
    """Play and print."""
    parser = Command("conditions", __doc__, seed=0)
    parser.add_argument(
        "--players",
        nargs="+",
        default=("planner", "best_pot"),
        metavar="PLAYER",
        help="who plays, a name or NAME=FOLDER [planner best_pot]",
    )
    parser.add_argument(
        "--ways", nargs="+", default=tuple(NAMES), choices=tuple(NAMES), help="on which tables [all]"
    )
    parser.add_argument("--noise", default="professional", help="execution errors [professional]")
    parser.add_argument("--physics", choices=("paper", "match"), default="match", help="the preset [match]")
    parser.add_argument("--visits", type=at_least(2), default=200, help="visits of each [200]")
    args = parser.options()
    try:
        players = entrants(args.players)
    except ValueError as error:
        parser.error(str(error))
    found, first = {}, next(iter(players))
    print(
        f"{'player':16s}{'constants':32s}{'points a visit':24s}" + f"more than {first}" * (len(players) > 1)
    )
    for way in dict.fromkeys(args.ways):
        means = {}
        for name, seeds in players.items():
            each = [points(one, way, args.noise, args.physics, args.visits, args.seed) for one in seeds]
            made = np.stack(each)
            # the same visits for all players; the seeds of each training apart
            means[name] = made.mean(), resampled(made, np.random.default_rng(0))
            found[f"{name}, {NAMES[way]}"] = made.tolist() if len(seeds) > 1 else made[0].tolist()
            line = f"{name:16s}{NAMES[way]:32s}{shown(*means[name]):24s}"
            if name != first:
                line += shown(*(mine - its for mine, its in zip(means[name], means[first], strict=True)))
            print(line.rstrip(), flush=True)
    save_json(args.json, found)
    return 0


def shown(mean, again):
    """A mean and the interval of its resamples, in words."""
    low, high = interval(again)
    return f"{mean:8.1f} [{low:.1f}, {high:.1f}]"


if __name__ == "__main__":
    run(main)
