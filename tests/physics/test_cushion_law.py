"""Does a faster ball always come off a cushion faster? The law e(v) and the whole impact."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import snooker_env as sn
from snooker_env.physics.impact import contact
from tests.kernels import from_python
from tests.physics.cases import R

cushion_restitution = from_python(contact.cushion_restitution)
FASTEST = 1000.0
MOST_POWER = 0.8
some = settings(max_examples=200, deadline=None, derandomize=True, database=None)
SPEEDS = np.geomspace(1e-3, FASTEST, 50)
STRAIGHT, SLANTED = (0.0, 1.0, 0.0), (np.sqrt(0.5), np.sqrt(0.5), 0.0)

laws = st.builds(
    lambda e_c, knee, power: {"e_c": e_c, "e_c_knee": knee, "e_c_power": power},
    st.floats(0.05, 1.0),
    st.floats(-3.0, 3.0).map(lambda x: 10.0**x),
    st.one_of(st.floats(0.0, MOST_POWER), st.just(MOST_POWER)),
)
cushions = st.builds(
    lambda mu_c, mu_s, sin_theta: {"mu_c": mu_c, "mu_s": mu_s, "sin_theta": sin_theta},
    st.floats(0.0, 0.5),
    st.floats(0.0, 0.5),
    st.floats(0.0, 0.5),
)


def restitution(physics, speeds):
    packed = physics.pack()
    return np.array([cushion_restitution(float(v), packed) for v in speeds])


def rebound(physics, speed, direction, rolling, fidelity="reference"):
    """Normal speed off a cushion along x of a ball that moves along ``direction``."""
    v = speed * np.array(direction)
    w = np.array((-v[1], v[0], 0.0)) / R if rolling else np.zeros(3)
    return -sn.collide_cushion(v, w, (0, 1, 0), physics, fidelity)[0][1]


# the law


@some
@given(laws)
def test_speed_times_restitution_rises_for_all_constants(law):
    physics = sn.Physics(**law)
    speeds = np.unique(np.concatenate((SPEEDS, law["e_c_knee"] * np.array((1 - 1e-6, 1.0, 1 + 1e-6)))))
    e = restitution(physics, speeds)
    assert ((e > 0.0) & (e <= law["e_c"])).all()
    apart = np.diff(speeds) > 1e-14 * speeds[1:]  # of nearer ones the products may round to the same number
    assert (np.diff(speeds * e)[apart] > 0.0).all() and (np.diff(speeds * e) >= -1e-15 * speeds[1:]).all()


def test_the_law_is_what_the_text_says():
    physics = sn.Physics(e_c=0.9, e_c_knee=2.0, e_c_power=0.5)
    assert restitution(physics, (1e-9, 1.0, 2.0)).tolist() == [0.9] * 3
    assert restitution(physics, (8.0, 200.0)) == pytest.approx((0.45, 0.09), rel=1e-15)


# the whole impact


@some
@given(laws, cushions, st.sampled_from((STRAIGHT, SLANTED)), st.booleans())
def test_the_rebound_rises_with_speed(law, cushion, direction, rolling):
    physics = sn.Physics(**law, **cushion)
    # beyond, e may be under what the solver resolves
    speeds = [v for v in SPEEDS if v < 1e4 * law["e_c_knee"]]
    out = np.array([rebound(physics, v, direction, rolling) for v in speeds])
    assert (np.diff(out) > 0.0).all()


@pytest.mark.slow
def test_the_rebound_goes_as_no_higher_power_of_e_than_the_bound_of_the_power_allows():
    """d log(rebound) / d log(e) <= 1 / 0.8: what ``e_c_power`` <= 0.8 rests on. The largest are near (0.5, 0.45, 0.5), e about 0.1."""
    rng, largest = np.random.default_rng(8), 0.0
    for k in range(4000):
        least = 0.4 if k % 2 else 0.0
        mu_c, mu_s, sin_theta = rng.uniform(least, 0.5, 3)
        e, step = 10.0 ** rng.uniform(-2.0, -0.01), 1.003
        both = [sn.Physics(mu_c=mu_c, mu_s=mu_s, sin_theta=sin_theta, e_c=x) for x in (e, e * step)]
        one, two = (rebound(physics, 1.0, SLANTED if k % 4 else STRAIGHT, k % 3 > 0) for physics in both)
        largest = max(largest, np.log(two / one) / np.log(step))
    assert 1.05 < largest < 1.0 / MOST_POWER
