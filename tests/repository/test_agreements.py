"""Do the rooms agree on what they share? What one takes for granted of another."""

import dataclasses

import numpy as np
import pytest

from benchmarks._common.shot_sets import _execute
from snooker_env import Physics, Table, geometry
from snooker_env.game import balls, in_hand, layouts, spotting
from snooker_env.physics import columns as p
from snooker_env.physics import table
from snooker_env.physics.parameters import MARLOW
from snooker_env.tasks import observations
from snooker_env.tasks.box_actions import Actions
from snooker_env.tasks.noise import Noise, with_errors
from tests.kernels import from_python
from tests.shots import shot


@pytest.mark.parametrize("name", ["match", "tight"])
def test_wherever_a_layout_may_put_a_ball_the_table_of_the_physics_has_room(name):
    x, y = np.meshgrid(np.linspace(-0.9, 0.9, 61), np.linspace(-1.8, 1.8, 121))
    places = np.column_stack([x.ravel(), y.ravel()])
    room = np.array([geometry.HALF_WIDTH, geometry.HALF_LENGTH]) - geometry.BALL_RADIUS - layouts.CUSHION_GAP
    clear = np.all(np.abs(places) <= room, axis=1)
    far = np.hypot(*(places[:, None] - geometry.POCKET_PLACES).transpose(2, 0, 1))
    clear &= np.all(far >= layouts.POCKET_GAP, axis=1)
    assert clear.sum() > 5000
    Table.preset(name).check(places[clear][:, None], geometry.BALL_RADIUS)  # each by itself


def test_constants_that_rooms_share_agree():
    assert balls.TOUCH == table.OVERLAP_ALLOWED == 1e-6
    # of every ball that a hand puts down
    assert spotting.balls.CLEARANCE is in_hand.CLEARANCE is balls.CLEARANCE
    assert layouts.GAP > balls.PINK_GAP > balls.CLEARANCE > balls.REFEREE_TOUCH > balls.TOUCH
    # Half a radius at the end of the action's scale is what ``Physics.max_offset`` allows by default
    actions = Actions("absolute")
    side = shot(actions, [0, 1, 0, 0], balls.SPOTS, np.ones(22, bool), 2)[1]
    assert side == Physics().max_offset == 0.5
    kinds = observations.STATE_ENTRIES[1:9]
    assert kinds == tuple(b.name.lower() for b in balls.BallOn if b >= 0)
    numbers = balls.N_BALLS * len(observations.BALL_COLUMNS) + len(observations.STATE_ENTRIES)
    assert observations.size_of("flat", False, replaced=False, speeds=9) == numbers
    assert balls.NAMES[16:] == balls.COLOUR_NAMES
    assert len(balls.NAMES) == balls.N_BALLS == len(balls.VALUES) == len(balls.SPOTS)


def test_physics_packs_every_field_that_a_kernel_needs_in_its_place():
    """Each field changed alone moves exactly its own place of the vector."""
    others = {"spin_decel": p.P_SPIN, "e_c_knee": p.P_E_KNEE, "e_c_power": p.P_E_POWER, "sin_theta": p.P_SIN}
    # where the power may be changed, a jaw has a restitution of its own, and balls fly
    base = Physics(e_c_knee=1.0, e_j=0.9, flight=True, tables=False)
    for name in {field.name for field in dataclasses.fields(Physics)} - {"mu_bb", "flight", "tables"}:
        value = getattr(base, name) + 1e-3
        changed = dataclasses.replace(base, **{name: value}).pack()
        if name in ("end_mass_ratio", "max_offset"):
            assert np.array_equal(changed, base.pack())
            continue
        place = others[name] if name in others else getattr(p, f"P_{name.upper()}")
        assert np.flatnonzero(changed != base.pack()).tolist() == [place] and changed[place] == value, name
    assert Physics(e_c=0.7).pack()[p.P_E_J] == 0.7
    assert np.array_equal(Physics(e_t=0.7).pack(), Physics().pack()) and Physics().pack()[p.P_E_T] == 0.0
    assert 0.0 < Physics(flight=True, e_t=0.0).pack()[p.P_E_T] < 1e-200  # above 0: balls fly
    law = [p.P_MU_BB_LEAST, p.P_MU_BB_EXTRA, p.P_MU_BB_FADE]
    packed = {(0.01, 0.1, 2.0): [0.01, 0.1, 2.0], 0.07: [0.07, 0.0, 0.0], "marlow": list(MARLOW)}
    assert {mu_bb: Physics(mu_bb=mu_bb).pack()[law].tolist() for mu_bb in packed} == packed


def test_a_stroke_of_the_benchmarks_errs_as_the_package_s_law_says():
    noise, law = Noise.of("club"), from_python(with_errors)
    packed = noise.pack(geometry.BALL_RADIUS)
    for seed in range(40):
        errors = noise.draw_errors(np.random.default_rng(seed), 1)[0]
        wanted = law(2.0, 0.1, -0.2, 0.7, 0.0, tuple(errors), packed)
        got = _execute(2.0, 0.1, -0.2, 0.7, noise, np.random.default_rng(seed))
        assert got == pytest.approx(wanted, rel=1e-12)
