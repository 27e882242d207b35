"""Where do stored tables come from? From banks, which ``python -m benchmarks.make_tables NAME`` makes by simulated play.

* ``opened.npz``: a break-off and further hard strokes until the pack is spread; all 22 balls and some pot on a red.
* ``safety.npz``: positions of frames in which a red is on, but no pot.
* ``escape.npz``: snookers from which constant choices often fail."""

from functools import cache, lru_cache
from pathlib import Path

import numpy as np

from .._lib.types import Floats
from .balls import N_BALLS

FOLDER = Path(__file__).parent
HELD_OUT = 2048
"""Number of opened tables that only the layout "held_out" deals, for evaluation."""
BANKS = {"opened": HELD_OUT, "safety": 512, "escape": 512}
"""Of each bank the number of its last tables, which are held out."""
NO_BANK = np.zeros((0, N_BALLS, 2))
NO_BANK.setflags(write=False)


@cache
def bank(name: str) -> Floats:
    """The tables of a bank: float64 (k, 22, 2) [m], NaN for a ball that is not on the table; read-only."""
    with np.load(FOLDER / f"{name}.npz") as data:
        tables = data["positions"].astype(np.float64)
    tables.setflags(write=False)
    return tables


def split_bank(name: str) -> tuple[range, range]:
    """Indices of the tables of a bank that are not held out, and of those that are."""
    size = len(bank(name))
    return range(size - BANKS[name]), range(size - BANKS[name], size)


@lru_cache(8)
def bank_without(name: str, unfit: tuple[int, ...]) -> Floats:
    """The bank with each table of ``unfit`` replaced by the next of its part that fits; others stay."""
    if not unfit:
        return bank(name)
    tables = bank(name).copy()
    for part in split_bank(name):
        fit = np.setdiff1d(part, unfit)
        for k in np.intersect1d(part, unfit):
            tables[k] = tables[fit[np.searchsorted(fit, k) % len(fit)]]
    tables.setflags(write=False)
    return tables
