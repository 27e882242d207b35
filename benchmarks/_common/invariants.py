"""Does a shot obey the laws? This reads the engine's own log of a shot, piece by piece, and finds the worst figure
of every invariant.

The log holds each ball's motion as closed forms, so the motion between events is checked as well as the events.
For every pair, the check follows the gap in steps no longer than the gap allows (at least ``LEAST``, which can
hide at most 2e-10 m), and likewise for jaws. Energies are those of translation, rotation and height, per unit
mass. A ball in the air over a pocket is judged when it returns: it may have no more energy than at the edge. All
balls together may at no event gain energy; balls in the air may gain at most the energy of a fall by R.
"""

from dataclasses import dataclass
from math import hypot, inf, isfinite, sqrt

import numba
import numpy as np

from snooker_env.kernels import entry, kernel
from snooker_env.physics import flight
from snooker_env.physics.arrays import Boundaries, Ends
from snooker_env.physics.cloth import AIR, AX, AY, COLUMNS, FALLING, GONE, REST, T0, T_END, VX, VY, X, Y
from snooker_env.physics.columns import P_G, P_MU_BB_EXTRA, P_MU_BB_LEAST, P_MU_S, P_R, P_SPIN
from snooker_env.physics.engine import EventKind, Status
from snooker_env.simulation import MAX_EVENTS, _run, log_space

FINITE, CLOCK, JUMP, ENERGY, PHASE, ALL, MOMENTUM = range(7)
PARTING, OVERLAP, CUSHION, OUTSIDE, BELOW, REST_TIME, ACCOUNT = range(7, 14)
WHAT = {
    "finite": "numbers that are not finite",
    "clock": "time going backwards [s]",
    "jump": "jump of a path at an event [m]",
    "energy at impact": "energy gained in an impact, over the energy of its balls",
    "energy between": "energy gained between events, over the ball's",
    "energy of all": "energy gained by all balls together, those in the air too, over the shot's, for each event of a flight",
    "momentum": "momentum of a pair changed by more than the cloth can [of the impulse]",
    "parting": "speed of a pair still closing after its impact, over the closing speed",
    "overlap": "overlap of two balls, at events and between [m]",
    "in cushion": "overlap with a nose or jaw, at events and between [m]",
    "off the table": "place of a ball on the bed beyond all noses and falls [m]",
    "below the bed": "depth of a ball in the air below its height on the bed [m]",
    "rest": "speed (v + R w) left at the reported time of rest [m/s]",
    "account": "balls whose place, fate or log does not add up",
}
NAMES = tuple(WHAT)
LEAST = 1e-5
LEAST_ENERGY = 1e-18
"""Balls with a smaller share of the shot's energy count as at rest, up to rounding."""
_BALL_BALL, _CUSHION, _JAW = map(int, (EventKind.BALL_BALL, EventKind.CUSHION, EventKind.JAW))
_POT, _DROP, _RETURN = map(int, (EventKind.POT, EventKind.DROP, EventKind.RETURN))


@kernel
def _energy(v, w, R):
    return 0.5 * (v[0] * v[0] + v[1] * v[1]) + 0.2 * R * R * (w[0] * w[0] + w[1] * w[1] + w[2] * w[2])


@kernel
def _aloft(rows, state, i, t, phys):
    """Height of ball i above the bed, its rate, and their energy per unit mass; 0 unless it flies."""
    if state[i] != AIR:
        return 0.0, 0.0, 0.0
    z, u = flight.height(rows, state, i, t, phys)
    return z, u, phys[P_G] * z + 0.5 * u * u


@kernel
def _note(worst, what, x):
    if not x <= worst[what]:  # a NaN counts as a failure
        worst[what] = x if x == x else inf


@kernel
def _step(gap, speed, accel, left):
    """The longest time in which two bodies cannot close more than the gap."""
    reach = max(gap, LEAST)
    if speed * left + 0.5 * accel * left * left < reach:
        return left
    return min(left, 2.0 * reach / (speed + sqrt(speed * speed + 2.0 * accel * reach)))


@kernel
def _follow(rows, state, a, b, start, stop, d, phys):
    """The deepest overlap of balls a and b (at distance d) in [start, stop]."""
    ax, ay = rows[a, AX] - rows[b, AX], rows[a, AY] - rows[b, AY]
    falls = (state[a] == AIR) != (state[b] == AIR)
    accel, t, deepest = hypot(ax, ay) + (phys[P_G] if falls else 0.0), start, -inf
    while True:
        r1, v1, _ = flight.evaluate(rows, state, a, t, phys)
        r2, v2, _ = flight.evaluate(rows, state, b, t, phys)
        z1, u1, _ = _aloft(rows, state, a, t, phys)
        z2, u2, _ = _aloft(rows, state, b, t, phys)
        gap = hypot(hypot(r2[0] - r1[0], r2[1] - r1[1]), z2 - z1) - d
        deepest = max(deepest, -gap)
        if not t < stop:
            return deepest
        step = _step(gap, hypot(hypot(v1[0] - v2[0], v1[1] - v2[1]), u1 - u2), accel, stop - t)
        t = stop if not t + step < stop else t + step


@kernel
def _all_energy(rows, state, t, phys):
    """Energy of all balls at t, counting only certain energy for those in the air, and the number in the air."""
    total, air = 0.0, 0
    for i in range(len(rows)):
        if state[i] != GONE:
            _, v, w = flight.evaluate(rows, state, i, t, phys)
            total += _energy(v, w, phys[P_R]) + _aloft(rows, state, i, t, phys)[2]
            if state[i] == FALLING:
                total -= phys[P_G] * phys[P_R]
                air += 1
    return total, air


@kernel
def _beyond(r, noses, falls):
    """Distance of a centre outside the rectangle around the noses and falls [m]."""
    out = -inf
    for axis in range(2):
        for side in (-1.0, 1.0):
            level = -inf
            for k in range(len(noses)):
                if noses[k, 0] == axis and noses[k, 1] == side:
                    level = max(level, noses[k, 2])
            if level > -inf:
                for k in range(len(falls)):
                    level = max(level, side * falls[k, axis] + falls[k, 2])
                out = max(out, side * r[axis] - level)
    return out


@kernel
def _in_jaw(jaw, x, y, R):
    """Depth of a centre in a jaw (-inf if it does not face the jaw), and its distance from the jaw.

    A jaw is no deeper than a ball, because another part of the table lies far behind a straight facing. (No path
    gets there unseen, because the steps are much shorter.)
    """
    dx, dy = x - jaw[0], y - jaw[1]
    far, level, inner = hypot(dx, dy), jaw[2] + R, jaw[2] - R
    ahead, cos_half = dx * jaw[3] + dy * jaw[4], jaw[5]
    if ahead >= cos_half * far:
        if inner < far:
            return level - far, max(far - level, 0.0)
        return -inf, inner - far
    beside, sin_half = abs(dx * jaw[4] - dy * jaw[3]), sqrt(1.0 - cos_half * cos_half)
    nearest = min(max(ahead * cos_half + beside * sin_half, inner), level)  # on the end of the arc's band
    return -inf, hypot(ahead - nearest * cos_half, beside - nearest * sin_half)


@kernel
def _in_boundary(r, noses, jaws, R):
    """Depth of a centre in a nose or jaw, and its distance from the next jaw."""
    deepest, clear = -inf, inf
    for k in range(len(noses)):
        across, along = (r[0], r[1]) if noses[k, 0] == 0.0 else (r[1], r[0])
        if noses[k, 3] <= along <= noses[k, 4]:
            deepest = max(deepest, noses[k, 1] * across - (noses[k, 2] - R))
    for k in range(len(jaws)):
        deep, far = _in_jaw(jaws[k], r[0], r[1], R)
        deepest, clear = max(deepest, deep), min(clear, far)
    return deepest, clear


@kernel
def _along_boundary(rows, state, i, stop, noses, jaws, R, phys):
    """The largest depth of ball i in noses and jaws over its current piece, until ``stop``."""
    t, deepest = rows[i, T0], -inf
    if state[i] == REST or len(noses) + len(jaws) == 0:
        stop = t
    accel = hypot(rows[i, AX], rows[i, AY])
    for c in range(2):  # at its turning point, a parabola may dip into a nose
        a = rows[i, AX + c]
        turn = rows[i, T0] - rows[i, VX + c] / a if a != 0.0 else inf
        if rows[i, T0] < turn < stop:
            deepest = max(
                deepest, _in_boundary(flight.evaluate(rows, state, i, turn, phys)[0], noses, jaws, R)[0]
            )
    while True:
        r, v, _ = flight.evaluate(rows, state, i, t, phys)
        deep, clear = _in_boundary(r, noses, jaws, R)
        deepest = max(deepest, deep)
        if not t < stop:
            return deepest
        step = _step(min(clear, 0.02), hypot(v[0], v[1]), accel, stop - t)
        t = stop if not t + step < stop else t + step


@numba.njit(nogil=True, error_model="numpy")  # inner kernels allocate no arrays
def _check(segments, what, n, duration, phys, boundaries, worst):
    noses, jaws, falls, R = boundaries
    D = 2.0 * R
    rows, state = np.zeros((n, COLUMNS)), np.zeros(n, np.int64)
    old, old_state = np.zeros((n, COLUMNS)), np.zeros(n, np.int64)
    brought = np.zeros(n)  # energy of the balls in the air when they reached the edge
    for i in range(n):
        rows[i] = segments[i, :COLUMNS]
        state[i] = int(segments[i, COLUMNS + 1])
    at, now = n, 0.0
    shot, _ = _all_energy(rows, state, 0.0, phys)
    had, flown = shot, 0  # energy of all balls when none was last in the air, and the events since then
    for e in range(len(what)):
        kind, i, j = what[e, 0], what[e, 1], what[e, 2]
        balls = 2 if kind == _BALL_BALL else 1
        if at + balls > len(segments):
            _note(worst, ACCOUNT, 1.0)
            return
        t = segments[at, T0]
        _note(worst, CLOCK, now - t)
        now = t
        before = after = 0.0
        for k in range(balls):
            b = i if k == 0 else j
            old[b], old_state[b] = rows[b], state[b]
            new = segments[at + k]
            if int(new[COLUMNS]) != b or new[T0] != t or state[b] == GONE:
                _note(worst, ACCOUNT, 1.0)
                return
            for c in range(COLUMNS):
                if not (isfinite(new[c]) or (c == T_END and new[c] > 0.0)):
                    _note(worst, FINITE, 1.0)
                    return
            r, v, w = flight.evaluate(rows, state, b, t, phys)
            _, v0, w0 = flight.evaluate(rows, state, b, rows[b, T0], phys)
            z, _, own = _aloft(rows, state, b, t, phys)
            begun, ended = (
                _energy(v0, w0, R) + _aloft(rows, state, b, rows[b, T0], phys)[2],
                _energy(v, w, R) + own,
            )
            if begun > 0.0:
                _note(worst, PHASE, (ended - begun) / begun)
            before += ended
            _note(worst, JUMP, hypot(r[0] - new[X], r[1] - new[Y]))
            _note(worst, BELOW, -z)
            if state[b] != FALLING and state[b] != AIR:
                _note(worst, CUSHION, _along_boundary(rows, state, b, t, noses, jaws, R, phys))
            for other in range(n):
                if other != b and state[other] != GONE and not (state[other] == REST and state[b] == REST):
                    _note(
                        worst,
                        OVERLAP,
                        _follow(rows, state, b, other, max(rows[b, T0], rows[other, T0]), t, D, phys),
                    )
        for k in range(balls):
            b = i if k == 0 else j
            rows[b] = segments[at + k, :COLUMNS]
            state[b] = int(segments[at + k, COLUMNS + 1])
            if state[b] != GONE:
                _, v, w = flight.evaluate(rows, state, b, t, phys)
                z_new, _, own = _aloft(rows, state, b, t, phys)
                after += _energy(v, w, R) + own
                if old_state[b] == AIR or state[b] == AIR:
                    _note(worst, JUMP, abs(z_new - _aloft(old, old_state, b, t, phys)[0]))
        at += balls
        total, air = _all_energy(rows, state, t, phys)
        flown += 1
        if shot > 0.0:
            _note(worst, ALL, (total - had) / (shot * flown))
        if air == 0:
            had, flown = total, 0
        for k in range(balls):
            b = i if k == 0 else j
            if state[b] != FALLING and state[b] != GONE and state[b] != AIR:
                _note(worst, OUTSIDE, _beyond((rows[b, X], rows[b, Y]), noses, falls))
        in_air = old_state[i] == FALLING or (balls == 2 and old_state[j] == FALLING)
        flies = (
            state[i] == AIR
            or old_state[i] == AIR
            or (balls == 2 and (state[j] == AIR or old_state[j] == AIR))
        )
        if kind == _DROP:
            brought[i] = before
        elif balls == 2 and in_air:  # no ball can take more than the energy of both
            brought[i] += before
            brought[j] += before
        elif kind == _RETURN:
            _note(worst, ENERGY, (after - brought[i]) / brought[i])
        elif before > LEAST_ENERGY * shot and not in_air:
            _note(worst, ENERGY, (after - before) / before)
        if kind == _BALL_BALL and not flies:
            r1, v1, _ = flight.evaluate(old, old_state, i, t, phys)
            r2, v2, _ = flight.evaluate(old, old_state, j, t, phys)
            nx, ny = (
                (r2[0] - r1[0]) / hypot(r2[0] - r1[0], r2[1] - r1[1]),
                (r2[1] - r1[1]) / hypot(r2[0] - r1[0], r2[1] - r1[1]),
            )
            closing = (v1[0] - v2[0]) * nx + (v1[1] - v2[1]) * ny
            a1, a2 = rows[i, VX] - v1[0], rows[i, VY] - v1[1]
            b1, b2 = rows[j, VX] - v2[0], rows[j, VY] - v2[1]
            push = hypot(a1 + b1, a2 + b2)
            impulse = max(hypot(a1, a2), hypot(b1, b2))
            size = hypot(v1[0], v1[1]) + hypot(v2[0], v2[1])
            share = phys[P_MU_S] * (phys[P_MU_BB_LEAST] + phys[P_MU_BB_EXTRA])
            if impulse > 0.0 and not in_air and before > LEAST_ENERGY * shot:
                _note(worst, MOMENTUM, (push - share * (impulse + push) - 1e-14 * size) / impulse)
            still = (rows[i, VX] - rows[j, VX]) * nx + (rows[i, VY] - rows[j, VY]) * ny
            if closing > 0.0 and not in_air:
                _note(worst, PARTING, (still - 1e-14 * size) / closing)
        elif (kind == _CUSHION or kind == _JAW) and not in_air and not flies:
            if kind == _CUSHION:
                nx, ny = (noses[j, 1], 0.0) if noses[j, 0] == 0.0 else (0.0, noses[j, 1])
            else:
                nx, ny = jaws[j, 0] - rows[i, X], jaws[j, 1] - rows[i, Y]
                far = hypot(nx, ny)
                nx, ny = nx / far, ny / far
            _, v, _ = flight.evaluate(old, old_state, i, t, phys)
            closing = v[0] * nx + v[1] * ny
            if closing > 0.0:
                _note(
                    worst,
                    PARTING,
                    (rows[i, VX] * nx + rows[i, VY] * ny - 1e-14 * hypot(v[0], v[1])) / closing,
                )
        elif (kind == _DROP or (kind == _POT and not in_air)) and not flies:
            far = hypot(rows[i, X] - falls[j, 0], rows[i, Y] - falls[j, 1])
            _note(worst, JUMP, abs(far - falls[j, 2]))
    if at != len(segments):
        _note(worst, ACCOUNT, 1.0)
    for i in range(n):
        if state[i] == GONE:
            continue
        r, v, w = flight.evaluate(rows, state, i, duration, phys)
        left = hypot(v[0], v[1]) + R * (hypot(w[0], w[1]) + (abs(w[2]) if phys[P_SPIN] > 0.0 else 0.0))
        _note(worst, REST_TIME, left)
        if state[i] != REST:
            _note(worst, ACCOUNT, 1.0)
        _note(worst, CUSHION, _in_boundary(r, noses, jaws, R)[0])
        for j in range(i):
            if state[j] != GONE:
                _note(worst, OVERLAP, D - hypot(rows[i, X] - rows[j, X], rows[i, Y] - rows[j, Y]))


@entry
def _check_all(log, ends, n, phys, boundaries, worst):
    for k in range(len(worst)):
        if ends.status[k] == 0:
            segments, what = log.segments[k, : ends.n_segments[k]], log.what[k, : ends.n_events[k]]
            _check(segments, what, n, ends.duration[k], phys, boundaries, worst[k])


@dataclass(frozen=True)
class Checked:
    """The results of b shots: outcome and the worst figure of each invariant."""

    positions: np.ndarray
    on_table: np.ndarray
    potted: np.ndarray
    duration: np.ndarray
    n_events: np.ndarray
    status: np.ndarray
    """``Status`` of each shot; if it is not OK, nothing else is judged."""
    worst: np.ndarray
    """(b, len(NAMES))"""


def play(balls, physics, table, fidelity, max_events=MAX_EVENTS, log_size=512):
    """Play b shots and check each. balls: positions, velocities, spins and on_table, plus heights and their rates if balls
    fly; fidelity as from ``parse_fidelity``."""
    state = [np.array(a) for a in balls]
    b, n = state[0].shape[:2]
    log = log_space(b, log_size, 2 * log_size + n + 2)
    out = _run(state, physics, table, fidelity, max_events, log)
    worst = np.full((b, len(NAMES)), -inf)
    ends = Ends(out.status, out.n_events, out.n_segments, out.duration)
    _check_all(
        log, ends, n, physics.pack(), Boundaries(table.noses, table.jaws, table.falls, physics.R), worst
    )
    checked = Checked(state[0], state[3], out.potted, out.duration, out.n_events, out.status, worst)
    for k in np.flatnonzero(out.status == Status.LOG_FULL):  # few shots, with more room
        one = play([a[k : k + 1] for a in balls], physics, table, fidelity, max_events, 8 * log_size)
        for mine, its in zip(vars(checked).values(), vars(one).values(), strict=True):
            mine[k] = its[0]
    finite = np.isfinite(checked.positions).all((1, 2)) & np.isfinite(checked.duration)
    worst[~finite, FINITE] = 1.0
    return checked
