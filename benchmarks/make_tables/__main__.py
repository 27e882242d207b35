"""How are the stored tables of a layout made? By simulated play; see the files of ``opened``, ``safety`` and ``escape``.
Writes ``game/LAYOUT.npz``.

    python -m benchmarks.make_tables LAYOUT [--tables N] [--seed 0] [--out FOLDER]
"""

import io

import numpy as np

from snooker_env.game.layouts import FOLDER

from .._common.command import Command, at_least, run, save_bytes
from . import escape, opened, safety

MAKERS = {"opened": (opened, 10240), "safety": (safety, 1024), "escape": (escape, 1024)}
"""Layout -> the module that makes its tables, and their number."""


def main():
    """Command line."""
    parser = Command("make_tables", __doc__, files=("LAYOUT.npz",), folder=FOLDER, seed=0)
    parser.add_argument("layout", choices=MAKERS, help="whose tables")
    parser.add_argument(
        "--tables", type=at_least(2), metavar="N", help="number of tables [opened: 10240, others: 1024]"
    )
    options = parser.options()
    maker, usual = MAKERS[options.layout]
    tables, looked_at = maker.make(options.tables or usual, options.seed)
    packed, file = io.BytesIO(), options.folder / f"{options.layout}.npz"
    np.savez_compressed(packed, positions=tables)
    save_bytes(file, packed.getvalue())
    print(f"{len(tables)} tables of {looked_at:,} {'snookers' if maker is escape else 'frames'} -> {file}")


if __name__ == "__main__":
    run(main)
