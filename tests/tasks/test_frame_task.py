"""Does ``task="frame"`` keep Gymnasium's contract in every game, and whose is what its infos say?"""

import inspect

import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import snooker_env as sn
from snooker_env import SnookerEnv
from snooker_env.game.balls import BLACK, BLUE, CUE, PINK, SPOTS, BallOn
from snooker_env.game.fouls import AUTO
from snooker_env.tasks.observations import FRAME_ENTRIES
from snooker_env.tasks.options import NAMES
from tests.tables import begun, frame_env, frame_state, plain


def test_gymnasium_checks_a_match():
    options = {"layout": "pots:easy", "opponent": "random", "says": ["nominate", "decision", "lot"]}
    check_env(SnookerEnv(task="match", **options), skip_render_check=True)


def test_the_spaces_grow_and_those_of_a_visit_do_not():
    assert SnookerEnv().observation_space.shape == (61,) and SnookerEnv().action_space.shape == (4,)
    assert SnookerEnv(observation="flat").observation_space.shape == (121,)
    assert frame_env().observation_space.shape == (140,) and frame_env().action_space.shape == (7,)
    assert frame_env(miss="clear_path").observation_space.shape == (206,)
    assert frame_env(observation="balls").observation_space["state"].shape == (30,)
    assert "replaced" not in frame_env(observation="balls").observation_space.spaces
    assert frame_env(observation="balls", miss="clear_path").observation_space["replaced"].shape == (22, 3)
    discrete = {"action": "discrete", "observation": "masked", "placement": False}
    masked = frame_env(**discrete, says=["nominate", "concede"], miss="clear_path").observation_space
    assert masked["observations"].shape == (206,) and masked["action_mask"].shape == (7 * 540 + 1,)
    assert frame_env(says=[], placement=False).action_space.shape == (4,)
    assert len(FRAME_ENTRIES) == 19


def test_infos_have_the_same_keys_and_types_at_all_times():
    env, rng = frame_env(opponent="random", layout="random:4"), np.random.default_rng(3)
    infos = [env.reset(seed=3)[1]]
    for _ in range(150):
        infos.append(env.reset()[1] if env.over else env.step(rng.uniform(-1, 1, 7))[-1])
    assert len({tuple(sorted((k, type(v).__name__) for k, v in info.items())) for info in infos}) == 1
    assert {"score", "opponent_score", "opponent_strokes", "winner", "choice", "free_ball"} <= set(infos[0])
    assert {"needs_snookers", "clock", "misses", "failures", "anywhere", "warned"} <= set(infos[0])
    assert {info["winner"] for info in infos} > {-1} and {info["choice"] for info in infos} == {True, False}


def test_every_argument_is_documented():
    described = f"{sn.Options.__doc__}{SnookerEnv.__doc__}"
    assert all(name in described for name in (*NAMES, "render_mode", "render_size"))
    arguments = {"options", "render_mode", "render_size", "keywords"}
    assert set(inspect.signature(SnookerEnv).parameters) == arguments


@pytest.mark.parametrize("game", ["snooker", "six_red", "shoot_out"])
def test_the_state_before_the_first_reset_is_sound(game):
    env = sn.SnookerEnv(task="frame", game=game)
    state = env.get_state()
    env.set_state(plain(state))
    assert env.get_state() == state


def test_a_nomination_does_not_outlive_its_frame():
    """An error in a stroke, or in an opponent, may leave one behind."""
    env = begun(frame_env())
    position = sn.Position(cue=(0.0, 0.0), black=(0.3, 0.3), on="black")
    for start in ({}, {"state": env.get_state()}, {"position": position}):
        env.tables.nominated[0] = PINK
        env.reset(options=start)
        assert env.tables.nominated[0] == AUTO


BETWEEN = {CUE: (0.0, -0.3), 1: (0.0, 1.2), BLUE: (0.0, 0.0), BLACK: (0.0, 0.2)}
AT_THE_BLUE = [-0.95, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0]
"""A foul that leaves a free ball."""


@pytest.mark.parametrize("opponent", ["ghost_ball", "random"])
def test_what_is_open_when_a_frame_is_stopped_is_the_opponents(opponent):
    """The agent's foul is the last stroke: the decision, and the free ball, are the other player's."""
    env = frame_env(aim="absolute", opponent=opponent, max_strokes=5)
    frame_state(env, BETWEEN, {"ball_on": BallOn.RED}, strokes=4)
    _, _, _, truncated, info = env.step(AT_THE_BLUE)
    assert truncated and info["foul"] and env.frame.phase == "choice" and env.frame.free_ball
    assert (info["choice"], info["free_ball"], info["break"]) == (False, False, 0.0)


def test_of_two_players_the_one_who_waits_has_no_break_no_choice_and_no_free_ball():
    match = frame_state(sn.match_env(aim="absolute"), BETWEEN, {"ball_on": BallOn.RED})
    match.step(AT_THE_BLUE)
    assert match.agent_selection == "player_1" and match.frame.free_ball
    for key in ("choice", "free_ball"):
        assert [match.infos[name][key] for name in match.possible_agents] == [False, True]
    match.reset(options={"position": sn.Position(cue=(0.3, 1.1), black=(0.6, 1.4), points=33)})
    assert [match.infos[name]["break"] for name in match.possible_agents] == [33.0, 0.0]


PINK_AND_BLACK = {CUE: (0.0, 0.3), PINK: (0.0, 0.9), BLACK: SPOTS[BLACK]}
FREE = {"ball_on": BallOn.PINK, "free_ball": True}
ONLY_BLACK, LAST = {CUE: (0.3, 1.1), BLACK: (0.6, 1.4)}, {"ball_on": BallOn.BLACK}


@pytest.mark.parametrize(
    ("places", "frame", "available", "lead", "needs"),
    [
        *[
            (PINK_AND_BLACK, FREE, 13 + 6, lead, needs)
            for lead, needs in ((14, False), (19, False), (20, True))
        ],
        *[(ONLY_BLACK, LAST, 7, lead, needs) for lead, needs in ((0, False), (7, False), (8, True))],
    ],
)
def test_snookers_are_needed_by_who_trails_by_more_than_is_left(places, frame, available, lead, needs):
    """A free ball is worth the ball on."""
    env = frame_env(aim="absolute")
    state = frame_state(env, places, frame | {"scores": (10, 10 + lead)}).get_state()
    observation, info = env.reset(options={"state": state})
    assert info["needs_snookers"] is needs and info["free_ball"] == ("free_ball" in frame)
    names = dict(zip(FRAME_ENTRIES, observation[-len(FRAME_ENTRIES) :].tolist(), strict=True))
    assert names["available"] == pytest.approx(available / 155)
    assert names["lead"] == pytest.approx(-lead / (lead + 147))
