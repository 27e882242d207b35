"""How does one simulate shots, one or many? Checked input in, ``Shot`` and ``ShotBatch`` out."""

import os
import threading
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple

import numpy as np

from .._lib.check import array, flags, integer, refuse, refuse_what, truth
from .._lib.types import Batches, Fidelity, FlagRows, Flags, Solver, Vectors
from ..physics import cloth, engine
from ..physics.arrays import Ends, Log
from ..physics.events import LOG_FULL, OK, UNSOUND, EventKind, Status
from ..physics.impact import contact
from ..physics.parameters import FARTHEST, FASTEST, MOST_SPIN, Physics, PhysicsLike
from ..physics.table import Table, TableLike
from .shot import EVENT, WHY, Shot, ShotBatch, SimulationError

MAX_EVENTS = 100_000
MAX_BALLS = 4096  # of one shot: the times of all pairs are stored (134 MB)
_FIRST_LOG = 512
_LOCK, _SHOTS = threading.Lock(), 0  # a shot that is simulated again with a longer log counts once


def count(shots: int) -> None:
    """Add a number of shots; safe in any thread."""
    global _SHOTS
    with _LOCK:
        _SHOTS += shots


def count_shots() -> int:
    """Count the shots that this process has simulated so far.

    Returns
    -------
    int
        Their number: read it before and after a decision. Single impacts are no shots.

    Examples
    --------
    >>> import numpy as np
    >>> import snooker_env as sn
    >>> from snooker_env.benchmark import count_shots
    >>> before = count_shots()
    >>> _ = sn.simulate(np.zeros((1, 2)), np.array([[1.0, 0.0]]), np.zeros((1, 3)))
    >>> count_shots() - before
    1
    """
    return _SHOTS


def _balls(positions, velocities, spins, on_table, flies, batch, checked=False):
    """New arrays of a shot, where balls fly with heights and their rates; ``checked``: limits, too."""
    lead = (-1,) if batch else ()
    farthest, fastest, most_spin = (FARTHEST, FASTEST, MOST_SPIN) if checked else (None, None, None)
    r = array("positions", positions, (*lead, -1, _columns(positions, flies)), farthest, "m")
    shape = r.shape[:-1]
    v = array("velocities", velocities, (*shape, _columns(velocities, flies)), fastest, "m/s")
    w = array("spins", spins, (*shape, 3), most_spin, "rad/s")
    if not 1 <= shape[-1] <= MAX_BALLS:
        allowed = f"must hold at least one ball and at most {MAX_BALLS}"
        raise refuse_what("positions", f"array of shape {r.shape}", allowed)
    here = np.ones(shape, bool) if on_table is None else flags("on_table", on_table, shape)
    if not flies:
        return r, v, w, here
    aloft = np.zeros((*shape, 2))
    for c, part in enumerate((r, v)):
        if part.shape[-1] == 3:
            aloft[..., c] = part[..., 2]
    if (low := aloft[..., 0].min()) < 0.0:
        raise refuse("positions z", float(low), "must be a height above the bed: at least 0 m")
    return r[..., :2].copy(), v[..., :2].copy(), w, here, aloft


def _columns(value, flies):
    """How many columns positions or velocities have."""
    return 3 if flies and np.shape(value)[-1:] == (3,) else 2


def _refuse(balls, physics, table):
    """Raise the ValueError of a shot, or of a batch of shots, that the engine found ``UNSOUND``."""
    r, v, w, here, *aloft = balls
    if aloft:
        r, v = (np.concatenate([part, aloft[0][..., c, None]], axis=-1) for c, part in enumerate((r, v)))
    r, _, _, here, *_ = _balls(r, v, w, here, bool(aloft), batch=r.ndim == 3, checked=True)
    table.check(r, physics.R, "positions", here)
    raise AssertionError("a sound shot was refused")  # the two checks are the same


def simulate(
    positions: Vectors,
    velocities: Vectors,
    spins: Vectors,
    table: TableLike = "match",
    physics: PhysicsLike = None,
    fidelity: Fidelity = "standard",
    *,
    on_table: Flags | None = None,
    max_events: int = MAX_EVENTS,
) -> Shot:
    """Simulate one shot until everything is at rest.

    The same input gives the same result, bit for bit.

    Parameters
    ----------
    positions : array_like, float (n, 2)
        Centres of the balls [m]: origin at the table's centre, +x to the yellow side, +y to the black end.
        Balls may touch balls and cushions, and overlap by at most 1e-6 m. All balls are equal; n is 1 to
        4096. With ``physics.flight`` also (n, 3): the third column is the height of the centre above its height on the bed.
    velocities : array_like, float (n, 2)
        Velocities [m/s], each component within 1,000 of zero. With ``physics.flight`` also (n, 3): a ball that is driven
        into the bed bounces.
    spins : array_like, float (n, 3)
        Angular velocities [rad/s], each component within 100,000 of zero.
    table : str, Table or None
        A preset ("match", "tight", "uk8", "pool9", "carom"), a ``Table``, or None for unbounded cloth.
        ``physics.R`` must be the ``ball_radius`` of a preset.
    physics, fidelity
        As in ``collide_balls``.
    on_table : array_like, bool (n,), optional
        False for the balls to leave out; None: all are on the table.
    max_events : int
        The most events that the shot may have, in [1, 2**31].

    Returns
    -------
    Shot
        Final positions, pots, the log of events and the paths. ValueError for bad input, SimulationError if the shot
        does not come to rest within ``max_events`` events or the computation of an impact does not end.

    Examples
    --------
    >>> import snooker_env as sn
    >>> v, w = sn.strike(speed=3.0, aim=1.5708)
    >>> shot = sn.simulate([(0.0, -1.2), (0.0, 0.6)], [v[:2], (0.0, 0.0)], [w, (0.0, 0.0, 0.0)], physics="match")
    >>> shot.positions.shape, shot.on_table.tolist()
    ((2, 2), [True, True])
    """
    physics, table, solver = Physics.of(physics), Table.of(table), contact.parse_fidelity(fidelity)
    balls = _balls(positions, velocities, spins, on_table, physics.flight, batch=False)
    physics.check_stopping()
    table.check_ball(physics.R)
    max_events = integer("max_events", max_events, 1, 2**31)
    try:
        shot = play(balls, physics, table, solver, max_events, doubt=True)
    except SimulationError:
        count(1)
        raise
    count(1)
    return shot


def play(
    balls: tuple[Any, ...],
    physics: Physics,
    table: Table,
    fidelity: Solver,
    max_events: int = MAX_EVENTS,
    *,
    path: bool = True,
    doubt: bool = False,
) -> Shot:
    """``simulate`` of ``_balls``, not counted; ``path``: for ``Shot.at``; ``doubt``: numbers are checked."""
    capacity = min(_FIRST_LOG, max_events)
    while True:
        state = [a[None].copy() for a in balls]
        log = _take_log(capacity, 2 * capacity + len(balls[0]) + 2 if path else 0)
        out = _run(state, physics, table, fidelity, max_events, log, doubt=doubt)
        if out.status[0] != LOG_FULL:
            break
        capacity *= 4
    events, segments = out.log(0), log.segments[0, : out.n_segments[0]].copy()
    if capacity <= _FIRST_LOG:
        _KEPT.log = log
    if out.status[0] != OK:
        if out.status[0] == UNSOUND:
            _refuse(balls, physics, table)
        raise _failure(out, 0, events)
    ends = state[0][0], out.potted[0], state[3][0], float(out.duration[0])
    return Shot(*ends, events, segments, physics, table)


def simulate_batch(
    positions: Batches,
    velocities: Batches,
    spins: Batches,
    table: TableLike = "match",
    physics: PhysicsLike = None,
    fidelity: Fidelity = "standard",
    *,
    on_table: FlagRows | None = None,
    threads: int | None = None,
    events: bool = False,
    max_events: int = MAX_EVENTS,
) -> ShotBatch:
    """Simulate b independent shots at once.

    Parameters
    ----------
    positions, velocities, spins : array_like, float (b, n, 2), (b, n, 2) and (b, n, 3)
        Centres of the balls [m], velocities [m/s] and angular velocities [rad/s]; these and the following as in
        ``simulate``.
    table, physics, fidelity
        The same for all shots.
    on_table : array_like, bool (b, n), optional
        False for the balls to leave out; None: all are on the table.
    threads : int, optional
        Number of threads, in [1, 1024]; None: one for each core. Results do not depend on it.
    events : bool
        Whether to return each shot's log of events too.
    max_events : int
        The most events that one shot may have, in [1, 2**31].

    Returns
    -------
    ShotBatch
        Final positions, pots and durations, and with ``events`` the logs. Errors as of ``simulate``; they name the shot.

    Examples
    --------
    >>> import numpy as np
    >>> import snooker_env as sn
    >>> velocities = np.array([[(1.0, 0.0)], [(2.0, 0.0)]])
    >>> batch = sn.simulate_batch(np.zeros((2, 1, 2)), velocities, np.zeros((2, 1, 3)))
    >>> batch.positions.shape, batch.events is None
    ((2, 1, 2), True)
    """
    physics, table, solver = Physics.of(physics), Table.of(table), contact.parse_fidelity(fidelity)
    state = _balls(positions, velocities, spins, on_table, physics.flight, batch=True)
    r, here = state[0], state[3]
    physics.check_stopping()
    table.check_ball(physics.R)
    events = truth("events", events)
    threads = os.cpu_count() or 1 if threads is None else integer("threads", threads, 1, 1024)
    max_events = integer("max_events", max_events, 1, 2**31)
    start = tuple(a.copy() for a in state)
    log = log_space(len(r), _FIRST_LOG if events else 0, 0)
    out = _run(state, physics, table, solver, max_events, log, threads, doubt=True)
    if (out.status == UNSOUND).any():
        _refuse(start, physics, table)
    count(len(r))
    logs = [out.log(k) for k in range(len(r))] if events else None
    for k in np.flatnonzero(out.status != OK).tolist():
        # rare: the log is longer than the first guess, so the shot is simulated again with more room
        if out.status[k] == LOG_FULL:
            one = play(tuple(part[k] for part in start), physics, table, solver, max_events, path=False)
            r[k], here[k] = one.positions, one.on_table
            out.potted[k], out.duration[k] = one.potted, one.duration
            out.n_events[k] = len(one.events)
            if logs is not None:
                logs[k] = one.events
        else:
            raise _failure(out, k, logs[k] if logs else None)
    return ShotBatch(r, out.potted, here, out.duration, out.n_events, logs)


class _Run(NamedTuple):
    potted: np.ndarray
    status: np.ndarray
    n_events: np.ndarray
    n_segments: np.ndarray
    duration: np.ndarray
    event_time: np.ndarray
    event_what: np.ndarray
    segments: np.ndarray

    def log(self, k):
        m = min(int(self.n_events[k]), self.event_time.shape[1])
        events, what = np.empty(m, EVENT), self.event_what[k, :m]
        events["time"] = self.event_time[k, :m]
        events["kind"], events["i"], events["j"] = what.T
        return events


def log_space(b: int, log_size: int, path_size: int) -> Log:
    """A ``Log`` of b shots."""
    times, what = np.zeros((b, log_size)), np.zeros((b, log_size, 3), np.int32)
    return Log(times, what, np.zeros((b, path_size, cloth.SEGMENT)))


_KEPT = threading.local()
_NO_KICKS = np.empty(0)


def _take_log(log_size, path_size):
    """``log_space`` of one shot: this thread's last, as a new one takes longer than most shots; a shot inside a shot makes its own."""
    log = _KEPT.__dict__.pop("log", None)
    if log is None or (log.time.shape[1], log.segments.shape[1]) != (log_size, path_size):
        return log_space(1, log_size, path_size)
    return log


def _run(state, physics, table, fidelity, max_events, log=None, threads=1, doubt=False):
    """Run the engine on the arrays of ``_balls``: batched, in place, maybe with a ``Log``."""
    b, n = state[0].shape[:2]
    log = log or log_space(b, 0, 0)
    ends = Ends(np.zeros(b, np.int64), np.zeros(b, np.int64), np.zeros(b, np.int64), np.zeros(b))
    out = _Run(np.zeros((b, n), np.int64), *ends, *log)
    bounds = table.noses, table.jaws, table.falls, table._reach(physics.R)
    setup = physics.packed_for(fidelity)[None], _NO_KICKS, *bounds, *fidelity, doubt
    balls, aloft = (*state[:4], out.potted), state[4] if physics.flight else None
    arguments = balls, aloft, setup, max_events, tuple(log), tuple(ends)

    def run(first, last):
        engine.run_batch(*arguments, first, last)

    threads = min(threads, b)
    if threads <= 1:
        run(0, b)
    else:
        # more slices than threads, because shots differ in length
        cuts = np.linspace(0, b, 4 * threads + 1).astype(int)
        with ThreadPoolExecutor(threads) as pool:
            list(pool.map(run, cuts[:-1], cuts[1:]))
    return out


def _failure(out, k, events):
    """The error for shot k, which did not end well."""
    last = ""
    if events is not None and len(events):
        time, kind, i, j = events[-1].tolist()
        last = f"; the last was {EventKind(kind).name} of {i} and {j} at {time:.6f} s"
    return SimulationError(f"shot {k} {WHY[Status(out.status[k])]} (after {out.n_events[k]} events{last})")
