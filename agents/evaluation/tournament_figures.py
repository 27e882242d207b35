"""Which figures follow from the frames of a tournament? Wins, breaks, fouls and strengths, with intervals.

All figures follow from the rows. The bootstrap resamples seeds: the two matches on one seed, one opened by each
player, stay together, and all pairs with the same number of seeds have the same seeds in each sample. Intervals are
95 % percentile intervals (``snooker_env.benchmark``). A share of 0 % or 100 % has the exact one-sided bound instead,
with each seed counted once.

Strengths are those of Bradley and Terry [Biometrika 39 (1952) 324]: player i beats j with probability
p_ij = 1 / (1 + exp(t_j - t_i)), a draw is half a win for each, and the t maximise the sum of w_ij log p_ij over
all pairs, where w_ij counts the wins of i over j. With 0 % or 100 % wins there is no maximum, so each pair that met
gets ``PRIOR`` additional drawn matches. One unit of strength is 400 / ln 10 points of Elo: 400 points more mean ten
wins for one loss.
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from snooker_env.benchmark.statistics import RESAMPLES, Resamples, adjust, figure

from .metrics import add_bound

PRIOR = 1.0
"""Drawn matches added to each pair that met."""
ELO = 400.0 / np.log(10.0)
"""Points of Elo per unit of strength."""
SMALLEST = 1e-10
"""The fit ends when no player's expected share of wins differs from the actual share by more than this."""
LONGEST = 2.0
"""Longest step of Newton's method in a strength; a longer one could overshoot far from the maximum."""
ROUNDS = 200
KEYS = ("first", "second", "seed", "opener", "frame", "winner")
"""First columns of a row: indices of the players; seed; which of them broke off in the match's first frame (0 or 1); the
frame's index in the match; its winner, or -1 if it was stopped."""
COUNTED = ("points", "scored", "visits", "strokes", "fouls", "best")
"""Counts for each player: points, points of its own pots, visits, strokes, fouls, points of its best visit."""
COLUMNS = (*KEYS, *(f"{name}_{side}" for name in COUNTED for side in KEYS[:2]), "luck")
"""All columns of a row. The last one is the first player's luck in the frame, in ``PARTS`` of a frame."""
PARTS = 1000
ANCHOR_ELO = 1000.0
"""Elo of the anchor."""
RATIOS = {
    "points_a_frame": ("points", "frames"),
    "average_break": ("scored", "visits"),
    "fouls_a_frame": ("fouls", "frames"),
    "strokes_a_frame": ("strokes", "frames"),
}
"""Figures of a player that are ratios of two sums over all its frames."""


@dataclass
class PlayedPair:
    """The frames of two players, summed for each seed; ``sums``: name -> float (2, seeds), one row per player."""

    players: tuple
    sums: dict
    opened: np.ndarray
    """Wins of each player in the matches that it opened, (2, seeds)."""
    draws: int
    stopped: int
    best: tuple

    @classmethod
    def of(cls, players, rows):
        """Make this from the rows (n, len(COLUMNS)) of the pair."""
        column = {name: rows[:, c] for c, name in enumerate(COLUMNS)}
        seeds, at = np.unique(column["seed"], return_inverse=True)
        m = len(seeds)

        def total(values, where=None):
            return np.bincount(at if where is None else at[where], values, m)

        sides = [(column["winner"] == side) + 0.5 * (column["winner"] < 0) for side in (0, 1)]
        lead = np.zeros((2, m))  # frames of the match, by its opener
        np.add.at(lead, (column["opener"], at), sides[0] - sides[1])
        won = 0.5 * (1.0 + np.sign(lead))  # the first player's
        sums = {"won": np.stack([won.sum(0), (1.0 - won).sum(0)]), "matches": np.full((2, m), 2.0)}
        sums["frames_won"] = np.stack([total(side) for side in sides])
        sums["frames"] = np.stack([total(np.ones(len(rows)))] * 2)
        luck = total(column["luck"]) / PARTS
        adjusted = adjust(sums["won"][:1], luck[None])[0]
        sums["adjusted"] = np.stack([adjusted, 2.0 - adjusted])
        for name in COUNTED:
            sums[name] = np.stack([total(column[f"{name}_{side}"]) for side in KEYS[:2]])
        opened = np.stack([won[0], 1.0 - won[1]])
        best = tuple(int(column[f"best_{side}"].max()) for side in KEYS[:2])
        return cls(players, sums, opened, int((lead == 0).sum()), int((column["winner"] < 0).sum()), best)

    @property
    def seeds(self):
        """The number of seeds played."""
        return self.opened.shape[1]

    def samples(self, values, resamples):
        """Bootstrap samples of the sum of ``values`` (seeds,)."""
        return Resamples(1, self.seeds, resamples).sums(values[None])


def pairs_of(rows):
    """The ``PlayedPair`` of every pair in the rows, in order."""
    table = np.array(rows, np.int64).reshape(-1, len(COLUMNS))
    pairs = sorted({(int(a), int(b)) for a, b in table[:, :2]})
    return [PlayedPair.of(pair, table[(table[:, :2] == pair).all(1)]) for pair in pairs]


def _share(won, matches, drawn, seeds):
    """A share with its interval, or with the exact bound for this many seeds if it is 0 % or 100 %."""
    return add_bound(figure(won / matches, drawn), seeds)


def figures_of(labels, rows, anchor, resamples=RESAMPLES):
    """All figures of a tournament.

    "players": for each label "matches", "frames", "won", "drawn", "win_rate" (the mean over its opponents),
    "adjusted" (win_rate less luck), "frame_rate", "elo", "elo_by_prior", the ratios of ``RATIOS`` and "highest_break".
    "pairs": for each pair "first", "second", "matches", "won", "drawn", "win_rate" and "adjusted" of the first player,
    and "when_opening", the win rate of each in the matches that it opened. "opener": the share of matches won by the player
    who opened them; "stopped": number of stopped frames. A figure is {"value", "low", "high"}.
    """
    pairs = pairs_of(rows)
    elo = _elo(pairs, len(labels), labels.index(anchor), resamples)
    players = {}
    for k, label in enumerate(labels):
        mine = [(pair, pair.players.index(k)) for pair in pairs if k in pair.players]
        players[label] = _player(mine, resamples) | elo[k] if mine else None
    shares = [_pair(pair, labels, resamples) for pair in pairs]
    many = sum(2 * pair.seeds for pair in pairs)
    drawn = sum(pair.samples(pair.opened.sum(0), resamples) for pair in pairs) / many
    opener = _share(sum(pair.opened.sum() for pair in pairs) / many, 1.0, drawn, many / 2)
    stopped = sum(pair.stopped for pair in pairs)
    return {"players": players, "pairs": shares, "opener": opener, "stopped": stopped}


def _player(mine, resamples):
    """The figures of a player in these pairs, each given with the player's place in it."""
    sums, drawn = {}, {}
    for pair, side in mine:
        for name, values in pair.sums.items():
            sums[name] = sums.get(name, 0.0) + values[side].sum()
            drawn[name] = drawn.get(name, 0.0) + pair.samples(values[side], resamples)
    seeds = sum(pair.seeds for pair, _ in mine)
    figures = {"matches": int(sums["matches"]), "frames": int(sums["frames"]), "won": sums["won"]}
    figures["drawn"] = sum(pair.draws for pair, _ in mine)
    rates = (
        ("win_rate", "won", "matches"),
        ("adjusted", "adjusted", "matches"),
        ("frame_rate", "frames_won", "frames"),
    )
    for name, won, many in rates:
        shares = [pair.sums[won][side].sum() / pair.sums[many][side].sum() for pair, side in mine]
        drawn_of = lambda sums, pair, side: pair.samples(pair.sums[sums][side], resamples)  # noqa: E731
        samples = [drawn_of(won, pair, side) / drawn_of(many, pair, side) for pair, side in mine]
        figures[name] = _share(np.mean(shares), 1.0, np.mean(samples, axis=0), seeds)
    for name, (above, below) in RATIOS.items():
        known = bool(sums[below])
        drawn_ratio = drawn[above] / drawn[below] if known else [np.nan]
        figures[name] = figure(sums[above] / sums[below] if known else np.nan, drawn_ratio)
    return figures | {"highest_break": max(pair.best[side] for pair, side in mine)}


def _pair(pair, labels, resamples):
    """The figures of two players against each other."""
    won, matches, n = pair.sums["won"], pair.sums["matches"][0].sum(), pair.seeds
    opening = [_share(wins.sum(), n, pair.samples(wins, resamples) / n, n) for wins in pair.opened]
    first, second = (labels[k] for k in pair.players)
    made = {"first": first, "second": second, "matches": int(matches), "won": float(won[0].sum())}
    made |= {"drawn": pair.draws, "when_opening": opening}
    adjusted = pair.sums["adjusted"][0]
    made["adjusted"] = figure(adjusted.sum() / matches, pair.samples(adjusted, resamples) / matches)
    return made | {"win_rate": _share(won[0].sum(), matches, pair.samples(won[0], resamples) / matches, n)}


def _elo(pairs, k, anchor, resamples):
    """For each of k players, "elo" and whether only the prior determines its distance from the anchor."""
    wins, drawn, seeds = np.zeros((k, k)), np.zeros((resamples, k, k)), np.zeros((k, k))
    for pair in pairs:
        for (i, j), values in zip((pair.players, pair.players[::-1]), pair.sums["won"], strict=True):
            wins[i, j], seeds[i, j] = values.sum(), pair.seeds
            drawn[:, i, j] = pair.samples(values, resamples)
    met = find_reachable(seeds > 0, anchor)
    here = np.flatnonzero(met)
    at = int(np.searchsorted(here, anchor))
    among = np.ix_(here, here)
    both = strengths(np.concatenate([wins[None], drawn])[(slice(None), *among)], PRIOR)
    elo = ANCHOR_ELO + ELO * (both - both[:, at : at + 1])
    sound = find_comparable(wins[among], at)
    all_elo = [{"elo": figure(np.nan, [np.nan]), "elo_by_prior": True} for _ in range(k)]
    for j, i in enumerate(here):
        mine = figure(elo[0, j], elo[1:, j])
        if not sound[j]:
            mine |= _bounds(elo[0], j, sound, wins[among], seeds[among])
        all_elo[i] = {"elo": mine, "elo_by_prior": not sound[j]}
    return all_elo


def _bounds(elo, j, sound, wins, seeds):
    """ "low" and "high" of a player that won or lost all matches against players comparable with the anchor."""
    others = np.flatnonzero(sound & (seeds[j] > 0))
    strength, many = elo[others] / ELO, seeds[j, others]
    if not wins[others, j].any():
        low = float(ELO * bound(strength, many))
        return {"low": low if np.isfinite(low) else None, "high": None}
    high = float(-ELO * bound(-strength, many))
    return {"low": None, "high": high if np.isfinite(high) else None}


def schedule(labels):
    """All pairs of players."""
    return list(combinations(range(len(labels)), 2))


def strengths(wins, prior=PRIOR):
    """The strengths (..., k) of k players, with mean 0, for one or many tables of wins.

    ``wins[..., i, j]`` counts how often i beat j, draws as halves. The pairs that met must link all players.
    """
    w = np.array(wins, np.float64)
    k = w.shape[-1]
    first = w.reshape(-1, k, k)[0]
    w = w + 0.5 * prior * ((first + first.T) > 0)
    n = w + np.swapaxes(w, -1, -2)
    many, t = np.maximum(n.sum(-1), 1e-300), np.zeros(w.shape[:-1])
    for _ in range(ROUNDS):
        p = chance(t[..., :, None] - t[..., None, :])
        slope = w.sum(-1) - (n * p).sum(-1)
        if np.abs(slope / many).max(initial=0.0) < SMALLEST:
            break
        curve = n * p * (1.0 - p)
        bend = -curve + 1.0 / k  # keep the mean at 0
        bend[..., range(k), range(k)] += curve.sum(-1)
        step = np.linalg.solve(bend, slope[..., None])[..., 0]
        longest = np.abs(step).max(-1, keepdims=True)
        t += step * np.minimum(1.0, LONGEST / np.maximum(longest, LONGEST))
    return t - t.mean(-1, keepdims=True)


def chance(ahead):
    """The chance to win of a player whose strength exceeds the other's by ``ahead``."""
    return 0.5 * (1.0 + np.tanh(0.5 * np.asarray(ahead, np.float64)))


def find_reachable(edges, start):
    """Which players (k,) can be reached from one (itself included) along ``edges`` (k, k)."""
    reached = np.zeros(len(edges), bool)
    reached[start] = True
    for _ in range(len(edges)):
        reached |= edges[reached].any(0)
    return reached


def find_comparable(wins, anchor):
    """Which players (k,) won and lost against the anchor, directly or through others, so that results compare them."""
    won = np.asarray(wins) > 0
    return find_reachable(won, anchor) & find_reachable(won.T, anchor)


def bound(others, matches, level=0.95):
    """The smallest strength of a player that won all its matches (m,) against players of strengths (m,).

    At this strength, winning all has probability 1 - level. For a player that lost all, negate strengths and bound.
    """
    others, matches = np.asarray(others, np.float64), np.asarray(matches, np.float64)
    if matches.sum() <= 0:
        return -np.inf
    low, high = others.min() - 50.0, others.max() + 50.0
    for _ in range(100):
        middle = 0.5 * (low + high)
        likely = (matches * np.log(np.maximum(chance(middle - others), 1e-300))).sum() > np.log(1.0 - level)
        low, high = (low, middle) if likely else (middle, high)
    return 0.5 * (low + high)
