"""Whose stroke is it in ``task="frame"``, what may they decide, and what is it worth?"""

import gymnasium
import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game.balls import BLACK, BLUE, CUE, PINK, SPOTS, BallOn
from snooker_env.geometry import D_RADIUS
from snooker_env.tasks.observations import FRAME_ENTRIES, SIZE
from tests.tables import PLACES, begun, frame_env, frame_state, plain

CHOICE_SEEN, FREE_BALL_SEEN = (SIZE + FRAME_ENTRIES.index(name) for name in ("choice", "free_ball"))
"""Where an observation says that a decision is open, and that there is a free ball."""


FOULED = {"phase": "choice", "striker": 0, "scores": (0, 4)}


@pytest.mark.parametrize(
    ("decision", "own"), [(0.0, True), (-0.33, True), (1.0, True), (-0.34, False), (-1.0, False)]
)
def test_after_a_foul_the_action_decides(decision, own):
    """Without a miss called, "replace" is no option and means to play."""
    env = frame_state(frame_env(opponent="ghost_ball"), PLACES, FOULED)
    assert env.tables.observe(np.zeros(1, np.int64), 0)[0][CHOICE_SEEN] == 1.0
    _, _, _, _, info = env.step([-0.5, 0, 0, 0, 0, 0, decision])
    assert (info["events"] > 0) == own
    assert own or info["opponent_strokes"] > 0


def test_replacing_after_a_miss_brings_the_balls_back():
    env = begun(sn.match_env(miss="clear_path"))
    offender, before = env.frame.striker, env.positions.copy()
    env.step(np.array([-0.8, 0, 0, -0.5, 0.3, 0.2, 0]))  # at the bottom cushion, hitting nothing
    placed = 0.3 * D_RADIUS, -1.0475 - D_RADIUS * np.sqrt(1 - 0.3**2) * 0.6
    assert env.frame.choices == ("play", "play_again", "replace")
    assert not np.allclose(env.positions[CUE], placed)
    after = plain(env.get_state())
    env.set_state(after)
    env.step(np.array([0, 0, 0, 0, 0, 0, 1.0]))
    assert env.get_state()["strokes"] == 1 and np.allclose(env.positions[CUE], placed, rtol=0, atol=1e-15)
    assert env.frame.striker == offender and env.frame.in_hand
    assert env.agent_selection == f"player_{offender}" and np.array_equal(before[1:], env.positions[1:])


def test_a_free_ball_is_seen_and_scores():
    places = {CUE: (0.3, 1.1), BLUE: (0.6, 1.4), 1: (-0.5, -1.2), PINK: SPOTS[PINK], BLACK: (0.0, 0.0)}
    env = frame_state(frame_env(opponent="ghost_ball"), places, FOULED | {"free_ball": True})
    on = env.tables.on(0)
    assert on >> BLUE & 1 and on >> 1 & 1
    assert env.tables.observe(np.zeros(1, np.int64), 0)[0][FREE_BALL_SEEN] == 1.0
    _, reward, _, _, info = env.step([-0.5, 0, 0, 0, 0, 0, 0])
    assert (reward, info["points"], env.ball_on) == (1.0, 1.0, BallOn.ANY_COLOUR)
    assert np.array_equal(env.positions[BLUE], SPOTS[BLACK])  # it came back; its own spot is taken
    other = frame_state(frame_env(opponent="ghost_ball"), places, FOULED)
    assert not other.tables.on(0) >> BLUE & 1


@pytest.mark.parametrize(
    ("opponent", "layout"), [("none", "colours"), ("random", "random:2"), ("ghost_ball", "pots:easy")]
)
def test_points_add_up_to_the_difference_and_win_says_who_won(opponent, layout):
    """From the first stroke, which may be the opponent's, to the last, which may be in the same player's first visit."""
    broke, before = 0, 0
    for seed in range(8):
        totals = {}
        for reward in ("points", "win"):
            env = frame_env(opponent=opponent, reward=reward, layout=layout, noise="club")
            _, info = env.reset(seed=seed)
            broke += info["opponent_score"] + info["score"] > 0
            before += info["winner"] >= 0
            rng, total, over = np.random.default_rng(seed), 0.0, False
            while not over:
                _, r, terminated, _, info = env.step(rng.uniform(-1, 1, 7))
                total, over = total + r, terminated
                assert reward == "points" or (r == 0.0) != over
            totals[reward] = total
        assert totals["points"] == info["score"] - info["opponent_score"] and info["winner"] >= 0
        assert totals["win"] == (1.0 if info["winner"] == 0 else -1.0)
    assert (broke > 0) == (opponent != "none")
    assert before > 0 or opponent != "ghost_ball" or layout != "pots:easy"


def test_a_frame_that_the_opponent_wins_in_his_first_visit_is_one_that_was_lost():
    """Nothing is dealt again: the reset shows that it is lost, the next step plays nothing and reports it."""
    env, won = frame_env(opponent="ghost_ball", layout="pots:easy", reward="win"), 0
    for seed in range(15):
        observation, info = env.reset(seed=seed)
        before = env.positions
        if info["winner"] < 0:
            continue
        won += 1
        assert info["winner"] == 1 and info["opponent_strokes"] > 0 and env.over
        state = plain(env.get_state())
        for start in (None, state):
            if start:
                env.reset(options={"state": start})
            same, reward, terminated, truncated, after = env.step(env.action_space.sample())
            assert (reward, terminated, truncated) == (-1.0, True, False)
            assert np.array_equal(same, observation)
            assert (after["strokes"], after["opponent_strokes"], after["events"]) == (info["strokes"], 0, 0)
            assert after["winner"] == 1
            assert np.array_equal(before, env.positions)
            with pytest.raises(gymnasium.error.ResetNeeded):
                env.step(env.action_space.sample())
    assert won > 2


def test_before_the_first_reset_a_frame_can_be_read_and_nothing_is_played():
    many, text = sn.SnookerVectorEnv(2, task="frame", render_mode="ansi"), {"render_mode": "ansi"}
    for env, size in ((frame_env(**text), 7), (sn.match_env(**text), 7), (many, (2, 4))):
        assert env.render() and env.get_state()
        with pytest.raises(gymnasium.error.ResetNeeded, match=r"^call reset|^the frame has not begun: call"):
            env.step(np.zeros(size))
    assert frame_env().frame.phase == "stroke" and frame_env().over


# A frame that goes nowhere is stopped by the referee, and no score that play reaches breaks it


@pytest.mark.parametrize("opponent", ["none", "random", "ghost_ball"])
def test_the_referee_stops_the_frame_after_the_very_stroke(opponent):
    env, cut = frame_env(opponent=opponent, max_strokes=6), 0
    for seed in range(6):
        _, info = env.reset(seed=seed)
        played, rng = info["strokes"], np.random.default_rng(seed)
        assert played < 6
        while True:
            obs, _, terminated, truncated, info = env.step(rng.uniform(-1, 1, 7))
            played += (info["events"] > 0 or info["seconds"] > 0) + info["opponent_strokes"]
            assert info["strokes"] == played <= 6 and env.observation_space.contains(obs)
            assert truncated == (played == 6 and not terminated) and type(truncated) is bool
            if terminated or truncated:
                break
        assert terminated or info["winner"] == -1
        before = plain(env.get_state())
        with pytest.raises(gymnasium.error.ResetNeeded):
            env.step(np.zeros(7))
        assert plain(env.get_state()) == before
        cut += truncated and env.frame.striker == 1
        other = frame_env(opponent=opponent, max_strokes=6)
        other.set_state(before)  # in the middle of a visit of the opponent, too
        assert other.over and plain(other.get_state()) == before
        with pytest.raises(ValueError, match=r"state\.strokes = 6: must be below max_strokes = 6"):
            other.reset(options={"state": before})
    assert (cut > 0) == (opponent != "none")  # alone the agent is always to play
