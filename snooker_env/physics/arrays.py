"""Which arrays does a shot work on? Named and grouped: what ``engine.run`` takes; the last two groups are its work space.

Kernels below it take arrays one by one, and so does the one that Python calls: see ``engine.run`` and ``engine.run_batch`` for the cost.
"""

from typing import NamedTuple

import numpy as np


class World(NamedTuple):
    """What is the same in all shots: constants, the table, and how impacts are solved."""

    phys: np.ndarray
    """``Physics.pack()``."""
    noses: np.ndarray
    jaws: np.ndarray
    falls: np.ndarray
    fidelity: int
    """As ``contact.parse_fidelity`` returns it, with n_steps."""
    n_steps: int


class Balls(NamedTuple):
    """The n balls of a shot, before it and then after it."""

    positions: np.ndarray
    """(n, 2) [m]."""
    velocities: np.ndarray
    """(n, 2) [m/s]."""
    spins: np.ndarray
    """(n, 3) [rad/s]."""
    on_table: np.ndarray
    """(n,) bool."""
    potted: np.ndarray
    """(n,) int64: the pocket that a ball was lost in during the shot, or -1."""


class Log(NamedTuple):
    """What is written down while a shot runs; arrays of length 0 for what is not wanted."""

    time: np.ndarray
    """(m,) [s], of each event."""
    what: np.ndarray
    """(m, 3) int32: kind, i, j."""
    segments: np.ndarray
    """(k, cloth.SEGMENT): the paths."""


class Ends(NamedTuple):
    """How each of b shots ended; (b,) each."""

    status: np.ndarray
    n_events: np.ndarray
    n_segments: np.ndarray
    duration: np.ndarray
    """[s]"""


class Motions(NamedTuple):
    """How each ball moves now."""

    motion: np.ndarray
    """(n, cloth.COLUMNS)."""
    state: np.ndarray
    """(n,) int64: see ``cloth.py``."""
    flight: np.ndarray
    """(n, FLIGHT): what a falling ball has besides its motion, columns below."""


class Forecast(NamedTuple):
    """What each ball will meet, as things stand; inf: nothing."""

    pair: np.ndarray
    """(n, n) [s]: when two balls meet."""
    best_time: np.ndarray
    """(n,): the earliest of a row of ``pair``,"""
    best_ball: np.ndarray
    """and which ball it is with; -1 if none."""
    own_time: np.ndarray
    """(n,): the next event without another ball,"""
    own_kind: np.ndarray
    """its kind,"""
    own_index: np.ndarray
    """and its nose, jaw or pocket; -1 if it has none."""


IN_X, IN_Y, POCKET, Z0, U0, Z1, U1, END_VX, END_VY, KIND, INDEX = range(11)
FLIGHT = 11
"""Columns of ``flight``. Where the ball came in, seen from the pocket's centre, and the pocket; the drop of its centre and the rate of
that, at the start and the end of this leg; velocity, kind of event and its index at the end."""
