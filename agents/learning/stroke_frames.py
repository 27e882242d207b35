"""How is a part of a round of frames played for ``stroke_value``, and what are its strokes worth? In each of its positions,
some of the strokes that it considers are simulated with execution errors. The ``tactician``'s worth (expected points minus
the opponent's) judges the positions that they leave."""

import numpy as np

from snooker_env import Options
from snooker_env.planning.learned.frame_strokes import FrameStrokes
from snooker_env.players import FRAMES
from snooker_env.players import player as snooker_player
from snooker_env.players.search_player import Tactician
from snooker_env.players.stroke_value_player import StrokeValuePlayer

from .frame_self_play import play_frames


def try_frames(learned, noise, cue, seeds, other, tried, rng, threads):
    """Play frames from the tables ``seeds``, with the layers ``learned``, against ``other``: the name of a player, or None for
    itself, in which case both sides count. ``tried``: numbers of best strokes (by estimate) and of others tried, errors for
    each, the share of strokes played that are not the best, and the number of best strokes from which these come.

    Returns the features of the strokes tried, float16 (n, k, SIZE), their worth [points], float32 (n, k), and the seeds of
    the tables (n,)."""
    best, others, errors, explore, among = tried
    options = Options(task="frame", **FRAMES, cue=cue, miss="clear_path", noise=noise)
    known = options.but(conditions="fixed")  # a player does not know the constants of a table
    player, judge = StrokeValuePlayer(learned).at(known), Tactician().at(known).judge
    search: FrameStrokes = player.search
    for value in (search.values.value, search.worth.value):
        value.threads = threads
    rows = []

    def act(tables, mine, at, keys):
        strokes, compared, start = player.decide_frames(at, keys)
        here = [k for k, one in enumerate(compared) if one is not None and len(one.strokes) >= best + others]
        if here:
            looked = search.look(start[here], keys[here])
            scores = np.where(looked.there, search.scores(looked.seen), -np.inf)
            order, every = np.argsort(-scores, axis=1, kind="stable"), np.arange(len(here))[:, None]
            picks = order[:, : best + others]
            for j, count in enumerate(looked.there.sum(axis=1).tolist()):
                picks[j, best:] = rng.choice(order[j, best:count], others, replace=False)
            which = np.repeat(np.arange(len(here)), picks.shape[1] * errors)
            trials = np.repeat(looked.strokes[every, picks].reshape(-1, 5), errors, axis=0)
            met = judge.noise.draw_errors(rng, len(which))
            worth = judge.gains(start[here], which, trials, met)[:, 1].reshape(*picks.shape, errors)
            seen = looked.seen[every, picks].astype(np.float16)
            rows.append((seen, worth.mean(axis=2).astype(np.float32), seeds[mine[here]]))
        for k, one in enumerate(compared):
            if one is not None and rng.random() < explore:
                strokes.values[k] = one.strokes.values[rng.integers(min(among, len(one.strokes)))]
        return strokes

    against = None if other is None else snooker_player(other).at(known)
    play_frames(options.rules, int(seeds[0]), len(seeds), act, against, threads)
    return tuple(map(np.concatenate, zip(*rows, strict=True)))
