"""Where do opened tables come from? A bank of tables opened by real simulated play, shipped as data: ``opened.npz``.

Each table: a break-off, then further hard strokes at the reds, all simulated and refereed, until the pack is spread; kept if all 22
balls are still on it and some red can be potted. ``python -m benchmarks.make_opened`` makes the file. The last ``HELD_OUT`` tables are
never dealt by ``opened``: they are for evaluation. Every table is also dealt mirrored in the long axis.
"""

from functools import cache
from pathlib import Path

import numpy as np

from .balls import GREEN, N_BALLS, YELLOW

FILE = Path(__file__).with_name("opened.npz")
HELD_OUT = 2048


@cache
def bank():
    """(k, 22, 2) float64 [m], read-only."""
    with np.load(FILE) as data:
        tables = data["positions"].astype(np.float64)
    tables.setflags(write=False)
    return tables


def _deal(rng, first, last):
    positions = bank()[rng.integers(first, last)].copy()
    if rng.random() < 0.5:
        positions[:, 0] *= -1.0
        positions[[YELLOW, GREEN]] = positions[[GREEN, YELLOW]]  # so that each keeps its side of the table
    return positions, np.ones(N_BALLS, dtype=np.bool_)


def opened(rng):
    """A table opened by play: ``positions`` (22, 2) [m] and ``on_table`` (22,) all True."""
    return _deal(rng, 0, len(bank()) - HELD_OUT)


def held_out(rng):
    """As ``opened``, from the tables that it never deals."""
    return _deal(rng, len(bank()) - HELD_OUT, len(bank()))
