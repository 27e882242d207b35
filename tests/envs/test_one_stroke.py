"""Does an episode of one stroke in a frame end with the first one that is no foul, and what the opponent makes of it?"""

import gymnasium
import numpy as np
import pytest

import snooker_env as sn
from snooker_env.tasks.frame_kernels import MOST_STEPS
from tests.tables import begun

FRAME = {"task": "frame", "aim": "target", "layout": "opened", "opponent": "ghost_ball", "noise": "club"}
ONE = FRAME | {"one_stroke": True}
ACTION = np.array([-0.3, 0.0, 0.1, 0.2], np.float32)


def played(seed, **options):
    """The environment after the first step of an episode that the agent begins, and what the step returned."""
    env = begun(sn.SnookerEnv(**options), seed, options={"breaker": 0})
    return env, env.step(ACTION)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("reward", ["points", "win"])
def test_its_step_is_the_first_one_of_a_frame(seed, reward):
    env, one = played(seed, **ONE, reward=reward)
    whole, first = played(seed, **FRAME, reward=reward)
    assert np.array_equal(one[0], first[0]) and one[1] == first[1] and one[4] == first[4]
    fair = not one[4]["foul"] and not one[4]["choice"]
    assert one[2] is fair and first[2] is False and one[3] is first[3] is False
    assert env.over is fair and not whole.over
    if not fair:
        return
    with pytest.raises(gymnasium.error.ResetNeeded, match="the frame is over"):
        env.step(ACTION)


def test_its_reward_is_the_growth_of_the_lead_until_it_is_the_agents_turn_again():
    tables = sn.SnookerVectorEnv(200, **ONE, autoreset_mode="Disabled")
    tables.reset(seed=1)
    _, rewards, terminated, truncated, info = tables.step(np.tile(ACTION, (200, 1)))
    fair = ~info["foul"] & ~info["choice"].astype(bool)
    assert 0 < fair.sum() < 200 and np.array_equal(terminated, fair) and not truncated.any()
    assert np.array_equal(rewards, info["score"] - info["opponent_score"])
    potted, visited = info["points"] > 0, info["opponent_strokes"] > 0
    assert 0 < potted.sum() < 200 and not (potted & visited).any()  # who pots has the next turn
    assert (visited | potted | (info["winner"] >= 0)).all() and rewards.min() < 0


def test_the_agent_begins_unless_it_is_said_otherwise():
    tables = sn.SnookerVectorEnv(40, **ONE)
    assert not tables.reset(seed=1)[1]["opponent_strokes"].any()
    info = tables.reset(seed=1, options={"breaker": 1})[1]
    assert info["opponent_strokes"].all()
    _, rewards, _, _, info = tables.step(np.tile(ACTION, (40, 1)))  # the opponent's first visit is paid, too
    assert np.array_equal(rewards, info["score"] - info["opponent_score"])


@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
def test_many_tables_begin_anew_as_one_does(mode):
    tables, one = sn.SnookerVectorEnv(3, **ONE, autoreset_mode=mode), begun(sn.SnookerEnv(**ONE), 5)
    observations, _ = tables.reset(seed=5)
    for _ in range(6):
        assert np.array_equal(observations[0], one.tables.observe(np.zeros(1, int))[0])
        observations, rewards, terminated, *_ = tables.step(np.tile(ACTION, (3, 1)))
        out = one.step(ACTION)
        assert terminated[0] == out[2] and rewards[0] == out[1]
        if out[2]:
            one.reset()
            if mode == "NextStep":
                observations, rewards, terminated, *_ = tables.step(np.tile(ACTION, (3, 1)))
                assert not terminated[0] and not rewards[0]


def test_who_fouls_is_sent_back_until_the_stroke_is_fair():
    """The softest stroke straight up the table from the D strikes no ball; 20 steps are the most."""
    options = ONE | {"layout": "break_off", "aim": "absolute", "miss": "clear_path"}
    env = begun(sn.SnookerEnv(**options | {"opponent": "none"}), 3)
    fouls = 0
    for step in range(MOST_STEPS):
        _, reward, terminated, truncated, info = env.step([-1.0, 0.0, 0.0, -0.5])
        fouls += info["foul"]
        assert not terminated and truncated is (step == MOST_STEPS - 1) and reward == -4.0
    assert fouls == MOST_STEPS and env.over


def test_a_state_of_it_has_its_stroke_to_come():
    env, _ = played(4, **ONE)
    state = env.get_state()
    env.reset(options={"state": state})
    assert not env.over and env.step(ACTION)[2] is True
    strokes = env.get_state()["strokes"]
    assert strokes > state["strokes"]


def test_alone_it_ends_with_the_stroke():
    env = begun(sn.SnookerEnv(**ONE | {"opponent": "none"}), 2)
    _, reward, terminated, _, info = env.step(ACTION)
    assert terminated and info["opponent_strokes"] == 0 and reward == info["score"] - info["opponent_score"]
    assert env.get_state()["strokes"] == 1


@pytest.mark.parametrize("make", [sn.match_env, lambda **options: sn.MatchVectorEnv(2, **options)])
def test_two_players_have_none(make):
    with pytest.raises(ValueError, match="one_stroke=False: a match has two players"):
        make(one_stroke=True)
