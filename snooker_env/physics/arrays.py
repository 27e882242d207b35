"""Which arrays does a shot work on? In groups of what its kernels read, handed on whole at every call."""

from typing import NamedTuple

import numpy as np


class Law(NamedTuple):
    """What decides an impact: the constants, and how it is solved."""

    phys: np.ndarray  # (22 + m,) ``Physics.pack``
    fidelity: int  # as ``contact.parse_fidelity`` returns it, together with n_steps
    n_steps: int


class Boundaries(NamedTuple):
    """What the balls of radius R [m] meet on a table."""

    noses: np.ndarray  # (k, 5), and the next two: as in ``table.Table``
    jaws: np.ndarray
    falls: np.ndarray
    R: float


class Setup(NamedTuple):
    """What a shot needs beside its balls."""

    law: Law
    first: Law  # of the first impact of two balls, which a kick may change; else the same
    boundaries: Boundaries
    reach: np.ndarray  # (2, 2): the lowest and highest x and y that a ball's centre may have [m]
    clear: tuple[float, float, float, float]  # ``detection.clear_box``


class Balls(NamedTuple):
    """The n balls of a shot: before it, and in the same arrays after it."""

    positions: np.ndarray  # (n, 2) [m]
    velocities: np.ndarray  # (n, 2) [m/s]
    spins: np.ndarray  # (n, 3) [rad/s]
    on_table: np.ndarray  # (n,) bool
    potted: np.ndarray  # (n,) int64: the pocket that took the ball in this shot; ``events.OFF_TABLE``; or -1


class Log(NamedTuple):
    """The log of a shot. Arrays of length 0 switch a part of it off."""

    time: np.ndarray  # (m,) time of each event [s]
    what: np.ndarray  # (m, 3) int32: kind, i and j of each event
    segments: np.ndarray  # (k, cloth.SEGMENT): the paths


class Ends(NamedTuple):
    """How each of b shots ended; each array has shape (b,)."""

    status: np.ndarray
    n_events: np.ndarray
    n_segments: np.ndarray
    duration: np.ndarray  # [s]


class Motions(NamedTuple):
    """The present motion of each ball."""

    motion: np.ndarray  # (n, cloth.COLUMNS)
    state: np.ndarray  # (n,) int64: a state of ``cloth.py``
    flight: np.ndarray  # (n, flight.COLUMNS): more of a falling ball (``pocket.py``), of ball 0


class Forecast(NamedTuple):
    """The paths' bounds, and the next events of each ball; inf: none. m: n, rounded up to a multiple of ``LANES``."""

    bounds: np.ndarray  # (4, m) least and most x, then y, of each ball's path [m]; off the table inf, -inf
    pair: np.ndarray  # (n, m) times at which two balls meet [s]
    best_time: np.ndarray  # (m,) the earliest time of each row of ``pair`` [s]
    best_ball: np.ndarray  # (n,) the other ball of that meeting; -1 if there is none
    alone_time: np.ndarray  # (m,) time of the next event without another ball [s]
    alone_kind: np.ndarray  # (n,) kind of that event
    alone_index: np.ndarray  # (n,) its nose, jaw or pocket; -1 if it has none
