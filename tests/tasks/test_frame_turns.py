"""Whose stroke is it in ``task="frame"``, what may he decide, and what is it worth?"""

import json

import gymnasium
import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game.balls import BLACK, BLUE, CUE, PINK, SPOTS, BallOn
from snooker_env.game.ruling import Foul
from snooker_env.geometry import D_RADIUS
from snooker_env.tasks.observations import FRAME_ENTRIES, SIZE
from tests.tables import PLACES, frame_env, frame_state

TO_BLUE = 0.0
"""Absolute aim along +x."""
CHOICE_SEEN, FREE_BALL_SEEN = (SIZE + FRAME_ENTRIES.index(name) for name in ("choice", "free_ball"))
"""Where an observation says that a decision is open, and that there is a free ball."""


def test_a_step_ends_when_the_agent_is_to_play_or_the_frame_is_over():
    env = frame_env(opponent="random", layout="random:3")
    for seed in range(10):
        env.reset(seed=seed)
        while not env.over:
            assert env.frame.striker == 0
            _, _, terminated, truncated, info = env.step(env.action_space.sample())
            assert terminated == env.over and truncated is False
            assert (info["winner"] >= 0) == terminated
        with pytest.raises(gymnasium.error.ResetNeeded):
            env.step(np.zeros(7))


def test_the_agent_stays_while_it_scores_and_the_opponent_comes_after_a_miss():
    env = frame_state(frame_env(opponent="ghost_ball"), PLACES, {})
    _, reward, _, _, info = env.step([-0.5, 0, 0, 0, 0, 0, 0])
    assert (reward, info["points"], info["opponent_strokes"], env.ball_on) == (1.0, 1.0, 0, BallOn.ANY_COLOUR)
    _, _, _, _, info = env.step([-0.9, 0, 0, 1.0, 0, 0, 0])
    assert info["points"] == 0.0 and info["opponent_strokes"] > 0


def test_alone_a_miss_and_a_foul_give_the_table_back():
    places = {CUE: (0.0, -0.5), 1: (0.6, 1.4), BLUE: (0.3, -0.5), PINK: SPOTS[PINK], BLACK: SPOTS[BLACK]}
    env = frame_state(frame_env(aim="absolute"), places, {})
    before = env.positions[BLUE].copy()
    _, reward, terminated, _, info = env.step([-0.9, 0, 0, TO_BLUE, 0, 0, 0])
    assert (reward, info["fouls"], info["opponent_score"]) == (-5.0, Foul.WRONG_FIRST, 5.0)
    assert info["opponent_strokes"] == 0
    assert not terminated and not env.frame.free_ball and env.frame.phase == "stroke"
    assert not np.array_equal(env.positions[BLUE], before)  # from where the balls lie


# Decisions


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


def test_without_the_option_the_agent_always_plays():
    env = frame_state(frame_env(opponent="ghost_ball", decision=False), PLACES, FOULED)
    assert env.step([-0.5, 0, 0, 0, -1.0, -1.0])[4]["events"] > 0


def test_replacing_after_a_miss_brings_the_balls_back():
    env = sn.match_env(miss="clear_path")
    env.reset(seed=1)
    offender, before = env.frame.striker, env.positions.copy()
    env.step(np.array([-0.8, 0, 0, -0.5, 0.3, 0.2, 0]))  # at the bottom cushion, hitting nothing
    placed = 0.3 * D_RADIUS, -1.0475 - D_RADIUS * np.sqrt(1 - 0.3**2) * 0.6
    assert env.frame.choices == ("play", "play_again", "replace")
    assert not np.allclose(env.positions[CUE], placed)
    after = json.loads(json.dumps(env.get_state()))
    env.set_state(after)
    env.step(np.array([0, 0, 0, 0, 0, 0, 1.0]))
    assert env.strokes == 1 and np.allclose(env.positions[CUE], placed, rtol=0, atol=1e-15)
    assert env.frame.striker == offender and env.frame.in_hand
    assert env.agent_selection == f"player_{offender}" and np.array_equal(before[1:], env.positions[1:])


def test_a_free_ball_is_seen_and_scores():
    places = {CUE: (0.3, 1.1), BLUE: (0.6, 1.4), 1: (-0.5, -1.2), PINK: SPOTS[PINK], BLACK: (0.0, 0.0)}
    env = frame_state(frame_env(opponent="ghost_ball"), places, FOULED | {"free_ball": True})
    assert env.on >> BLUE & 1 and env.on >> 1 & 1
    assert env.tables.observe(np.zeros(1, np.int64), 0)[0][FREE_BALL_SEEN] == 1.0
    _, reward, _, _, info = env.step([-0.5, 0, 0, 0, 0, 0, 0])
    assert (reward, info["points"], env.ball_on) == (1.0, 1.0, BallOn.ANY_COLOUR)
    assert np.array_equal(env.positions[BLUE], SPOTS[BLACK])  # it came back; its own spot is taken
    plain = frame_state(frame_env(opponent="ghost_ball"), places, FOULED)
    assert not plain.on >> BLUE & 1


# Rewards


@pytest.mark.parametrize("opponent", ["none", "random", "ghost_ball"])
@pytest.mark.parametrize("layout", ["random:2", "pots:easy", "colours"])
def test_points_add_up_to_the_difference_and_win_says_who_won(opponent, layout):
    """From the first stroke, which may be the opponent's, to the last, which may be in his first visit."""
    broke, before = 0, 0
    for seed in range(15):
        totals = {}
        for reward in ("points", "win"):
            env = frame_env(opponent=opponent, reward=reward, layout=layout, noise="club")
            _, info = env.reset(seed=seed)
            broke, before = (
                broke + (info["opponent_score"] + info["score"] > 0),
                before + (info["winner"] >= 0),
            )
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
    for seed in range(60):
        observation, info = env.reset(seed=seed)
        before = env.positions
        if info["winner"] < 0:
            continue
        won += 1
        assert info["winner"] == 1 and info["opponent_strokes"] > 0 and env.over
        state = json.loads(json.dumps(env.get_state()))
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
    assert won > 10


# What a step returns


ON_BLACK = {CUE: (0.3, 1.1), BLACK: (0.6, 1.4)}


@pytest.mark.parametrize("strokes", [5, 9])
def test_a_frame_that_ends_by_the_rules_with_its_last_stroke_is_not_stopped(strokes):
    frame = {"ball_on": BallOn.BLACK, "scores": (20, 0)}
    env = frame_state(frame_env(aim="absolute", max_strokes=10), ON_BLACK, frame, strokes=strokes)
    for _ in range(40):  # along the pot, a little to both sides of it
        aim = np.arctan2(0.3, 0.3) / np.pi + np.random.default_rng(_).uniform(-0.01, 0.01)
        env = frame_state(env, ON_BLACK, frame, strokes=strokes)
        _, _, terminated, truncated, info = env.step([-0.4, 0, 0, aim, 0, 0, 0])
        if terminated:
            assert not truncated and info["winner"] == 0 and info["strokes"] == strokes + 1
            break
        assert truncated == (strokes == 9) or info["foul"]
    assert terminated


@pytest.mark.parametrize(("lead", "needs"), [(0, False), (7, False), (8, True)])
def test_snookers_are_needed_by_who_trails_by_more_than_is_left(lead, needs):
    """Only the black is left, seven points; and the observation shows them."""
    env = frame_env(aim="absolute")
    plain = frame_state(env, ON_BLACK, {"ball_on": BallOn.BLACK, "scores": (10, 10 + lead)}).get_state()
    observation, info = env.reset(options={"state": plain})
    assert info["needs_snookers"] is needs
    names = dict(zip(FRAME_ENTRIES, observation[-len(FRAME_ENTRIES) :].tolist(), strict=True))
    assert names["available"] == pytest.approx(7 / 155)
    assert names["lead"] == pytest.approx(-lead / (lead + 147))


def test_before_the_first_reset_a_frame_can_be_read_and_nothing_is_played():
    for env in (
        frame_env(render_mode="ansi"),
        sn.match_env(render_mode="ansi"),
        sn.SnookerVectorEnv(2, task="frame", render_mode="ansi"),
    ):
        assert env.render() and env.get_state()
        with pytest.raises(
            gymnasium.error.ResetNeeded, match=r"^call reset|^the frame has not begun: call reset"
        ):
            env.step(np.zeros((2, 4)) if isinstance(env, sn.SnookerVectorEnv) else np.zeros(7))
    assert frame_env().frame.phase == "stroke" and frame_env().over


# A colour that is named


def test_a_colour_named_that_is_not_struck_first_costs_the_higher_of_the_two():
    """Blue lies in the way: fair when nothing or blue was named; when black was named it costs seven."""
    places = {CUE: (0.0, -0.5), 1: (0.6, 1.4), BLUE: (0.3, -0.5), PINK: SPOTS[PINK], BLACK: SPOTS[BLACK]}
    for named, penalty in ((-1, 0), (BLUE, 0), (PINK, 6), (BLACK, 7)):
        env = frame_state(frame_env(aim="absolute"), places, {"ball_on": BallOn.ANY_COLOUR})
        env.tables.nominated[0] = named
        _, _, _, _, info = env.step([-0.9, 0, 0, TO_BLUE, 0, 0, 0])
        assert (info["penalty"], info["fouls"]) == (penalty, Foul.WRONG_FIRST if penalty else 0), named
