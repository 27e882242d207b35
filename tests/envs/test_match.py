"""Is the match of two players a sound PettingZoo environment, and whose turn is it?"""

import json

import gymnasium
import numpy as np
import pytest

import snooker_env as sn
from snooker_env.tasks import observations
from tests.processes import ROOT, python
from tests.tables import PLACES, frame_state, plain

pytest.importorskip("pettingzoo")
from pettingzoo.test import api_test, seed_test

WIN = {"layout": "colours", "aim": "target", "reward": "win"}
CHOICES = {"action": "discrete", "layout": "random:2"}
MATCH = {"frames": 3, "layout": "pots:easy", "says": ["nominate", "concede"]}


@pytest.mark.parametrize("options", [{"aim": "target"}, {"max_strokes": 20}, WIN, CHOICES, MATCH | CHOICES])
def test_pettingzoo_checks_its_interface(options, strict, capsys):
    api_test(sn.match_env(**options), num_cycles=200)
    assert "Passed API test" in capsys.readouterr().out


MASKED = {"action": "discrete", "observation": "masked"}
SAID = {"says": ["nominate", "concede", "claim", "lot"]}


@pytest.mark.parametrize("options", [{"observation": "balls"}, MASKED, MASKED | SAID, MASKED | {"frames": 3}])
def test_pettingzoo_checks_its_interface_with_dicts_of_observations(options, capsys):
    """Random players take the mask from the observation. PettingZoo warns of every Dict observation."""
    with pytest.warns(UserWarning, match="Observation"):
        api_test(sn.match_env(layout="random:3", **options), num_cycles=80)
    assert "Passed API test" in capsys.readouterr().out


@pytest.mark.parametrize("options", [{}, {"action": "discrete"}, MASKED, {"frames": 3}])
def test_nothing_is_observed_before_the_first_reset(options):
    env = sn.match_env(**options)
    for look in (lambda: env.observe("player_0"), env.last, lambda: env.agent_selection):
        with pytest.raises(AttributeError, match=r"^agent_selection cannot be read before reset\(\): call"):
            look()
    if "action" in options:
        with pytest.raises(AttributeError, match=r"before reset\(\)"):
            env.action_mask("player_1")
    with pytest.raises(gymnasium.error.ResetNeeded, match=r"call reset\(\) before step\(\)"):
        env.step(None)
    env.reset(seed=1)
    assert all(env.observation_space(name).contains(env.observe(name)) for name in env.agents)


@pytest.mark.parametrize("options", [{"noise": "club", "layout": "random:3"}, MATCH])
def test_pettingzoo_checks_its_seeds(options, strict):
    seed_test(lambda: sn.match_env(aim="target", **options), num_cycles=60)


def test_each_player_sees_its_own_side():
    env = frame_state(sn.match_env(), PLACES, {"striker": 1, "scores": (31, 62)})
    mine, theirs = env.observe("player_0"), env.observe("player_1")
    assert np.array_equal(mine[:121], theirs[:121]) and mine.shape == (121 + len(observations.FRAME_ENTRIES),)
    assert mine[121:124] == pytest.approx([31 / 178, 62 / 209, -31 / 178])
    assert theirs[121:124] == pytest.approx([62 / 209, 31 / 178, 31 / 178])
    assert (mine[125], theirs[125]) == (0.0, 1.0)
    mine[:] = 0.3
    assert not np.array_equal(env.observe("player_0"), mine)


@pytest.mark.parametrize(("limit", "why"), [(1000, "terminations"), (1, "truncations")])
def test_a_state_of_a_frame_that_has_ended_ends_at_once(limit, why):
    env, other = (sn.match_env(aim="target", layout="random:1", max_strokes=limit) for _ in range(2))
    env.reset(seed=1)
    rng = np.random.default_rng(1)
    while not (any(env.terminations.values()) or any(env.truncations.values())):
        env.step(rng.uniform(-1, 1, 7))
    other.reset(options={"state": plain(env.get_state())})
    assert getattr(env, why) == getattr(other, why) == {"player_0": True, "player_1": True}
    assert other.observe("player_0").tobytes() == env.observe("player_0").tobytes()
    for player in other.agent_iter():
        assert any(other.last()[2:4]) and player in other.possible_agents
        other.step(None)
    assert not other.agents


def test_pettingzoo_is_loaded_only_when_asked_for_and_its_lack_is_explained():
    lacking = "assert 'pettingzoo' not in sys.modules\nsys.modules['pettingzoo'] = None"
    code = f"import sys, snooker_env as sn\n{lacking}\ntry: sn.match_env()\nexcept ImportError as e: print(e)"
    needs = f'match_env needs PettingZoo; install it, in the clone {ROOT}, with: pip install -c constraints.txt -e ".[multi]"'
    assert python(code)[0].strip() == needs


# Two players on many tables play what ``match_env`` plays; seats may differ


def test_tables_that_have_ended_stand_still_until_they_are_reset():
    tables = sn.MatchVectorEnv(4, layout="random:0", max_strokes=6, threads=1, reward="win")
    with pytest.raises(gymnasium.error.ResetNeeded):
        tables.step(np.zeros((4, 7)))
    tables.reset(seed=0)
    for _ in range(6):
        out = tables.step(np.tile([-0.9, 0, 0, 0.5, 0, 0, 0], (4, 1)))
    assert out[3].all()
    before = json.dumps(tables.get_state())
    _, rewards, terminated, truncated, _ = tables.step(np.zeros((4, 7)))
    assert json.dumps(tables.get_state()) == before and not rewards.any() and truncated.all()
    assert not terminated.any()
    _, infos = tables.reset(options={"reset_mask": np.array([True, False, False, True]), "breaker": 1})
    assert infos["_strokes"].tolist() == [True, False, False, True]
    assert tables.strikers[[0, 3]].tolist() == [1, 1]
    assert tables.step(np.zeros((4, 7)))[3].tolist() == [False, True, True, False]
