"""Whose is what the info of a frame says: at its end, when it is stopped, and with a free ball?"""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game.balls import BLACK, BLUE, CUE, PINK, SPOTS, BallOn
from snooker_env.tasks.observations import FRAME_ENTRIES
from tests.tables import frame_env, frame_state

AIM = np.arctan2(0.3, 0.3) / np.pi
LAST_BLACK = {CUE: (0.3, 1.1), BLACK: (0.6, 1.4)}
SOFT = [-0.9, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]
"""Down the table: into nothing."""


def clears_up(observation, rng):
    """Pots the ball at (0.6, 1.4) into the top right pocket from (0.3, 1.1)."""
    return [-0.4, 0.0, 0.0, AIM, 0.0, 0.0, 0.0]


def test_the_break_at_the_end_of_a_frame_is_the_players_own():
    """After the agent's miss the opponent pots pink and black: his 13 are none of the agent's."""
    places = {CUE: (0.3, 1.1), PINK: (0.6, 1.4), BLACK: (-0.5, -1.0)}
    env = frame_env(aim="target", opponent="ghost_ball")
    for seed in range(200):
        state = frame_state(
            env, places, {"ball_on": BallOn.PINK, "striker": 0, "scores": (0, 30)}
        ).get_state()
        env.reset(seed=seed, options={"state": state})
        _, _, terminated, _, info = env.step([-0.95, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
        if terminated and info["opponent_score"] > 35:
            break
    assert terminated and info["winner"] == 1 and env.points > 0
    assert info["break"] == 0.0
    own = frame_state(env, LAST_BLACK, {"ball_on": BallOn.BLACK, "scores": (20, 0), "break_points": 6})
    for offset in np.linspace(-0.2, 0.2, 41):
        own = frame_state(env, LAST_BLACK, {"ball_on": BallOn.BLACK, "scores": (20, 0), "break_points": 6})
        _, _, terminated, _, info = own.step([-0.4, 0.0, 0.0, offset, 0.0, 0.0, 0.0])
        if terminated and info["points"]:
            break
    assert (info["winner"], info["break"]) == (0, 13.0)


def test_what_is_open_when_a_frame_is_stopped_is_the_opponents():
    """The agent's foul is the last stroke: the decision, and the free ball, are the other player's."""
    for opponent in ("ghost_ball", "random"):
        env = frame_env(aim="absolute", opponent=opponent, max_strokes=5)
        places = {CUE: (0.0, -0.3), 1: (0.0, 1.2), BLUE: (0.0, 0.0), BLACK: (0.0, 0.2)}
        frame_state(env, places, {"ball_on": BallOn.RED}, strokes=4)
        _, _, _, truncated, info = env.step([-0.95, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0])
        assert truncated and info["foul"] and env.frame.phase == "choice" and env.frame.free_ball
        assert (info["choice"], info["free_ball"], info["break"]) == (False, False, 0.0)


def test_of_two_players_the_one_who_waits_has_no_break_no_choice_and_no_free_ball():
    match = sn.match_env(aim="absolute")
    match.reset(seed=1)
    places = {CUE: (0.0, -0.3), 1: (0.0, 1.2), BLUE: (0.0, 0.0), BLACK: (0.0, 0.2)}
    env = frame_state(frame_env(), places, {"ball_on": BallOn.RED})
    match.reset(options={"state": env.get_state()})
    match.step([-0.95, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0])
    assert match.agent_selection == "player_1" and match.frame.free_ball
    assert [(i["choice"], i["free_ball"]) for i in map(match.infos.get, match.possible_agents)] == [
        (False, False),
        (True, True),
    ]
    match.reset(options={"position": sn.Position(cue=(0.3, 1.1), black=(0.6, 1.4), points=33)})
    assert [match.infos[name]["break"] for name in match.possible_agents] == [33.0, 0.0]


@pytest.mark.parametrize(("lead", "needs"), [(14, False), (19, False), (20, True)])
def test_a_free_ball_is_worth_the_ball_on(lead, needs):
    """Pink and black are left: 13 points, and 6 for the free ball."""
    env = frame_env(aim="absolute")
    places = {CUE: (0.0, 0.3), PINK: (0.0, 0.9), BLACK: SPOTS[BLACK]}
    state = frame_state(
        env, places, {"ball_on": BallOn.PINK, "scores": (10, 10 + lead), "free_ball": True}
    ).get_state()
    observation, info = env.reset(options={"state": state})
    assert info["needs_snookers"] is needs and info["free_ball"]
    assert observation[-len(FRAME_ENTRIES) + FRAME_ENTRIES.index("available")] == pytest.approx(19 / 155)
