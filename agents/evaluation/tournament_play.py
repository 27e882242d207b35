"""How do two players meet? In many frames side by side; each seed is played twice, opened once by each player.

In one of the two matches on a seed the first player is the environment's agent, in the other the second is. The
roles differ slightly: for a player without placement, a cue ball in hand stays at its usual place (agent) or goes
where "ghost_ball" would put it (opponent). On even seeds the agent opens, on odd ones the opponent. A table whose
match has ended takes the next one; when half of the tables have no match left, the others continue in a smaller
environment. The frames of a match follow each other on one table, and the players break off in turn. The best of N
ends when one player has won more than N / 2, or after N frames. A table's draws depend only on its seed.

A visit is all consecutive strokes of a player, even across the lot at a re-spotted black.
"""

import copy
import time
import zlib
from dataclasses import dataclass, field

import numpy as np

from agents._lib.physics_option import physics_option
from snooker_env import Options, SnookerVectorEnv
from snooker_env.benchmark import count_shots
from snooker_env.benchmark.luck_counter import Luck
from snooker_env.players import FRAMES, ask_player, decision_seeds

from .tournament_figures import COUNTED, PARTS
from .travel import unpack

TABLES = 128
"""Tables side by side."""
CHUNK = 100
"""Seeds per chunk. Each chunk creates its players again; a tournament can be resumed between chunks."""


class TimedPlayer:
    """A player with counts of its ``decisions``, their total ``seconds`` and simulated ``shots``. ``seed`` is that of its
    draws."""

    def __init__(self, player, seed=0):
        self._player, self.seed = player, seed
        self.count = {"decisions": 0, "seconds": 0.0, "shots": 0}  # shared by all bound copies

    def at(self, rules):
        bound = copy.copy(self)
        bound._player = self._player.at(rules)
        return bound

    def play(self, positions, seeds):
        began, before = time.perf_counter(), count_shots()
        strokes = self._player.play(positions, np.asarray(seeds) ^ (self.seed & 0xFFFFFFFF))
        self.count["seconds"] += time.perf_counter() - began
        self.count["shots"] += count_shots() - before
        self.count["decisions"] += len(strokes)
        return strokes


@dataclass
class Encounter:
    """Some matches of two players, and the state of each table. Side 0 is the agent, side 1 the opponent.

    ``pair``: indices of the players; ``exchanged``: the second of them is the agent; ``queue``: seed and opening side
    of matches that no table has begun; ``rows``: one for each ended frame, columns ``COLUMNS``.
    """

    pair: tuple
    exchanged: bool
    queue: list
    best_of: int
    rows: list = field(default_factory=list)

    def __post_init__(self):
        n = min(TABLES, len(self.queue))
        self.unit = np.full((n, 2), -1)  # seed and opener
        self.frame, self.won = np.zeros(n, int), np.zeros((n, 2))
        self.sums = {name: np.zeros((n, 2), int) for name in COUNTED}
        # the agent's visit, and whether its next stroke begins a new one
        self.visit, self.fresh = np.zeros(n, int), np.ones(n, bool)
        self.played = np.zeros(n, int)  # strokes of both
        self.decision = np.zeros(n, int)  # the agent's, in this match
        for k in range(n):
            self.unit[k] = self.queue.pop(0)

    @property
    def going(self):
        """Tables that have a match."""
        return self.unit[:, 0] >= 0

    @property
    def breakers(self):
        """The side that breaks off in the frame of each table."""
        return np.where(self.going, (self.unit[:, 1] + self.frame) % 2, 0)

    def begun(self, which, info):
        """Record that frames have begun on the tables ``which`` (n,) bool; the opponent may have had a visit."""
        for values in (*self.sums.values(), self.visit, self.played):
            values[which] = 0
        self.fresh[which] = True
        self._opponent(which, info["opponent_score"], info["score"], info["opponent_strokes"])
        self._score(which, info)

    def step_all(self, which, info):
        """Record one step on the tables ``which`` (n,) bool."""
        struck = which & (info["strokes"] - self.played - info["opponent_strokes"] > 0)
        points, penalty = (np.where(struck, info[name], 0).astype(int) for name in ("points", "penalty"))
        gained = info["opponent_score"].astype(int) - self.sums["points"][:, 1] - penalty
        conceded = info["score"].astype(int) - self.sums["points"][:, 0] - points
        self.visit[struck & self.fresh] = 0
        self.visit += points
        self.sums["visits"][:, 0] += struck & self.fresh
        self.sums["strokes"][:, 0] += struck
        self.sums["fouls"][:, 0] += struck & (info["fouls"] != 0)
        self.sums["scored"][:, 0] += points
        self._best(struck, 0, self.visit)
        self.fresh = np.where(struck, points == 0, self.fresh) | (which & (info["opponent_strokes"] > 0))
        self._opponent(which, gained, conceded, info["opponent_strokes"])
        self._score(which, info)

    def _opponent(self, which, scored, conceded, strokes):
        """Record one visit of the opponent, if it had any strokes; ``conceded``: points for its fouls."""
        struck = which & (strokes > 0)
        scored = np.where(struck, scored, 0).astype(int)
        self.sums["visits"][:, 1] += struck
        self.sums["strokes"][:, 1] += np.where(struck, strokes, 0)
        self.sums["fouls"][:, 1] += struck & (conceded > 0)  # a foul ends the visit
        self.sums["scored"][:, 1] += scored
        self._best(struck, 1, scored)

    def _best(self, which, side, points):
        best = self.sums["best"]
        best[which, side] = np.maximum(best[which, side], points[which])

    def _score(self, which, info):
        self.played[which] = info["strokes"][which]
        for side, name in enumerate(("score", "opponent_score")):
            self.sums["points"][which, side] = info[name][which]

    def take_up_next(self, which, info, luck):
        """Record the end of frames on the tables ``which`` (n,) bool: write rows and take the next frames. ``luck`` (n,) is the
        agent's luck in these frames, reset afterwards."""
        for k in np.flatnonzero(which).tolist():
            winner, (seed, opener) = int(info["winner"][k]), self.unit[k].tolist()
            sides = (1, 0) if self.exchanged else (0, 1)  # the pair's first player, then its second
            sums = [int(self.sums[name][k, side]) for name in COUNTED for side in sides]
            won = -1 if winner < 0 else sides[winner]
            its = round((-PARTS if self.exchanged else PARTS) * luck[k])
            self.rows.append([*self.pair, seed, sides[opener], int(self.frame[k]), won, *sums, its])
            self.won[k] += 0.5 if winner < 0 else [winner == 0, winner == 1]
            self.frame[k] += 1
            if self.frame[k] == self.best_of or self.won[k].max() > 0.5 * self.best_of:
                self.frame[k], self.won[k], self.decision[k] = 0, 0.0, 0
                self.unit[k] = self.queue.pop(0) if self.queue else -1

    def keep(self, which):
        """Continue only with the tables ``which`` (n,) bool."""
        self.sums = {name: values[which] for name, values in self.sums.items()}
        for name in ("unit", "frame", "won", "visit", "fresh", "played", "decision"):
            setattr(self, name, getattr(self, name)[which])


def play_pair(pair, players, game, seeds, best_of=1, threads=None, tick=None):
    """Play two matches on each seed. Returns one row per frame, columns ``COLUMNS``, by seeds, openers and frames.

    ``players``: those of the ``pair`` of indices; ``game``: options of the frames; ``threads`` do not change the
    result; ``tick`` is called with the number of matches that have ended.
    """
    rows = []
    for exchanged in (False, True):
        meeting = Encounter(pair, exchanged, [(seed, seed % 2) for seed in seeds], best_of)
        one, other = players[::-1] if exchanged else players
        before = len(seeds) * exchanged
        counted = tick and (lambda n, before=before: tick(before + n))
        _play(meeting, one, other, game, threads, counted)
        rows += meeting.rows
    return sorted(rows)


def seed_of_draws(label, other, first):
    """The seed of a player's draws against ``other`` in the matches from seed ``first`` on."""
    return zlib.crc32(f"{label}\n{other}\n{first}".encode())


def play(shared, args, threads, tick=None):
    """Run a part, a pair on some seeds. Returns rows and each player's decisions, their time [s] and simulated shots.

    ``shared``: "players", of ``travel.pack``. ``args``: "pair" (indices), "seeds" of the matches, "draws"
    (each player's ``seed_of_draws``), "game" as in the file, "best_of"; ``tick`` is that of ``play_pair``.
    """
    both = zip(args["pair"], args["draws"], strict=True)
    players = [TimedPlayer(unpack(shared["players"][k]), seed) for k, seed in both]
    game = args["game"] | {"physics": physics_option(args["game"]["physics"])}
    rows = play_pair(tuple(args["pair"]), players, game, args["seeds"], args["best_of"], threads, tick)
    counted = {name: np.array([player.count[name] for player in players]) for name in players[0].count}
    return {"rows": np.array(rows, np.int64), **counted}


def _play(meeting, agent, opponent, game, threads, tick):
    """Play all matches of an encounter."""
    options = Options(task="frame", **FRAMES, **game)
    agent = agent.at(options)
    matches, ended = len(meeting.queue) + len(meeting.frame), 0
    tables = _tables(meeting, options, opponent, threads)
    luck = Luck(tables, "won")
    _, info = tables.reset(seed=meeting.unit[:, 0].tolist(), options={"breaker": meeting.breakers})
    meeting.begun(meeting.going, info)
    # after the reset, because only then does a state surely await a stroke
    moved = np.zeros(len(meeting.frame), bool)
    over = info["winner"] >= 0  # won by the opponent in its first visit, so the next step plays nothing
    while (going := meeting.going).any():
        to_play = going & ~over
        actions = ask_player(agent, tables, to_play, decision_seeds(0, meeting.unit[:, 0], meeting.decision))
        meeting.decision += 1
        luck.note(to_play, actions.astype(np.float32))
        _, _, terminated, truncated, info = tables.step(actions.astype(np.float32))
        meeting.step_all(going, info)
        done = terminated | truncated
        moved, over = ~done, np.zeros(len(done), bool)
        if done.any():
            before = meeting.unit.copy()
            meeting.take_up_next(going & done, info, luck.sums)
            luck.sums[done], luck.counts[:] = 0.0, meeting.going
            over = _renew(tables, meeting, done, before)
        now = matches - len(meeting.queue) - int(meeting.going.sum())
        if tick is not None and now != ended:
            tick(now)
        ended = now
        if 0 < (left := meeting.going).mean() <= 0.5 and moved[left].all():
            states = [state for state, some in zip(tables.get_state(), left, strict=True) if some]
            tables.close()
            meeting.keep(left)
            tables, sums = _tables(meeting, options, opponent, threads), luck.sums[left]
            luck = Luck(tables, "won")
            luck.sums[:] = sums
            _, info = tables.reset(options={"states": states})
            over = np.zeros(len(states), bool)
    tables.close()


def _tables(meeting, options, opponent, threads):
    how = {"threads": threads, "autoreset_mode": "Disabled"}
    return SnookerVectorEnv(len(meeting.frame), options, opponent=opponent, **how)


def _renew(tables, meeting, done, before):
    """Begin the next frames on tables whose frames have ended. Returns the tables whose next frame ended at once.

    A new match is dealt from its seed. In a later frame, and on tables without a match, the random numbers continue.
    """
    anew = (meeting.unit != before).any(1) & meeting.going
    seeds = [int(seed) if new else None for seed, new in zip(meeting.unit[:, 0], anew, strict=True)]
    _, info = tables.reset(seed=seeds, options={"reset_mask": done, "breaker": meeting.breakers})
    meeting.begun(done & meeting.going, info)
    return done & (info["winner"] >= 0)
