"""Does random play ever lose, double, overlap or misplace a ball? Checked after every shot."""

import numpy as np
import pytest

from snooker_env.envs.snooker import SnookerEnv
from snooker_env.game.balls import CUE, BallOn
from snooker_env.geometry import BALL_RADIUS as R
from snooker_env.tasks.box_actions import AIMS
from tests.tables import LAYOUTS


def check_table(env, before, info):
    """After a shot: nothing lost, nothing doubled, nothing overlapping, nothing outside."""
    here = env.on_table
    places = env.positions[here]
    gaps = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1))[np.triu_indices(len(places), 1)]
    assert np.isfinite(env.positions).all()
    assert gaps.size == 0 or gaps.min() >= 2 * R - 1e-6
    env.table.check(env.positions, R, on_table=here)
    assert env.points <= 155
    lost = before & ~here
    assert not (here & ~before)[1:].any()
    potted = env.last_shot.potted >= 0
    assert not (lost & ~potted)[1:].any() and not (potted & ~before).any()
    assert lost[1:16].tolist() == potted[1:16].tolist()  # a red in a pocket never comes back
    if here.any() and env.ball_on != BallOn.NOTHING:
        gone = before[16:] & ~here[16:]
        assert gone.sum() <= 1 and (
            not gone.any() or (info["ball_on"] == 2 + gone.argmax() and not info["foul"] and info["points"])
        )
    assert env.over or here[CUE]
    assert env.over == (not info["points"]) or not here[1:].any()
    assert info["break"] == env.points


@pytest.mark.parametrize("layout", LAYOUTS)
def test_random_play_loses_no_ball(layout):
    """Some 40 visits a layout, wild shots and good ones, level and raised cues, noise, all three rewards."""
    rng = np.random.default_rng(LAYOUTS.index(layout))
    strokes = most = 0
    for aim in AIMS:
        arguments = {
            "aim": aim,
            "layout": layout,
            "noise": "club",
            "fidelity": "fast",
            "elevation": aim == "absolute",
        }
        env = SnookerEnv(placement=layout == "break_off", reward="points_and_fouls", **arguments)
        obs, _ = env.reset(seed=LAYOUTS.index(layout))
        for _ in range(19):
            if env.over:
                obs, _ = env.reset()
            while not env.over:
                assert env.observation_space.contains(obs)
                before = env.on_table.copy()
                action = rng.uniform(-1, 1, env.action_space.shape)
                if aim == "target":
                    action[:4] = rng.uniform(-0.6, 0.3), 0.0, rng.uniform(-0.8, 0.5), 0.0
                obs, reward, *_, info = env.step(action)
                assert env.observation_space.contains(obs)
                assert reward == info["points"] - info["penalty"]
                check_table(env, before, info)
                strokes += 1
                most = max(most, env.points)
    assert strokes >= 38
    assert most > 0 or layout == "break_off"
