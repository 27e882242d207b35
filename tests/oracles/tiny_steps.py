"""Where do the balls of a shot come to rest on an unbounded cloth? An integrator with small fixed steps, as
an oracle for the event engine.

Method. Every ball is moved by the forces of the moment: in each step of length ``dt`` the friction acts
against the slip (or the motion) as it is at the step's start, velocities and positions advance under that
constant force, and the direction is worked out anew at the next step. (A resistance that depends on the speed
is that of the step's middle.) A step in which a slip, a roll or a
spin would reverse is cut there, so the end of a phase is found inside its step. Nothing is predicted beyond a
step and no collision time is computed from a polynomial: two balls meet when they are found to overlap, or to
have been closest, within a step, and the moment is bisected.

Forces (``shared/reference/physics.md`` 1.3; the cloth touches at ``-R z``): slip ``u = v + w x (-R z)``;
sliding friction ``-mu_s M g u/|u|`` at that point, which turns the ball with moment of inertia 2/5 M R^2;
when rolling (u = 0), a deceleration ``mu_r g + roll_drag v^2`` and ``w`` with ``v``; ``w_z`` towards 0 at ``spin_decel`` in
every state. Balls stay on the cloth: vertical velocities after an impact are dropped.

SI units; table frame, right-handed, z up.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numba
import numpy as np

from .ball_ball import Friction, ball_ball

ZERO_SLIP = 1e-12  # [m/s] a slip below this is rolling; a real slip ends by a cut step, exactly
APPROACH = 1e-10  # [m/s] touching balls that approach more slowly than this are left alone
TOUCH = 1e-12  # [m] balls this close touch: contacts are located to this distance


@numba.njit
def _move(ball, h, radius, mu_s_g, mu_r_g, spin_decel, drag):
    """Advance one ball (x, y, vx, vy, wx, wy, wz) by h under the forces of the moment, in place."""
    turn = spin_decel * h
    ball[6] = 0.0 if abs(ball[6]) <= turn else ball[6] - math.copysign(turn, ball[6])
    left = h
    while left > 0.0:
        ux, uy = ball[2] - radius * ball[5], ball[3] + radius * ball[4]
        slip = math.sqrt(ux * ux + uy * uy)
        if slip > ZERO_SLIP:  # sliding: the slip loses 7/2 of the friction's acceleration
            t = min(left, slip / (3.5 * mu_s_g))
            ax, ay = -mu_s_g * ux / slip, -mu_s_g * uy / slip
            ball[0] += ball[2] * t + 0.5 * ax * t * t
            ball[1] += ball[3] * t + 0.5 * ay * t * t
            ball[2] += ax * t
            ball[3] += ay * t
            ball[4] += 2.5 / radius * ay * t  # (-R z) x (M a) / (2/5 M R^2)
            ball[5] -= 2.5 / radius * ax * t
            if t < left:  # the slip has ended in this step
                ball[4], ball[5] = -ball[3] / radius, ball[2] / radius
        else:
            speed = math.sqrt(ball[2] * ball[2] + ball[3] * ball[3])
            if speed == 0.0:
                return
            middle = max(0.0, speed - 0.5 * left * (mu_r_g + drag * speed * speed))
            slows = mu_r_g + drag * middle * middle
            t = left if slows * left < speed else speed / slows
            ax, ay = -slows * ball[2] / speed, -slows * ball[3] / speed
            ball[0] += ball[2] * t + 0.5 * ax * t * t
            ball[1] += ball[3] * t + 0.5 * ay * t * t
            if t < left:
                ball[2] = ball[3] = 0.0
            else:
                ball[2] += ax * t
                ball[3] += ay * t
            ball[4], ball[5] = -ball[3] / radius, ball[2] / radius
        left -= t


@numba.njit
def _gap_after(a, b, t, diameter, radius, mu_s_g, mu_r_g, spin_decel, drag):
    """Gap [m] between two balls and its rate [m/s] after both have moved by t from the given states."""
    p, q = a.copy(), b.copy()
    if t > 0.0:
        _move(p, t, radius, mu_s_g, mu_r_g, spin_decel, drag)
        _move(q, t, radius, mu_s_g, mu_r_g, spin_decel, drag)
    dx, dy = q[0] - p[0], q[1] - p[1]
    distance = math.sqrt(dx * dx + dy * dy)
    return distance - diameter, ((q[2] - p[2]) * dx + (q[3] - p[3]) * dy) / distance


@numba.njit
def _contact(a, b, h, diameter, radius, mu_s_g, mu_r_g, spin_decel, drag):
    """When, within h, do two balls meet? Bisection on the motion itself; infinity if they do not."""
    gap0, rate0 = _gap_after(a, b, 0.0, diameter, radius, mu_s_g, mu_r_g, spin_decel, drag)
    if gap0 <= TOUCH and rate0 < -APPROACH:
        return 0.0
    gap1, rate1 = _gap_after(a, b, h, diameter, radius, mu_s_g, mu_r_g, spin_decel, drag)
    lo, hi = 0.0, h
    if rate0 < 0.0:
        if rate1 > 0.0 and gap1 > 0.0:  # it came and went: the closest moment, where the rate changes sign
            near, far = 0.0, h
            for _ in range(60):
                middle = 0.5 * (near + far)
                if _gap_after(a, b, middle, diameter, radius, mu_s_g, mu_r_g, spin_decel, drag)[1] < 0.0:
                    near = middle
                else:
                    far = middle
            hi = near
            gap1 = _gap_after(a, b, hi, diameter, radius, mu_s_g, mu_r_g, spin_decel, drag)[0]
    else:
        # apart or moving apart all the time (rounding may show an overlap of touching balls)
        if rate1 >= -APPROACH:
            return np.inf
        near, far = 0.0, h  # it went and came back: the farthest moment
        for _ in range(60):
            middle = 0.5 * (near + far)
            if _gap_after(a, b, middle, diameter, radius, mu_s_g, mu_r_g, spin_decel, drag)[1] < 0.0:
                far = middle
            else:
                near = middle
        lo = far
        if gap1 <= 0.0 and _gap_after(a, b, lo, diameter, radius, mu_s_g, mu_r_g, spin_decel, drag)[0] <= 0.0:
            return h  # pressed together throughout: one impact per step
    if gap1 > 0.0:
        return np.inf
    for _ in range(60):
        middle = 0.5 * (lo + hi)
        if middle <= lo or middle >= hi:
            break
        if _gap_after(a, b, middle, diameter, radius, mu_s_g, mu_r_g, spin_decel, drag)[0] > 0.0:
            lo = middle
        else:
            hi = middle
    return hi


@numba.njit
def _run_to_contact(balls, time, into_step, dt, max_time, diameter, radius, mu_s_g, mu_r_g, spin_decel, drag):
    """Step all balls, in place, until two meet or all are at rest.

    ``into_step``: how much of the current step has passed. Returns (time, into_step, i, j), i = -1 at rest,
    -2 if max_time is past.
    """
    n = balls.shape[0]
    while time < max_time:
        h = dt - into_step
        fastest, moving = 0.0, False
        for i in range(n):
            speed = math.sqrt(balls[i, 2] ** 2 + balls[i, 3] ** 2)
            slip = math.sqrt(
                (balls[i, 2] - radius * balls[i, 5]) ** 2 + (balls[i, 3] + radius * balls[i, 4]) ** 2
            )
            fastest = max(fastest, speed)
            moving = moving or speed > 0.0 or slip > ZERO_SLIP
        if not moving:
            return time, 0.0, -1, -1
        reach = 2.0 * (fastest + mu_s_g * h) * h + 1e-9  # no gap can close by more than this within the step
        first, first_i, first_j = np.inf, -1, -1
        for i in range(n):
            for j in range(i + 1, n):
                dx, dy = balls[j, 0] - balls[i, 0], balls[j, 1] - balls[i, 1]
                if math.sqrt(dx * dx + dy * dy) - diameter <= reach:
                    t = _contact(balls[i], balls[j], h, diameter, radius, mu_s_g, mu_r_g, spin_decel, drag)
                    if t < first:
                        first, first_i, first_j = t, i, j
        t = min(first, h)
        if t > 0.0:
            for i in range(n):
                _move(balls[i], t, radius, mu_s_g, mu_r_g, spin_decel, drag)
        time += t
        if first_i >= 0:
            return time, into_step + t if into_step + t < dt else 0.0, first_i, first_j
        into_step = 0.0
    return time, 0.0, -2, -1


def simulate(
    positions,
    velocities,
    spins,
    *,
    R: float,
    M: float,
    g: float,
    mu_s: float,
    mu_r: float,
    spin_decel: float,
    roll_drag: float = 0.0,
    e: float,
    mu_bb: Friction,
    dt: float = 5e-5,
    impact: Callable | None = None,
    max_time: float = 120.0,
    log: list | None = None,
) -> np.ndarray:
    """Final positions, shape (n, 2) [m], of n balls on an unbounded cloth without cushions, once all are at
    rest.

    positions, velocities : shape (n, 2) [m], [m/s]. spins : shape (n, 3) [rad/s].
    R, M : radius [m], mass [kg]. g [m/s^2]. mu_s, mu_r : sliding and rolling friction of ball on cloth.
    spin_decel [rad/s^2]. roll_drag [1/m]: growth of the resistance to rolling with the square of the speed.
    e, mu_bb : restitution and friction between balls, used by the default ``impact`` only.
    dt : step [s]. The result does not depend on it beyond rounding unless a phase of motion and a contact
    begin and end within one step;
        halve it to see.
    impact : callable (v1, w1, v2, w2, normal) -> (v1, w1, v2, w2), arrays (3,), normal (3,) from ball 1 to
    ball 2; ``ball_ball.ball_ball``
        with the given parameters if None. Vertical velocities it returns are dropped.
    log : if a list is given, (time, i, j) of each impact is appended.

    Contacts in one step are resolved in order of time; at equal times (a touching cluster) the pair with the
    lowest indices goes first. Raises RuntimeError if the balls still move after ``max_time`` [s] or after
    10000 impacts.
    """
    if impact is None:

        def impact(v1, w1, v2, w2, normal):
            return ball_ball(v1, w1, v2, w2, normal, R=R, M=M, e=e, mu_bb=mu_bb, mu_s=mu_s)

    balls = np.concatenate([np.asarray(a, dtype=float) for a in (positions, velocities, spins)], axis=1)
    time = into_step = 0.0
    for _ in range(10_000):
        time, into_step, i, j = _run_to_contact(
            balls, time, into_step, dt, max_time, 2.0 * R, R, mu_s * g, mu_r * g, spin_decel, roll_drag
        )
        if i == -1:
            return balls[:, :2].copy()
        if i == -2:
            raise RuntimeError(f"the balls still move after {max_time} s")
        normal = np.append(balls[j, :2] - balls[i, :2], 0.0)
        normal /= np.linalg.norm(normal)
        flat = [np.append(balls[k, 2:4], 0.0) for k in (i, j)]
        v1, w1, v2, w2 = impact(flat[0], balls[i, 4:7].copy(), flat[1], balls[j, 4:7].copy(), normal)
        balls[i, 2:4], balls[i, 4:7] = v1[:2], w1
        balls[j, 2:4], balls[j, 4:7] = v2[:2], w2
        if log is not None:
            log.append((time, i, j))
    raise RuntimeError("10000 impacts: the balls rattle between each other")
