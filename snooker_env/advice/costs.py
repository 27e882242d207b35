"""What do strokes cost a player? Points of a frame lost by potting, position and safety (docs/play/coach.md)."""

import numpy as np

from .._lib.types import Floats, Ints
from ..planning import Positions, Proposals, Search, pots
from ..planning.proposals import Asking, strokes_at
from ..planning.sobol import sobol_points
from ..planning.worth import lead_of, pass_after_miss
from .practice import JUDGING, Practice, join, keys, one_position
from .recorded import Recorded

PARTS = ("potting", "position", "safety")
SAMPLES = 24  # how often the best stroke at a called pot is played
SLOW, FAST, TIP = 0.8, 4.5, 0.35
"""Of the strokes tried there: cue speeds [m/s], the largest height of the tip over R."""


def count_costs(strokes: list[Recorded], bench: Practice, seed: int) -> tuple[Floats, Ints]:
    """Points lost against the errors of ``bench``, (n, 3) by ``PARTS``; how many strokes tell each, (3,)."""
    parts, counts = np.zeros((len(strokes), 3)), np.zeros(3, np.int64)
    known = [k for k, one in enumerate(strokes) if one.after is not None]
    at = {k: one_position(strokes[k].position, strokes[k].scores) for k in known}
    worths = judge_worth(bench, [at[k] for k in known])
    left = value_strokes(bench, [strokes[k] for k in known])
    for k, worth, value in zip(known, worths, left, strict=True):
        one = strokes[k]
        if one.ball is None:
            parts[k, 2] = worth - value
            counts[2] += 1
            continue
        best = play_best_pot(bench, at[k], one, seed) if one.potted is not None else None
        if best is None:
            continue
        p, made, missed = best
        parts[k, 0] = (p - bool(one.potted)) * (made - missed)
        parts[k, 1 if one.potted else 2] = (made if one.potted else missed) - value
        counts += [1, bool(one.potted), not one.potted]
    return parts, counts


def judge_worth(bench: Practice, at: list[Positions]) -> Floats:
    """What positions of frames are worth to their strikers (n,)."""
    return np.asarray(bench.judge.worth(join(at)), np.float64) if at else np.empty(0)


def value_strokes(bench: Practice, strokes: list[Recorded]) -> Floats:
    """What strokes were worth as they came (n,): points, and the worth of what they left."""
    out = np.array([float(one.points - one.penalty) for one in strokes])
    going = [k for k, one in enumerate(strokes) if one.after is not None and not one.after.over]
    after = []
    for one in (strokes[k] for k in going):
        scores = one.scores[0] + one.points, one.scores[1] + one.penalty
        scores = tuple(min(score, 1000) for score in (scores if one.goes_on else scores[::-1]))
        after.append(one_position(one.after, scores))
    signs = np.array([1.0 if strokes[k].goes_on else -1.0 for k in going])
    out[going] += signs * judge_worth(bench, after)
    return out


def play_best_pot(
    bench: Practice, at: Positions, one: Recorded, seed: int
) -> tuple[float, float, float] | None:
    """The target's best stroke at the called pot: chance, worth if made and if missed; None if not direct."""
    direct, judge = pots(at, 16), bench.judge
    which = np.flatnonzero((direct.ball[0] == one.ball) & (direct.pocket[0] == one.pocket))
    if not len(which):
        return None

    def at_the_pot(asking: Asking, at: Positions, m: int, seeds: Ints) -> Proposals:
        u = sobol_points(m, 2, seed)
        tips = np.column_stack([SLOW * (FAST / SLOW) ** u[:, 0], np.zeros(m), TIP * (2.0 * u[:, 1] - 1.0)])
        return strokes_at(at, np.full((1, m), which[0]), tips[None], asking.spread, asking.dynamics)

    (ranked,) = Search(judge, propose=at_the_pot).rank(at, [seed])
    best = ranked.strokes[ranked.kinds == 0][:1].values
    if not len(best):
        return None
    many = 1 if bench.sure else SAMPLES
    stops = bench.play(at, np.zeros(many, np.int64), np.repeat(best, many, 0), keys(seed, JUDGING, many))
    went = (stops.potted[:, one.ball] == one.pocket) & (stops.penalty == 0)
    if not went.any():
        return None
    worth = judge.value_of(np.repeat(lead_of(at), many), stops.afterstates)[:, 1]
    # where it is never missed: a miss would leave the balls about as they lie
    left = float(worth[~went].mean()) if not went.all() else -float(judge.worth(pass_after_miss(at))[0])
    return float(went.mean()), float(worth[went].mean()), left
