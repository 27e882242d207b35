"""Where do opened tables come from? From a bank, ``opened.npz``, that ``python -m benchmarks.make_opened``
makes: a break-off and further hard strokes until the pack is spread, all 22 balls and some pot on a red."""

from functools import cache, lru_cache
from pathlib import Path

import numpy as np

from .._types import Floats
from .balls import N_BALLS

FILE = Path(__file__).with_name("opened.npz")
HELD_OUT = 2048
"""Number of tables of the bank that only the layout "held_out" deals, for evaluation."""
NO_BANK = np.zeros((0, N_BALLS, 2))
NO_BANK.setflags(write=False)


@cache
def bank() -> Floats:
    """The opened tables: float64 (k, 22, 2) [m], read-only."""
    with np.load(FILE) as data:
        tables = data["positions"].astype(np.float64)
    tables.setflags(write=False)
    return tables


def kept(size: int) -> tuple[range, range]:
    """Indices of the tables that are not held out, and of those that are, of ``size`` in all."""
    return range(size - HELD_OUT), range(size - HELD_OUT, size)


@lru_cache(8)
def bank_without(unfit: tuple[int, ...]) -> Floats:
    """The bank with each table of ``unfit`` replaced by the next of its part that fits; others stay."""
    if not unfit:
        return bank()
    tables = bank().copy()
    for part in kept(len(tables)):
        fit = np.setdiff1d(part, unfit)
        for k in np.intersect1d(part, unfit):
            tables[k] = tables[fit[np.searchsorted(fit, k) % len(fit)]]
    tables.setflags(write=False)
    return tables
