"""How strong are the five opponents of the page? Every one against every other, each with its own errors.

    python -m benchmarks.levels [--frames 100] [--budget 100] [--seed 0] [--json FILE] [--out FOLDER]

Frames of snooker from the break with a real cue; half are opened by each. ``--budget`` cuts the simulated shots of a
stroke down to so many. Strengths are those of Bradley and Terry (``agents.tournament``), the first opponent's 1000; each
pair counts one drawn frame more. Intervals of the wins are Wilson's, 95 %.
"""

from itertools import combinations

import numpy as np

import snooker_env as sn
from snooker_env.advice.outcomes import wilson
from snooker_env.play.levels import LEVELS
from snooker_env.players import FRAMES, ask_player, decision_seeds
from snooker_env.players.opponents import PlayerOpponent
from snooker_env.tasks.frames import Frames, Seat

from ._common.command import Command, at_least, run, save_json

AT_ONCE, LONGEST = 50, 2000
ELO = 400.0 / np.log(10.0)


def player_of(level, budget):
    """The agent that plays as this level, with at most so many simulated shots for a stroke."""
    kind, _, shots = level.agent.rpartition("_")
    return sn.player(f"{kind}_{min(int(shots), budget)}" if shots.isdigit() else level.agent)


def count_wins(one, other, frames, budget, seed):
    """How many of so many frames the first of two levels wins."""
    game = sn.Options(task="frame", cue="real", miss="clear_path", **FRAMES)
    rules = [game.but(noise=level.noise) for level in (one, other)]
    agent, opponent = (player_of(each, budget).at(own) for each, own in zip((one, other), rules, strict=True))
    won = 0
    for first in range(0, frames, AT_ONCE):
        seeds = np.arange(first, min(frames, first + AT_ONCE)) + seed
        tables = sn.SnookerVectorEnv(
            len(seeds), rules[0], opponent=player_of(other, budget), autoreset_mode="Disabled"
        )
        seats = Seat.of(rules[0].rules), Seat.of(rules[1].rules, PlayerOpponent(opponent, other.name))
        assert isinstance(tables.tables, Frames)
        tables.tables.sit(seats)
        _, info = tables.reset(seed=seeds.tolist(), options={"breaker": seeds % 2})
        winners = info["winner"].copy()
        for decision in range(LONGEST):
            going = winners < 0
            if not going.any():
                break
            draws = decision_seeds(0, seeds, np.full(len(seeds), decision))
            actions = ask_player(agent, tables, going, draws)
            _, _, ended, stopped, info = tables.step(actions.astype(np.float32))
            winners = np.where(going, info["winner"], winners)
            if (done := ended | stopped).any():  # a frame that nobody looks at goes on there
                tables.reset(options={"reset_mask": done})
        won += int((winners == 0).sum())
        tables.close()
    return won


def fit_elo(wins, frames):
    """Elo of n players from ``wins`` (n, n), the first one's 1000: the maximum of the likelihood, by its fixed point."""
    wins = wins + 0.5 * (1 - np.eye(len(wins)))
    strength = np.ones(len(wins))
    for _ in range(10_000):
        pairs = (wins + wins.T) / (strength[:, None] + strength)
        strength = wins.sum(axis=1) / pairs.sum(axis=1)
        strength /= strength[0]
    return 1000.0 + ELO * np.log(strength)


def main():
    parser = Command("levels", __doc__, seed=0)
    for name, least, what in (
        ("frames", 2, "frames of each pair"),
        ("budget", 30, "most shots for a stroke"),
    ):
        parser.add_argument(f"--{name}", type=at_least(least), default=100, metavar="N", help=f"{what} [100]")
    args = parser.options()
    n, wins = len(LEVELS), np.zeros((len(LEVELS), len(LEVELS)))
    for a, b in combinations(range(n), 2):
        won = count_wins(LEVELS[a], LEVELS[b], args.frames, args.budget, args.seed)
        wins[a, b], wins[b, a] = won, args.frames - won
        low, high = (100 * end for end in wilson(won, args.frames))
        share = 100 * won / args.frames
        print(f"{LEVELS[a].name} beats {LEVELS[b].name} in {share:.0f} % [{low:.0f}, {high:.0f}]", flush=True)
    elo = fit_elo(wins, args.frames).round().astype(int).tolist()
    for level, value in zip(LEVELS, elo, strict=True):
        print(f"{level.name}: {value}")
    names = [level.name for level in LEVELS]
    save_json(args.json, {"names": names, "wins": wins.astype(int).tolist(), "elo": elo})
    return 0


if __name__ == "__main__":
    run(main)
