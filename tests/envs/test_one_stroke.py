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


@pytest.mark.parametrize("seed", range(3))
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


def test_alone_it_ends_with_the_stroke():
    env = begun(sn.SnookerEnv(**ONE | {"opponent": "none"}), 2)
    _, reward, terminated, _, info = env.step(ACTION)
    assert terminated and info["opponent_strokes"] == 0 and reward == info["score"] - info["opponent_score"]
    assert env.get_state()["strokes"] == 1
