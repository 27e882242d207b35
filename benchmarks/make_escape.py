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
SIDE_BY_SIDE, TRIALS, MOST = 2000, 16, 0.5
"""Tables at once, strokes on each, and the largest share of them that may be fair."""


def failed(first):
    """The tables with seeds from ``first`` on that are kept: (k, 22, 2) float32, NaN for balls that are not there."""
    tables = SnookerVectorEnv(SIDE_BY_SIDE, **RULES, **VISITS, autoreset_mode="Disabled")
    seeds, fair = np.arange(first, first + SIDE_BY_SIDE), np.zeros(SIDE_BY_SIDE)
    tables.reset(seed=first)
    dealt = np.where(tables.tables.on_table[:, :, None], tables.tables.positions, np.nan)
    everywhere = np.ones(SIDE_BY_SIDE, bool)
    actions = decided(
        player("ghost_ball").at(tables), tables, everywhere, decision_seeds(0, seeds, 0)
    ).astype(np.float32)
    for trial in range(TRIALS):
        tables.reset(seed=first)
        tables.tables.streams[:, 0] = decision_seeds(1, seeds, trial)  # other errors on the same table
        fair += tables.step(actions)[1]
    tables.close()
    return dealt[fair <= MOST * TRIALS].astype(np.float32)


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
