"""What does a ball do that a raised cue drives into the bed? One sphere in three dimensions: the tip's impulse,
bounces on the slate, flights between them, and the cloth.

An oracle for the strike of a raised cue. The bed has a restitution ``e_t`` here, which the package's model does
not know: where the ball comes to rest must not depend on it, but as ``flown`` says.

The tip gives the impulse V per unit of mass along the cue, at a place that is off the centre, square to the cue;
the ball takes V along the cue and the spin r x J / (2/5 R^2). It then moves downwards at V sin(elevation). A
bounce (``shared/reference/real.md`` 3) returns e_t of the downward speed, and Coulomb friction acts against the
slip of the lowest point, ``s = v + w x (-R z)``, at most mu_s times the bounce's normal impulse, at most 2/7 of
the slip. In the air gravity alone acts. When the ball bounces no more, it slides on a
parabola and rolls on a line.

SI units; table frame, right-handed, z up.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

STILL = 1e-9  # [m/s] a ball that bounces more slowly lies on the bed
UP = np.array([0.0, 0.0, 1.0])


class Cloth(NamedTuple):
    """The ball and what it lies on."""

    R: float = 0.02625
    g: float = 9.81
    mu_s: float = 0.21
    mu_r: float = 0.0127


def off_the_tip(speed, way, side, top, elevation, cloth):
    """Velocity and spin in three dimensions; ``way``: the horizontal direction of the impulse [rad]."""
    ahead = np.array([math.cos(way), math.sin(way), 0.0])
    cue = math.cos(elevation) * ahead - math.sin(elevation) * UP
    right = np.cross(ahead, UP)
    place = cloth.R * (side * right + top * np.cross(right, cue))
    return speed * cue, np.cross(place, speed * cue) / (0.4 * cloth.R**2)


def bounce(v, w, e_t, cloth):
    """Velocity and spin after the bed has stopped a ball that moves downwards, and thrown it up at e_t."""
    normal = (1.0 + e_t) * -v[2]
    slip = v + np.cross(w, -cloth.R * UP)
    slip[2] = 0.0
    size = math.sqrt(slip @ slip)
    push = -min(2.0 / 7.0, cloth.mu_s * normal / size if size else 1.0) * slip
    return v + push + normal * UP, w - 2.5 / cloth.R * np.cross(UP, push)


def rest(v, w, e_t, cloth):
    """Where a ball comes to rest, (2,) from where it is driven into the bed with v and w."""
    place = np.zeros(2)
    while v[2] < -STILL:
        v, w = bounce(v, w, e_t, cloth)
        place = place + v[:2] * 2.0 * v[2] / cloth.g
        v = v * (1.0, 1.0, -1.0)  # it comes down as fast as it went up
    slip = v[:2] + cloth.R * np.array([-w[1], w[0]])
    size, rolls = max(np.hypot(*slip), 1e-300), v[:2] - 2.0 / 7.0 * slip
    t = 2.0 * size / (7.0 * cloth.mu_s * cloth.g)
    place = place + v[:2] * t - 0.5 * cloth.mu_s * cloth.g * t * t * slip / size
    return place + rolls * np.hypot(*rolls) / (2.0 * cloth.mu_r * cloth.g)


def flown(speed, elevation, e_t, cloth):
    """For how long the ball bounces [s]: hops of 2 v / g, each e_t of the one before."""
    return 2.0 * e_t * speed * math.sin(elevation) / (cloth.g * (1.0 - e_t))


def behind(speed, elevation, e_t, cloth):
    """How far at most a ball whose slip ends in a hop lies behind one that never left the bed [m].

    Friction has come in a push where it hops and evenly where it lies; over a whole hop of the upward speed a
    the two ways cancel: the push at its start leads by mu_s a, half the hop later by nothing, and at its end
    lags by mu_s a. A slip that ends inside the hop leaves the rest of that triangle uncancelled, at most
    mu_s a^2 / (2 g); the first hop is the largest.
    """
    return cloth.mu_s * (e_t * speed * math.sin(elevation)) ** 2 / (2.0 * cloth.g)
