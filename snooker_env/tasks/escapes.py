"""Over which cushions does the cue ball reach a ball on that it does not see? A search, and one stroke's aim.

Search. A ball that leaves a cushion slides along a curve before it rolls again: a mirror image misses by up to 20
degrees. Up to a scale the rebound of a rolling ball depends on its angle alone, as ``_REBOUND`` holds it from simulated
shots, for a ball struck ``ROLLING`` above its middle: for "paper" at any speed, for "match" up to 2 m/s.

Aim. Speed, height and side of the strike turn the escape. So the cue ball is played alone with the engine's models,
in directions about that of the search, and sent along the middle of the successes."""

from math import atan2, cos, hypot, pi, sin, sqrt

import numpy as np

from .._lib.jit import kernel
from ..game.balls import N_BALLS
from ..game.paths import find_first_ball
from ..geometry import BALL_RADIUS, HALF_LENGTH, HALF_WIDTH
from ..physics import cloth, events
from ..physics.arrays import Boundaries, Law
from ..physics.columns import AXIS_X, AXIS_Y, P_R
from ..physics.detection import boundary_event, pair_time
from ..physics.impact.contact import FAST, collide_cushion, cushion_restitution
from .pot_aim import stroke_in_room, struck_by
from .windows import wrap_angle

ROLL = 0.25  # twice a rolling ball's deceleration [m/s^2]
ROLLING = 0.4  # tip offset over R with which a ball rolls from the start
LINE_AIM, LINE_ROOM, LINE_SPEED, LINE_WORTH = range(4)
"""Columns of a line: direction, how much it may err [rad]; cue speed of an escape [m/s], 0 if seen; worth."""
_ANGLES = 9  # the rows of ``_REBOUND`` are 10 degrees apart
_REBOUND = (
    (0.583, 0.000, 0.1190, 0.0000),
    (0.574, 0.104, 0.1162, 0.0164),
    (0.552, 0.206, 0.1074, 0.0312),
    (0.519, 0.313, 0.0934, 0.0440),
    (0.466, 0.444, 0.0756, 0.0563),
    (0.388, 0.583, 0.0555, 0.0645),
    (0.296, 0.714, 0.0350, 0.0643),
    (0.199, 0.831, 0.0171, 0.0535),
    (0.099, 0.928, 0.0046, 0.0317),
    (0.000, 1.000, 0.0000, 0.0000),
)
"""A ball rolls into a cushion at speed v, at 0, 10, .. 90 degrees to its normal. When it rolls again:
velocity along normal and cushion over v, way along each over v^2 [s^2/m]."""
_MOUTH, _SAME = 0.12, 0.1
"""No cushion is used so near to a pocket's nominal place [m]; escapes so near in direction are one [rad]."""
_DIRECTIONS, _LEGS = 720, 4  # directions tried; most straight parts of an escape, one more than cushions
_SPEEDS, _WIDE = (1.7, 2.8, 4.2), 4.0
"""Cue speeds of an escape [m/s]: the next where one leaves fewer than ``_WIDE`` directions."""
_HALVES = ((AXIS_X, HALF_WIDTH), (AXIS_Y, HALF_LENGTH))
_BED = np.array([(axis, side, half, -9.0, 9.0) for axis, half in _HALVES for side in (-1.0, 1.0)])
_NO_JAWS, _NO_FALLS = np.empty((0, 6)), np.empty((0, 3))
for _constant in (_BED, _NO_JAWS, _NO_FALLS):
    _constant.setflags(write=False)
_X, _Y = HALF_WIDTH - BALL_RADIUS, HALF_LENGTH - BALL_RADIUS
_CLEAR = (-_X, _X, -_Y, _Y)
_STEP, _STEPS = 0.0087, (30, 75)
"""Directions tried about an escape: distance [rad]; number on either side, and if none succeeds."""
_HALVINGS = 3  # how often that distance is halved to find where a window ends


@kernel
def _in_mouth(x, y, end):
    """Whether the cue ball at (x, y) meets an end cushion (``end``) or a long one too near to a pocket."""
    return abs(x) > HALF_WIDTH - _MOUTH if end else abs(y) > HALF_LENGTH - _MOUTH or abs(y) < _MOUTH


@kernel
def _rebound(cosine):
    """The row of ``_REBOUND`` for the cosine of an angle to the normal, by linear interpolation."""
    at = atan2(sqrt(max(0.0, 1.0 - cosine * cosine)), cosine) * 18.0 / pi
    k = min(int(at), _ANGLES - 1)
    s = at - k
    (a, b, c, d), (a1, b1, c1, d1) = _REBOUND[k], _REBOUND[k + 1]
    return a + s * (a1 - a), b + s * (b1 - b), c + s * (c1 - c), d + s * (d1 - d)


@kernel
def _reaches(positions, on_table, on, ux, uy, speed):
    """Worth of a rolling cue ball's direction u, less for each cushion; 0 if it meets no ball on first."""
    x, y, v2 = positions[0, 0], positions[0, 1], speed * speed
    width, length = HALF_WIDTH - BALL_RADIUS, HALF_LENGTH - BALL_RADIUS
    worth = 1.0
    for _ in range(_LEGS):
        across = (width - x) / ux if ux > 0.0 else (-width - x) / ux if ux < 0.0 else 1e9
        along = (length - y) / uy if uy > 0.0 else (-length - y) / uy if uy < 0.0 else 1e9
        run = max(0.0, min(across, along))
        stop = v2 / ROLL
        ball = find_first_ball(positions, on_table, x, y, ux, uy, min(run, 0.9 * stop))
        if ball:
            return worth if (on >> ball) & 1 else 0.0
        if run >= stop:
            return 0.0
        x, y = x + run * ux, y + run * uy
        v2 -= ROLL * run
        end = along < across
        if _in_mouth(x, y, end):
            return 0.0
        normal, tangent, away, past = _rebound(abs(uy) if end else abs(ux))
        nx, ny = (0.0, -1.0 if uy > 0.0 else 1.0) if end else (-1.0 if ux > 0.0 else 1.0, 0.0)
        tx, ty = (1.0 if ux > 0.0 else -1.0, 0.0) if end else (0.0, 1.0 if uy > 0.0 else -1.0)
        dx, dy = v2 * (away * nx + past * tx), v2 * (away * ny + past * ty)
        chord = hypot(dx, dy)
        if abs(x + dx) > width or abs(y + dy) > length:
            return 0.0
        if chord > 1e-9:
            ball = find_first_ball(positions, on_table, x, y, dx / chord, dy / chord, chord)
            if ball:
                return 0.6 * worth if (on >> ball) & 1 else 0.0
        x, y = x + dx, y + dy
        ux, uy = normal * nx + tangent * tx, normal * ny + tangent * ty
        left = hypot(ux, uy)
        ux, uy = ux / left, uy / left
        v2 *= left * left
        worth *= 0.6
    return 0.0


@kernel
def _keep(lines, first, count, aim, half, speed, worth):
    """Insert an escape into the rows ``first`` to ``count``, best first; returns the new ``count``."""
    for k in range(first, count):
        if abs(wrap_angle(lines[k, LINE_AIM] - aim)) < _SAME:
            if lines[k, LINE_WORTH] >= worth:
                return count
            for after in range(k, count - 1):
                for c in range(4):
                    lines[after, c] = lines[after + 1, c]
            count -= 1
            break
    at = count
    while at > first and lines[at - 1, LINE_WORTH] < worth:
        at -= 1
    if at == lines.shape[0]:
        return count
    count = min(count + 1, lines.shape[0])
    for k in range(count - 1, at, -1):
        for c in range(4):
            lines[k, c] = lines[k - 1, c]
    lines[at, LINE_AIM], lines[at, LINE_ROOM] = wrap_angle(aim), half
    lines[at, LINE_SPEED], lines[at, LINE_WORTH] = speed, worth
    return count


@kernel
def find_escapes(positions, on_table, on, lines, first):
    """Write the escapes with the widest windows into the rows from ``first`` on; returns the rows in use."""
    turn, count = 2.0 * pi / _DIRECTIONS, first
    for s in range(len(_SPEEDS)):
        begin, speed = 0, _SPEEDS[s]
        while _reaches(positions, on_table, on, cos(begin * turn), sin(begin * turn), speed) > 0.0:
            begin += 1  # a window must not be cut in two where the directions begin
            if begin == _DIRECTIONS:
                break
        worth, run = 0.0, 0
        for k in range(begin, begin + _DIRECTIONS + 1):
            here = _reaches(positions, on_table, on, cos(k * turn), sin(k * turn), speed)
            if here > 0.0:
                worth, run = worth + here, run + 1
            elif run:
                aim = (k - 0.5 * (run + 1)) * turn
                count = _keep(lines, first, count, aim, 0.5 * run * turn, speed, worth)
                worth, run = 0.0, 0
        if count > first and lines[first, LINE_WORTH] >= _WIDE:
            break
    return count


@kernel
def _succeeds(aim, stroke, positions, on_table, on, law, work):
    """Whether the cue ball meets a ball on first, by the engine's models, and no pocket's mouth before."""
    phys, motion, state, R = law.phys, work.motion, work.state, law.phys[P_R]
    (vx, vy, _), w = struck_by(stroke_in_room(aim, stroke, positions, on_table, law), law)
    boundaries, rough = Boundaries(_BED, _NO_JAWS, _NO_FALLS, R), Law(phys, FAST, 0)
    cloth.begin(motion, state, 0, 0.0, (positions[0, 0], positions[0, 1]), (vx, vy), w, phys)
    legs, now = 1, 0.0
    while state[0] > cloth.REST:
        wall, kind, nose = boundary_event(motion, state, 0, boundaries, _CLEAR)
        ball, until = 0, min(wall, motion[0, cloth.T_END])
        for i in range(1, N_BALLS):
            x, y, d = positions[i, 0], positions[i, 1], 2.0 * R
            off = x + d < motion[0, cloth.LO_X] or x - d > motion[0, cloth.HI_X]
            if not on_table[i] or off or y + d < motion[0, cloth.LO_Y] or y - d > motion[0, cloth.HI_Y]:
                continue
            cloth.begin(motion, state, 1, 0.0, (x, y), (0.0, 0.0), (0.0, 0.0, 0.0), phys)
            t = pair_time(motion, state, 0, 1, now, d)
            if t <= until:
                ball, until = i, t
        if ball:
            return (on >> ball) & 1 != 0
        now = until
        if kind == events.CUSHION and wall <= motion[0, cloth.T_END]:
            (x, y), v, w = cloth.evaluate(motion, state, 0, wall, phys)
            end = _BED[nose, 0] == AXIS_Y
            if legs == _LEGS or _in_mouth(x, y, end):
                return False
            nx, ny = (0.0, _BED[nose, 1]) if end else (_BED[nose, 1], 0.0)
            e = cushion_restitution(v[0] * nx + v[1] * ny, phys)
            v3, w, solved = collide_cushion((v[0], v[1], 0.0), w, (nx, ny), rough, e, work.series)
            if not solved:
                return False
            cloth.begin(motion, state, 0, wall, (x, y), (v3[0], v3[1]), w, phys)
            legs += 1
        else:
            cloth.next_phase(motion, state, 0, phys)
    return False


@kernel
def escape_aim(about, stroke, positions, on_table, on, law, work):
    """Direction [rad] in which the stroke meets a ball on: the middle of the widest, nearest window about ``about``, or that itself."""
    best, low, high = 0.0, about, about
    for steps in _STEPS:
        run = 0
        for k in range(-steps, steps + 2):
            aim = about + k * _STEP
            if k <= steps and _succeeds(aim, stroke, positions, on_table, on, law, work):
                run += 1
            elif run:
                worth = run - 0.01 * abs(k - 0.5 * (run + 1))
                if worth > best:
                    best, low, high = worth, aim - run * _STEP, aim - _STEP
                run = 0
        if best > 0.0:
            break
    if best == 0.0:
        return about
    step = _STEP
    for _ in range(_HALVINGS):
        step *= 0.5
        if _succeeds(low - step, stroke, positions, on_table, on, law, work):
            low -= step
        if _succeeds(high + step, stroke, positions, on_table, on, law, work):
            high += step
    return 0.5 * (low + high)
