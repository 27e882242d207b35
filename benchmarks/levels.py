"""How strong are the five opponents of the page? Each plays the next, with its own errors.

    python -m benchmarks.levels [--frames 100] [--budget 100] [--seed 0] [--json FILE] [--out FOLDER]

They play frames of snooker from the break-off with a real cue; each opens half of the frames. ``--budget`` limits the
simulated shots of a stroke. The first opponent has an Elo of 1000. Each further Elo is the previous one plus 400 log10 of
wins over losses, with one drawn frame added. Intervals of the wins are Wilson's, 95 %.
"""

from itertools import pairwise
from math import log10

import numpy as np

import snooker_env as sn
from snooker_env.advice.outcomes import wilson
from snooker_env.play.levels import LEVELS
from snooker_env.players import FRAMES, ask_player, decision_seeds
from snooker_env.players.opponents import PlayerOpponent
from snooker_env.tasks.frames import Frames, Seat

from ._common.command import Command, at_least, run, save_figures

AT_ONCE, LONGEST = 50, 2000


def player_of(level, budget):
    """The agent of this level, with at most ``budget`` simulated shots per stroke."""
    kind, _, shots = level.agent.rpartition("_")
    return sn.player(f"{kind}_{min(int(shots), budget)}" if shots.isdigit() else level.agent)


def count_wins(one, other, frames, budget, seed):
    """Number of frames that the first of two levels wins."""
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
            if (done := ended | stopped).any():  # a frame without spectators continues there
                tables.reset(options={"reset_mask": done})
        won += int((winners == 0).sum())
        tables.close()
    return won


def main():
    parser = Command("levels", __doc__, seed=0)
    for name, least, what in (
        ("frames", 2, "frames per pair"),
        ("budget", 30, "maximum simulated shots per stroke"),
    ):
        parser.add_argument(f"--{name}", type=at_least(least), default=100, metavar="N", help=f"{what} [100]")
    args = parser.options()
    elo, wins = 1000.0, []
    for weaker, stronger in pairwise(LEVELS):
        won = args.frames - count_wins(weaker, stronger, args.frames, args.budget, args.seed)
        elo += 400.0 * log10((won + 0.5) / (args.frames - won + 0.5))
        low, high = (100 * end for end in wilson(won, args.frames))
        share = f"{100 * won / args.frames:.0f} % [{low:.0f}, {high:.0f}]"
        print(f"{stronger.name} beats {weaker.name} in {share}: {elo:.0f}", flush=True)
        wins.append({"stronger": stronger.name, "weaker": weaker.name, "won": won, "elo": round(elo)})
    save_figures(args, {"frames": args.frames, "budget": args.budget, "pairs": wins})
    return 0


if __name__ == "__main__":
    run(main)
