"""Where do the tables of the layout "escape" come from? From the layout "snookered": those on which the plain escape,
``ghost_ball``'s, fails as often as not. Writes ``game/escape.npz``.

    python -m benchmarks.make_escape [--tables 1024] [--seed 0] [--json FILE] [--out FOLDER]

Each table meets a professional's execution errors many times, with a real cue. The later half of the tables is held
out.
"""

import io

import numpy as np

from snooker_env import SnookerVectorEnv
from snooker_env.game.banks import FOLDER
from snooker_env.players import VISITS, decided, decision_seeds, player

from ._common.command import Command, at_least, run, save_bytes, save_json

FILE = "escape.npz"
RULES = {"layout": "snookered", "reward": "legal", "one_stroke": True, "noise": "professional", "cue": "real"}
SIDE_BY_SIDE, MOST = 2000, 0.5
"""Tables at once, and the largest share of the strokes on one that may be fair."""
FIRST, TRIALS = 4, 16
"""Strokes on each table; where one of the first few is none, all of them."""


def fair_share(seeds, trials):
    """Of tables with these seeds: the tables (n, 22, 2), NaN for balls that are not there, and the share of so many plain
    escapes that are fair (n,)."""
    tables, fair = (
        SnookerVectorEnv(len(seeds), **RULES, **VISITS, autoreset_mode="Disabled"),
        np.zeros(len(seeds)),
    )
    tables.reset(seed=seeds.tolist())
    dealt = np.where(tables.tables.on_table[:, :, None], tables.tables.positions, np.nan)
    everywhere, plain = np.ones(len(seeds), bool), player("ghost_ball").at(tables)
    actions = decided(plain, tables, everywhere, decision_seeds(0, seeds, 0)).astype(np.float32)
    for trial in range(trials):
        tables.reset(seed=seeds.tolist())
        tables.tables.streams[:, 0] = decision_seeds(1, seeds, trial)  # other errors on the same table
        fair += tables.step(actions)[1]
    tables.close()
    return dealt, fair / trials


def failed(first):
    """The tables with seeds from ``first`` on that are kept: (k, 22, 2) float32."""
    seeds = np.arange(first, first + SIDE_BY_SIDE)
    doubtful = seeds[fair_share(seeds, FIRST)[1] < 1.0]
    dealt, share = fair_share(doubtful, TRIALS)
    return dealt[share <= MOST].astype(np.float32)


def main():
    """Command line."""
    parser = Command("make_escape", __doc__, files=(FILE,), folder=FOLDER, seed=0)
    parser.add_argument("--tables", type=at_least(2), default=1024, help="so many [1024]")
    options = parser.options()
    kept, first = np.empty((0, 22, 2), np.float32), 1_000_000 * options.seed
    while len(kept) < options.tables:
        kept = np.concatenate([kept, failed(first)])
        first += SIDE_BY_SIDE
    packed = io.BytesIO()
    np.savez_compressed(packed, positions=kept[: options.tables])
    save_bytes(options.folder / FILE, packed.getvalue())
    counts = {"seed": options.seed, "tables": options.tables, "snookers": first - 1_000_000 * options.seed}
    save_json(options.json, counts)
    print(f"{options.tables} tables of {counts['snookers']:,} snookers -> {options.folder / FILE}")


if __name__ == "__main__":
    run(main)
