"""Which laws hold for every impact, every phase on the cloth and every shot? Properties, tried on what hypothesis draws."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import snooker_env as sn
from snooker_env import EventKind
from snooker_env.physics import detection
from snooker_env.physics.detection import SKIN
from tests.flights import calm
from tests.kernels import from_python

R, g = 0.02625, 9.81
D = 2 * R
FIDELITIES = ("fast", "standard", "reference")
many = settings(max_examples=250, deadline=None, derandomize=True, database=None)
some = settings(max_examples=100, deadline=None, derandomize=True, database=None)

part = st.floats(-1, 1).map(lambda x: 0.0 if abs(x) < 1e-6 else x)
angles = st.floats(-np.pi, np.pi)
speeds = st.one_of(st.floats(0.01, 8), st.sampled_from([1e-6, 1e-3, 50.0]))
spins = st.one_of(st.just(0.0), st.floats(0.1, 3), st.just(50.0))
"""Of R w over the speed."""
constants = st.builds(
    sn.Physics,
    mu_s=st.floats(0.02, 0.5),
    mu_bb=st.one_of(st.just("marlow"), st.floats(0, 0.5)),
    e_b=st.one_of(st.sampled_from([0.0, 1.0]), st.floats(0, 1)),
    e_c=st.one_of(st.sampled_from([0.0, 1.0]), st.floats(0, 1)),
    mu_c=st.floats(0, 0.4),
)


def horizontal(angle):
    return np.array([np.cos(angle), np.sin(angle), 0.0])


def turned(a, by):
    c, s = np.cos(by), np.sin(by)
    return np.asarray(a, float) @ np.array([(c, s, 0), (-s, c, 0), (0, 0, 1)])


@st.composite
def ball_impacts(draw):
    """v1, w1, v2, w2, normal of balls that close."""
    speed, angle = draw(speeds), draw(angles)
    normal = horizontal(angle)
    v1 = speed * horizontal(angle + draw(st.floats(-1.55, 1.55)))
    v2 = draw(st.sampled_from([0.0, 0.0, 0.4])) * speed * np.array([draw(part), draw(part), 0.0])
    w1, w2 = (draw(spins) * speed / R * np.array([draw(part), draw(part), draw(part)]) for _ in range(2))
    if draw(st.booleans()):
        w1[:2] = -v1[1] / R, v1[0] / R  # rolling
    assume((v1 - v2) @ normal > 1e-4 * speed)
    return v1, w1, v2, w2, normal


@st.composite
def nose_impacts(draw):
    """v, w, normal of a ball that moves into a cushion."""
    speed, angle = draw(speeds), draw(angles)
    v = speed * horizontal(angle + draw(st.floats(-1.5, 1.5)))
    return v, draw(spins) * speed / R * np.array([draw(part), draw(part), draw(part)]), horizontal(angle)


def size_of(case):
    """A speed that bounds the impact: velocities and R times spins."""
    return sum(np.linalg.norm(a) * (R if k % 2 else 1.0) for k, a in enumerate(case[:-1]))


def energy(rows):
    return sum(a @ a * (0.2 * R * R if k % 2 else 0.5) for k, a in enumerate(rows))


def far(got, want):
    """Largest difference of velocities and R * spins."""
    each = enumerate(zip(got, want, strict=True))
    return max(np.abs(np.subtract(a, b)).max() * (R if k % 2 else 1.0) for k, (a, b) in each)


# impacts of two balls


@many
@given(ball_impacts(), constants, st.sampled_from(FIDELITIES))
def test_two_balls_gain_no_energy_and_keep_their_momentum(case, physics, fidelity):
    """The pair's momentum changes by what the cloth's friction can give at the most, mu_s mu_bb of the
    impulse; its angular momentum about the line of centres not at all, but for the cloth; and the balls
    part."""
    v1, w1, v2, w2, n = case
    out = sn.collide_balls(*case, physics, fidelity)
    size, a, b, _ = size_of(case), *physics.friction_law
    tol = 1e-7 if fidelity == "standard" else 1e-9  # with next to no friction the error of the solution shows
    assert energy(out) <= energy(case[:-1]) * (1 + tol)
    change = (out[0] + out[2] - v1 - v2)[:2]
    impulse = max(np.linalg.norm(out[0] - v1), np.linalg.norm(out[2] - v2))
    share = 0.0 if fidelity == "fast" else physics.mu_s * (a + b)
    assert np.hypot(*change) <= share * (impulse + np.hypot(*change)) + tol * size
    assert (out[2] - out[0]) @ n >= -1e-6 * (v1 - v2) @ n - 1e-13 * size
    # equal balls, equal arms: friction at the contact turns both alike about the vertical, and the cloth
    # turns neither
    assert (out[1] - w1)[2] == pytest.approx((out[3] - w2)[2], abs=1e-9 * size / R)
    # the free ball's velocity and spin change by one and the same impulse: dw = (5/2) n x dv / R
    if fidelity == "fast":
        for dv, dw, arm in ((out[0] - v1, out[1] - w1, n), (out[2] - v2, out[3] - w2, -n)):
            assert dw == pytest.approx(2.5 / R * np.cross(arm, dv), abs=1e-9 * size / R)


@many
@given(ball_impacts(), st.floats(0, 1), st.sampled_from(FIDELITIES))
def test_without_friction_e_is_the_ratio_of_parting_to_closing(case, e, fidelity):
    v1, w1, v2, w2, n = case
    out = sn.collide_balls(*case, {"mu_bb": 0.0, "e_b": e}, fidelity)
    # e^2 is what is solved for: near e = 0 the root of the tolerance
    tol = {"fast": 1e-12, "standard": 2e-5, "reference": 1e-7}[fidelity]
    allowed = tol * (v1 - v2) @ n + 1e-13 * size_of(case)
    assert (out[2] - out[0]) @ n == pytest.approx(e * (v1 - v2) @ n, abs=allowed)
    assert far((out[1], out[1], out[3], out[3]), (w1, w1, w2, w2)) <= 1e-12 * size_of(case)
    along = 0.5 * (1 + e) * ((v1 - v2) @ n) * n
    assert far(out[::2], (v1 - along, v2 + along)) <= max(tol, 1e-12) * size_of(case)


@many
@given(ball_impacts(), constants, st.sampled_from(FIDELITIES), angles)
def test_an_impact_is_the_same_mirrored_turned_and_swapped(case, physics, fidelity, by):
    """Mirrored, turned, and with the balls' names swapped, the outcome is mirrored, turned and swapped."""
    out, size = sn.collide_balls(*case, physics, fidelity), size_of(case)
    v, w = np.array([-1, 1, 1]), np.array([1, -1, -1])  # spins are axial
    flips = (v, w, v, w, v)
    tol = {"fast": 1e-12, "standard": 1e-5, "reference": 1e-8}[fidelity]
    mirrored = sn.collide_balls(*(a * f for a, f in zip(case, flips, strict=True)), physics, fidelity)
    assert far(mirrored, [a * f for a, f in zip(out, flips[:4], strict=True)]) <= 1e-14 * size
    around = sn.collide_balls(*(turned(a, by) for a in case), physics, fidelity)
    assert far(around, [turned(a, by) for a in out]) <= tol * size
    swapped = sn.collide_balls(*(case[k] for k in (2, 3, 0, 1)), -case[4], physics, fidelity)
    assert far(swapped, [out[k] for k in (2, 3, 0, 1)]) <= tol * size


@many
@given(
    ball_impacts(),
    constants.filter(lambda p: p.mu_bb != "marlow"),
    st.sampled_from(FIDELITIES),
    st.sampled_from([0.25, 2.0, 1024.0]),
)
def test_an_impact_scales_with_its_speed(case, physics, fidelity, k):
    """With constant friction and restitution all speeds scale together: exactly, where k is a power of two."""
    out = sn.collide_balls(*case, physics, fidelity)
    faster = sn.collide_balls(*(k * a for a in case[:-1]), case[-1], physics, fidelity)
    assert far(faster, [k * a for a in out]) <= 1e-12 * k * size_of(case)


@many
@given(ball_impacts(), constants)
def test_the_three_fidelities_agree_as_far_as_they_promise(case, physics):
    """standard and reference solve the same equations; fast leaves out the cloth, whose friction is at most mu_s mu_bb of the impulse."""
    fast, standard, reference = (sn.collide_balls(*case, physics, f) for f in FIDELITIES)
    assert far(standard, reference) <= 1e-5 * size_of(case)
    if physics.mu_bb == 0:
        assert far(fast, reference) <= 1e-6 * size_of(case)


# cushions


@many
@given(nose_impacts(), constants, st.sampled_from(FIDELITIES), angles)
def test_a_cushion_takes_energy_gives_none_and_has_no_preferred_direction(case, physics, fidelity, by):
    v, w, n = case
    out, size = sn.collide_cushion(*case, physics, fidelity), size_of(case)
    # "fast" integrates with a loose tolerance here
    tol = {"fast": 0.1, "standard": 1e-5, "reference": 1e-8}[fidelity]
    assert energy(out) <= energy((v, w)) * (1 + 1e-9)
    assert out[0] @ n <= 1e-3 * v @ n
    mirrored = sn.collide_cushion(v * (-1, 1, 1), w * (1, -1, -1), n * (-1, 1, 1), physics, fidelity)
    assert far(mirrored, (out[0] * (-1, 1, 1), out[1] * (1, -1, -1))) <= 1e-14 * size
    around = sn.collide_cushion(*(turned(a, by) for a in case), physics, fidelity)
    assert far(around, [turned(a, by) for a in out]) <= tol * size


@many
@given(nose_impacts(), st.floats(0, 1), st.sampled_from(FIDELITIES))
def test_without_friction_a_cushion_returns_e_of_the_speed(case, e, fidelity):
    """The nose pushes along its own slanted normal and the cloth holds the ball down: v n goes to -e v n, nothing else changes."""
    v, w, n = case
    out = sn.collide_cushion(*case, {"mu_c": 0.0, "mu_s": 0.0, "e_c": e}, fidelity)
    # e near 0: the parting is a root of what is left of the work
    tol = {"fast": 1e-2, "standard": 2e-5, "reference": 1e-7}[fidelity]
    assert far(out, (v - (1 + e) * (v @ n) * n, w)) <= tol * np.linalg.norm(v)


# the cloth


@st.composite
def lone_balls(draw):
    """v (2,), w (3,) of one ball."""
    speed = draw(st.floats(0.01, 8))
    v = speed * horizontal(draw(angles))[:2]
    return v, draw(spins) * speed / R * np.array([draw(part), draw(part), draw(part)])


@many
@given(lone_balls(), st.floats(0.02, 1), st.floats(0.003, 0.2), st.floats(0, 1))
def test_cloth_friction_brakes_along_the_slip_and_turns_the_ball_about_its_contact(ball, mu_s, mu_r, at):
    """While it slides: dv/dt = -mu_s g u/|u|, and the angular momentum about the contact with the cloth, v +
    (2/5) R (w_y, -w_x), stays. Energy falls throughout; when it rolls, the slip is zero."""
    v0, w0 = ball
    shot = sn.simulate([(0, 0)], [v0], [w0], None, {"mu_s": mu_s, "mu_r": mu_r})
    slip = v0 + R * np.array([-w0[1], w0[0]])
    size = np.linalg.norm(v0) + R * np.linalg.norm(w0)
    rolls = shot.events["time"][0] if shot.events["kind"][0] == EventKind.ROLL else 0.0
    assert rolls == pytest.approx(np.hypot(*slip) / (3.5 * mu_s * g), abs=1e-12)
    t = at * rolls
    _, (v,), (w,) = shot.at(t)
    if rolls > 1e-9:
        assert v - v0 == pytest.approx(-mu_s * g * t * slip / np.hypot(*slip), abs=1e-12 * size)
        turn0, turn = (a + 0.4 * R * np.array([b[1], -b[0]]) for a, b in ((v0, w0), (v, w)))
        assert turn == pytest.approx(turn0, abs=1e-12 * size)
    _, velocities, whirls = shot.at(np.linspace(0, shot.duration, 60))
    joules = 0.5 * (velocities[:, 0] ** 2).sum(1) + 0.2 * R * R * (whirls[:, 0] ** 2).sum(1)
    assert (np.diff(joules) <= 1e-13 * joules[0]).all() and joules[-1] <= 1e-25
    if rolls < shot.duration:
        _, (v,), (w,) = shot.at(rolls + 0.5 * (shot.duration - rolls))
        assert v + R * np.array([-w[1], w[0]]) == pytest.approx([0, 0], abs=1e-13 * size)


# whole shots

PLACES = np.array([(0.0, 0.0), (0.3, 0.02), (0.45, -0.3), (-0.2, 0.5), (0.42, 0.045), (0.62, 0.3)])


@st.composite
def shots(draw, table=True, touching=True):
    """positions, velocities, spins of 1 to 6 balls: apart, or (``touching``) some frozen to the one before; the first is struck."""
    n = draw(st.integers(1, 6))
    shift = draw(st.tuples(st.floats(-0.2, 0.2), st.floats(-1.0, 1.0)))
    near = st.tuples(st.floats(-0.02, 0.02), st.floats(-0.02, 0.02))
    p = PLACES[:n] + [draw(near) for _ in range(n)] + shift
    for k in range(2, n):
        if touching and draw(st.booleans()):
            apart = np.nextafter(D, 1) + draw(st.sampled_from([0, 1e-12, 1e-9]))
            p[k] = p[k - 1] + apart * horizontal(draw(angles))[:2]
    gaps = np.hypot(*(p[:, None] - p[None]).transpose(2, 0, 1)) + np.eye(n)
    assume(gaps.min() >= D and (not table or np.abs(p[:, 0]).max() < 0.86))
    v, w = np.zeros((n, 2)), np.zeros((n, 3))
    target = p[-1 if draw(st.booleans()) else min(1, n - 1)]
    aim = np.arctan2(*(target - p[0])[::-1]) + draw(st.floats(-0.1, 0.1))
    velocity, w[0] = sn.strike(draw(st.floats(0.05, 7)), aim, draw(part) * 0.35, draw(part) * 0.35)
    v[0] = velocity[:2]
    if n > 2 and draw(st.booleans()):
        v[-1], w[-1] = draw(st.tuples(part, part)), 30 * np.array(draw(st.tuples(part, part, part)))
    return p, v, w


def in_play(shot, t):
    """Which balls have not dropped by t?"""
    here = np.ones(len(shot.positions), bool)
    drops = shot.events[shot.events["kind"] == EventKind.POT]
    here[drops["i"][drops["time"] <= t]] = False
    return here


@some
@given(
    shots(),
    st.sampled_from(["match", "tight", None]),
    constants,
    st.sampled_from([*FIDELITIES, "euler:1000"]),
)
def test_a_shot_keeps_every_law(shot, table, physics, fidelity):
    """Between and at events: no overlap, no energy gained, nobody off the table but through a pocket; at the end everything rests."""
    end = sn.simulate(*shot, table, physics, fidelity)
    times = np.union1d(end.events["time"], np.linspace(0, end.duration, 200))
    r, v, w = end.at(times)
    joules = 0.5 * (v**2).sum((1, 2)) + 0.2 * R * R * (w**2).sum((1, 2))
    if not (fidelity == "euler:1000" and max(physics.e_b, physics.e_c) > 0.99):  # its last step may gain 1/N
        assert (np.diff(joules[calm(end, times)]) <= 1e-9 * joules[0]).all()
    for t, now in zip(times, r, strict=True):
        here = in_play(end, t)
        now = now[here]
        if len(now) > 1:
            apart = np.hypot(*(now[:, None] - now[None]).transpose(2, 0, 1)) + np.eye(len(now))
            assert apart.min() > D - 1e-9
        if table:
            beside = np.abs(np.abs(now[:, 1]) - 0.9) < 0.7  # of a long cushion, clear of the pockets
            assert (np.abs(now[beside, 0]) <= 0.889 - R + 1e-9).all()
    assert (np.diff(end.events["time"]) >= 0).all() and end.events["time"].max(initial=0) <= end.duration
    assert (end.potted >= 0).tolist() == (~end.on_table).tolist() == (~in_play(end, np.inf)).tolist()
    _, v, w = end.at(end.duration)
    assert (v == 0).all() and np.abs(w).max() < 1e-9
    assert np.abs(end.at(end.duration)[0] - end.positions).max() <= 1e-12


@some
@given(
    angles,
    st.tuples(part, part, part),
    st.floats(20, 400),
    constants,
    st.sampled_from([None, "match"]),
    st.sampled_from([0.0, 1e-12, 1e-9]),
)
def test_a_ball_held_by_its_spin_hops_at_the_spins_expense(angle, axis, spin, physics, table, gap):
    """A ball that spins on the spot against a frozen ball, or a cushion: a lasting contact. It ends, and no hop gains energy."""
    at, way = np.array([0.889 - R - gap, 0.5]), np.array([abs(np.cos(angle)), np.sin(angle)])
    p = np.array([at, at - (np.nextafter(D, 1) + gap) * way])
    w = np.zeros((2, 3))
    w[0] = spin * np.array(axis)
    end = sn.simulate(p, np.zeros((2, 2)), w, table, physics)
    times = np.append(0.0, end.events["time"])
    _, v, w = end.at(times[calm(end, times)])
    joules = 0.5 * (v**2).sum((1, 2)) + 0.2 * R * R * (w**2).sum((1, 2))
    assert (np.diff(joules) <= 1e-13 * joules[0]).all()


@some
@given(shots(touching=False), st.sampled_from(FIDELITIES))
def test_a_mirrored_shot_is_the_mirror_image(shot, fidelity):
    """x -> -x: the same arithmetic, sign for sign, so the same to the last bit."""
    p, v, w = shot
    one = sn.simulate(p, v, w, fidelity=fidelity)
    two = sn.simulate(p * (-1, 1), v * (-1, 1), w * (1, -1, -1), fidelity=fidelity)
    assert (two.positions == one.positions * (-1, 1)).all()
    assert two.duration == one.duration and (two.events["time"] == one.events["time"]).all()
    pockets = np.array([1, 0, 5, 4, 3, 2, -1])
    assert (two.potted == pockets[one.potted]).all()


@some
@given(shots(table=False, touching=False), angles, st.tuples(part, part))
def test_on_unbounded_cloth_no_place_or_direction_is_special(shot, by, shift):
    """Turned and moved, the shot ends turned and moved, as far as rounding allows: up to six contacts."""
    p, v, w = shot
    one = sn.simulate(p, v, w, None, fidelity="reference")
    contacts = one.events["kind"] == EventKind.BALL_BALL
    assume(contacts.sum() <= 6)
    flat = lambda a: turned(np.column_stack([a, np.zeros(len(a))]), by)[:, :2]  # noqa: E731
    two = sn.simulate(flat(p) + shift, flat(v), turned(w, by), None, fidelity="reference")
    kinds = [(e["kind"], e["i"], e["j"]) for e in one.events[contacts]]
    met = two.events[two.events["kind"] == EventKind.BALL_BALL]
    assert kinds == [(e["kind"], e["i"], e["j"]) for e in met]
    assert np.abs(two.positions - flat(one.positions) - shift).max() < 1e-5


@some
@given(shots(touching=False), st.randoms(use_true_random=False))
def test_names_of_balls_do_not_matter(shot, random):
    order = list(range(len(shot[0])))
    random.shuffle(order)
    one, two = sn.simulate(*shot), sn.simulate(*(a[order] for a in shot))
    assume((one.events["kind"] == EventKind.BALL_BALL).sum() <= 6)
    assert np.abs(two.positions - one.positions[order]).max() < 1e-4
    assert (two.potted == one.potted[order]).all()


@some
@given(shots(touching=False), st.floats(0.05, 0.95))
def test_a_shot_stopped_and_started_again_goes_on_as_before(shot, at):
    one = sn.simulate(*shot, None, fidelity="reference")
    assume(0 < (one.events["kind"] == EventKind.BALL_BALL).sum() <= 4)
    t = at * one.events["time"][-1]
    assume(np.abs(one.events["time"] - t).min() > 1e-6)
    two = sn.simulate(*one.at(t), None, fidelity="reference")
    assert np.abs(two.positions - one.positions).max() < 1e-6
    assert t + two.duration == pytest.approx(one.duration, abs=1e-6)


# what the fuzz found

UNSOLVED = """
-0.0037727559465330724 0.33474473152165324 15.946283824890289 -3.103489430192995 -4.040993500703731 0 1 0.7
0.14 0.4 0.98
-0.03150012916185054 0.16182982301995855 -5.631742292193911 -0.9135289056240937 9.235027324826552 0 1 0.3
0.3 0.6 0.98
0.1892598335095641 -0.022659902199318786 0.8632343694978586 7.209898419411966 4.553909051496761 0 -1
0.37435603872240425 0.0960303469577783 0.5986740392033739 0.45095779299471095
0.6852182528384435 0.3014285607836339 -11.482992791757482 26.10355248908356 -45.77952915771147 1 0
0.371821773133134 0.2176661633068515 0.5294182367993291 0.4692885555332693
1.7571646438865136 -0.4642600144717246 17.686095789399033 66.939605481391 45.636404073107386 1 0
0.24694609284162072 0.39121172612894456 0.5299161939002829 0.027594006678478555
"""
"""Cushion impacts that "standard" or "reference" once did not end: v (2), w (3), normal (2), mu_s, mu_c, sin_theta, e_c."""


@pytest.mark.parametrize("numbers", np.array(UNSOLVED.split(), float).reshape(-1, 11))
def test_cushion_impacts_that_once_did_not_end(numbers):
    v, w, n, (mu_s, mu_c, sin_theta, e_c) = numbers[:2], numbers[2:5], numbers[5:7], numbers[7:]
    physics = sn.Physics(mu_s=mu_s, mu_c=mu_c, sin_theta=sin_theta, e_c=e_c)
    standard, reference = (sn.collide_cushion((*v, 0), w, (*n, 0), physics, f) for f in FIDELITIES[1:])
    # (Moreau's steps agree with reference: where friction and drive almost balance, standard is less exact)
    assert far(standard, reference) <= 5e-5 * size_of((np.array(v), np.array(w), n))
    assert energy(reference) < energy((np.array(v), np.array(w)))


@pytest.mark.parametrize("depth", [0.9, 1.1, 1.49, 1.51])
def test_touching_balls_that_creep_together_meet_however_deep(depth):
    """Pressed between 1 and 1.5 skins deep they once never met, and went on into each other."""
    crossing = from_python(detection.distance_crossing)
    assert crossing(D - depth * SKIN, 0.0, -4e-5, 0.0, 0.0, 0.0, D, 1.0) < 1e-3
