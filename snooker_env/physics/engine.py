"""How does a whole shot run? Predict, take the earliest event, resolve it, predict its balls anew.

A ball's predictions hold until an event changes its motion. Ties: by (time, kind, ball, partner)."""

from math import inf, sqrt

import numpy as np

from .._lib.jit import entry, inline, kernel
from .._lib.lanes import LANES, lane, lanes, lanes_at, lesser, no_more
from . import cloth, columns, events, flight, pocket
from .arrays import Balls, Boundaries, Forecast, Law, Log, Motions, Setup
from .cloth import AIR, FALLING, GONE, HI_X, HI_Y, LO_X, LO_Y, REST, T0, T_END, UZ, VX, VY, WZ, X, Y, Z
from .detection import HELD, TOUCH, boundary_event, clear_box, pair_time
from .events import EventKind as EventKind  # for the layers above
from .events import Status as Status
from .flight import SETTLE
from .impact import free
from .impact.polynomial import WORK
from .meetings import energy_loss, meet, meet_in_air, rebound, rebound_in_air
from .parameters import FARTHEST, FASTEST, MOST_SPIN
from .placement import SOUND, layout_fault, place_fault

_LIFTS = -1  # status of a run without flight that has stopped where a ball would fly
_LATEST = 1.7e308  # every time of a meeting is below


@kernel
def _begin_again(paths, i, t, ball, way, other, boundaries, phys):
    """Ball i = (r, v, w) met a ball at t, which now has the velocity ``other``; ``way``: unit vector to it. Write its next phase."""
    (motion, state, falls), (r, v, w) = paths, ball
    if state[i] == FALLING:
        at, velocity = (r[0], r[1], falls[i, pocket.Z0]), (v[0], v[1], falls[i, pocket.U0])
        at_once = motion[i, T0] == t
        pocket.next_leg(paths, i, t, at, velocity, w, boundaries, phys)
        # A leg is its mean line, which may lead back into the other ball where edge and jaw hold this one. The two
        # would meet again without end: so this ball is pressed over the edge, and lost.
        if at_once and (motion[i, VX] - other[0]) * way[0] + (motion[i, VY] - other[1]) * way[1] > 0.0:
            pocket.lose(paths, i, t, at, velocity, w, phys)
    else:
        cloth.begin(motion, state, i, t, (r[0], r[1]), (v[0], v[1]), w, phys)


@kernel
def _part(paths, i, j, t, ball_i, ball_j, before, boundaries, phys):
    """Two balls part (``before``: v1, w1, v2, w2): one is lifted; the bed gives the other back at most what the impact has lost."""
    motion, state, _falls = paths
    impulse = max(ball_i[1][2], ball_j[1][2])
    if impulse > 0.0:
        after = ball_i[1], ball_i[2], ball_j[1], ball_j[2]
        impulse = min(impulse, sqrt(2.0 * energy_loss(before, after, phys[columns.P_R])))
    (xi, yi), (xj, yj) = ball_i[0], ball_j[0]
    nx, ny = (xj - xi) / (2.0 * phys[columns.P_R]), (yj - yi) / (2.0 * phys[columns.P_R])
    both = (i, ball_i, (nx, ny), ball_j[1]), (j, ball_j, (-nx, -ny), ball_i[1])
    for k, (r, v, w), way, other in both:
        if state[k] == FALLING:
            _begin_again(paths, k, t, (r, v, w), way, other, boundaries, phys)
        elif v[2] > 0.0:
            flight.leave(motion, state, k, t, r, v, w, v[2], phys)
        else:
            u, spin, up = flight.press_into_bed(v, w, impulse, phys)
            flight.leave(motion, state, k, t, r, u, spin, up, phys)


@kernel
def _meet_in_air(paths, i, j, t, law, boundaries, series):
    """Balls i and j meet, one or both in the air: write their next phases; OK, or IMPACT_UNSOLVED."""
    motion, state, falls = paths
    phys = law.phys
    zi, ui = flight.height(motion, state, i, t, phys)
    zj, uj = flight.height(motion, state, j, t, phys)
    if state[j] == AIR and (state[i] != AIR or zj > zi):
        i, j, zi, ui, zj, uj = j, i, zj, uj, zi, ui  # i is in the air, and not below j
    (x1, y1), v1, w1 = flight.evaluate(motion, state, i, t, phys)
    (x2, y2), v2, w2 = flight.evaluate(motion, state, j, t, phys)
    other = state[j]
    if other == FALLING:
        v2 = pocket.aloft(motion, falls, j, t, v2, phys)
    if other != AIR:
        zj, uj = 0.0, 0.0
    nx, ny, nz = x2 - x1, y2 - y1, zj - zi
    d = sqrt(nx * nx + ny * ny + nz * nz)
    lies, normal = other != AIR and other != FALLING, (nx / d, ny / d, nz / d)
    v1, v2 = (v1[0], v1[1], ui), (v2[0], v2[1], uj)
    a, wa, b, wb, press, solved = meet_in_air(v1, w1, v2, w2, normal, lies, law, series)
    flight.take_off(motion, state, i, t, (x1, y1, zi), a, wa, phys)
    if other == AIR:
        flight.take_off(motion, state, j, t, (x2, y2, zj), b, wb, phys)
    elif other == FALLING:
        _begin_again(paths, j, t, ((x2, y2), b, wb), (-nx / d, -ny / d), a, boundaries, phys)
    elif b[2] > 0.0:
        flight.leave(motion, state, j, t, (x2, y2), b, wb, b[2], phys)
    else:
        u, spin, up = flight.press_into_bed(b, wb, press, phys)
        flight.leave(motion, state, j, t, (x2, y2), u, spin, up, phys)
    return events.OK if solved else events.IMPACT_UNSOLVED


@kernel
def _in_air(paths, i, kind, j, t, boundaries, phys):
    """Ball i in the air meets a nose, a jaw, the bed, a rail or a fall at t: write its next phase."""
    motion, state, falls = paths
    (x, y), (vx, vy), w = flight.evaluate(motion, state, i, t, phys)
    z, u = flight.height(motion, state, i, t, phys)
    if kind == events.CUSHION or kind == events.JAW:
        normal = flight.edge_normal(motion, state, i, t, kind, j, boundaries, phys)
        v, w = rebound_in_air((vx, vy, u), w, normal, kind == events.JAW, phys)
        flight.take_off(motion, state, i, t, (x, y, z), v, w, phys)
    elif kind == events.LAND:
        v, w, up = flight.bounce_off_bed((vx, vy), w, -u, phys)
        flight.leave(motion, state, i, t, (x, y), v, w, up, phys)
    elif kind == events.RAIL:
        v, w, up = flight.bounce_off_bed((vx, vy), w, -u, phys)
        flight.take_off(motion, state, i, t, (x, y, z), (v[0], v[1], up), w, phys)
    else:
        # it came over the pocket where its path enters the circle
        fall, speed2, back = boundaries.falls[j], vx * vx + vy * vy, 0.0
        dx, dy, radius = x - fall[columns.FALL_X], y - fall[columns.FALL_Y], fall[columns.FALL_RADIUS]
        if speed2 > 0.0:
            along, inside2 = dx * vx + dy * vy, radius * radius - dx * dx - dy * dy
            back = (along + sqrt(max(0.0, along * along + inside2 * speed2))) / speed2
        falls[i, pocket.IN_X], falls[i, pocket.IN_Y] = dx - vx * back, dy - vy * back
        falls[i, pocket.POCKET] = j
        pocket.next_leg(paths, i, t, (x, y, 0.0), (vx, vy, -u), w, boundaries, phys)


@kernel
def _earliest(times):
    """The least of these times, and its first index."""
    least = lanes_at(times, 0)
    for k in range(LANES, times.shape[0], LANES):
        least = lesser(lanes_at(times, k), least)
    t = min(min(lane(least, 0), lane(least, 1)), min(lane(least, 2), lane(least, 3)))
    latest, k = lanes(t, t, t, t), 0
    which = no_more(lanes_at(times, 0), latest)
    while which == 0:
        k += LANES
        which = no_more(lanes_at(times, k), latest)
    while which & 1 == 0:
        which >>= 1
        k += 1
    return t, k


@kernel
def _rescan(pair, best_time, best_ball, i):
    """Ball i's earliest partner from the stored pair times; in a tie the lower index."""
    time, ball = _earliest(pair[i])
    best_time[i], best_ball[i] = time, ball if time < inf else -1


@kernel
def _bound(bounds, i, lo_x, hi_x, lo_y, hi_y):
    """Keep the bounds of ball i's path [m]."""
    bounds[0, i], bounds[1, i], bounds[2, i], bounds[3, i] = lo_x, hi_x, lo_y, hi_y


@kernel
def _predict(paths, i, t, boundaries, clear, forecast, phys, aloft):
    """Ball i has a new motion at time t: predict all its events, and correct its partners' rows."""
    motion, state, falls = paths
    bounds, pair, best_time, best_ball, alone_time, alone_kind, alone_index = forecast
    still, flies, m = state[i] == REST, state[i] == AIR, pair.shape[1]
    d = 2.0 * boundaries.R + TOUCH
    lo_x, hi_x, lo_y, hi_y = motion[i, LO_X], motion[i, HI_X], motion[i, LO_Y], motion[i, HI_Y]
    _bound(bounds, i, lo_x, hi_x, lo_y, hi_y)
    lo_x, hi_x, lo_y, hi_y = lo_x - d, hi_x + d, lo_y - d, hi_y + d
    lows_x, highs_x = lanes(lo_x, lo_x, lo_x, lo_x), lanes(hi_x, hi_x, hi_x, hi_x)
    lows_y, highs_y = lanes(lo_y, lo_y, lo_y, lo_y), lanes(hi_y, hi_y, hi_y, hi_y)
    known = lanes(_LATEST, _LATEST, _LATEST, _LATEST)
    time, ball = inf, -1
    for k in range(0, m, LANES):
        # whose path has a place in this one's bounds, and whose meeting with i was known
        near = (
            no_more(lows_x, lanes_at(bounds, m + k))
            & no_more(lanes_at(bounds, k), highs_x)
            & no_more(lows_y, lanes_at(bounds, 3 * m + k))
            & no_more(lanes_at(bounds, 2 * m + k), highs_y)
        )
        which = near | no_more(lanes_at(pair, i * m + k), known)
        j = k - 1
        while which:
            j += 1
            wanted, is_near = which & 1, near & 1
            which >>= 1
            near >>= 1
            if not wanted or j == i:
                continue
            if not is_near or (still and state[j] == REST):
                if pair[i, j] < inf:
                    pair[i, j] = pair[j, i] = inf
                    if best_ball[j] == i:
                        _rescan(pair, best_time, best_ball, j)
                continue
            a, b = (i, j) if i < j else (j, i)
            if aloft is not None and (flies or state[j] == AIR):
                s = flight.pair_time(motion, state, a, b, t, 2.0 * boundaries.R, phys)
            else:
                s = pair_time(motion, state, a, b, t, 2.0 * boundaries.R)
            pair[i, j] = pair[j, i] = s
            if s < time:
                time, ball = s, j
            if s < best_time[j] or (s == best_time[j] and i < best_ball[j]):
                best_time[j], best_ball[j] = s, i
            elif best_ball[j] == i and s > best_time[j]:
                _rescan(pair, best_time, best_ball, j)
    best_time[i], best_ball[i] = time, ball
    alone_time[i], alone_kind[i], alone_index[i] = inf, events.NONE, -1
    if state[i] == FALLING:
        alone_time[i], alone_index[i] = motion[i, T_END], int(falls[i, pocket.INDEX])
        alone_kind[i] = int(falls[i, pocket.KIND])
    elif state[i] == AIR:
        if aloft is not None:
            s, kind, index = flight.next_event(motion, i, boundaries, clear, phys)
            alone_time[i], alone_kind[i], alone_index[i] = s, kind, index
    elif not still:
        s, kind, index = boundary_event(motion, state, i, boundaries, clear)
        if s > motion[i, T_END] or kind == events.NONE:
            s, index = motion[i, T_END], -1
            kind = events.ROLL if state[i] == cloth.SLIDE else events.BEND
            kind = events.STOP if state[i] == cloth.ROLL else kind
        alone_time[i], alone_kind[i], alone_index[i] = s, kind, index


@kernel
def _is_clear(motion, i, clear):
    """Whether ball i is in the rectangle free of noses, jaws and falls, or at most ``HELD`` outside."""
    x, y = motion[i, X], motion[i, Y]
    lo_x, hi_x, lo_y, hi_y = clear
    return (lo_x - HELD <= x) & (x <= hi_x + HELD) & (lo_y - HELD <= y) & (y <= hi_y + HELD)


@kernel
def _is_astray(motion, state, i, reach, boundaries):
    """Whether ball i is on the bed deeper than ``HELD`` in a cushion, over a pocket, or off the table."""
    if state[i] == FALLING or state[i] == AIR:
        return False
    return place_fault(motion[i, X], motion[i, Y], reach, boundaries, HELD, HELD)[0] != SOUND


@kernel
def _watch(paths, kind, j, t, phys):
    """Ball 0 has an event at t: is its stroke a jump shot? In columns of ``flight``, until that is certain."""
    motion, state, seen = paths
    d, other = 2.0 * phys[columns.P_R], j if kind == events.BALL_BALL else -1
    flies, struck = state[0] == AIR, int(seen[0, flight.STRUCK])
    (x, y), _v, _w = flight.evaluate(motion, state, 0, t, phys)
    if struck < 0:
        if flies and flight.passes_over(motion, state, 0, t, other, d):
            seen[0, flight.JUMPED] = 1.0
        if other >= 0:
            (a, b), _v, _w = flight.evaluate(motion, state, other, t, phys)
            least = d - flight.OVER
            above = flies and (a - x) * (a - x) + (b - y) * (b - y) < least * least
            seen[0, flight.STRUCK], seen[0, flight.WATCHED] = other, 0.0 if above else -1.0
            seen[0, flight.WAY_X], seen[0, flight.WAY_Y] = motion[0, VX], motion[0, VY]
        return
    # it met that ball from above: where does it come down?
    seen[0, flight.WATCHED] = -1.0
    if state[struck] == GONE:
        seen[0, flight.JUMPED] = 1.0
        return
    (a, b), _v, _w = flight.evaluate(motion, state, struck, t, phys)
    if (x - a) * seen[0, flight.WAY_X] + (y - b) * seen[0, flight.WAY_Y] > 0.0:
        seen[0, flight.JUMPED] = 1.0


@kernel
def _lands_off(motion, state, i, t, clear, reach, boundaries):
    """Whether ball i comes down, or out of a pocket, where no bed is: behind jaws."""
    dt = t - motion[i, T0]
    x, y = motion[i, X] + motion[i, VX] * dt, motion[i, Y] + motion[i, VY] * dt
    if clear[0] <= x <= clear[1] and clear[2] <= y <= clear[3]:
        return False
    return place_fault(x, y, reach, boundaries, HELD, HELD)[0] != SOUND


@kernel
def _lie(motion, i, x, y):
    """Ball i is out of play: it lies at (x, y) [m]."""
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


@inline
def _begin(balls, aloft, segments, paths, boundaries, clear, forecast, phys):
    """Write the first phase of each ball and predict its events -> the number of segments."""
    positions, velocities, spins, on_table, potted = balls
    motion, state, _ = paths
    bounds, pair, best_time, best_ball, alone_time, _, _ = forecast
    n_segments = np.int64(0)  # (typed: with a literal numba would compile ``_record`` twice)
    for i in range(state.shape[0]):
        potted[i] = -1
        best_time[i], best_ball[i], alone_time[i] = inf, -1, inf
        for j in range(pair.shape[1]):
            pair[i, j] = inf
        if on_table[i]:
            r, v = (positions[i, 0], positions[i, 1]), (velocities[i, 0], velocities[i, 1])
            w = spins[i, 0], spins[i, 1], spins[i, 2]
            motion[i, Z] = motion[i, UZ] = 0.0
            cloth.begin(motion, state, i, 0.0, r, v, w, phys)
            if aloft is not None and (aloft[i, 0] > 0.0 or aloft[i, 1] != 0.0):
                r3, v3 = (r[0], r[1], aloft[i, 0]), (v[0], v[1], aloft[i, 1])
                flight.take_off(motion, state, i, 0.0, r3, v3, w, phys)
            _bound(bounds, i, motion[i, LO_X], motion[i, HI_X], motion[i, LO_Y], motion[i, HI_Y])
        else:
            state[i] = GONE
            _lie(motion, i, positions[i, 0], positions[i, 1])
            _bound(bounds, i, inf, -inf, inf, -inf)
        n_segments = _record(segments, n_segments, motion, state, i)
    for i in range(state.shape[0]):
        if state[i] > REST:
            _predict(paths, i, 0.0, boundaries, clear, forecast, phys, aloft)
    return n_segments


@inline
def _next_event(forecast):
    """The earliest event: time [s], kind, ball, partner; ties: the lowest kind, then the lowest ball."""
    _bounds, _pair, best_time, best_ball, alone_time, alone_kind, alone_index = forecast
    t, i = _earliest(best_time)
    s, k = _earliest(alone_time)
    if t <= s:
        kind, j = np.int64(events.NONE if t == inf else events.BALL_BALL), best_ball[i]
    else:
        t, i, kind = s, k, alone_kind[k]
        for k in range(i + 1, alone_kind.shape[0]):
            if alone_time[k] == t and alone_kind[k] < kind:
                i, kind = k, alone_kind[k]
        j = alone_index[i]
    return t, kind, i, j


@inline
def _kind_now(paths, aloft, t, kind, i, j, setup):
    """The kind of an event, now that it comes: a ball at a fall may fly on; one may come down where no bed is."""
    motion, state, _ = paths
    law, _, boundaries, reach, clear = setup
    if kind == events.POT and state[i] != FALLING and state[i] != AIR:
        (x, y), (vx, vy), _ = cloth.evaluate(motion, state, i, t, law.phys)
        if pocket.ahead(x, y, vx, vy, boundaries.falls, j, boundaries.jaws, law.phys)[0] < inf:
            return np.int64(events.DROP)
    down = aloft is not None and (kind == events.LAND or kind == events.RETURN)
    if down and _lands_off(motion, state, i, t, clear, reach, boundaries):
        return np.int64(events.OFF if kind == events.LAND else events.POT)
    return kind


@inline
def _note(log, n_events, n_segments, max_events, t, kind, i, j):
    """Write an event to the log -> OK, or why there may be no more."""
    time, what, segments = log
    if n_events == max_events:
        return events.TOO_MANY_EVENTS
    if time.shape[0] > 0:
        if n_events == time.shape[0] or (segments.shape[0] > 0 and n_segments + 2 > segments.shape[0]):
            return events.LOG_FULL
        time[n_events] = t
        what[n_events, events.LOG_KIND] = kind
        what[n_events, events.LOG_I], what[n_events, events.LOG_J] = i, j
    return events.OK


@inline
def _meet_on_bed(paths, aloft, lift, i, j, t, met, setup, series):
    """Balls i and j meet, neither in the air: write their next phases -> a status."""
    motion, state, over = paths
    law, first, boundaries, _, _ = setup
    phys = law.phys
    r1, v1, w1 = cloth.evaluate(motion, state, i, t, phys)
    r2, v2, w2 = cloth.evaluate(motion, state, j, t, phys)
    if state[i] == FALLING:
        v1 = pocket.aloft(motion, over, i, t, v1, phys)
    if state[j] == FALLING:
        v2 = pocket.aloft(motion, over, j, t, v2, phys)
    nx, ny = r2[0] - r1[0], r2[1] - r1[1]
    d = sqrt(nx * nx + ny * ny)
    nx, ny = nx / d, ny / d
    u1, s1, u2, s2, solved = meet(v1, w1, v2, w2, (nx, ny), law if met else first, series)
    if max(u1[2], u2[2]) >= lift:
        if aloft is None:
            return _LIFTS
        else:
            before = (v1[0], v1[1], 0.0), w1, (v2[0], v2[1], 0.0), w2
            _part(paths, i, j, t, (r1, u1, s1), (r2, u2, s2), before, boundaries, phys)
    else:
        _begin_again(paths, i, t, (r1, u1, s1), (nx, ny), u2, boundaries, phys)
        other = motion[i, VX], motion[i, VY]
        _begin_again(paths, j, t, (r2, u2, s2), (-nx, -ny), other, boundaries, phys)
    return events.OK if solved else events.IMPACT_UNSOLVED


@kernel
def _over_pocket(paths, i, kind, j, t, boundaries, phys):
    """Ball i comes over a pocket; or there it meets a jaw, or comes back: write its next phase."""
    motion, state, over = paths
    r, v, w = cloth.evaluate(motion, state, i, t, phys)
    if kind == events.DROP:
        over[i, pocket.IN_X] = r[0] - boundaries.falls[j, columns.FALL_X]
        over[i, pocket.IN_Y] = r[1] - boundaries.falls[j, columns.FALL_Y]
        over[i, pocket.POCKET] = j
        pocket.next_leg(paths, i, t, (r[0], r[1], 0.0), (v[0], v[1], 0.0), w, boundaries, phys)
        return
    v = over[i, pocket.END_VX], over[i, pocket.END_VY]
    if kind == events.JAW:
        at = r[0], r[1], over[i, pocket.Z1]
        _, nx, ny, sin_phi, _ = pocket.jaw_gap(at, boundaries.jaws, j, boundaries.R, phys[columns.P_SIN])
        cos_phi = sqrt(1.0 - sin_phi * sin_phi)
        normal, falls_at = (nx * cos_phi, ny * cos_phi, sin_phi), (v[0], v[1], -over[i, pocket.U1])
        u, w = free.against(falls_at, w, normal, phys[columns.P_MU_C], phys[columns.P_E_J], boundaries.R)
        pocket.next_leg(paths, i, t, at, (u[0], u[1], -u[2]), w, boundaries, phys)
    else:  # back on the bed, which stops the vertical motion
        cloth.begin(motion, state, i, t, r, v, w, phys)
        motion[i, Z] = motion[i, UZ] = 0.0


@inline
def _rebound_on_bed(paths, aloft, lift, i, kind, j, t, law, boundaries, series):
    """Ball i on the bed meets a nose or a jaw: write its next phase -> a status."""
    motion, state, _ = paths
    noses, jaws, phys = boundaries.noses, boundaries.jaws, law.phys
    r, v, w = cloth.evaluate(motion, state, i, t, phys)
    if kind == events.CUSHION:
        side, across = noses[j, columns.NOSE_SIDE], noses[j, columns.NOSE_AXIS] == columns.AXIS_X
        nx, ny = (side, 0.0) if across else (0.0, side)
    else:
        nx, ny = jaws[j, columns.JAW_X] - r[0], jaws[j, columns.JAW_Y] - r[1]
        d = sqrt(nx * nx + ny * ny)
        nx, ny = nx / d, ny / d
    u, w, solved = rebound(v, w, (nx, ny), kind == events.JAW, law, series)
    if u[2] >= lift:
        if aloft is None:
            return _LIFTS
        else:
            flight.take_off(motion, state, i, t, (r[0], r[1], 0.0), u, w, phys)
    else:
        cloth.begin(motion, state, i, t, r, (u[0], u[1]), w, phys)
    return events.OK if solved else events.IMPACT_UNSOLVED


@kernel
def _leave(paths, i, kind, j, t, potted, reach, boundaries, forecast, phys):
    """Ball i is potted, or forced off the table: remove all its events -> a status."""
    motion, state, _ = paths
    bounds, pair, best_time, best_ball, alone_time, _, _ = forecast
    (x, y), _v, _w = cloth.evaluate(motion, state, i, t, phys)
    _lie(motion, i, x, y)
    if _is_astray(motion, state, i, reach, boundaries):
        return events.ASTRAY
    potted[i] = j if kind == events.POT else events.OFF_TABLE
    motion[i, T0], motion[i, T_END] = t, inf
    state[i] = GONE
    _bound(bounds, i, inf, -inf, inf, -inf)
    n = pair.shape[0]
    for k in range(n):
        pair[i, k] = pair[k, i] = inf
    best_time[i], best_ball[i], alone_time[i] = inf, -1, inf
    for k in range(n):
        if best_ball[k] == i:
            _rescan(pair, best_time, best_ball, k)
    return events.OK


@inline
def _end(balls, paths, status, last, phys):
    """Write where the balls are after the last event -> the shot's duration [s]."""
    positions, velocities, spins, on_table, _potted = balls
    motion, state, _ = paths
    end = last
    for i in range(state.shape[0]):
        if state[i] == GONE:
            positions[i, 0], positions[i, 1] = motion[i, X], motion[i, Y]
            on_table[i] = False
        else:
            r, v, w = cloth.evaluate(motion, state, i, max(end, motion[i, T0]), phys)
            positions[i, 0], positions[i, 1] = r[0], r[1]
            velocities[i, 0], velocities[i, 1] = v[0], v[1]
            spins[i, 0], spins[i, 1], spins[i, 2] = w[0], w[1], w[2]
            # at rest a ball may still spin on the spot
            if status == events.OK and phys[columns.P_SPIN] > 0.0:
                end = max(end, motion[i, T0] + abs(motion[i, WZ]) / phys[columns.P_SPIN])
    return end


@kernel
def run(balls, aloft, lift, setup, max_events, log, paths, forecast, series, so_far):
    """Simulate one shot to rest, in place -> status, number of events and of segments, duration [s].

    ``aloft`` None: no ball flies. Such a run stops with ``_LIFTS`` at the first impact after which a ball would go up at
    ``lift`` [m/s] or faster; a run with ``aloft`` then goes on from its result, ``so_far``. ``aloft``: (n, 2), the height
    of each ball above the bed [m] and its rate [m/s]; after the shot its first number is 1 for a jump shot of ball 0.
    ``paths``, ``forecast`` and ``series``: work space. Not inlined into ``run_batch``, which makes arrays: numba
    would count references to the arrays of a tuple at every use (4 % of a shot of two balls)."""
    law, first, boundaries, reach, clear = setup
    phys, segments, (motion, state, over) = law.phys, log.segments, paths
    n_segments = n_events = np.int64(0)
    status, end, met, begins = events.OK, 0.0, False, True
    if aloft is not None:
        over[0, flight.STRUCK], over[0, flight.WATCHED], over[0, flight.JUMPED] = -1.0, 0.0, 0.0
        before, n_events, n_segments, end = so_far
        if before == _LIFTS:
            begins, n_events, met = False, n_events - 1, over[0, flight.MET] != 0.0
            if met:
                over[0, flight.WATCHED] = -1.0
    if begins:
        n_segments = _begin(balls, aloft, segments, paths, boundaries, clear, forecast, phys)
    while True:
        t, kind, i, j = _next_event(forecast)
        if t == inf:
            break
        kind = _kind_now(paths, aloft, t, kind, i, j, setup)
        status = _note(log, n_events, n_segments, max_events, t, kind, i, j)
        if status != events.OK:
            break
        n_events, end = n_events + 1, t
        pair, leaves = kind == events.BALL_BALL, kind == events.POT or kind == events.OFF
        flies = False
        if aloft is None:
            # also where a ball over a pocket comes back or meets one: ``pocket.aloft`` cannot begin an impact twice
            at_pocket = kind == events.RETURN or (pair and (state[i] == FALLING or state[j] == FALLING))
            if lift < inf and at_pocket:
                status = _LIFTS
                break
        else:
            flies = not leaves and (state[i] == AIR or (pair and state[j] == AIR))
            if i == 0 and over[0, flight.WATCHED] >= 0.0:
                _watch(paths, kind, j, t, phys)
            if flies and pair:
                status = _meet_in_air(paths, i, j, t, law if met else first, boundaries, series)
            elif flies:
                _in_air(paths, i, kind, j, t, boundaries, phys)
        if flies:
            pass
        elif pair:
            status = _meet_on_bed(paths, aloft, lift, i, j, t, met, setup, series)
        elif kind == events.ROLL or kind == events.STOP or kind == events.BEND:
            cloth.next_phase(motion, state, i, phys)
        elif leaves:
            status = _leave(paths, i, kind, j, t, balls.potted, reach, boundaries, forecast, phys)
        elif kind == events.DROP or state[i] == FALLING:
            _over_pocket(paths, i, kind, j, t, boundaries, phys)
        else:
            status = _rebound_on_bed(paths, aloft, lift, i, kind, j, t, law, boundaries, series)
        if status != events.OK:
            break
        if leaves:
            n_segments = _record(segments, n_segments, motion, state, i)
            continue
        if not _is_clear(motion, i, clear) and _is_astray(motion, state, i, reach, boundaries):
            status = events.ASTRAY
            break
        n_segments = _record(segments, n_segments, motion, state, i)
        _predict(paths, i, t, boundaries, clear, forecast, phys, aloft)
        if pair:
            met = True
            n_segments = _record(segments, n_segments, motion, state, j)
            _predict(paths, j, t, boundaries, clear, forecast, phys, aloft)
    end = _end(balls, paths, status, end, phys)
    if aloft is not None:
        aloft[0, 0] = over[0, flight.JUMPED]
    else:
        over[0, flight.MET] = 1.0 if met else 0.0
    return status, n_events, n_segments, end


@kernel
def _is_sound(balls, aloft, k, reach, boundaries):
    """Whether shot k may begin with these places, speeds and spins; ``aloft``: of all shots, or None."""
    positions, velocities, spins, on_table, _potted = balls
    for i in range(positions.shape[0]):
        for c in range(2):
            if not (abs(positions[i, c]) <= FARTHEST and abs(velocities[i, c]) <= FASTEST):
                return False
        if aloft is not None and not (0.0 <= aloft[k, i, 0] <= FARTHEST and abs(aloft[k, i, 1]) <= FASTEST):
            return False
        for c in range(3):
            if not abs(spins[i, c]) <= MOST_SPIN:
                return False
    return layout_fault(positions, on_table, reach, boundaries)[1] == SOUND


@entry(what="the shot engine", seconds=19)
def run_batch(balls, aloft, setup, max_events, log, ends, start, stop):
    """Simulate shots ``start`` to ``stop`` of a batch; arrays of balls, aloft, log and ends have a batch axis.

    ``setup``: constants, one row for all shots or one for each; kicks, none or for each shot the friction of its first
    impact of two balls where that is above 0; noses, jaws, falls, reach, fidelity, n_steps; doubt: whether shots are
    checked first, and stay ``UNSOUND`` if they may not begin. Plain tuples take 0.3 us a call, named ones 3 us."""
    positions, velocities, spins, on_table, potted = balls
    time, what, segments = log
    status, n_events, n_segments, duration = ends
    phys, kicks, noses, jaws, falls, reach, fidelity, n_steps, doubt = setup
    boundaries = Boundaries(noses, jaws, falls, phys[0, columns.P_R])
    clear = clear_box(boundaries)
    bad = np.empty(columns.CONSTANTS)
    n = positions.shape[1]
    m = (n + LANES - 1) // LANES * LANES
    paths = Motions(np.zeros((n, cloth.COLUMNS)), np.zeros(n, np.int64), np.zeros((n, flight.COLUMNS)))
    (times, alone), (who, kinds, places) = np.full((2, m), inf), np.zeros((3, n), np.int64)
    forecast = Forecast(np.empty((4, m)), np.empty((n, m)), times, who, alone, kinds, places)
    for i in range(n, m):
        _bound(forecast.bounds, i, inf, -inf, inf, -inf)
    series = np.zeros(WORK)
    for k in range(start, stop):
        shot = Balls(positions[k], velocities[k], spins[k], on_table[k], potted[k])
        if doubt and not _is_sound(shot, aloft, k, reach, boundaries):
            status[k] = events.UNSOUND
            continue
        law = Law(phys[min(k, phys.shape[0] - 1)], fidelity, n_steps)
        first = law
        if kicks.shape[0] and kicks[k] > 0.0:
            # with a constant friction, and without tables of the impacts of balls
            for c in range(columns.CONSTANTS):
                bad[c] = law.phys[c]
            bad[columns.P_MU_BB_LEAST], bad[columns.P_MU_BB_EXTRA], bad[columns.P_BALLS] = kicks[k], 0.0, 0.0
            first = Law(bad, fidelity, n_steps)
        world, its = Setup(law, first, boundaries, reach, clear), Log(time[k], what[k], segments[k])
        if aloft is None:
            found = run(shot, None, inf, world, max_events, its, paths, forecast, series, None)
        else:
            found, flies = (np.int64(events.OK), np.int64(0), np.int64(0), 0.0), False
            for i in range(n):  # in the air, or on its way up
                flies |= aloft[k, i, 0] > 0.0 or aloft[k, i, 1] != 0.0
            if not flies:
                found = run(shot, None, SETTLE, world, max_events, its, paths, forecast, series, None)
            if flies or found[0] == _LIFTS:
                found = run(shot, aloft[k], SETTLE, world, max_events, its, paths, forecast, series, found)
        status[k], n_events[k], n_segments[k], duration[k] = found
