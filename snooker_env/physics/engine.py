"""How does a whole shot run? The event loop: predict, take the earliest event, resolve it, predict again for the balls that it changed.

Predictions are stored: those of a ball hold as long as no event changes its motion. Ties are decided by (time, kind, ball, partner), kinds
in the order of ``EventKind``. The loop allocates nothing.
"""

from math import inf, sqrt

import numpy as np

from .._jit import entry, inlined, kernel
from . import cloth, events, pocket
from .arrays import END_VX, END_VY, FLIGHT, HAD, IN_X, IN_Y, INDEX, KIND, POCKET, U0, U1, Z0, Z1, Balls, Forecast, Log, Motions, Setup
from .cloth import AX, AY, FALLING, GONE, HI_X, HI_Y, LO_X, LO_Y, REST, T0, T_END, VX, VY, WX, WY, WZ, X, Y
from .columns import AXIS_X, FALL_X, FALL_Y, JAW_X, JAW_Y, NOSE_AXIS, NOSE_SIDE
from .detection import HELD, TOUCH, boundary_event, clear_box, may_meet, pair_time
from .events import EventKind as EventKind  # for the layers above
from .events import Status as Status
from .impact.contact import collide_balls, collide_cushion
from .impact.polynomial import WORK
from .meetings import meet, rebound
from .parameters import P_G, P_R, P_SIN, P_SPIN
from .placement import SOUND, place_fault


@kernel
def _begin(motion, state, i, t, r, v, w, phys):
    cloth.begin(motion, state, i, t, r[0], r[1], v[0], v[1], w[0], w[1], w[2], phys)


@kernel
def _fly(motion, state, flight, i, t, x, y, z, vx, vy, u, w, falls, jaws, phys):
    """Ball i is over a pocket, in the air: write its next leg, a straight line to its next event."""
    here = int(flight[i, POCKET])
    end, jaw, T, x1, y1, z1, vx1, vy1, u1 = pocket.fly(x, y, z, vx, vy, u, flight[i, IN_X], flight[i, IN_Y], falls, here, jaws, phys)
    state[i] = FALLING
    T = max(T, pocket.SHORTEST)
    motion[i, X], motion[i, Y], motion[i, VX], motion[i, VY] = x, y, (x1 - x) / T, (y1 - y) / T
    motion[i, AX] = motion[i, AY] = 0.0
    motion[i, WX], motion[i, WY], motion[i, WZ] = w
    motion[i, T0], motion[i, T_END] = t, t + T
    motion[i, LO_X], motion[i, HI_X], motion[i, LO_Y], motion[i, HI_Y] = min(x, x1), max(x, x1), min(y, y1), max(y, y1)
    flight[i, HAD] = 0.5 * (vx * vx + vy * vy + u * u) - phys[P_G] * z
    flight[i, Z0], flight[i, U0], flight[i, Z1], flight[i, U1], flight[i, END_VX], flight[i, END_VY] = z, u, z1, u1, vx1, vy1
    flight[i, KIND] = events.JAW if end == pocket.JAW else events.RETURN if end == pocket.BACK else events.POT
    flight[i, INDEX] = jaw if end == pocket.JAW else here


@kernel
def _aloft(motion, flight, i, t, v, phys):
    """Ball i in the air meets another ball at time t, when its leg has the velocity v: its velocity. The leg starts anew there.

    A leg with the edge or a soft jaw on its way is not straight, and its mean speed in the plane is not that of any moment. Together with
    the drop it may come to more energy than the ball had at the start of the leg: then the ball is slower.
    """
    s = (t - motion[i, T0]) / (motion[i, T_END] - motion[i, T0])
    z, u = flight[i, Z0] + s * (flight[i, Z1] - flight[i, Z0]), flight[i, U0] + s * (flight[i, U1] - flight[i, U0])
    vx, vy = v
    has, had = 0.5 * (vx * vx + vy * vy + u * u), max(0.0, flight[i, HAD] + phys[P_G] * z)
    if has > had:
        k = sqrt(had / has)
        vx, vy, u = vx * k, vy * k, u * k
    flight[i, Z0], flight[i, U0] = z, u
    return vx, vy


@kernel
def _begin_again(motion, state, flight, i, t, r, v, w, falls, jaws, phys):
    """Ball i has new velocities at time t, after a meeting with another ball: write its next phase, on the bed or in the air."""
    if state[i] == FALLING:
        _fly(motion, state, flight, i, t, r[0], r[1], flight[i, Z0], v[0], v[1], flight[i, U0], w, falls, jaws, phys)
    else:
        _begin(motion, state, i, t, r, v, w, phys)


@kernel
def _rescan(pair, best_time, best_ball, i):
    """Find the earliest partner of ball i from the stored pair times; in a tie the ball with the lower index."""
    n = pair.shape[0]
    time, ball = inf, -1
    for j in range(n):
        if pair[i, j] < time:
            time, ball = pair[i, j], j
    best_time[i], best_ball[i] = time, ball


@kernel
def _predict(motion, state, flight, i, t, noses, jaws, falls, clear, R, pair, best_time, best_ball, own_time, own_kind, own_index):
    """Ball i has a new motion at time t: predict all its events, and correct the rows of its partners."""
    n = pair.shape[0]
    still = state[i] == REST
    d = 2.0 * R + TOUCH
    lo_x, hi_x, lo_y, hi_y = motion[i, LO_X] - d, motion[i, HI_X] + d, motion[i, LO_Y] - d, motion[i, HI_Y] + d
    time, ball = inf, -1
    for j in range(n):
        if j == i or state[j] == GONE:
            continue
        if (still and state[j] == REST) or not may_meet(lo_x, hi_x, lo_y, hi_y, motion, j):
            if pair[i, j] < inf:
                pair[i, j] = pair[j, i] = inf
                if best_ball[j] == i:
                    _rescan(pair, best_time, best_ball, j)
            continue
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
    own_time[i], own_kind[i], own_index[i] = inf, events.NONE, -1
    if state[i] == FALLING:
        own_time[i], own_kind[i], own_index[i] = motion[i, T_END], int(flight[i, KIND]), int(flight[i, INDEX])
    elif not still:
        s, kind, index = boundary_event(motion, state, i, noses, jaws, falls, clear, R)
        if s > motion[i, T_END] or kind == events.NONE:
            s, index = motion[i, T_END], -1
            kind = events.STOP if state[i] == cloth.ROLL else events.ROLL if state[i] == cloth.SLIDE else events.BEND
        own_time[i], own_kind[i], own_index[i] = s, kind, index


@kernel
def _is_clear(motion, i, clear):
    """Whether ball i is in the rectangle that noses, jaws and falls leave free, or at most ``HELD`` outside: it is in none of them."""
    x, y = motion[i, X], motion[i, Y]
    lo_x, hi_x, lo_y, hi_y = clear
    return (lo_x - HELD <= x) & (x <= hi_x + HELD) & (lo_y - HELD <= y) & (y <= hi_y + HELD)


@kernel
def _is_astray(motion, state, i, reach, noses, jaws, falls, R):
    """Whether ball i lies or moves on the bed where no ball can be: deeper than ``HELD`` in a cushion, over a pocket, or off the table."""
    return state[i] != FALLING and place_fault(motion[i, X], motion[i, Y], reach, noses, jaws, falls, R, HELD, HELD)[0] != SOUND


@kernel
def _leave(state, i, pair, best_time, best_ball, own_time):
    """Ball i is off the table: remove all its events."""
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
    """Ball i is out of play: write a row that leaves it at (x, y) [m]."""
    for c in range(cloth.COLUMNS):
        motion[i, c] = 0.0
    motion[i, X], motion[i, Y] = x, y


@kernel
def _record(segments, n_segments, motion, state, i):
    """Append ball i's present phase to the path log."""
    if segments.shape[0] == 0:
        return n_segments
    for c in range(cloth.COLUMNS):
        segments[n_segments, c] = motion[i, c]
    segments[n_segments, cloth.SEGMENT_BALL], segments[n_segments, cloth.SEGMENT_STATE] = i, state[i]
    return n_segments + 1


@inlined
def _next_event(best_time, best_ball, own_time, own_kind, own_index):
    """The earliest event: time [s], kind, ball and partner; of simultaneous ones the lowest kind, then the lowest ball."""
    t, kind, i, j = inf, np.int64(events.NONE), np.int64(-1), np.int64(-1)
    for k in range(best_time.shape[0]):
        s = best_time[k]
        if s < t or (s == t and s < inf and kind > events.BALL_BALL):
            t, kind, i, j = s, events.BALL_BALL, k, best_ball[k]
        s = own_time[k]
        if s < t or (s == t and s < inf and kind > own_kind[k]):
            t, kind, i, j = s, own_kind[k], k, own_index[k]
    return t, kind, i, j


@inlined
def run(balls, setup, max_events, log, paths, forecast, series):
    """Simulate one shot to rest, in place. ``paths``, ``forecast`` and ``series`` are work space.

    Returns status, number of events, number of segments, duration [s].

    The kernels called at every event take the arrays one by one, not the tuples. With tuples shots took 4 to 7 % longer at "standard" and
    6 to 16 % longer at "fast" (measured in turn, machine code of both from the cache).
    """
    positions, velocities, spins, on_table, potted = balls
    phys, noses, jaws, falls, reach, fidelity, n_steps = setup
    time, what, segments = log
    motion, state, flight = paths
    pair, best_time, best_ball, own_time, own_kind, own_index = forecast
    n = positions.shape[0]
    R = phys[P_R]
    clear = clear_box(noses, jaws, falls, R)
    n_segments = n_events = np.int64(0)  # (typed: with a literal numba would compile every callee twice)
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
    status = events.OK
    end = 0.0
    while True:
        t, kind, i, j = _next_event(best_time, best_ball, own_time, own_kind, own_index)
        if t == inf:
            break
        if kind == events.POT and state[i] != FALLING:
            r, v, w = cloth.evaluate(motion, state, i, t, phys)
            if pocket.ahead(r[0], r[1], v[0], v[1], falls, j, jaws, phys)[0] < inf:
                kind = np.int64(events.DROP)
        if n_events == max_events:
            status = events.TOO_MANY_EVENTS
            break
        if time.shape[0] > 0:
            if n_events == time.shape[0] or (segments.shape[0] > 0 and n_segments + 2 > segments.shape[0]):
                status = events.LOG_FULL
                break
            time[n_events] = t
            what[n_events, events.LOG_KIND], what[n_events, events.LOG_I], what[n_events, events.LOG_J] = kind, i, j
        n_events += 1
        end = t
        if kind == events.BALL_BALL:
            r1, v1, w1 = cloth.evaluate(motion, state, i, t, phys)
            r2, v2, w2 = cloth.evaluate(motion, state, j, t, phys)
            if state[i] == FALLING:
                v1 = _aloft(motion, flight, i, t, v1, phys)
            if state[j] == FALLING:
                v2 = _aloft(motion, flight, j, t, v2, phys)
            nx, ny = r2[0] - r1[0], r2[1] - r1[1]
            d = sqrt(nx * nx + ny * ny)
            v1, w1, v2, w2, solved = meet(v1, w1, v2, w2, nx / d, ny / d, phys, fidelity, n_steps, series)
            _begin_again(motion, state, flight, i, t, r1, v1, w1, falls, jaws, phys)
            _begin_again(motion, state, flight, j, t, r2, v2, w2, falls, jaws, phys)
        elif kind == events.ROLL or kind == events.STOP or kind == events.BEND:
            cloth.next_phase(motion, state, i, phys)
            solved = True
        elif kind == events.POT:
            r, v, w = cloth.evaluate(motion, state, i, t, phys)
            _lie(motion, i, r[0], r[1])
            if _is_astray(motion, state, i, reach, noses, jaws, falls, R):
                status = events.ASTRAY
                break
            potted[i] = j
            _leave(state, i, pair, best_time, best_ball, own_time)
            motion[i, T0], motion[i, T_END] = t, inf
            n_segments = _record(segments, n_segments, motion, state, i)
            continue
        elif kind == events.DROP:
            r, v, w = cloth.evaluate(motion, state, i, t, phys)
            flight[i, IN_X], flight[i, IN_Y], flight[i, POCKET] = r[0] - falls[j, FALL_X], r[1] - falls[j, FALL_Y], j
            _fly(motion, state, flight, i, t, r[0], r[1], 0.0, v[0], v[1], 0.0, w, falls, jaws, phys)
            solved = True
        elif state[i] == FALLING:
            r, _, w = cloth.evaluate(motion, state, i, t, phys)
            v, u = (flight[i, END_VX], flight[i, END_VY]), flight[i, U1]
            if kind == events.JAW:
                z = flight[i, Z1]
                _, nx, ny, sin_phi, _ = pocket.jaw_gap(r[0], r[1], z, jaws, j, R, phys[P_SIN])
                vx, vy, u, w = pocket.strike_jaw(v[0], v[1], u, w, nx, ny, sin_phi, phys)
                _fly(motion, state, flight, i, t, r[0], r[1], z, vx, vy, u, w, falls, jaws, phys)
            else:  # back on the bed, which stops the vertical motion
                _begin(motion, state, i, t, r, v, w, phys)
            solved = True
        else:
            r, v, w = cloth.evaluate(motion, state, i, t, phys)
            if kind == events.CUSHION:
                nx, ny = (noses[j, NOSE_SIDE], 0.0) if noses[j, NOSE_AXIS] == AXIS_X else (0.0, noses[j, NOSE_SIDE])
            else:
                nx, ny = jaws[j, JAW_X] - r[0], jaws[j, JAW_Y] - r[1]
                d = sqrt(nx * nx + ny * ny)
                nx, ny = nx / d, ny / d
            v, w, solved = rebound(v, w, nx, ny, kind == events.JAW, phys, fidelity, n_steps, series)
            _begin(motion, state, i, t, r, v, w, phys)
        if not solved:
            status = events.IMPACT_UNSOLVED
            break
        if not _is_clear(motion, i, clear) and _is_astray(motion, state, i, reach, noses, jaws, falls, R):
            status = events.ASTRAY
            break
        n_segments = _record(segments, n_segments, motion, state, i)
        _predict(motion, state, flight, i, t, noses, jaws, falls, clear, R, pair, best_time, best_ball, own_time, own_kind, own_index)
        if kind == events.BALL_BALL:
            n_segments = _record(segments, n_segments, motion, state, j)
            _predict(motion, state, flight, j, t, noses, jaws, falls, clear, R, pair, best_time, best_ball, own_time, own_kind, own_index)
    for i in range(n):
        if state[i] == GONE:
            positions[i, 0], positions[i, 1] = motion[i, X], motion[i, Y]
            on_table[i] = False
        else:
            r, v, w = cloth.evaluate(motion, state, i, max(end, motion[i, T0]), phys)
            positions[i, 0], positions[i, 1] = r[0], r[1]
            velocities[i, 0], velocities[i, 1] = v[0], v[1]
            spins[i, 0], spins[i, 1], spins[i, 2] = w[0], w[1], w[2]
            if status == events.OK and phys[P_SPIN] > 0.0:  # at rest a ball may still spin on the spot
                end = max(end, motion[i, T0] + abs(motion[i, WZ]) / phys[P_SPIN])
    return status, n_events, n_segments, end


@entry(what="the shot engine", seconds=7, uses=(collide_balls, collide_cushion))
def run_batch(positions, velocities, spins, on_table, potted, phys, noses, jaws, falls, reach, fidelity, n_steps, max_events, time, what,
              segments, status, n_events, n_segments, duration, start, stop):  # fmt: skip
    """Simulate shots ``start`` to ``stop`` of a batch. All arrays of the balls, the log and the outcome have a leading batch axis.

    The arguments are those of ``Balls``, ``Setup``, ``Log`` and ``Ends``, in their order: ``run_batch(*balls, *setup, max_events, *log,
    *ends, start, stop)``. Passed as four tuples they would take 3 us a call, because numba would then determine the type of each array at
    every call (measured; a shot of two balls takes 6 us). The work space is made once.
    """
    n = positions.shape[1]
    setup = Setup(phys, noses, jaws, falls, reach, fidelity, n_steps)
    paths = Motions(np.zeros((n, cloth.COLUMNS)), np.zeros(n, np.int64), np.zeros((n, FLIGHT)))
    forecast = Forecast(np.zeros((n, n)), np.zeros(n), np.zeros(n, np.int64), np.zeros(n), np.zeros(n, np.int64), np.zeros(n, np.int64))
    series = np.zeros(WORK)
    for k in range(start, stop):
        balls, log = Balls(positions[k], velocities[k], spins[k], on_table[k], potted[k]), Log(time[k], what[k], segments[k])
        status[k], n_events[k], n_segments[k], duration[k] = run(balls, setup, max_events, log, paths, forecast, series)
