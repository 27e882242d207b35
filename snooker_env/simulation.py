"""How do I call the physics? One impact, one strike, one shot, many shots: checked input in, plain arrays and ``Shot`` out."""

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

import numpy as np

from ._check import array, flags, integer, refuse, refuse_what
from ._jit import entry
from .physics import cloth, cue, engine, trajectory
from .physics.events import EventKind, Status
from .physics.impact import contact
from .physics.impact.polynomial import WORK
from .physics.parameters import FASTEST, FASTEST_IMPACT, MOST_SPIN, MOST_SPIN_IMPACT, P_E_B, Physics
from .physics.table import Table

EVENT = np.dtype([("time", np.float64), ("kind", np.int32), ("i", np.int32), ("j", np.int32)])
"""One logged event; ``kind`` is an ``EventKind``."""

MAX_EVENTS = 100_000
MAX_BALLS = 4096
"""Balls of one shot: the times of all pairs are kept, 134 MB of them here."""
FARTHEST = 1e6
"""Balls lie within this [m] of the origin: there places are still known to 1e-10 m."""
_FIRST_LOG = 512


class SimulationError(RuntimeError):
    """A shot that could not be computed; the message names the shot, its last event and what to try."""


@entry(what="the impact of two balls", uses=(contact.collide_balls,))
def _collide_balls(v1, w1, v2, w2, nx, ny, phys, fidelity, n_steps):
    return contact.collide_balls(v1, w1, v2, w2, nx, ny, phys, phys[P_E_B], fidelity, n_steps, np.empty(WORK))


@entry(what="the impact with a cushion", uses=(contact.collide_cushion,))
def _collide_cushion(v, w, nx, ny, phys, fidelity, n_steps):
    e = contact.cushion_restitution(v[0] * nx + v[1] * ny, phys)
    return contact.collide_cushion(v, w, nx, ny, phys, e, fidelity, n_steps, np.empty(WORK))


def _unit_normal(normal):
    nx, ny, nz = array("normal", normal, (3,)).tolist()
    if abs(nz) > 1e-9 or abs(np.hypot(nx, ny) - 1.0) > 1e-6:
        length = (nx * nx + ny * ny + nz * nz) ** 0.5
        raise refuse("normal", (nx, ny, nz), f"must be a horizontal unit vector: z = 0, length 1 to 1e-6 (it is {length:.7g})")
    size = float(np.hypot(nx, ny))
    return nx / size, ny / size


def _velocity(name, value):
    return tuple(array(name, value, (3,), FASTEST_IMPACT, "m/s").tolist())


def _spin(name, value):
    return tuple(array(name, value, (3,), MOST_SPIN_IMPACT, "rad/s").tolist())


def collide_balls(v1, w1, v2, w2, normal, physics=None, fidelity="standard"):
    """The frictional impact of two balls standing on the cloth (Mathavan, Jackson & Parkin 2014, 2.1 to 2.4).

    v1, v2: velocities [m/s], w1, w2: spins [rad/s], each (3,), no number beyond 1e6 m/s and 1e9 rad/s; normal: horizontal unit
    vector from ball 1 to ball 2. Returns v1, w1, v2, w2 after the impact, (3,) float64 each, the vertical velocity of the lifted ball
    included. Balls that do not close (zero or parting normal speed) come back unchanged. ``fidelity``: "fast" (closed form, free
    spheres), "standard", "reference", or "euler:N" (the paper's own scheme with N of eq. 14).

    Raises ValueError on bad shapes, numbers not finite or beyond these, a normal that is not horizontal and unit, an unknown fidelity or
    physics.
    """
    physics, (code, n_steps) = Physics.of(physics), contact.parse_fidelity(fidelity)
    args = _velocity("v1", v1), _spin("w1", w1), _velocity("v2", v2), _spin("w2", w2)
    *out, solved = _collide_balls(*args, *_unit_normal(normal), physics.pack(), code, n_steps)
    if not solved:
        raise SimulationError(f"the impact of v1, w1, v2, w2 = {args} did not end at fidelity {fidelity!r}; try another fidelity")
    return tuple(np.array(a) for a in out)


def collide_cushion(v, w, normal, physics=None, fidelity="standard"):
    """The impact of a ball with a cushion's nose (Mathavan, Jackson & Parkin 2010, with Coulomb's law at zero slip).

    v: velocity [m/s], w: spin [rad/s], (3,) each, bounded as in ``collide_balls``; normal: horizontal unit vector INTO the cushion.
    Returns v, w after the impact; a ball that does not move into the cushion comes back unchanged. Fidelities as in ``collide_balls``;
    "fast" integrates with a loose tolerance (no closed form keeps the cloth's reaction, worth 7 % of the rebound). Raises ValueError as
    ``collide_balls`` does.
    """
    physics, (code, n_steps) = Physics.of(physics), contact.parse_fidelity(fidelity)
    args = _velocity("v", v), _spin("w", w)
    *out, solved = _collide_cushion(*args, *_unit_normal(normal), physics.pack(), code, n_steps)
    if not solved:
        raise SimulationError(f"the cushion impact of v, w = {args} did not end at fidelity {fidelity!r}; try another fidelity")
    return tuple(np.array(a) for a in out)


def strike(speed, aim, side=0.0, top=0.0, elevation=0.0, physics=None):
    """The cue ball's velocity (3,) [m/s] and spin (3,) [rad/s] just after the cue has struck it.

    speed in [0, 1000]: the speed the cue gives [m/s], along the cue; aim: direction of the cue [rad], anticlockwise from +x; side, top: tip
    offset over R, + right, + up as the player sees it; elevation of the butt [rad] in [0, 1.5]. Side spin deflects the ball off the
    aim (squirt, to the left for right side); an elevated cue with side gives the spin of a swerve or masse, and the cloth takes the
    downward part of the speed: the ball leaves along the cloth with speed cos(elevation).

    Raises ValueError on a miscue (offset beyond ``physics.max_offset`` R, 0.5 by default), a negative speed, non-finite numbers.
    """
    v, w = cue.strike(speed, aim, side, top, elevation, Physics.of(physics))
    return np.array(v), np.array(w)


@dataclass(frozen=True, eq=False)
class Shot:
    """One simulated shot. All arrays are fresh and the caller's own.

    Fields:

    * positions: (n, 2) [m] at rest; of a potted ball: where its centre crossed the fall, or where its flight over the pocket ended.
    * potted: (n,) int: pocket index, or -1 if not potted in this shot. ``Table.pockets`` names them: on a table with six pockets
      ``snooker_env.POCKETS``.
    * on_table: (n,) bool: still in play.
    * duration: Time [s] until everything is at rest, spin included (with ``spin_decel`` 0, which ends no spin: until no ball moves across
      the table).
    * events: Structured array of ``time`` [s], ``kind`` (EventKind), ``i``, ``j``, in order.
    """

    positions: np.ndarray
    potted: np.ndarray
    on_table: np.ndarray
    duration: float
    events: np.ndarray
    segments: np.ndarray = field(repr=False)
    physics: Physics = field(repr=False)

    def at(self, t):
        """Positions (n, 2) [m], velocities (n, 2) [m/s] and spins (n, 3) [rad/s] at time t [s], finite and not negative.

        t may be an array of shape (m,): then a leading axis m is added to each. At the time of an impact: just after it. From ``duration``
        on, however late, everything is at rest: the positions are ``positions``, velocities and spins zero (with ``spin_decel`` 0 a spin
        about the vertical stays as it is). A potted ball lies still in its place of ``positions``, without spin, from its pot on, and
        one that was not on the table where it was given. A ball in the air over a pocket has the mean velocity from event to event.
        """
        times = array("t", t if np.ndim(t) else [t], (-1,))
        if times.size and times.min() < 0:
            raise refuse("t", float(times.min()), "must not be negative")
        n, m = len(self.positions), len(times)
        out = np.zeros((m, n, 2)), np.zeros((m, n, 2)), np.zeros((m, n, 3))
        segments = np.require(self.segments, np.float64, ["C", "W"])  # as compiled for; a shot that came from elsewhere may be read-only
        trajectory.states_at(segments, n, times, self.physics.pack(), *out)
        if self.physics.spin_decel > 0:
            out[2][times >= self.duration] = 0.0  # rounding may leave 1e-14 of a spin at the very time at which it ends
        return tuple(a[0] for a in out) if np.ndim(t) == 0 else out


@dataclass(frozen=True, eq=False)
class ShotBatch:
    """Many simulated shots: the fields of ``Shot`` with a leading axis b. ``events``: one array a shot if asked for, else None."""

    positions: np.ndarray
    potted: np.ndarray
    on_table: np.ndarray
    duration: np.ndarray
    event_count: np.ndarray
    events: list[np.ndarray] | None = None


def _balls(positions, velocities, spins, on_table, batch):
    lead = (-1,) if batch else ()
    r = array("positions", positions, (*lead, -1, 2), FARTHEST, "m")
    shape = r.shape[:-1]
    v = array("velocities", velocities, (*shape, 2), FASTEST, "m/s")
    w = array("spins", spins, (*shape, 3), MOST_SPIN, "rad/s")
    if not 1 <= shape[-1] <= MAX_BALLS:
        raise refuse_what("positions", f"array of shape {r.shape}", f"must hold at least one ball and at most {MAX_BALLS}")
    here = np.ones(shape, bool) if on_table is None else flags("on_table", on_table, shape)
    return r, v, w, here


def simulate(positions, velocities, spins, table="match", physics=None, fidelity="standard", *, on_table=None, max_events=MAX_EVENTS):
    """Play one shot until everything is at rest.

    positions (n, 2) [m], velocities (n, 2) [m/s] and spins (n, 3) [rad/s] of n balls in the world frame (origin at the table's centre, +y
    to the black end), each number within 1,000 m/s and 100,000 rad/s; table: a preset's name ("match", "tight", "uk8", "pool9", "carom",
    each for the balls of its game: physics.R must be ``Table.preset(name).ball_radius``), a ``Table``, or None for unbounded cloth;
    on_table (n,) bool: balls to leave out are False. All balls are equal. Balls may touch each other and the cushions (to within 1e-6 m).
    The same input gives the same bits.

    Returns a ``Shot``. Raises ValueError on bad input (field, value, what is allowed), SimulationError if the shot does not come to rest
    within ``max_events`` events.
    """
    physics, table, fidelity = Physics.of(physics), Table.of(table), contact.parse_fidelity(fidelity)
    r, v, w, here = _balls(positions, velocities, spins, on_table, batch=False)
    physics.check_stopping()
    table.check(r, physics.R, "positions", here)
    return play(r, v, w, here, physics, table, fidelity, integer("max_events", max_events, 1, 2**31))


def play(positions, velocities, spins, on_table, physics, table, fidelity, max_events=MAX_EVENTS, *, path=True):
    """``simulate`` without its checks, for callers whose layouts are known to be sound; the arrays given are left as they are.

    fidelity: as ``parse_fidelity`` returns it. path=False saves the log that ``Shot.at`` needs.
    """
    capacity = min(_FIRST_LOG, max_events)
    while True:
        state = [a[None].copy() for a in (positions, velocities, spins, on_table)]
        path_size = 2 * capacity + len(positions) + 2 if path else 0
        out = _run(state, physics, table, fidelity, max_events, capacity, path_size)
        if out.status[0] != Status.LOG_FULL:
            break
        capacity *= 4
    events = out.log(0)
    _raise_unless_ok(out, 0, events)
    segments = out.segments[0, : out.n_segments[0]].copy()
    return Shot(state[0][0], out.potted[0], state[3][0], float(out.duration[0]), events, segments, physics)


def simulate_batch(
    positions, velocities, spins, table="match", physics=None, fidelity="standard", *, on_table=None, threads=None, events=False,
    max_events=MAX_EVENTS,
):  # fmt: skip
    """Play b shots on b tables at once: positions (b, n, 2), velocities (b, n, 2), spins (b, n, 3), on_table (b, n) bool or None.

    threads: how many to use, None for one per core; results do not depend on it. events: also return each shot's event log.
    Returns a ``ShotBatch``. Errors as in ``simulate``.
    """
    physics, table, fidelity = Physics.of(physics), Table.of(table), contact.parse_fidelity(fidelity)
    r, v, w, here = _balls(positions, velocities, spins, on_table, batch=True)
    physics.check_stopping()
    table.check(r, physics.R, "positions", here)
    threads = os.cpu_count() or 1 if threads is None else integer("threads", threads, 1, 1024)
    max_events = integer("max_events", max_events, 1, 2**31)
    start = r.copy(), v.copy(), w.copy(), here.copy()
    out = _run((r, v, w, here), physics, table, fidelity, max_events, _FIRST_LOG if events else 0, 0, threads)
    logs = [out.log(k) for k in range(len(r))] if events else None
    for k in np.flatnonzero(out.status != int(Status.OK)).tolist():
        if out.status[k] == Status.LOG_FULL:  # rare: a log longer than the first guess; played once more with room
            one = play(start[0][k], start[1][k], start[2][k], start[3][k], physics, table, fidelity, max_events, path=False)
            r[k], here[k], out.potted[k], out.duration[k] = one.positions, one.on_table, one.potted, one.duration
            out.n_events[k] = len(one.events)
            if logs is not None:
                logs[k] = one.events
        else:
            _raise_unless_ok(out, k, logs[k] if logs else None)
    return ShotBatch(r, out.potted, here, out.duration, out.n_events, logs)


@dataclass
class _Run:
    potted: np.ndarray
    status: np.ndarray
    n_events: np.ndarray
    n_segments: np.ndarray
    duration: np.ndarray
    event_time: np.ndarray
    event_what: np.ndarray
    segments: np.ndarray

    def log(self, k):
        events = np.zeros(self.n_events[k], EVENT)
        m = min(self.n_events[k], self.event_time.shape[1])
        events["time"][:m] = self.event_time[k, :m]
        for c, name in enumerate(("kind", "i", "j")):
            events[name][:m] = self.event_what[k, :m, c]
        return events[:m]


def _run(state, physics, table, fidelity, max_events, log_size, path_size, threads=1):
    """Run the engine on ``state`` = positions, velocities, spins, on_table (batched, changed in place)."""
    b, n = state[0].shape[:2]
    out = _Run(
        np.zeros((b, n), np.int64), np.zeros(b, np.int64), np.zeros(b, np.int64), np.zeros(b, np.int64), np.zeros(b),
        np.zeros((b, log_size)), np.zeros((b, log_size, 3), np.int32), np.zeros((b, path_size, cloth.SEGMENT)),
    )  # fmt: skip
    world = physics.pack(), table.noses, table.jaws, table.falls, *fidelity
    log, outcome = (out.event_time, out.event_what, out.segments), (out.status, out.n_events, out.n_segments, out.duration)

    def run(first, last):
        engine.run_batch(*state, out.potted, *world, max_events, *log, *outcome, first, last)

    threads = min(threads, b)
    if threads <= 1:
        run(0, b)
    else:
        cuts = np.linspace(0, b, 4 * threads + 1).astype(int)  # more slices than threads: shots differ in length
        with ThreadPoolExecutor(threads) as pool:
            list(pool.map(run, cuts[:-1], cuts[1:]))
    return out


def _raise_unless_ok(out, k, events):
    status = out.status[k]
    if status == Status.OK:
        return
    last = ""
    if events is not None and len(events):
        time, kind, i, j = events[-1].tolist()
        last = f"; the last was {EventKind(kind).name} of {i} and {j} at {time:.6f} s"
    why = {
        Status.TOO_MANY_EVENTS: "did not come to rest in time; a ball may be held against another: allow more max_events",
        Status.IMPACT_UNSOLVED: "holds an impact that did not end; try another fidelity, or less extreme friction",
    }[Status(status)]
    raise SimulationError(f"shot {k} {why} (after {out.n_events[k]} events{last})")
