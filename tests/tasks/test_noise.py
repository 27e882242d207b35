"""Is the noise as wide as its level says, does it reach the table, and does it leave every shot playable?"""

import math
from dataclasses import replace

import numpy as np
import pytest

from snooker_env import Physics, SnookerEnv, strike
from snooker_env.geometry import BALL_RADIUS as R
from snooker_env.tasks.noise import LEVELS, Noise, chance_within, execute_stroke
from tests.kernels import from_python
from tests.tables import after_strike, begun

_executed = from_python(execute_stroke)


def drawn(noise, n, speed, side, top, aim, elevation):
    """So many shots as executed, from one stream: (n, 5)."""
    stream, packed = np.array([7, 0], np.uint64), noise.pack(R)
    shot = map(float, (speed, side, top, aim, elevation))
    return np.array([_executed(*numbers, packed, stream) for numbers in [tuple(shot)] * n])


def test_noise_has_the_deviations_that_it_says():
    """20 000 draws: a standard deviation is known to 0.5 %, a mean to 0.7 % of one."""
    noise = Noise(aim_deg=0.2, speed_rel=0.03, speed_abs=0.04, offset_mm=0.4, elevation_deg=0.5)
    shot = (2.0, 0.1, -0.2, 0.7, 0.3)
    draws = drawn(noise, 20_000, *shot)
    sigma = [math.hypot(0.03 * 2.0, 0.04), 0.4e-3 / R, 0.4e-3 / R, math.radians(0.2), math.radians(0.5)]
    assert draws.std(axis=0) == pytest.approx(sigma, rel=0.025)
    assert np.abs((draws.mean(axis=0) - shot) / sigma).max() < 0.035
    assert np.abs(np.corrcoef(draws.T) - np.eye(5)).max() < 0.035
    normal = (draws - shot) / sigma
    assert (np.abs(normal) > 1).mean(axis=0) == pytest.approx([0.3173] * 5, abs=0.015)
    assert (np.abs(normal) > 3).mean(axis=0) == pytest.approx([0.0027] * 5, abs=0.002)


WIDTHS = {  # of the aim [deg] and of the speed [m/s] at 3 m/s; 3.162 = sqrt(1 + 3^2)
    "none": (0.0, 0.0),
    "professional": (0.014 * 3.162, 0.051),
    "amateur": (0.028 * 3.162, 0.102),
    "club": (0.056 * 3.162, 0.204),
    "beginner": (0.112 * 3.162, 0.408),
    "robot": (0.033, 0.24),
    "olympiad": (0.125, 0.075),
}


@pytest.mark.parametrize("name", LEVELS)
def test_each_level_is_as_wide_as_written(name):
    draws = drawn(replace(LEVELS[name], lapse=0.0), 4000, 3.0, 0, 0, 1.0, 0.2)
    widths = np.degrees(draws[:, 3].std()), draws[:, 0].std()
    assert widths == pytest.approx(WIDTHS[name], rel=0.05, abs=1e-12)


@pytest.mark.parametrize(
    ("name", "physics"), [*((name, "paper") for name in LEVELS), ("club", {"end_mass_ratio": 15.0})]
)
def test_the_total_direction_error_is_that_of_the_balls_struck(name, physics):
    """Aim and squirt together, as the balls leave; 4000 of them give a standard deviation to 1.1 %."""
    constants = Physics.of(physics)
    ways = []
    strokes = drawn(replace(LEVELS[name], lapse=0.0), 4000, 2.0, 0.0, 0.0, 0.0, 0.0)
    for speed, side, top, aim, elevation in strokes.tolist():
        v, _ = strike(speed, aim, side, top, elevation, constants)
        ways.append(math.degrees(math.atan2(v[1], v[0])))
    wanted = LEVELS[name].direction_deg(physics, speed=2.0)
    assert np.std(ways) == pytest.approx(wanted, rel=0.045, abs=1e-12)


def test_errors_of_aim_and_tip_grow_with_the_speed():
    """sqrt(1 + (growth V)^2), of those alone: by 5/3 and 13/5, with 1 and 2.4 m/s of growth 4/3 and 1."""
    wide = dict(aim_deg=0.1, offset_mm=0.3, elevation_deg=0.2, speed_abs=0.05)
    for growth, speed, times in ((4.0 / 3.0, 1.0, 5.0 / 3.0), (1.0, 2.4, 2.6), (3.0, 0.0, 1.0)):
        flat, grown = (drawn(Noise(**wide, growth=g), 300, speed, 0.0, 0.0, 0.0, 0.3) for g in (0.0, growth))
        assert grown[:, 1:4] == pytest.approx(times * flat[:, 1:4], rel=1e-12)
        assert (grown[:, [0, 4]] == flat[:, [0, 4]]).all()
    assert Noise(growth=0.6).silent
    assert Noise(aim_deg=0.1, growth=4.0 / 3.0).direction_deg(speed=1.0) == pytest.approx(0.5 / 3.0)


def test_a_lapse_makes_all_five_errors_larger_and_no_other_stroke_changes():
    """A share p of the strokes has K times the errors that it would have; from keys as from Sobol or NumPy's numbers."""
    wide, n = Noise(aim_deg=0.1, offset_mm=0.3, elevation_deg=0.2, speed_rel=0.02), 20_000
    lapsing = replace(wide, lapse=0.1, lapse_factor=4.0)
    meant = 2.0, 0.1, 0.2, 0.3, 0.5
    plain, some = (drawn(noise, n, *meant) - meant for noise in (wide, lapsing))
    times = some / plain
    lapse = times[:, 3] > 2.0
    assert times == pytest.approx(np.where(lapse, 4.0, 1.0)[:, None] * np.ones(5), rel=1e-6)
    assert lapse.mean() == pytest.approx(0.1, abs=4 * math.sqrt(0.09 / n))
    # the sixth number alone decides
    assert abs(np.corrcoef(lapse, np.abs(plain[:, 3]))[0, 1]) < 4 / math.sqrt(n)
    streams = np.array([[k, 0] for k in range(n)], np.uint64)
    numbers = lapsing.errors_of(streams)
    assert (numbers == wide.errors_of(streams)).all(axis=1).mean() == pytest.approx(0.9, abs=0.01)
    assert (streams[:, 1] == 0).all()
    for errors in (numbers, lapsing.draw_errors(np.random.default_rng(3), n)):
        assert errors.std(axis=0) == pytest.approx([math.sqrt(0.9 + 0.1 * 16.0)] * 5, rel=0.05)
        assert (np.abs(errors) > 4.0).mean(axis=0) == pytest.approx([0.1 * 0.3173] * 5, abs=0.006)
    for p, share in ((0.0, 0.0), (1.0, 1.0)):
        always = Noise(aim_deg=0.1, lapse=p, lapse_factor=3.0).draw_errors(np.random.default_rng(3), 500)
        assert (np.abs(always) > 4.5).any() == (share == 1.0)
        assert always.std() == pytest.approx(1.0 + 2.0 * share, rel=0.05)


def test_the_chance_to_stay_within_is_that_of_the_errors_drawn():
    noise = Noise(aim_deg=0.1, lapse=0.07, lapse_factor=5.0)
    errors = np.radians(0.1) * noise.draw_errors(np.random.default_rng(4), 200_000)[:, 3]
    spread = noise.spread()
    for within in (0.3, 1.0, 2.0, 6.0):
        chance = from_python(chance_within)(within * spread.core, spread)
        assert chance == pytest.approx((np.abs(errors) < within * spread.core).mean(), abs=0.004)


def test_speed_and_elevation_are_never_negative():
    draws = drawn(Noise(speed_abs=1.0, elevation_deg=5.0), 500, 0.2, 0, 0, 0, 0.0)
    assert draws[:, 0].min() == 0.0 < draws[:, 0].max() and draws[:, 4].min() == 0.0 < draws[:, 4].max()


def test_no_noise_draws_nothing():
    env = begun(SnookerEnv(layout="random:3"))
    before = env.get_state()
    env.step(np.zeros(4))
    assert env.get_state()["stream"] == before["stream"] and env.get_state()["rng"] == before["rng"]
    noisy = begun(SnookerEnv(layout="random:3", noise={"offset_mm": 1e-9}))
    noisy.step(np.zeros(4))
    assert noisy.get_state()["stream"] == [before["stream"][0], before["stream"][1] + 3]
    errors = set(Noise.__dataclass_fields__) - {"growth", "lapse", "lapse_factor"}
    assert Noise().silent and not any(Noise(**{f: 1e-9}).silent for f in errors)


def test_a_noisy_tip_is_drawn_back_too():
    """However wide the noise, no shot is a miscue that raises."""
    env = SnookerEnv(layout="random:2", noise={"offset_mm": 30.0}, render_mode="ansi")
    for seed in range(20):
        env.reset(seed=seed)
        v, w = after_strike(env, [0, 1, 0, 0.3])
        assert np.hypot(w[2], np.hypot(*w[:2])) <= 2.5 * np.hypot(*v) / R * 0.5 * (1 + 1e-9)
