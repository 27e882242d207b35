"""What does a plain player do without a pot? The break-off, a soft stroke at what it sees, else an escape over cushions; kernels.

No shot is simulated. A cue ball that leaves a cushion slides along a curve before it rolls again, so a plain mirror image misses by up to
20 degrees. What becomes of a ball that rolls into a cushion depends on its angle alone, up to a scale: its velocity in proportion to that
before, the length of its curve to the square of it. ``_REBOUND`` holds this, from shots in the simulator. The cue ball is therefore struck
0.4 R above its middle, where it rolls at once. The table holds for the physics "paper" at any speed and for "match" up to 2 m/s.
"""

from math import atan2, cos, hypot, pi, sin, sqrt

from .._jit import kernel
from ..game.balls import N_BALLS, N_REDS, SPOTS
from ..game.philox import pair
from ..geometry import AIM_X, AIM_Y, BALL_RADIUS, HALF_LENGTH, HALF_WIDTH, POCKET_AIMS

ROLL = 0.25
"""Twice a rolling ball's deceleration [m/s^2]."""
SLIDE = 1.4
"""Initial speed of a ball struck in its middle, over the speed with which it rolls on."""
BREAK_X = 0.18
"""Where the cue ball stands for the break-off: so far from the brown spot along the baulk line, on either side [m]."""
_BREAK_SPEED, _BREAK_SIDE, _BREAK_TOP, _BREAK_OFF = 3.4, 0.42, 0.1, 0.62
"""Of the break-off: a third of the end red, with running side, so that the cue ball comes back to baulk over three cushions. The last: how
far the cue ball's path passes the centre of the red, over 2 R. Chosen among 6,000 random ones: of those that return the cue ball to baulk
in each of 40 trials of a professional, one that leaves hardly a pot."""
_ROLLING = 0.4
"""Tip offset over R with which a ball rolls from the start."""

_ANGLES = 9
"""The rows of ``_REBOUND`` are 10 degrees apart."""
_REBOUND = (
    (0.583, 0.000, 0.1190, 0.0000), (0.574, 0.104, 0.1162, 0.0164), (0.552, 0.206, 0.1074, 0.0312), (0.519, 0.313, 0.0934, 0.0440),
    (0.466, 0.444, 0.0756, 0.0563), (0.388, 0.583, 0.0555, 0.0645), (0.296, 0.714, 0.0350, 0.0643), (0.199, 0.831, 0.0171, 0.0535),
    (0.099, 0.928, 0.0046, 0.0317), (0.000, 1.000, 0.0000, 0.0000),
)  # fmt: skip
"""A ball rolls into a cushion at speed v, at an angle of 0, 10, .. 90 degrees to its normal. When it rolls again: its velocity along the
normal and along the cushion, over v, and how far it has come along each, over v^2 [s^2/m]."""

_MOUTH = 0.12
"""No cushion is used within this distance of a pocket's nominal place, along the cushion [m]."""
_DIRECTIONS = 720
_SPEEDS = (1.7, 2.8, 4.2)
"""Cue speeds of an escape [m/s]: the next one is tried where the one before leaves no window of ``_WIDE``."""
_WIDE = 4.0
"""Number of directions of a window that is wide enough, after a deduction for cushions."""
_LEGS = 4
"""Most straight parts of an escape: one more than cushions."""
_PARTS = 10
"""Half the number of directions in which a ball is aimed at."""
_NUDGE = 0.3
"""How much faster than needed a cue ball is rolled at a ball [m/s]; its speed varies by a tenth."""
_STOP = 6.1
"""Squared speed of a ball struck 0.4 R below its middle that slides so far without spin left, over the distance [m/s^2]: 0.32 of it, over
the cloth's sliding friction of 2 m/s^2."""
_NEAR_POCKET = 0.09
"""A cue ball that passes so near to a pocket's aim point is taken to go in [m]."""
_EASY = 0.01
"""Half a window that a player cannot miss [rad]. Among balls that offer one, the nearest is the best."""


@kernel
def met(positions, on_table, x, y, ux, uy, far):
    """The ball that the cue ball meets first, rolling from (x, y) along the unit vector u for the distance ``far`` [m]; 0 if none."""
    ball = 0
    for i in range(1, N_BALLS):
        if on_table[i]:
            bx, by = positions[i, 0] - x, positions[i, 1] - y
            along, across = bx * ux + by * uy, bx * uy - by * ux
            if along > 0.0 and abs(across) < 2.0 * BALL_RADIUS:
                run = along - sqrt(4.0 * BALL_RADIUS * BALL_RADIUS - across * across)
                if run < far:
                    far, ball = run, i
    return ball


@kernel
def racked(positions, on_table):
    """The end red of the last row if all balls stand as at the start of a frame, with 15 reds or 6; else 0."""
    end = 0
    for i in range(1, N_BALLS):
        if on_table[i] and (abs(positions[i, 0] - SPOTS[i, 0]) > 1e-3 or abs(positions[i, 1] - SPOTS[i, 1]) > 1e-3):
            return 0
        if on_table[i] and i <= N_REDS:
            end = i
    return end if on_table[1] and on_table[end // 2] and (end == N_REDS or end == 6) else 0


@kernel
def break_off(positions, end_red):
    """The stroke from the place of the cue ball: (speed, side, top, direction of the cue ball), at the end red on its side.

    ``end_red``: that on the right.
    """
    sign = -1.0 if positions[0, 0] < 0.0 else 1.0
    dx, dy = sign * SPOTS[end_red, 0] - positions[0, 0], SPOTS[end_red, 1] - positions[0, 1]
    return _BREAK_SPEED, sign * _BREAK_SIDE, _BREAK_TOP, atan2(dy, dx) - sign * _BREAK_OFF * 2.0 * BALL_RADIUS / hypot(dx, dy)


@kernel
def open_part(positions, on_table, on, ball):
    """The widest part of a ball on that can be struck: (direction of its middle, half its width) [rad]; no width: there is none.

    Another ball on in the way may be struck as well.
    """
    x, y = positions[0, 0], positions[0, 1]
    dx, dy = positions[ball, 0] - x, positions[ball, 1] - y
    far = hypot(dx, dy)
    towards = atan2(dy, dx)
    sine = min(1.0, 2.0 * BALL_RADIUS / far)
    step = atan2(sine, sqrt(max(0.0, 1.0 - sine * sine))) / (_PARTS + 0.5)
    best, middle, run = 0, 0.0, 0
    for part in range(-_PARTS, _PARTS + 1):
        angle = towards + part * step
        struck = met(positions, on_table, x, y, cos(angle), sin(angle), far)
        run = run + 1 if struck and (on >> struck) & 1 else 0
        if run > best:
            best, middle = run, part - 0.5 * (run - 1)
    return towards + middle * step, 0.5 * best * step


@kernel
def _goes_in(positions, ball, ux, uy, v2):
    """Whether a cue ball that rolls along u with the squared speed v2 [m^2/s^2] into ``ball`` is likely to go on into a pocket."""
    x, y = positions[0, 0], positions[0, 1]
    bx, by = positions[ball, 0] - x, positions[ball, 1] - y
    along, across = bx * ux + by * uy, bx * uy - by * ux
    run = along - sqrt(max(0.0, 4.0 * BALL_RADIUS * BALL_RADIUS - across * across))
    x, y = x + run * ux, y + run * uy
    nx, ny = (positions[ball, 0] - x) / (2.0 * BALL_RADIUS), (positions[ball, 1] - y) / (2.0 * BALL_RADIUS)
    fullness = ux * nx + uy * ny
    gx, gy = ux - fullness * nx * 5.0 / 7.0, uy - fullness * ny * 5.0 / 7.0  # where it rolls after the impact, over the speed before
    left = hypot(gx, gy)
    end = left * left * v2 / ROLL + 2.0 * BALL_RADIUS
    for k in range(POCKET_AIMS.shape[0]):
        px, py = POCKET_AIMS[k, AIM_X] - x, POCKET_AIMS[k, AIM_Y] - y
        near = min(end, max(0.0, (px * gx + py * gy) / left))
        if hypot(px - near * gx / left, py - near * gy / left) < _NEAR_POCKET:
            return True
    return False


@kernel
def soft(positions, on_table, on, drive):
    """The soft stroke at the nearest ball on that is seen well: (speed, top, direction) and half its window [rad]; no window: none is.

    It is aimed at the middle of what is seen; where the cue ball would follow into a pocket, halfway to an edge, or so that it stops at
    the ball, without spin at the impact. ``drive``: how much farther than needed it rolls [m].
    """
    x, y = positions[0, 0], positions[0, 1]
    best, speed, top, aim, window = -1e9, 0.0, 0.0, 0.0, 0.0
    for ball in range(1, N_BALLS):
        if not (on_table[ball] and (on >> ball) & 1):
            continue
        middle, half = open_part(positions, on_table, on, ball)
        if half == 0.0:
            continue
        dx, dy = positions[ball, 0] - x, positions[ball, 1] - y
        far = hypot(dx, dy)
        run = max(0.0, far - 2.0 * BALL_RADIUS)
        arrival = _NUDGE * _NUDGE + 2.0 * _NUDGE * sqrt(ROLL * far) + ROLL * drive  # its squared speed at the ball
        for way in range(4):
            angle, seen, wanted, spin = middle + (0.0, 0.5, -0.5, 0.0)[way] * half, 0.5 * half, SLIDE * (sqrt(ROLL * far) + _NUDGE), 0.0
            worth = 0.0
            if way == 0:
                seen = half
            if way == 3:
                angle, wanted, spin, worth = atan2(dy, dx), min(5.0, sqrt(_STOP * run) + 0.1), -_ROLLING, -1.0
                seen = min(seen, half - abs(sin(angle - middle)))
            elif _goes_in(positions, ball, cos(angle), sin(angle), arrival):
                worth = -5.0
            if drive > 0.0:
                wanted = sqrt(wanted * wanted + SLIDE * SLIDE * ROLL * drive)
            worth += 1e3 * min(seen, _EASY) - far
            if seen > 0.0 and worth > best:
                best, speed, top, aim, window = worth, wanted, spin, angle, seen
    return speed, top, aim, window


@kernel
def _rebound(cosine):
    """The row of ``_REBOUND`` for the cosine of an angle to the cushion's normal, by linear interpolation."""
    at = atan2(sqrt(max(0.0, 1.0 - cosine * cosine)), cosine) * 18.0 / pi
    k = min(int(at), _ANGLES - 1)
    s = at - k
    low, high = _REBOUND[k], _REBOUND[k + 1]
    return (
        low[0] + s * (high[0] - low[0]), low[1] + s * (high[1] - low[1]),
        low[2] + s * (high[2] - low[2]), low[3] + s * (high[3] - low[3]),
    )  # fmt: skip


@kernel
def _reaches(positions, on_table, on, ux, uy, speed):
    """Whether the cue ball, rolling along u, meets a ball on first: the worth of the direction, less for each cushion; 0 if it does not."""
    x, y, v2 = positions[0, 0], positions[0, 1], speed * speed
    width, length = HALF_WIDTH - BALL_RADIUS, HALF_LENGTH - BALL_RADIUS
    worth = 1.0
    for _ in range(_LEGS):
        across = (width - x) / ux if ux > 0.0 else (-width - x) / ux if ux < 0.0 else 1e9
        along = (length - y) / uy if uy > 0.0 else (-length - y) / uy if uy < 0.0 else 1e9
        run = max(0.0, min(across, along))
        stop = v2 / ROLL
        ball = met(positions, on_table, x, y, ux, uy, min(run, 0.9 * stop))
        if ball:
            return worth if (on >> ball) & 1 else 0.0
        if run >= stop:
            return 0.0
        x, y = x + run * ux, y + run * uy
        v2 -= ROLL * run
        end = along < across
        if abs(x) > HALF_WIDTH - _MOUTH if end else abs(y) > HALF_LENGTH - _MOUTH or abs(y) < _MOUTH:
            return 0.0
        normal, tangent, away, past = _rebound(abs(uy) if end else abs(ux))
        nx, ny = (0.0, -1.0 if uy > 0.0 else 1.0) if end else (-1.0 if ux > 0.0 else 1.0, 0.0)
        tx, ty = (1.0 if ux > 0.0 else -1.0, 0.0) if end else (0.0, 1.0 if uy > 0.0 else -1.0)
        dx, dy = v2 * (away * nx + past * tx), v2 * (away * ny + past * ty)
        chord = hypot(dx, dy)
        if abs(x + dx) > width or abs(y + dy) > length:
            return 0.0
        if chord > 1e-9:
            ball = met(positions, on_table, x, y, dx / chord, dy / chord, chord)
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
def escape(positions, on_table, on, vary, stream):
    """The escape with the widest window of directions: (speed, direction) and half the window [rad]; no window: none was found.

    ``vary``: the windows are weighted at random, so that another one is tried after a failure.
    """
    best, speed, aim, window = 0.0, _SPEEDS[1], 0.0, 0.0
    turn = 2.0 * pi / _DIRECTIONS
    for s in range(len(_SPEEDS)):
        first = 0
        while first < _DIRECTIONS and _reaches(positions, on_table, on, cos(first * turn), sin(first * turn), _SPEEDS[s]) > 0.0:
            first += 1  # a window must not be cut in two where the directions begin
        worth, run, weight = 0.0, 0, 1.0
        for k in range(first, first + _DIRECTIONS):
            here = _reaches(positions, on_table, on, cos(k * turn), sin(k * turn), _SPEEDS[s])
            if here == 0.0:
                worth, run = 0.0, 0
                continue
            if run == 0 and vary:
                u, _ = pair(stream)
                weight = 0.3 + 0.7 * u
            worth, run = worth + here, run + 1
            if weight * worth > best:
                best, speed, window = weight * worth, _SPEEDS[s], 0.5 * run * turn
                aim = (k - 0.5 * (run - 1)) * turn
        if best >= _WIDE:
            break
    return speed, aim, window


@kernel
def plain(positions, on_table, on, touching, vary, drive, stream):
    """A stroke without a pot, from where the cue ball lies: (speed, side, top, direction of the cue ball), at the balls in the mask ``on``.

    * Straight away from a ball on that touches the cue ball (in the mask ``touching``), which counts as striking it.
    * A soft stroke at the nearest ball on of which enough can be struck.
    * Else an escape over up to three cushions.
    * Else the direction in which it sees a little of a ball on, else that of the nearest one.

    ``vary``: a stroke from this position has failed, so another one is played. The direction varies within its window in any case.
    ``drive``: how much farther than needed it is to roll, over no cushion [m].
    """
    u, _ = pair(stream)
    shift = (1.6 if vary else 0.5) * (u - 0.5)
    for ball in range(1, N_BALLS):
        if ((touching & on) >> ball) & 1:
            speed = 0.6 if drive == 0.0 else sqrt(0.36 + SLIDE * SLIDE * ROLL * drive)
            return speed, 0.0, 0.0, atan2(positions[0, 1] - positions[ball, 1], positions[0, 0] - positions[ball, 0]) + shift
    speed, top, aim, window = soft(positions, on_table, on, drive)
    if window < 0.25 * _EASY:
        over, other, wide = escape(positions, on_table, on, vary, stream)
        if wide > window:
            speed, aim, window, top = over, other, wide, _ROLLING
    if window == 0.0:
        near = 1e9
        for ball in range(1, N_BALLS):
            far = hypot(positions[ball, 0] - positions[0, 0], positions[ball, 1] - positions[0, 1])
            if on_table[ball] and (on >> ball) & 1 and far < near:
                near, aim = far, atan2(positions[ball, 1] - positions[0, 1], positions[ball, 0] - positions[0, 0])
        speed, window = 2.0, 0.1
    return speed, 0.0, top, aim + shift * window
