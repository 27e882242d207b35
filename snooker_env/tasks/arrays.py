"""What do the kernels of tasks take? The arrays of n tables, of their shots and of a step's results, the dynamics, and work space.

Python hands over plain tuples of the first three (``Tables.arrays``, ``ShotBuffers.arrays``, ``StepOutput.arrays``), and a kernel that
Python calls gives them these names where it begins: numba takes a named tuple from Python 0.7 us later than a plain one.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._types import Bools, Floats, Ints, Singles, Words


class TableArrays(NamedTuple):
    """n tables, as ``Tables`` has them. A visit has no rows of the last three."""

    positions: Floats
    on_table: Bools
    game: Ints
    streams: Words
    nominated: Ints
    saved_positions: Floats
    saved_on_table: Bools


class ShotArrays(NamedTuple):
    """Shots of some tables, as ``ShotBuffers`` has them."""

    r: Floats
    v: Floats
    w: Floats
    here: Bools
    shots: Floats
    seen: Ints
    potted: Ints
    status: Ints
    duration: Floats
    event_time: Floats
    event_what: NDArray[np.int32]
    n_events: Ints
    segments: Floats
    n_segments: Ints


class OutputArrays(NamedTuple):
    """The results of a step, as ``StepOutput`` has them."""

    observations: Singles
    rewards: Floats
    terminated: Bools
    truncated: Bools
    reals: Floats
    counts: Ints
    last_observations: Singles
    last_reals: Floats
    last_counts: Ints


class CueLaw(NamedTuple):
    """How the cue strikes, and how balls move and collide."""

    phys: Floats
    """Packed ``Physics``."""
    end_mass_ratio: float
    fidelity: int
    n_steps: int
    """As ``parse_fidelity`` returns them."""


class Work(NamedTuple):
    """Work space of the kernels that seek a line of the cue ball; ``lines.new_work`` makes it."""

    lines: Floats
    """(LINE_ROWS, POT_COLUMNS): the pots or lines of a table, and windows."""
    motion: Floats
    """(2, cloth.COLUMNS)"""
    state: Ints
    """(2,) Phases of two balls."""
    series: Floats
    """Of the solution of an impact."""
