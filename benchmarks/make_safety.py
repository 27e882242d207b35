"""Where do the layouts "safety" and "escape" come from? Frames of the tactician against itself, from which the
positions are kept in which no pot is on. Writes ``game/safety.npz`` and ``game/escape.npz``.

    python -m benchmarks.make_safety [--tables 1024] [--player tactician_30] [--seed 0] [--json FILE] [--out FOLDER]

A position is kept if a red is on, the six colours are on the table, the cue ball is not in hand and no ball is
free: for "safety" if a red can be struck and no direct pot is likelier than 30 %, for "escape" if the cue ball is
snookered on every red. Of a frame at most three of each kind are kept. The later half of the tables is held out; no
frame has tables in both halves.
"""

import io

import numpy as np

from snooker_env import MatchVectorEnv
from snooker_env.game.balls import REDS_MASK, BallOn
from snooker_env.game.banks import FOLDER
from snooker_env.game.snookered import is_snookered
from snooker_env.planning import Positions, prospects_of, spread_of
from snooker_env.players import decided, decision_seeds, player

from ._common.command import Command, at_least, run, save_bytes, save_json

RULES = {"task": "frame", "noise": "professional", "cue": "real", "miss": "clear_path", "elevation": True}
LIKELY = 0.3
"""Chance of a direct pot, by its width, above which a position is none for a safety."""
SIDE_BY_SIDE, A_FRAME = 32, 3
"""Frames that are played side by side, and the most positions of one kind that are kept of one."""
KINDS = ("safety", "escape")


def kinds_of(at, spread, rails):
    """Which of ``KINDS`` each position is, -1 for none: int64 (n,)."""
    plain = (at.ball_on == BallOn.RED) & ~at.in_hand & ~at.free_ball & ~at.choice & at.on_table[:, 16:].all(1)
    likeliest = prospects_of(at, spread, most=16, rails=rails)[1].max(axis=1)
    kinds = np.where(plain & (likeliest <= LIKELY), 0, -1)
    for k in np.flatnonzero(plain):
        if is_snookered(at.positions[k], at.on_table[k], REDS_MASK)[0]:
            kinds[k] = 1
    return kinds


def played(name, first, many):
    """Of each of ``many`` frames with seeds from ``first`` on, the positions of each kind: [[table, ...], ...] each,
    (22, 2) with NaN for balls that are not on the table."""
    tables = MatchVectorEnv(many, **RULES)
    rules, seeds = tables.options.rules, np.arange(first, first + many)
    spread, who = spread_of(rules.noise, rules.physics), player(name).at(tables)
    tables.reset(seed=first)
    found = [[[] for _ in KINDS] for _ in range(many)]
    going, number = np.ones(many, bool), 0
    while going.any():
        rows = np.flatnonzero(going)
        at = Positions.of(tables)[rows]
        for k, kind in zip(rows, kinds_of(at, spread, rules.rails), strict=True):
            if kind >= 0:
                here = tables.tables.on_table[k][:, None]
                found[k][kind].append(np.where(here, tables.tables.positions[k], np.nan))
        actions = decided(who, tables, going, decision_seeds(first, seeds, number))
        _, _, terminated, truncated, _ = tables.step(actions)
        # without a red no position to come is of a kind
        going &= ~(terminated | truncated) & tables.tables.on_table[:, 1:16].any(axis=1)
        number += 1
    tables.close()
    return found


def some_of(tables, rng):
    """At most ``A_FRAME`` of a frame's tables, all different: a miss may have been replaced."""
    different = list({table.tobytes(): table for table in tables}.values())
    chosen = rng.permutation(len(different))[:A_FRAME]
    return [different[k].astype(np.float32) for k in sorted(chosen)]


def halves(frames, size):
    """``size`` tables of frames [[table, ...], ...]: half of them, then half of later frames; None if too few."""
    made = []
    for tables in frames:
        if len(made) < size // 2 <= len(made) + len(tables):
            tables = tables[: size // 2 - len(made)]
        made += tables
    return made[:size] if len(made) >= size else None


def main():
    """Command line."""
    parser = Command("make_safety", __doc__, files=[f"{kind}.npz" for kind in KINDS], folder=FOLDER, seed=0)
    parser.add_argument("--tables", type=at_least(2), default=1024, help="so many of each kind [1024]")
    parser.add_argument("--player", default="tactician_30", help="who plays both sides [tactician_30]")
    options = parser.options()
    rng = np.random.default_rng(options.seed)
    frames, first = {kind: [] for kind in KINDS}, 1000 * options.seed
    banks = dict.fromkeys(KINDS)
    while not all(banks.values()):
        for found in played(options.player, first, SIDE_BY_SIDE):
            for kind, tables in zip(KINDS, found, strict=True):
                frames[kind].append(some_of(tables, rng))
        first += SIDE_BY_SIDE
        banks = {kind: halves(frames[kind], options.tables) for kind in KINDS}
        print(
            {kind: sum(map(len, some)) for kind, some in frames.items()},
            "of",
            len(frames[kind]),
            "frames",
            flush=True,
        )
    for kind, bank in banks.items():
        packed = io.BytesIO()
        np.savez_compressed(packed, positions=np.array(bank))
        save_bytes(options.folder / f"{kind}.npz", packed.getvalue())
        print(f"{len(bank)} tables -> {options.folder / f'{kind}.npz'}")
    counts = {
        "seed": options.seed,
        "player": options.player,
        "tables": options.tables,
        "frames": len(frames[KINDS[0]]),
    }
    save_json(options.json, counts)


if __name__ == "__main__":
    run(main)
