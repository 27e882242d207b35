"""What do velocities and spins become in one frictional impact? By Moreau's implicit steps: a second method.

The impact of ``ball_ball`` and ``ball_cushion`` (sources and corrections there), and of a ball in the air with one on the
bed (``moreau_tilted``), stepped in the normal impulse p. In a
step of length h the friction at the contact A, the cloth's reaction N and its friction satisfy Coulomb's law and
N >= 0, v_z >= 0, N v_z = 0 with the velocities at the step's *end* (J. J. Moreau, "Unilateral contact and dry friction
in finite freedom dynamics", 1988): so slips stop, hold and start by themselves, without a state that says which. The law
is solved by projected iteration of the three impulses. Nothing is shared with the package: the inverse inertia seen at the
contacts is that of their rows in ``M^-1``, numerically. The error is that of first order, O(1/steps).

Units: velocities [m/s], ``R w`` [m/s]; impulses over the mass of a ball.
"""

import math

import numba
import numpy as np


@numba.njit(error_model="numpy")
def _disc(x, y, radius):
    """The point of a disc that is nearest to (x, y)."""
    size = math.hypot(x, y)
    if size <= radius:
        return x, y
    return x * radius / size, y * radius / size


@numba.njit(error_model="numpy")
def _after(u, D, k, J):
    """Slip k after the impulses J: a product of two small arrays costs ten times as much by ``@``."""
    row = D[k]
    return (
        u[k] + row[0] * J[0] + row[1] * J[1] + row[2] * J[2] + row[3] * J[3] + row[4] * J[4] + row[5] * J[5]
    )


@numba.njit(error_model="numpy")
def _march(slips, D, law, mu_s, e, h, most):
    """Slips u = (a1, a2, b1, b2, v_z, closing); D: their rates per impulse (F1, F2, G1, G2, N, p) -> impulses. ``law``:
    (a, b, c) of the friction at A, a + b exp(-c slip)."""
    u, new, total, J = slips.copy(), np.zeros(6), np.zeros(6), np.zeros(6)
    rate_a, rate_b = 1.0 / max(D[0, 0], D[1, 1]), 1.0 / D[2, 2]
    work = top = 0.0
    compressing = True
    for _ in range(most):
        J[5] = h
        for _trial in range(2000):
            moved = 0.0
            a1 = _after(u, D, 0, J)
            a2 = _after(u, D, 1, J)
            mu = law[0] + law[1] * math.exp(-law[2] * math.hypot(a1, a2))
            f1, f2 = _disc(J[0] - rate_a * a1, J[1] - rate_a * a2, mu * h)
            moved += abs(f1 - J[0]) + abs(f2 - J[1])
            J[0], J[1] = f1, f2
            n = max(0.0, J[4] - _after(u, D, 4, J) / D[4, 4])
            moved += abs(n - J[4])
            J[4] = n
            b1 = _after(u, D, 2, J)
            b2 = _after(u, D, 3, J)
            g1, g2 = _disc(J[2] - rate_b * b1, J[3] - rate_b * b2, mu_s * n)
            moved += abs(g1 - J[2]) + abs(g2 - J[3])
            J[2], J[3] = g1, g2
            if moved < 1e-14 * h:
                break
        for k in range(6):
            new[k] = _after(u, D, k, J)
        before, after = u[5], new[5]
        part = 1.0
        if compressing and after <= 0.0:
            turn = before / (before - after)
            top = work + 0.5 * before * turn * h
            compressing = False
        gained = 0.5 * (before + after) * h
        if not compressing and work + gained <= (1.0 - e * e) * top:
            # the root of before t + (after - before) t^2 / 2 = what is left, in this step
            left, bend = ((1.0 - e * e) * top - work) / h, after - before
            part = (-before - math.sqrt(max(before * before + 2.0 * bend * left, 0.0))) / bend
            return total + part * J
        work += gained
        for k in range(6):
            total[k] += J[k]
            u[k] = new[k]
    return total * np.nan


def _rates(rows):
    """The six slips' rates per unit impulse along the same rows, each on (v, R w) of two or one ball."""
    inertia = np.tile([1.0, 1.0, 1.0, 2.5, 2.5, 2.5], rows.shape[1] // 6)
    return rows @ (inertia[:, None] * rows.T), inertia[:, None] * rows.T


def _row(direction, arm):
    """The row of the velocity along ``direction`` of a ball's surface at R ``arm``: direction . (v + R w x arm)."""
    return np.concatenate([direction, np.cross(arm, direction)])


def moreau_cushion(v, w, normal, *, R, e, mu_w, mu_s, sin_theta, steps=20_000):
    """As ``ball_cushion``, by steps of 1/``steps`` of the closing speed."""
    v, w, n, z = (np.array(x, float) for x in (v, w, normal, (0.0, 0.0, 1.0)))
    m = math.sqrt(1.0 - sin_theta**2) * n + sin_theta * z
    along = np.cross(n, z)
    across = np.cross(along, m)
    x, y = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
    rows = np.array([_row(along, m), _row(across, m), _row(x, -z), _row(y, -z), _row(z, -z), -_row(m, m)])
    return _finish(rows, np.concatenate([v, R * w]), mu_w, mu_s, e, R, steps)


def moreau_balls(v1, w1, v2, w2, normal, *, R, e, mu, mu_s, pressed, steps=20_000):
    """As ``ball_ball`` at constant friction; ``pressed``: 1 or 2, the ball that friction presses into the cloth."""
    n, z = np.array(normal, float), np.array([0.0, 0.0, 1.0])
    rows = _two_balls(np.cross(n, z), z, n, pressed)
    state = np.concatenate([np.array(q, float) for q in (v1, R * np.array(w1), v2, R * np.array(w2))])
    return _finish(rows, state, mu, mu_s, e, R, steps)


def _two_balls(along, across, n, pressed):
    """The rows of two balls, of which the bed holds the pressed one; along, across: the tangents of their contact."""
    x, y, z = np.eye(3)
    held = [np.concatenate([_row(d, -z), np.zeros(6)][:: 1 if pressed == 1 else -1]) for d in (x, y, z)]
    both = [np.concatenate([_row(d, n), -_row(d, -n)]) for d in (along, across, -n)]
    return np.array([*both[:2], *held, both[2]])


def moreau_tilted(v1, w1, v2, w2, n, *, e, mu, mu_s, R, steps=20_000):
    """A free ball (1) meets one on the bed (2); n: the unit vector between them, not upwards; ``mu``: as ``law`` of
    ``_march``. The error of first order is taken out.

    Returns v1, w1, v2, w2 and the impulse by which friction pressed ball 2 down. Ball 2's vertical velocity is its lift,
    the bed's restitution not yet in it.
    """
    level = math.hypot(n[0], n[1])
    across = np.array([n[1], -n[0], 0.0]) / level if level > 0.0 else np.array([1.0, 0.0, 0.0])
    up = np.cross(across, n)
    rows, state = _two_balls(across, up, n, 2), np.concatenate([v1, R * w1, v2, R * w2])
    J = 2.0 * _impulses(rows, state, mu, mu_s, e, 2 * steps) - _impulses(rows, state, mu, mu_s, e, steps)
    if not np.isfinite(J).all():
        raise RuntimeError("the impact did not end")
    out = state + _rates(rows)[1] @ J
    # the bed held its height, or the ball has a lift
    out[8] = max(0.0, out[8]) if out[8] > 1e-9 * abs(state).max() else 0.0
    return out[0:3], out[3:6] / R, out[6:9], out[9:12] / R, float(J[1] * up[2])


def _impulses(rows, state, law, mu_s, e, steps):
    """The six impulses of an impact."""
    D, _ = _rates(rows)
    u = rows @ state
    u[5], D[5] = -u[5], -D[5]
    if u[5] <= 0.0:
        return np.zeros(6)
    scaled = (law[0], law[1], law[2] * u[5])
    return _march(u / u[5], D, scaled, mu_s, e, 1.0 / steps, 200 * steps) * u[5]


def _finish(rows, state, mu, mu_s, e, R, steps):
    after = state + _rates(rows)[1] @ _impulses(rows, state, (mu, 0.0, 0.0), mu_s, e, steps)
    out = after.reshape(-1, 2, 3) / np.array([1.0, R])[None, :, None]
    return tuple(part for ball in out for part in ball)
