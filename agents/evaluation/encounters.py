"""How are the matches of a tournament played in parts? A part is a pair of players and at most a hundred seeds; its result are its rows."""

import zlib

import numpy as np

from commands.physics_option import physics_option

from ..cluster.job import Job, Part
from .tournament_figures import schedule
from .tournament_play import TimedPlayer, play_pair
from .travel import arrived, sent


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


def drawn(label, other, first):
    """The seed of what a player draws in the matches against the label ``other`` from the seed ``first`` on."""
    return zlib.crc32(f"{label}\n{other}\n{first}".encode())


def play_on(tournament, cluster, tick=None, saved=None):
    """Play all parts of a tournament that are not in its rows yet on a cluster; the rows are those of ``Tournament.play``.

    Parameters
    ----------
    tournament : Tournament
        It gets the rows and the times.
    cluster : Cluster
        That was joined.
    tick : callable, optional
        Called with the number of matches that have ended.
    saved : callable, optional
        Called after each part.
    """
    labels, p = tournament.labels, tournament.protocol
    order = {pair: k for k, pair in enumerate(schedule(labels))}

    def ended(part, result):
        tournament.rows += result["rows"].tolist()
        tournament.rows.sort(key=lambda row: (order[tuple(row[:2])], row[2:5]))
        for k, decisions, seconds in zip(part.given["pair"], result["decisions"].tolist(), result["seconds"].tolist(), strict=True):
            tournament.times[k][0] += decisions
            tournament.times[k][1] += seconds
        if tick is not None:
            tick(tournament.ended)
        if saved is not None:
            saved()

    parts = []
    for pair, seeds in tournament.left:
        draws = [drawn(labels[k], labels[other], seeds[0]) for k, other in (pair, pair[::-1])]
        parts.append(part_of(pair, seeds, draws, tournament.game, p["best_of"], p["search_budget"]))
    job = Job(parts, {"players": {"players": [sent(entrant, 0) for entrant in tournament.entrants]}}, cluster, tick=ended)
    try:
        job.finish()
    except BaseException:  # what had ended is kept, whatever stopped the rest
        job.keep_finished()
        raise
