"""Do episodes draw their tables: within the ranges, by the seed, alike one by one and side by side?"""

import json
import re

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.physics import conditions
from snooker_env.physics.conditions import NAMES, RANGES
from snooker_env.physics.parameters import nominal, physics_with
from snooker_env.planning import Planner, Positions, Strokes
from tests.processes import ROOT
from tests.refusals import refuse_each
from tests.tables import begun

DRAWN = {"conditions": "drawn"}
OBSERVED = DRAWN | {"observe_conditions": True}
MIDDLE = np.array([0.5, 0.0, 0.1, 0.01])


def of_info(info):
    return np.array([info[name] for name in NAMES])


def of_state(env):
    return np.array(list(env.get_state()["conditions"].values()))


def test_a_draw_is_uniform_within_the_ranges_and_by_the_seed():
    drawn = conditions.draw_constants(np.random.default_rng(3).random((400, conditions.COLUMNS)))
    many = [physics_with(sn.Physics.preset("match"), tuple(values)) for values in drawn.tolist()]
    for name, (low, high) in RANGES.items():
        if name == "mu_bb_scale":
            values = np.array([one.friction_law[0] for one in many]) / sn.physics.parameters.MARLOW[0]
            assert all(one.friction_law[2] == sn.physics.parameters.MARLOW[2] for one in many)
        else:
            values = np.array([getattr(one, name) for one in many])
        shares = (values - low) / (high - low)
        assert shares.min() > -1e-9 and shares.max() < 1.0 + 1e-9
        # uniform: mean 1/2 with a standard error of 0.0144, tenths that hold 40 each
        assert abs(shares.mean() - 0.5) < 0.06, name
        assert np.histogram(shares, 10, (0.0, 1.0))[0].min() > 15, name
    values = np.array([[one.mu_s, one.mu_r, one.e_b, one.mu_c, one.e_c] for one in many])
    assert np.abs(np.corrcoef(values.T) - np.eye(5)).max() < 0.2  # independent
    assert many[0] != many[1] and many[0].e_c_knee == 2.02 and not many[0].tables


def test_the_ranges_and_their_order_are_those_of_the_page():
    """The order is that of observations: a model that was trained with another would read wrong constants."""
    page = (ROOT / "docs" / "environment" / "conditions.md").read_text(encoding="utf-8")
    row = re.compile(r"^\| `(\w+)`[^|]*\| ([\d.]+) \| ([\d.]+) \|", re.M)
    assert [(name, (float(a), float(b))) for name, a, b in row.findall(page)] == list(RANGES.items())


@pytest.mark.parametrize("task", ["visit", "frame", "match"])
def test_an_episode_keeps_its_table_and_the_next_one_has_another(task):
    options = OBSERVED | {"task": task, "layout": "opened"}
    env = sn.SnookerEnv(**options)
    observation, info = env.reset(seed=5)
    first = of_info(info)
    low, high = np.array(list(RANGES.values())).T
    for _ in range(3):
        assert ((first >= low) & (first <= high)).all() and (of_state(env) == first).all()
        shown = 2.0 * (first - low) / (high - low) - 1.0
        assert np.allclose(observation[-8:], shown, atol=1e-6) and env.observation_space.contains(observation)
        if env.over:
            break
        observation, _, _, _, info = env.step(MIDDLE)
        assert (of_info(info) == first).all()
    assert env.physics.mu_s == first[0] and env.physics.e_b == first[3]
    second = of_info(env.reset()[1])
    assert (second != first).all()
    assert (of_info(env.reset(seed=5)[1]) == first).all()
    assert (of_info(env.reset(seed=6)[1]) != first).all()


def test_shots_have_the_constants_of_their_table():
    env = begun(sn.SnookerEnv(aim="absolute", **DRAWN), 2)
    start, here = env.positions, env.on_table
    env.step(MIDDLE)
    shot = env.last_shot
    assert shot.physics == env.physics != sn.Physics()
    # the same shot by itself, with these constants and others
    direction = np.pi * MIDDLE[3]
    v, w = sn.strike(0.2 + 0.75 * 6.8, direction, 0.0, 0.05, physics=env.physics)
    velocities, spins = np.zeros((22, 2)), np.zeros((22, 3))
    velocities[0], spins[0] = v[:2], w
    shots = (
        sn.simulate(start, velocities, spins, physics=p, on_table=here) for p in (env.physics, sn.Physics())
    )
    ends = [shot.positions for shot in shots]
    assert np.allclose(ends[0], shot.positions, atol=1e-9) and np.abs(ends[1] - ends[0]).max() > 1e-3


def test_a_state_holds_the_table():
    env, fixed = (begun(sn.SnookerEnv(noise="club", **options), 4) for options in (DRAWN, {}))
    state = json.loads(json.dumps(env.get_state()))
    without = {key: value for key, value in state.items() if key != "conditions"}
    table = """
fixed(state) | state | a dict with ['conditions'] | must
drawn(without) | state | a dict without ['conditions'] | must
drawn(dict(state, conditions=dict(state["conditions"], mu_r=0.02))) | state.conditions.mu_r | 0.02 | must be a finite number in [0.01,
drawn(dict(state, conditions={"mu_s": 0.2})) | state.conditions | {'mu_s': 0.2} | must be a dict of the constants
"""
    names = {"state": state, "without": without, "fixed": fixed.set_state, "drawn": env.set_state}
    refuse_each(table, names)
    assert env.get_state() == state


def _planned(env, options, strokes):
    return Planner(options, threads=1).play_strokes(env, np.zeros(len(strokes), int), strokes).places


def test_plans_are_made_with_the_constants_of_the_table():
    options = sn.Options(aim="absolute", elevation=True, **DRAWN)
    env = begun(sn.SnookerEnv(options), 8)
    strokes = np.array([[3.0, 0.3, 0.1, 1.2, 0.0]])
    at, own, physics = Positions.of(env), _planned(env, options, strokes), env.physics
    assert (own == _planned(at, sn.Options(physics=physics), strokes)).all()
    nominal = _planned(env, options.but(conditions="fixed"), strokes)
    assert (nominal == _planned(at, sn.Options(), strokes)).all() and np.abs(nominal - own).max() > 1e-3
    # what the environment does
    env.step(Strokes(strokes).actions(options, at)[0])
    assert np.allclose(env.last_shot.positions, own[0], atol=1e-9)


def test_the_aim_is_solved_for_the_table():
    options = sn.Options(action="discrete", **DRAWN)
    many = sn.SnookerVectorEnv(2, options, threads=1)
    many.reset(seed=[1, 2], options={"position": sn.Position(cue=(0.0, 0.9), black=(0.4, 1.3))})
    at, target = Positions.of(many), np.array([[0.889, 1.7845]] * 2)
    own = Planner(options).pot_aim(at, [0, 1], [21, 21], target, 2.0)
    nominal = Planner(options.but(conditions="fixed")).pot_aim(at, [0, 1], [21, 21], target, 2.0)
    assert nominal[0] == nominal[1] and len({*own, nominal[0]}) == 3
    for k in range(2):
        planner = Planner(sn.Options(physics=many.tables.physics_of(k)))
        aim = planner.pot_aim(at, [k], [21], target[:1], 2.0)[0]
        assert abs(aim - own[k]) < 1e-12


def test_a_network_sees_the_constants_that_it_was_trained_with():
    seen = []

    class Looks:
        def __init__(self):
            self.options = {"observe_conditions": True}

        def act(self, observations, masks, seeds):
            seen.append(observations)
            return np.zeros((len(observations), 4))

    player = sn.player(Looks())
    env = begun(sn.SnookerEnv(**DRAWN), 1)
    player.at(env).play(env, [0])
    assert np.allclose(seen[-1][0, -8:], conditions.scale_to_unit(of_state(env)), atol=1e-6)
    player.at({"physics": "match"}).play(sn.Position(cue=(0.0, 0.9), black=(0.4, 1.3)), [0])
    middle = conditions.scale_to_unit(nominal(sn.Physics.preset("match")))
    assert np.allclose(seen[-1][0, -8:], middle, atol=1e-6)
