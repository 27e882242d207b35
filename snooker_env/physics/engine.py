"""How does a whole shot run? The event loop: predict, take the earliest event, resolve it, predict again what it touched.

Predictions are kept: a ball's contacts stand as long as no event changes its motion. Ties are decided by (time, kind, ball, partner),
kinds in the order of ``EventKind``. Nothing is allocated inside the loop.

Lasting contact. A ball that its spin holds against another (or against a cushion) would bounce on it ever faster and lower, without
end, because the cloth eats each bounce. So no impact leaves a pair parting slower than ``PART``: an impact that closes faster has
its restitution raised to that, one that closes more slowly is frictionless and takes the missing energy from the two balls' spin, as
the rubbing it stands for would. A contact that lasts is then a row of hops of about a micrometre, a millisecond each; energy never rises.
"""

from enum import IntEnum
from math import inf, sqrt

import numpy as np

from .._jit import entry, inlined, kernel
from . import cloth, pocket
from .cloth import AX, AY, FALLING, GONE, HI_X, HI_Y, LO_X, LO_Y, REST, T0, T_END, VX, VY, WX, WY, WZ, X, Y
from .detection import TOUCH, boundary_event, clear_box, may_meet, pair_time
from .impact.contact import collide_balls, collide_cushion, cushion_restitution
from .impact.polynomial import WORK
from .parameters import P_E_B, P_E_J, P_R, P_SIN, P_SPIN

PART = 2e-3  # m/s; below what a shot can show: a ball at this speed rolls 16 micrometres


class EventKind(IntEnum):
    """What happened. In the event log ``i`` is the ball; ``j`` the other ball (i < j), nose, jaw or pocket, or -1."""

    BALL_BALL = 0
    CUSHION = 1
    JAW = 2
    POT = 3
    ROLL = 4
    """Ball i stopped sliding; it rolls from now on."""
    STOP = 5
    """Ball i stopped (it may still spin on the spot)."""
    DROP = 6
    """Ball i flies over the edge of pocket j towards a jaw: a POT or a RETURN follows. A ball with no jaw on its way is potted at once."""
    RETURN = 7
    """Ball i comes back on to the bed, over the edge of pocket j."""
    BEND = 8
    """The nap turned rolling ball i: the next piece of its path begins. Only with ``Physics.nap``."""


class Status(IntEnum):
    """How a run ended."""

    OK = 0
    TOO_MANY_EVENTS = 1
    LOG_FULL = 2
    IMPACT_UNSOLVED = 3


_BALL_BALL, _CUSHION, _JAW, _POT = int(EventKind.BALL_BALL), int(EventKind.CUSHION), int(EventKind.JAW), int(EventKind.POT)
_ROLL, _STOP, _BEND = int(EventKind.ROLL), int(EventKind.STOP), int(EventKind.BEND)
_DROP, _RETURN = int(EventKind.DROP), int(EventKind.RETURN)
_OK, _TOO_MANY, _FULL, _UNSOLVED = int(Status.OK), int(Status.TOO_MANY_EVENTS), int(Status.LOG_FULL), int(Status.IMPACT_UNSOLVED)


@kernel
def _hop(closing, spin_energy):
    """A slow contact: the parting speed it gets and the factor left on the spins that pay for it.

    Energies per unit mass of the moving mass of the contact: closing^2 / 2 before, parting^2 / 2 after."""
    closing = max(closing, 0.0)
    missing = min(0.5 * (PART * PART - closing * closing), 0.5 * spin_energy)
    if missing <= 0.0:
        return closing, 1.0
    return sqrt(closing * closing + 2.0 * missing) * (1.0 - 1e-12), sqrt(1.0 - missing / spin_energy)


@kernel
def _spin_energy(w, R):
    """(1/5) R^2 w^2, per unit mass."""
    return 0.2 * R * R * (w[0] * w[0] + w[1] * w[1] + w[2] * w[2])


@kernel
def _scaled(w, k):
    return w[0] * k, w[1] * k, w[2] * k


@inlined
def _meet(v1, w1, v2, w2, nx, ny, phys, fidelity, n_steps, work):
    """Ball-ball impact inside a shot: ``collide_balls`` or, below ``PART``, a hop; the vertical velocity is dropped (as the paper does)."""
    closing = (v1[0] - v2[0]) * nx + (v1[1] - v2[1]) * ny
    if closing <= PART:
        # two equal balls: the contact's moving mass is M/2, so the spin energy counts double
        parting, k = _hop(closing, 2.0 * (_spin_energy(w1, phys[P_R]) + _spin_energy(w2, phys[P_R])))
        dv = 0.5 * (closing + parting)
        return (v1[0] - dv * nx, v1[1] - dv * ny), _scaled(w1, k), (v2[0] + dv * nx, v2[1] + dv * ny), _scaled(w2, k), True
    e = max(phys[P_E_B], PART / closing)
    a, wa, b, wb, solved = collide_balls((v1[0], v1[1], 0.0), w1, (v2[0], v2[1], 0.0), w2, nx, ny, phys, e, fidelity, n_steps, work)
    return (a[0], a[1]), wa, (b[0], b[1]), wb, solved


@inlined
def _rebound(v, w, nx, ny, jaw, phys, fidelity, n_steps, work):
    """Impact with a nose or a jaw inside a shot, by the same rules; (nx, ny) points into the cushion."""
    closing = v[0] * nx + v[1] * ny
    if closing <= PART:
        parting, k = _hop(closing, _spin_energy(w, phys[P_R]))
        dv = closing + parting
        return (v[0] - dv * nx, v[1] - dv * ny), _scaled(w, k), True
    e = max(phys[P_E_J] if jaw else cushion_restitution(closing, phys), PART / closing)
    a, wa, solved = collide_cushion((v[0], v[1], 0.0), w, nx, ny, phys, e, fidelity, n_steps, work)
    return (a[0], a[1]), wa, solved


@kernel
def _begin(motion, state, i, t, r, v, w, phys):
    cloth.begin(motion, state, i, t, r[0], r[1], v[0], v[1], w[0], w[1], w[2], phys)


# Columns of ``flight``, what a falling ball has besides its motion: where it came in, seen from the pocket's centre, and the pocket; the
# drop of its centre and the rate of that, at the start and the end of this leg; velocity, kind of event and its index at the end
IN_X, IN_Y, POCKET, Z0, U0, Z1, U1, END_VX, END_VY, KIND, INDEX = range(11)


@kernel
def _fly(motion, state, flight, i, t, x, y, z, vx, vy, u, w, falls, jaws, phys):
    """Ball i is over a pocket, in the air: write its next leg, a straight line to where something happens to it."""
    here = int(flight[i, POCKET])
    end, jaw, T, x1, y1, z1, vx1, vy1, u1 = pocket.fly(x, y, z, vx, vy, u, flight[i, IN_X], flight[i, IN_Y], falls, here, jaws, phys)
    state[i] = FALLING
    T = max(T, pocket.SHORTEST)
    motion[i, X], motion[i, Y], motion[i, VX], motion[i, VY] = x, y, (x1 - x) / T, (y1 - y) / T
    motion[i, AX] = motion[i, AY] = 0.0
    motion[i, WX], motion[i, WY], motion[i, WZ] = w
    motion[i, T0], motion[i, T_END] = t, t + T
    motion[i, LO_X], motion[i, HI_X], motion[i, LO_Y], motion[i, HI_Y] = min(x, x1), max(x, x1), min(y, y1), max(y, y1)
    flight[i, Z0], flight[i, U0], flight[i, Z1], flight[i, U1], flight[i, END_VX], flight[i, END_VY] = z, u, z1, u1, vx1, vy1
    flight[i, KIND] = _JAW if end == pocket.JAW else _RETURN if end == pocket.BACK else _POT
    flight[i, INDEX] = jaw if end == pocket.JAW else here


@kernel
def _begin_again(motion, state, flight, i, t, r, v, w, falls, jaws, phys):
    """Ball i has new velocities at time t, after a meeting with another ball: on the bed or on its way down."""
    if state[i] == FALLING:
        s = (t - motion[i, T0]) / (motion[i, T_END] - motion[i, T0])
        z, u = flight[i, Z0] + s * (flight[i, Z1] - flight[i, Z0]), flight[i, U0] + s * (flight[i, U1] - flight[i, U0])
        _fly(motion, state, flight, i, t, r[0], r[1], z, v[0], v[1], u, w, falls, jaws, phys)
    else:
        _begin(motion, state, i, t, r, v, w, phys)


@kernel
def _rescan(pair, best_time, best_ball, i):
    """The earliest partner of ball i from the kept pair times; the lower ball wins a tie."""
    n = pair.shape[0]
    time, ball = inf, -1
    for j in range(n):
        if pair[i, j] < time:
            time, ball = pair[i, j], j
    best_time[i], best_ball[i] = time, ball


@kernel
def _predict(motion, state, flight, i, t, noses, jaws, falls, clear, R, pair, best_time, best_ball, own_time, own_kind, own_index):
    """Ball i has a new motion at time t: predict all its events, and mend the rows of its partners."""
    n = pair.shape[0]
    still = state[i] == REST
    time, ball = inf, -1
    for j in range(n):
        if j == i or state[j] == GONE:
            continue
        s = inf
        if not (still and state[j] == REST) and may_meet(motion, i, j, 2.0 * R + TOUCH):
            a, b = (i, j) if i < j else (j, i)
            s = pair_time(motion, state, a, b, t, 2.0 * R)
        pair[i, j] = pair[j, i] = s
        if s < time:
            time, ball = s, j
        if s < best_time[j] or (s == best_time[j] and i < best_ball[j]):
            best_time[j], best_ball[j] = s, i
        elif best_ball[j] == i and s > best_time[j]:
            _rescan(pair, best_time, best_ball, j)
    best_time[i], best_ball[i] = time, ball
    own_time[i], own_kind[i], own_index[i] = inf, 0, -1
    if state[i] == FALLING:
        own_time[i], own_kind[i], own_index[i] = motion[i, T_END], int(flight[i, KIND]), int(flight[i, INDEX])
    elif not still:
        s, kind, index = boundary_event(motion, state, i, noses, jaws, falls, clear, R)
        if s > motion[i, T_END] or kind == 0:
            s, index = motion[i, T_END], -1
            kind = _STOP if state[i] == cloth.ROLL else _ROLL if state[i] == cloth.SLIDE else _BEND
        own_time[i], own_kind[i], own_index[i] = s, kind, index


@kernel
def _leave(state, i, pair, best_time, best_ball, own_time):
    """Ball i is off the table: no more events for it, and none with it."""
    state[i] = GONE
    n = pair.shape[0]
    for j in range(n):
        pair[i, j] = pair[j, i] = inf
    best_time[i], best_ball[i], own_time[i] = inf, -1, inf
    for j in range(n):
        if best_ball[j] == i:
            _rescan(pair, best_time, best_ball, j)


@kernel
def _lie(motion, i, x, y):
    """Ball i is out of play, at (x, y)."""
    for c in range(cloth.COLUMNS):
        motion[i, c] = 0.0
    motion[i, X], motion[i, Y] = x, y


@kernel
def _record(segments, n_segments, motion, state, i):
    """Append ball i's present phase to the path log: its motion row, then ball and state."""
    if segments.shape[0] == 0:
        return n_segments
    for c in range(cloth.COLUMNS):
        segments[n_segments, c] = motion[i, c]
    segments[n_segments, cloth.COLUMNS], segments[n_segments, cloth.COLUMNS + 1] = i, state[i]
    return n_segments + 1


@inlined
def run(positions, velocities, spins, on_table, potted, phys, noses, jaws, falls, fidelity, n_steps, max_events,
        event_time, event_what, segments, motion, state, flight, pair, best_time, own_time, best_ball, own_kind, own_index,
        work):  # fmt: skip
    """One shot to rest. In place: positions, velocities, spins become the final ones, on_table and potted are updated.

    event_time (m,), event_what (m, 3): the log (kind, i, j); with m = 0 nothing is logged. segments (k, COLUMNS + 2): the paths, or
    k = 0. The rest is work space for n balls. Returns status, number of events, number of segments, duration [s].
    """
    n = positions.shape[0]
    R = phys[P_R]
    clear = clear_box(noses, jaws, falls, R)
    n_segments = n_events = np.int64(0)  # (typed: a literal would have numba compile every callee twice)
    for i in range(n):
        potted[i] = -1
        best_time[i], best_ball[i], own_time[i] = inf, -1, inf
        for j in range(n):
            pair[i, j] = inf
        if on_table[i]:
            r, v = (positions[i, 0], positions[i, 1]), (velocities[i, 0], velocities[i, 1])
            _begin(motion, state, i, 0.0, r, v, (spins[i, 0], spins[i, 1], spins[i, 2]), phys)
        else:
            state[i] = GONE
            _lie(motion, i, positions[i, 0], positions[i, 1])
        n_segments = _record(segments, n_segments, motion, state, i)
    for i in range(n):
        if state[i] > REST:
            _predict(motion, state, flight, i, 0.0, noses, jaws, falls, clear, R, pair, best_time, best_ball, own_time, own_kind, own_index)
    status = _OK
    end = 0.0
    while True:
        t, kind, i, j = inf, np.int64(9), np.int64(-1), np.int64(-1)
        for k in range(n):
            s = best_time[k]
            if s < t or (s == t and s < inf and kind > _BALL_BALL):
                t, kind, i, j = s, _BALL_BALL, k, best_ball[k]
            s = own_time[k]
            if s < t or (s == t and s < inf and kind > own_kind[k]):
                t, kind, i, j = s, own_kind[k], k, own_index[k]
        if t == inf:
            break
        if kind == _POT and state[i] != FALLING:
            r, v, w = cloth.evaluate(motion, state, i, t, phys)
            if pocket.ahead(r[0], r[1], v[0], v[1], falls, j, jaws, phys)[0] < inf:
                kind = np.int64(_DROP)
        if n_events == max_events:
            status = _TOO_MANY
            break
        if event_time.shape[0] > 0:
            if n_events == event_time.shape[0] or (segments.shape[0] > 0 and n_segments + 2 > segments.shape[0]):
                status = _FULL
                break
            event_time[n_events] = t
            event_what[n_events, 0], event_what[n_events, 1], event_what[n_events, 2] = kind, i, j
        n_events += 1
        end = t
        if kind == _BALL_BALL:
            r1, v1, w1 = cloth.evaluate(motion, state, i, t, phys)
            r2, v2, w2 = cloth.evaluate(motion, state, j, t, phys)
            nx, ny = r2[0] - r1[0], r2[1] - r1[1]
            d = sqrt(nx * nx + ny * ny)
            v1, w1, v2, w2, solved = _meet(v1, w1, v2, w2, nx / d, ny / d, phys, fidelity, n_steps, work)
            _begin_again(motion, state, flight, i, t, r1, v1, w1, falls, jaws, phys)
            _begin_again(motion, state, flight, j, t, r2, v2, w2, falls, jaws, phys)
        elif kind == _ROLL or kind == _STOP or kind == _BEND:
            cloth.next_phase(motion, state, i, phys)
            solved = True
        elif kind == _POT:
            r, v, w = cloth.evaluate(motion, state, i, t, phys)
            potted[i] = j
            _leave(state, i, pair, best_time, best_ball, own_time)
            _lie(motion, i, r[0], r[1])
            motion[i, T0], motion[i, T_END] = t, inf
            n_segments = _record(segments, n_segments, motion, state, i)
            continue
        elif kind == _DROP:
            r, v, w = cloth.evaluate(motion, state, i, t, phys)
            flight[i, IN_X], flight[i, IN_Y], flight[i, POCKET] = r[0] - falls[j, 0], r[1] - falls[j, 1], j
            _fly(motion, state, flight, i, t, r[0], r[1], 0.0, v[0], v[1], 0.0, w, falls, jaws, phys)
            solved = True
        elif state[i] == FALLING:
            r, _, w = cloth.evaluate(motion, state, i, t, phys)
            v, u = (flight[i, END_VX], flight[i, END_VY]), flight[i, U1]
            if kind == _JAW:
                z = flight[i, Z1]
                _, nx, ny, sin_phi, _ = pocket.jaw_gap(r[0], r[1], z, jaws, j, R, phys[P_SIN])
                vx, vy, u, w = pocket.strike_jaw(v[0], v[1], u, w, nx, ny, sin_phi, phys)
                _fly(motion, state, flight, i, t, r[0], r[1], z, vx, vy, u, w, falls, jaws, phys)
            else:  # back on the bed, which takes its vertical velocity
                _begin(motion, state, i, t, r, v, w, phys)
            solved = True
        else:
            r, v, w = cloth.evaluate(motion, state, i, t, phys)
            if kind == _CUSHION:
                nx, ny = (noses[j, 1], 0.0) if noses[j, 0] == 0.0 else (0.0, noses[j, 1])
            else:
                nx, ny = jaws[j, 0] - r[0], jaws[j, 1] - r[1]
                d = sqrt(nx * nx + ny * ny)
                nx, ny = nx / d, ny / d
            v, w, solved = _rebound(v, w, nx, ny, kind == _JAW, phys, fidelity, n_steps, work)
            _begin(motion, state, i, t, r, v, w, phys)
        if not solved:
            status = _UNSOLVED
            break
        n_segments = _record(segments, n_segments, motion, state, i)
        _predict(motion, state, flight, i, t, noses, jaws, falls, clear, R, pair, best_time, best_ball, own_time, own_kind, own_index)
        if kind == _BALL_BALL:
            n_segments = _record(segments, n_segments, motion, state, j)
            _predict(motion, state, flight, j, t, noses, jaws, falls, clear, R, pair, best_time, best_ball, own_time, own_kind, own_index)
    for i in range(n):
        if state[i] == GONE:
            positions[i, 0], positions[i, 1] = motion[i, 0], motion[i, 1]
            on_table[i] = False
        else:
            r, v, w = cloth.evaluate(motion, state, i, max(end, motion[i, T0]), phys)
            positions[i, 0], positions[i, 1] = r[0], r[1]
            velocities[i, 0], velocities[i, 1] = v[0], v[1]
            spins[i, 0], spins[i, 1], spins[i, 2] = w[0], w[1], w[2]
            if status == _OK and phys[P_SPIN] > 0.0:  # at rest a ball may still spin on the spot
                end = max(end, motion[i, T0] + abs(motion[i, WZ]) / phys[P_SPIN])
    return status, n_events, n_segments, end


@entry(what="the shot engine", seconds=7, uses=(collide_balls, collide_cushion))
def run_batch(positions, velocities, spins, on_table, potted, phys, noses, jaws, falls, fidelity, n_steps, max_events,
              event_time, event_what, segments, status, n_events, n_segments, duration, start, stop):  # fmt: skip
    """Shots ``start`` to ``stop`` of a batch; arrays as in ``run`` with a leading batch axis. Work space is made once."""
    n = positions.shape[1]
    motion, flight = np.zeros((n, cloth.COLUMNS)), np.zeros((n, INDEX + 1))
    pair = np.full((n, n), inf)
    best_time, own_time = np.full(n, inf), np.full(n, inf)
    state, best_ball = np.zeros(n, np.int64), np.full(n, -1)
    own_kind, own_index = np.zeros(n, np.int64), np.full(n, -1)
    work = np.empty(WORK)
    for k in range(start, stop):
        status[k], n_events[k], n_segments[k], duration[k] = run(
            positions[k], velocities[k], spins[k], on_table[k], potted[k], phys, noses, jaws, falls, fidelity, n_steps, max_events,
            event_time[k], event_what[k], segments[k], motion, state, flight, pair, best_time, own_time, best_ball, own_kind, own_index,
            work,
        )  # fmt: skip
