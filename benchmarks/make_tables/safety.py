"""Where do the tables of the layout "safety" come from? From frames of the tactician against itself: they are positions
without a likely pot.

A position is kept if a red is the ball on (to be struck first) and can be struck, no direct pot is likelier than 40 %, at
least three reds and the six colours are on the table, the cue ball is not in hand, and there is no free ball. Each frame
gives at most three positions. The later half of the tables is held out; no frame has tables in both halves.
"""

import numpy as np

from snooker_env import MatchVectorEnv
from snooker_env.game.balls import REDS_MASK, BallOn
from snooker_env.game.snookered import is_snookered
from snooker_env.planning import Positions, prospects_of
from snooker_env.players import FRAMES, ask_player, decision_seeds, player

PLAYER = "tactician_30"
"""The player on both sides."""
RULES = {"task": "frame", "noise": "professional", "cue": "real", "miss": "clear_path", **FRAMES}
LIKELY = 0.4
"""Chance of a direct pot, by its width, above which a position is not kept."""
REDS, SIDE_BY_SIDE, A_FRAME = 3, 32, 3
"""Minimum reds; frames played side by side; maximum positions kept per frame."""


def calls_for_safety(at, spread, rails):
    """Whether to keep each position: bool (n,)."""
    kept = (at.ball_on == BallOn.RED) & ~at.in_hand & ~at.free_ball & ~at.choice
    kept &= at.on_table[:, 16:].all(axis=1) & (at.on_table[:, 1:16].sum(axis=1) >= REDS)
    kept &= prospects_of(at, spread, most=16, rails=rails)[1].max(axis=1) <= LIKELY
    for k in np.flatnonzero(kept):
        kept[k] = not is_snookered(at.positions[k], at.on_table[k], REDS_MASK)[0]
    return kept


def play_frames(first, many):
    """The kept positions of each of ``many`` frames with seeds from ``first`` on: (22, 2) each, with NaN for balls off the
    table."""
    tables = MatchVectorEnv(many, **RULES)
    rules, seeds = tables.options.rules, np.arange(first, first + many)
    spread, who = rules.noise.spread(rules.physics), player(PLAYER).at(tables)
    tables.reset(seed=first)
    found, going, number = [[] for _ in range(many)], np.ones(many, bool), 0
    while going.any():
        at, rows = Positions.of(tables), np.flatnonzero(going)
        for k in rows[calls_for_safety(at[rows], spread, rules.rails)].tolist():
            found[k].append(np.where(at.on_table[k][:, None], at.positions[k], np.nan))
        actions = ask_player(who, tables, going, decision_seeds(first, seeds, number))
        _, _, terminated, truncated, _ = tables.step(actions)
        # with fewer reds, no later position is kept
        going &= ~(terminated | truncated) & (tables.tables.on_table[:, 1:16].sum(axis=1) >= REDS)
        number += 1
    tables.close()
    return found


def some_of(tables, rng):
    """At most ``A_FRAME`` of a frame's tables, all different, because balls may have been replaced after a miss."""
    different = list({table.tobytes(): table for table in tables}.values())
    chosen = rng.permutation(len(different))[:A_FRAME]
    return [different[k].astype(np.float32) for k in sorted(chosen.tolist())]


def in_halves(frames, size):
    """``size`` tables of frames [[table, ...], ...], half of them from earlier frames than the rest; fewer if there are
    not enough."""
    made = []
    for tables in frames:
        across = len(made) < size // 2 < len(made) + len(tables)
        made += tables[: size // 2 - len(made)] if across else tables
    return made[:size]


def make(size, seed):
    """Tables (size, 22, 2), and the frames played."""
    rng = np.random.default_rng(seed)
    frames, tables = [], []
    while len(tables) < size:
        first = 1_000_000 * seed + len(frames)
        frames += [some_of(found, rng) for found in play_frames(first, SIDE_BY_SIDE)]
        tables = in_halves(frames, size)
    return np.array(tables), len(frames)
