"""How near does a cue come to rails and balls? By spheres along its axis, one after the other; nothing is solved."""

import numpy as np

TIP, BUTT, LENGTH, RAIL = 4.75e-3, 14e-3, 1.45, 0.038


def spheres(centre, aim, side, top, elevation, R, n=20_001):
    """Centres (n, 3) and radii (n,) of spheres whose union is the cue [m]."""
    c, s, ce, se = np.cos(aim), np.sin(aim), np.cos(elevation), np.sin(elevation)
    along, right, up = np.array([ce * c, ce * s, -se]), np.array([s, -c, 0.0]), np.array([se * c, se * s, ce])
    tip = np.array([*centre, R]) + R * (side * right + top * up - np.sqrt(1 - side**2 - top**2) * along)
    x = np.linspace(0.0, LENGTH, n)
    return tip - x[:, None] * along, TIP + (BUTT - TIP) * x / LENGTH


def clearance(centre, aim, side, top, elevation, R, rails=(), balls=()):
    """The least distance of the cue from rails (axis, side, level), as far as the table goes, and balls (x, y)."""
    at, r = spheres(centre, aim, side, top, elevation, R)
    least = np.inf
    for axis, sign, level in rails:
        across, above = np.maximum(level - sign * at[:, int(axis)], 0.0), np.maximum(at[:, 2] - RAIL, 0.0)
        least = min(least, (np.hypot(across, above) - r).min())
    for x, y in balls:
        least = min(least, (np.linalg.norm(at - (x, y, R), axis=1) - r - R).min())
    return least


def least_elevation(*args, low=0.0, high=np.pi / 2, **what):
    """The elevation at which the cue just touches, by halvings; 0: a level cue is clear; pi/2: none is."""
    centre, aim, side, top, R = args
    if clearance(centre, aim, side, top, 0.0, R, **what) >= 0.0:
        return 0.0
    if clearance(centre, aim, side, top, high, R, **what) < 0.0:
        return high
    for _ in range(40):
        middle = 0.5 * (low + high)
        clear = clearance(centre, aim, side, top, middle, R, **what) >= 0.0
        low, high = (low, middle) if clear else (middle, high)
    return high
