"""Do balls fly as they should? Closed forms: hops, bounces, jumps, noses, rails, impacts in the air."""

import math

import numpy as np
import pytest

import snooker_env as sn
from snooker_env import EventKind
from snooker_env.geometry import HALF_LENGTH, HALF_WIDTH
from snooker_env.physics import flight
from tests.kernels import from_python

FLYING = sn.Physics.preset("match", flight=True)
R, G, E_T = FLYING.R, FLYING.g, FLYING.e_t
HIGH = R * FLYING.sin_theta
STILL = (0.0, 0.0, 0.0)


def kinds(shot, ball=None):
    """The kinds of the events of a shot, or of one ball's."""
    return [EventKind(e["kind"]).name for e in shot.events if ball is None or e["i"] == ball]


def one(place, velocity, spin=STILL, physics=FLYING, table: sn.Table | str | None = "match"):
    """A shot of one ball from ``place`` (3,)."""
    return sn.simulate([place], [velocity], [spin], table=table, physics=physics)


@pytest.mark.parametrize(("speed", "inches"), [(3.13, 0.067), (5.36, 0.196), (8.94, 0.544)])
def test_a_rolling_ball_hops_off_a_full_ball_as_measured(speed, inches):
    """[TP B.5]: friction 0.06 and restitution 0.94."""
    physics = sn.Physics.preset("match", flight=True, mu_bb=0.06, e_b=0.94)
    balls = [(0, 0), (0, 2 * R + 1e-4)], [(0, speed), (0, 0)], [(-speed / R, 0, 0), STILL]
    shot = sn.simulate(*balls, None, physics)
    heights = shot.at(np.linspace(0, 0.3, 3001))[0][..., 2].max(axis=0)
    assert heights[0] == pytest.approx(0.0254 * inches, rel=0.05)
    # the other ball was pressed by the same impulse: it leaves the bed at e_t of the speed
    assert heights[1] == pytest.approx(E_T**2 * heights[0], rel=1e-3)


def test_a_dropped_ball_bounces_until_it_is_slower_than_it_settles():
    shot = one((0, 0, 0.3), STILL)
    first = math.sqrt(2 * 0.3 / G)
    down, times, t = math.sqrt(2 * G * 0.3), [], first
    while True:
        times.append(t)
        down *= E_T
        if down < flight.SETTLE:
            break
        t += 2 * down / G
    assert kinds(shot) == ["LAND"] * len(times)
    np.testing.assert_allclose(shot.events["time"], times, rtol=1e-12)
    assert np.abs(shot.events["z"]).max() < 1e-15
    assert shot.positions[0].tolist() == [0.0, 0.0]


def test_the_bed_rubs_by_its_impulse_or_until_the_ball_rolls():
    for spin, grips in ((60.0, False), (40.0, True)):
        w0 = np.array([0.6 * spin, 0.8 * spin, 7.0])
        v, w, up = from_python(flight.bounce_off_bed)((0.0, 0.0), tuple(w0), 1.0, FLYING.pack())
        push = min(FLYING.mu_s * (1.0 + E_T), R * spin * 2 / 7) * np.array([0.8, -0.6])
        assert (*v, up) == pytest.approx((*push, E_T))
        assert R * np.array(w) == pytest.approx(R * w0 + 2.5 * np.array([push[1], -push[0], 0.0]))
        assert (abs(v[0] - R * w[1]) < 1e-12) == grips


def test_a_cue_raised_far_enough_clears_a_ball_and_no_further():
    """The ball must rise by 2 R: e_t V sin(elevation) >= sqrt(4 g R)."""
    least = math.asin(math.sqrt(4 * G * R) / (E_T * 5.0))
    for elevation, clears in ((1.02 * least, True), (0.98 * least, False)):
        v, w = sn.strike(5.0, math.pi / 2, elevation=elevation, physics=FLYING)
        half = v[1] * v[2] / G  # where it is highest
        shot = sn.simulate([(0, 0), (0, half)], [v, STILL], [w, STILL], physics=FLYING)
        assert (kinds(shot)[0] == "LAND") == clears
    flat, _ = sn.strike(5.0, math.pi / 2, elevation=least, physics="match")
    assert flat[2] == 0.0


def test_where_no_ball_flies_nothing_changes():
    rng = np.random.default_rng(4)
    compared = 0
    for _ in range(200):
        places = np.column_stack([rng.uniform(-0.8, 0.8, 6), rng.uniform(-1.6, 1.6, 6)])
        if min(np.hypot(*(a - b)) for k, a in enumerate(places) for b in places[:k]) < 2 * R:
            continue
        v, w = np.zeros((6, 2)), np.zeros((6, 3))
        v[0] = rng.normal(0, 0.5, 2)
        w[0, :2] = -v[0, 1] / R, v[0, 0] / R
        both = (sn.Physics.preset("match", flight=f) for f in (False, True))
        flat, flying = (sn.simulate(places, v, w, physics=physics) for physics in both)
        if EventKind.LAND in flying.events["kind"]:
            continue
        assert np.array_equal(flat.positions, flying.positions) and flat.duration == flying.duration
        assert (flying.at(0.5 * flying.duration)[0][:, 2] == 0.0).all()
        compared += 1
    assert compared > 100


@pytest.mark.parametrize("height", [0.5 * HIGH, HIGH + 0.5 * R])
def test_a_nose_turns_a_ball_in_the_air_up_or_down(height):
    """Below the nose's height it is driven down, above it is thrown up: a free sphere and a fixed edge."""
    still = sn.Physics.preset("match", flight=True, g=1e-3, mu_c=0.0)
    # about as high where it meets the nose
    shot = one((0.5, 0.5, height), (1.0, 0.0, 0.5 * still.g * 0.34), physics=still)
    met = shot.events[0]
    assert EventKind(met["kind"]) == EventKind.CUSHION
    sin_phi = (HIGH - height) / R
    cos_phi = math.sqrt(1 - sin_phi**2)
    edge = HALF_WIDTH - R * (1 - math.sqrt(1 - still.sin_theta**2))
    assert met["time"] == pytest.approx(edge - R * cos_phi - 0.5, abs=1e-4)
    p = (1 + still.e_c) * cos_phi
    after = shot.at(met["time"])[1][0]
    np.testing.assert_allclose(after, (1 - p * cos_phi, 0.0, -p * sin_phi), atol=2e-3)


def test_a_ball_over_a_rail_bounces_there_or_leaves_the_table():
    top = HIGH + R
    shot = one((HALF_WIDTH - 0.1, 0.3, 0.2), (0.7, 0.0, 0.0))
    assert kinds(shot)[0] == "RAIL" and shot.potted[0] == -2 and not shot.on_table[0]
    assert shot.events[0]["time"] == pytest.approx(math.sqrt(2 * (0.2 - top) / G), rel=1e-12)
    assert shot.events["z"][0] == pytest.approx(top, abs=1e-12)
    far = one((HALF_WIDTH - 0.1, 0.3, 0.2), (3.0, 0.0, 0.5))
    assert kinds(far) == ["OFF"]
    assert far.duration == pytest.approx((0.1 + flight.RAIL - (R - R * math.sqrt(1 - 0.16))) / 3)


def test_balls_go_into_pockets_from_the_air_but_not_over_their_backs():
    x, y = sn.geometry.POCKET_AIMS[0, :2] if hasattr(sn, "geometry") else (-HALF_WIDTH, -HALF_LENGTH)
    way = np.array([x, y]) / np.hypot(x, y)
    start = np.array([x, y]) - 0.4 * way
    low = one((*start, 0.0), (*(2.0 * way), 0.9))
    assert low.potted[0] >= 0
    high = one((*start, 0.0), (*(3.0 * way), 2.5))
    assert high.potted[0] == -2 and kinds(high)[-1] == "OFF"


def test_balls_that_meet_in_the_air_keep_momentum_and_part_at_e():
    shot = sn.simulate(
        [(0, 0, 0.3), (0.02, 0.5, 0.31)],
        [(0.0, 1.5, 1.0), (0.0, -1.5, 1.0)],
        [(20.0, 5.0, -30.0), (0.0, 40.0, 10.0)],
        None,
        FLYING,
    )
    assert kinds(shot)[0] == "BALL_BALL"
    t = float(shot.events["time"][0])
    (r, v, w), (_, before, spun) = shot.at(t), shot.at(np.nextafter(t, 0))
    np.testing.assert_allclose(v.sum(axis=0), before.sum(axis=0), atol=1e-9)
    n = (r[1] - r[0]) / np.linalg.norm(r[1] - r[0])
    assert np.linalg.norm(r[1] - r[0]) == pytest.approx(2 * R, abs=2e-9)
    assert (v[1] - v[0]) @ n == pytest.approx(-FLYING.e_b * ((before[1] - before[0]) @ n), rel=1e-9)
    # angular momentum about the point of contact: of each ball by itself
    for k, side in ((0, 1.0), (1, -1.0)):
        turned = 0.4 * R**2 * (w[k] - spun[k]) - side * np.cross(R * n, v[k] - before[k])
        np.testing.assert_allclose(turned, 0.0, atol=1e-12)


def past_the_edges(places, table, physics):
    """How deep balls at ``places`` (m, 3) are in the edges of the noses and jaws [m], from the table's geometry alone."""
    R, (x, y, z) = physics.R, places.T
    inset, least = R * (1.0 - math.sqrt(1.0 - physics.sin_theta**2)), np.full(len(places), np.inf)
    up = z - R * physics.sin_theta
    for axis, side, level, low, high in table.noses:
        p, q = (x, y) if axis == 0 else (y, x)
        off, along = level - inset - side * p, q - np.clip(q, low, high)
        least = np.minimum(least, off**2 + along**2 + up**2)
    for jx, jy, radius, ux, uy, cosine in table.jaws:
        along, aside = (x - jx) * ux + (y - jy) * uy, (y - jy) * ux - (x - jx) * uy
        half = math.acos(cosine)
        turn = np.clip(np.arctan2(aside, along), -half, half)
        off = along - (radius + inset) * np.cos(turn), aside - (radius + inset) * np.sin(turn)
        least = np.minimum(least, off[0] ** 2 + off[1] ** 2 + up**2)
    return R - np.sqrt(least)


def deepest(shot):
    """``past_the_edges`` of a shot of one ball, but for where it is over a pocket or gone [m]."""
    times = np.concatenate([np.linspace(0.0, min(shot.duration, 3.0), 1500), shot.events["time"]])
    ends = {EventKind.DROP, EventKind.POT, EventKind.OFF}
    gone = [t for t, kind in shot.events[["time", "kind"]].tolist() if kind in ends]
    times = times[times < min(gone, default=np.inf)]
    return past_the_edges(shot.at(times)[0][:, 0], shot.table, shot.physics).max() if len(times) else 0.0


@pytest.mark.parametrize(
    ("place", "velocity", "first"),
    [
        ((-0.333, 1.704, 0.0), (-1.28, 0.27, 2.09), "JAW"),
        # along a nose out of the mouth of a pocket, where its line goes on without an edge
        ((-0.8306, 0.0545, 0.0), (-1.602, 0.0143, 0.8209), "JAW"),
    ],
)
def test_no_ball_is_in_an_edge_that_it_comes_down_on_from_behind(place, velocity, first):
    shot = one(place, velocity, physics=sn.Physics.preset("paper", flight=True))
    assert kinds(shot)[0] == first and deepest(shot) < 1e-9


@pytest.mark.slow
def test_lobs_at_pockets_meet_every_edge_from_every_side():
    """4,000 of four tables: no ball is deeper than ``SKIN``, which the text of ``detection`` allows, and rounding."""
    rng, jaws = np.random.default_rng(0), 0
    for k in range(4000):
        table = sn.Table.preset(("match", "tight", "pool9", "uk8")[k % 4])
        physics = sn.Physics.preset("match" if k % 8 < 4 else "paper", flight=True, **table.ball)
        fall, most = table.falls[rng.integers(len(table.falls))], table.bounds[:, 1] - physics.R - 5e-3
        start = np.clip(rng.uniform(-most, most), fall[:2] - 0.6, fall[:2] + 0.6)
        t = rng.uniform(0.03, 0.6)
        way, z = (fall[:2] + rng.normal(0.0, 0.06, 2) - start) / t, rng.choice([0.0, rng.uniform(0.0, 0.2)])
        up = (rng.uniform(-0.02, 0.06) - z + 0.5 * G * t * t) / t
        shot = one((*start, z), (*way, up), rng.normal(0.0, 60.0, 3), physics, table)
        jaws += "JAW" in kinds(shot)
        assert deepest(shot) < flight.SKIN * (1.0 + 1e-3), (k, table.name, start, z, way, up)
    assert jaws > 500


def test_a_jaw_is_met_in_the_air_where_its_edge_is():
    """As high as the nose the ball meets the edge R before it, and the edge lies R (1 - cos theta) inside the table's line."""
    still, speed = sn.Physics.preset("match", flight=True, g=1e-3), 1.0
    x, y, radius, ux, uy, _ = sn.Table.preset("match").jaws[0]
    edge = radius + R * (1 - math.sqrt(1 - still.sin_theta**2))
    start = edge + R + 0.05
    climb = 0.5 * still.g * 0.05
    shot = one((x + start * ux, y + start * uy, HIGH), (-speed * ux, -speed * uy, climb), physics=still)
    met = shot.events[0]
    assert (EventKind(met["kind"]), met["j"]) == (EventKind.JAW, 0)
    assert met["time"] == pytest.approx(0.05 / speed, abs=2e-6)


@pytest.mark.parametrize("seed", range(12))
def test_a_shot_goes_the_same_way_if_the_run_with_flight_plays_it_from_the_start(seed):
    """A far ball that is in the air for an instant sends the shot there at once; else it begins in the run without flight."""
    rng = np.random.default_rng(seed)
    rows = ((x, y) for y in (0.1, 0.4) for x in (-0.2, 0.0, 0.15))
    balls = [(rng.uniform(-0.3, 0.3), -0.8), *rows, (0.8, 1.7)]
    places = np.column_stack([balls, np.zeros(len(balls))])
    velocities, spins = np.zeros((len(balls), 3)), np.zeros((len(balls), 3))
    aim = math.atan2(0.9, balls[2][0] - balls[0][0]) + rng.uniform(-0.04, 0.04)
    velocities[0, :2] = 5.0 * math.cos(aim), 5.0 * math.sin(aim)
    ways = []
    for up in (0.0, 1e-12):
        velocities[-1, 2] = up
        flying = sn.Physics.preset("match", flight=True)
        shot = sn.simulate(places, velocities, spins, physics=flying, table="match")
        ways.append((shot.positions, [tuple(one)[:4] for one in shot.events if len(balls) - 1 != one["i"]]))
    assert np.array_equal(ways[0][0], ways[1][0]) and ways[0][1] == ways[1][1]
    assert len(ways[0][1]) > 10
