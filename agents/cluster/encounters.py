"""How are the matches of a tournament played in parts? A part is a pair of players and at most a hundred seeds; its result are its rows."""

import numpy as np

from commands.physics_option import physics_option

from ..evaluation.tournament_play import TimedPlayer, play_pair
from .job import Part
from .travel import arrived


def part_of(pair, seeds, players, game, best_of, budget):
    """The part in which a pair meets on these seeds.

    Parameters
    ----------
    pair : (int, int)
        Indices of the players.
    seeds : list of int
        Of the matches.
    players : list of int
        For each of the two, the seed of what it draws.
    game : dict
        Options of the frames, as they stand in the file.
    best_of, budget : int
        Frames of a match, and simulated shots a decision of a search.

    Returns
    -------
    Part
    """
    given = {"pair": list(pair), "seeds": list(seeds), "draws": list(players), "game": game, "best_of": best_of, "budget": budget}
    return Part("encounters", "players", given)


def play(shared, given, threads):
    """The task: one row for each frame, and each player's decisions and their time [s]."""
    sent = [shared["players"][k] for k in given["pair"]]
    players = tuple(
        TimedPlayer(arrived(agent, given["budget"], seed)) for agent, seed in zip(sent, given["draws"], strict=True)
    )  # fmt: skip
    game = given["game"] | {"physics": physics_option(given["game"]["physics"])}
    rows = play_pair(tuple(given["pair"]), players, game, given["seeds"], given["best_of"], threads)
    return {
        "rows": np.array(rows, np.int64), "decisions": np.array([player.decisions for player in players]),
        "seconds": np.array([player.seconds for player in players]),
    }  # fmt: skip
