"""How are the matches of a tournament played in parts? A part is a pair of players and at most a hundred
seeds."""

import zlib

import numpy as np

from commands.physics_option import physics_option

from .tournament_play import TimedPlayer, play_pair
from .travel import arrived


def drawn(label, other, first):
    """The seed of what a player draws against the label ``other`` in the matches from the seed ``first``
    on."""
    return zlib.crc32(f"{label}\n{other}\n{first}".encode())


def play(shared, args, threads, tick=None):
    """The task: one row for each frame, and each player's decisions and their time [s].

    ``shared``: "players", of ``travel.sent``. ``args``: "pair" (indices), "seeds" of the matches, "draws"
    (for each of the two the seed of what it draws), "game" as it stands in the file, "best_of". ``tick`` is
    called with the number of matches that have ended.
    """
    agents = [shared["players"][k] for k in args["pair"]]
    players = tuple(
        TimedPlayer(arrived(agent), seed) for agent, seed in zip(agents, args["draws"], strict=True)
    )
    game = args["game"] | {"physics": physics_option(args["game"]["physics"])}
    rows = play_pair(tuple(args["pair"]), players, game, args["seeds"], args["best_of"], threads, tick)
    return {
        "rows": np.array(rows, np.int64),
        "decisions": np.array([player.decisions for player in players]),
        "seconds": np.array([player.seconds for player in players]),
    }
