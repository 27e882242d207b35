"""Are impacts of rolling balls, which come from tables, those of ``reference``? And only those of rolling balls?"""

import pickle

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.physics.columns import CONSTANTS
from snooker_env.physics.impact import tables
from snooker_env.physics.impact.tables import CELL, NEAR, PRESETS, Rolling, make

PAPER = sn.Physics()
SOLVED = sn.Physics(tables=False)
KINKED = Rolling(0.33, 0.32, 0.09, 0.53)  # in some impacts a contact changes its state at the very end


def rolling(rng, physics):
    """A ball that rolls into a cushion at +y: any angle, speed and side."""
    speed, angle = np.exp(rng.uniform(np.log(0.05), np.log(8.0))), rng.uniform(0.002, np.pi - 0.002)
    v = speed * np.array([np.cos(angle), np.sin(angle), 0.0])
    return v, np.array([-v[1] / physics.R, v[0] / physics.R, rng.normal(0.0, 2.0) * speed / physics.R])


def difference(one, other, physics):
    """Of two outcomes: velocities and spins [m/s]."""
    scale = [1.0, physics.R] * (len(one) // 2)
    return max(k * np.abs(a - b).max() for k, a, b in zip(scale, one, other, strict=True))


def impacts(physics, seed=0, n=400):
    """Outcomes of n impacts at a fidelity: each kind of a table in turn, with the speed before."""
    rng, rest = np.random.default_rng(seed), np.zeros(3)
    for k in range(n):
        v, w = rolling(rng, physics)
        kind = k % 3
        speed = np.hypot(*v[:2])
        if kind == 0:
            yield lambda p, f, v=v, w=w: sn.collide_cushion(v, w, (0, 1, 0), p, f), speed
        elif kind == 1:
            yield lambda p, f, v=v, w=w: sn.collide_balls(v, w, rest, rest, (0, 1, 0), p, f), speed
        else:  # the resting ball is the first one
            yield lambda p, f, v=v, w=w: sn.collide_balls(rest, rest, -v, -w, (0, 1, 0), p, f), speed


def test_they_are_those_of_reference_to_1e_10_and_without_tables_to_1e_6():
    worst, solved = 0.0, 0.0
    for impact, speed in impacts(PAPER):
        truth = impact(PAPER, "reference")
        worst = max(worst, difference(impact(PAPER, "standard"), truth, PAPER) / speed)
        solved = max(solved, difference(impact(SOLVED, "standard"), truth, PAPER) / speed)
    assert worst < 1e-10
    assert 1e-8 < solved < 2e-6  # so the tables were asked


def test_reference_and_the_papers_scheme_ask_no_table():
    for impact, _ in impacts(PAPER, 1, 12):
        for fidelity in ("reference", "euler:200"):
            assert difference(impact(PAPER, fidelity), impact(SOLVED, fidelity), PAPER) == 0.0


@pytest.mark.parametrize("slip", [1e-6, -1e-3])
def test_a_ball_that_slides_a_little_is_solved(slip):
    v, w = rolling(np.random.default_rng(2), PAPER)
    w[0] += slip / PAPER.R
    still = np.zeros(3)
    for impact in (
        lambda p: sn.collide_cushion(v, w, (0, 1, 0), p),
        lambda p: sn.collide_balls(v, w, still, still, (0, 1, 0), p),
        lambda p: sn.collide_balls(v, w, -0.1 * v, w, (0, 1, 0), p),
    ):
        assert difference(impact(PAPER), impact(SOLVED), PAPER) == 0.0


def test_the_stored_tables_are_those_that_are_made_now():
    for rolling in PRESETS:
        assert np.abs(tables.table_of(rolling) - make(rolling)).max() < 1e-12
    for preset in ("paper", "match"):  # nothing is made for them
        physics = sn.Physics.preset(preset)
        assert Rolling(physics.sin_theta, physics.mu_c, physics.mu_s, physics.e_c) == PRESETS[0]
    assert Rolling(-1.0, PAPER.mu_bb, PAPER.mu_s, PAPER.e_b) == PRESETS[1]


@pytest.mark.parametrize(
    "constants", [{"e_j": 0.7}, {"mu_bb": 0.2, "e_b": 0.8}, {"mu_c": 0.18, "mu_s": 0.245}]
)
def test_other_constants_have_their_own(constants):
    physics = sn.Physics(**constants)
    for impact, speed in impacts(physics, 4, 60):
        assert difference(impact(physics, "standard"), impact(physics, "reference"), physics) < 1e-8 * speed


def test_cells_with_a_kink_are_empty_and_their_impacts_solved():
    table = make(KINKED)
    assert table is not None
    empty = np.isnan(table.reshape(NEAR + 1, CELL))
    assert np.array_equal(empty.all(1), empty.any(1)) and 0 < empty[:, 0].sum() < 20
    constants = {"sin_theta": KINKED.sin_t, "mu_c": KINKED.mu, "mu_s": KINKED.mu_s, "e_c": KINKED.e}
    physics, solved = sn.Physics(**constants), sn.Physics(**constants, tables=False)
    for k in range(NEAR):
        x = 2.0 ** (tables.LEAST_OCTAVE + k // 16) * (1.0 + (k % 16 + 0.37) / 16)
        ball = (0.0, 1.0, 0.0), (-1.0 / physics.R, 0.0, -x / physics.R)  # a1 / closing is x
        with_table, without = (sn.collide_cushion(*ball, (0, 1, 0), p) for p in (physics, solved))
        assert (difference(with_table, without, physics) == 0.0) == empty[k, 0]
        assert difference(with_table, without, physics) < 2e-6 * max(1.0, x)


def test_which_tables_a_physics_has_and_that_none_is_sent():
    rolls, slides = (1, 0), (2, 0)  # "standard" and "reference"
    for fields, fidelity, n in (
        ({}, rolls, 2),  # rails and jaws have the same
        ({"e_j": 0.5}, rolls, 3),
        ({"tables": False}, rolls, 0),
        ({}, slides, 0),
        ({"mu_c": 0.3, "mu_s": 0.3}, rolls, 1),  # of the balls: the cloth may hold one at a cushion
        ({"mu_c": 0.3, "mu_s": 0.4, "mu_bb": 0.9}, rolls, 0),
        ({"mu_bb": "marlow"}, rolls, 1),  # friction between balls varies
    ):
        assert len(sn.Physics(**fields).packed_for(fidelity)) == CONSTANTS + n * tables.SIZE, fields
    physics = sn.Physics(e_b=0.9)
    packed = physics.packed_for(rolls)
    assert packed is physics.packed_for(rolls) and len(pickle.dumps(physics)) < 2000
    assert pickle.loads(pickle.dumps(physics)) == physics
    physics.pack()[:] = 0.0  # a copy
    assert physics.pack()[0] == packed[0] == physics.R
