"""Is the strike of a raised cue right? A ball that bounces in three dimensions, laws, and shots.

``flight_3d`` bounces the ball on a bed with a restitution, which the model without flight does not know. The ball comes
to rest where the model's does, whatever the restitution, as long as its slip outlasts the bounces: the bed gives
V sin(elevation) and gravity's impulse in all, friction is mu_s of both against a slip that keeps its direction, and over
each hop the two ways of giving it move the ball equally far. If the slip ends before, two things are left: a triangle
(``behind``), and that a ball in the air is not slowed by the rolling resistance, so that it runs on at its rolling speed
for the rest of the bounces.
"""

import itertools
import math

import numpy as np
import pytest

import snooker_env as sn
from snooker_env import EventKind

from . import flight_3d

R, G, MU_S = 0.02625, 9.81, 0.21
CENTRE, FOLLOW, SCREW, RIGHT, MASSE = (0.0, 0.0), (0.0, 0.4), (0.0, -0.4), (0.35, 0.1), (-0.3, -0.35)
TIPS = [CENTRE, FOLLOW, SCREW, RIGHT, MASSE, (0.15, 0.05)]
DEGREES = [1, 4, 7, 12, 20, 35, 60]


def squirt(b):
    """TP A.31, b over R, for the presets' end mass."""
    return math.atan(2.5 * b * math.sqrt(1 - b * b) / (1 + 30 + 2.5 * (1 - b * b)))


def off_the_tip(speed, way, side, top, elevation):
    """Velocity and spin in three dimensions; ``way``: the horizontal direction of the impulse [rad]."""
    ahead, up = np.array([math.cos(way), math.sin(way), 0.0]), np.array([0.0, 0.0, 1.0])
    cue = math.cos(elevation) * ahead - math.sin(elevation) * up
    right = np.cross(ahead, up)
    place = R * (side * right + top * np.cross(right, cue))
    return speed * cue, np.cross(place, speed * cue) / (0.4 * R**2)


def flown(speed, elevation, e_t):
    """For how long the ball bounces [s]: hops of 2 v / g, each e_t of the one before."""
    return 2.0 * e_t * speed * math.sin(elevation) / (G * (1.0 - e_t))


def behind(speed, elevation, e_t):
    """How far at most a ball whose slip ends in a hop lies behind one that never left the bed [m].

    Friction has come in a push where it hops and evenly where it lies; over a whole hop of the upward speed a
    the two ways cancel: the push at its start leads by mu_s a, half the hop later by nothing, and at its end
    lags by mu_s a. A slip that ends inside the hop leaves the rest of that triangle uncancelled, at most
    mu_s a^2 / (2 g); the first hop is the largest.
    """
    return MU_S * (e_t * speed * math.sin(elevation)) ** 2 / (2.0 * G)


def modelled(speed, aim, tip, elevation):
    """Rest, rolling velocity, and when the slip ends, of a struck ball alone."""
    v, w = sn.strike(speed, aim, *tip, elevation)
    shot = sn.simulate([(0.0, 0.0)], [v[:2]], [w], table=None)
    slides = shot.events["time"][shot.events["kind"] == EventKind.ROLL]
    until = float(slides[0]) if len(slides) else 0.0
    return shot.positions[0], shot.at(until)[1][0], until


def slip(v, w):
    return np.array([v[0] - R * w[1], v[1] + R * w[0]])


@pytest.mark.parametrize("e_t", [0.02, 0.2, 0.5, 0.7])
@pytest.mark.parametrize("degrees", DEGREES)
def test_it_comes_to_rest_where_a_bouncing_ball_does(degrees, e_t, monkeypatch):
    """Within 1e-7 m where the slip outlasts the bounces; else as the two closed forms say, in direction too."""
    monkeypatch.setattr(flight_3d, "SETTLE", 1e-9)
    bed, elevation, aim, exact = sn.Physics(flight=True, e_t=e_t), math.radians(degrees), 0.7, 0
    for tip, speed in itertools.product(TIPS, [0.5, 1.5, 3.0, 6.0]):
        v, w = off_the_tip(speed, aim + squirt(tip[0]), *tip, elevation)
        rest, _ = flight_3d.simulate([(0.0, 0.0)], [v], [w], physics=bed, dt=1e-2)
        place, runs, until = modelled(speed, aim, tip, elevation)
        apart = rest[0, :2] - place
        left = flown(speed, elevation, e_t) - until
        if left <= 0.0:
            assert np.hypot(*apart) < 1e-7, (tip, speed)
            exact += 1
            continue
        u = slip(v, w) / np.hypot(*slip(v, w))
        apart -= runs * left
        most = behind(speed, elevation, e_t)
        assert -1e-7 < -apart @ u < most + 1e-7 and abs(apart @ (-u[1], u[0])) < 1e-7, (tip, speed)
    # 2/7 of the slip is enough for (1 + e) / (1 - e) mu_s V sin(elevation) in all of these
    assert exact >= (20 if math.tan(elevation) * (1 + e_t) / (1 - e_t) < 1.0 else 0)


@pytest.mark.parametrize("mu_s", [0.1, 0.21, 0.6])
def test_a_steep_cue_makes_the_ball_roll(mu_s):
    """Stun: the slip V cos(elevation) is gone where mu_s tan(elevation) = 2/7; at 5/7 of the speed, with the side
    spin untouched. Just below, the ball still slides: a twentieth of the slip is left at 19/20 of that."""
    edge = math.atan(2.0 / 7.0 / mu_s)
    physics = {"mu_s": mu_s}
    for steeper in (1e-6, 0.03, 0.1):
        v, w = sn.strike(2.0, 0.3, 0.0, 0.0, edge + steeper, physics)
        assert v == pytest.approx(
            5 / 7 * 2.0 * math.cos(edge + steeper) * np.array([math.cos(0.3), math.sin(0.3), 0])
        )
        assert np.allclose(slip(v, w), 0.0, atol=1e-15) and w[2] == 0.0
        shot = sn.simulate([(0, 0)], [v[:2]], [w], table=None, physics=physics)
        assert shot.events["kind"].tolist() == [EventKind.STOP]
    flatter = math.atan(0.95 * math.tan(edge))
    v, w = sn.strike(2.0, 0.3, 0.0, 0.0, flatter, physics)
    assert np.hypot(*slip(v, w)) == pytest.approx(0.05 * 2.0 * math.cos(flatter), rel=1e-9)
    level, raised = (sn.strike(2.0, 0.3, 0.3, 0.1, one, physics)[1][2] for one in (0.0, edge + 0.1))
    assert raised == pytest.approx(level * math.cos(edge + 0.1), rel=1e-12)
