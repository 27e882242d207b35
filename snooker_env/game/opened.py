"""Where do opened tables come from? A bank of tables opened by real simulated play, shipped as data: ``opened.npz``.

Each table: a break-off, then further hard strokes at the reds, all simulated and refereed, until the pack is spread; kept if all 22
balls are still on it and some red can be potted. ``python -m benchmarks.make_opened`` makes the file. The last ``HELD_OUT`` tables are
never dealt by the layout "opened": they are for evaluation ("held_out"). Every table is also dealt mirrored in the long axis.
"""

from functools import cache, lru_cache
from pathlib import Path

import numpy as np

from .._types import Floats
from .balls import N_BALLS

FILE = Path(__file__).with_name("opened.npz")
HELD_OUT = 2048
NO_BANK = np.zeros((0, N_BALLS, 2))
"""For layouts that need none."""
NO_BANK.setflags(write=False)


@cache
def bank() -> Floats:
    """(k, 22, 2) float64 [m], read-only."""
    with np.load(FILE) as data:
        tables = data["positions"].astype(np.float64)
    tables.setflags(write=False)
    return tables


def kept(size: int) -> tuple[range, range]:
    """The tables that are not held out, and those that are, of ``size`` in all."""
    return range(size - HELD_OUT), range(size - HELD_OUT, size)


@lru_cache(8)
def bank_without(unfit: tuple[int, ...]) -> Floats:
    """The bank with each table of ``unfit``, a tuple of indices, replaced by the next of its part (held out or not) that is not in it.

    So a stream deals the same tables as ever, but for these; some of each part must be left.
    """
    if not unfit:
        return bank()
    tables = bank().copy()
    for part in kept(len(tables)):
        fit = np.setdiff1d(part, unfit)
        for k in np.intersect1d(part, unfit):
            tables[k] = tables[fit[np.searchsorted(fit, k) % len(fit)]]
    tables.setflags(write=False)
    return tables
