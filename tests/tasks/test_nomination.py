"""What is a nominated colour worth, and what may be nominated and declared when?"""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game.balls import BLACK, BLUE, CUE, PINK, SPOTS, YELLOW, BallOn
from snooker_env.game.ruling import AUTO, Foul
from snooker_env.tasks import declarations, discrete_actions
from tests.refusals import refused
from tests.tables import PLACES as STANDING
from tests.tables import frame_env, frame_state, layout, plain
from tests.tasks.test_misses_in_hand import after_failures

COLOURS = {CUE: (0.0, -0.5), BLUE: (0.3, -0.5), PINK: SPOTS[PINK], BLACK: SPOTS[BLACK]}
PLACES = COLOURS | {1: (0.6, 1.4), YELLOW: SPOTS[YELLOW]}
TO_BLUE, TO_NOTHING = 0.0, -0.8
ANY = {"ball_on": BallOn.ANY_COLOUR}


def named(n, of=6):
    """The middle of part n of a range cut in equal parts."""
    return -1 + (2 * n + 1) / of


def test_the_number_of_strokes_is_the_same_in_both_files():
    assert declarations.STROKE_CHOICES == discrete_actions.SIZE == 540


@pytest.mark.parametrize(
    ("part", "aim", "penalty", "foul"),
    [
        (0, TO_NOTHING, 4, Foul.NO_CONTACT),
        (3, TO_NOTHING, 5, Foul.NO_CONTACT),
        (5, TO_NOTHING, 7, Foul.NO_CONTACT),
        (3, TO_BLUE, 0, Foul(0)),
        (0, TO_BLUE, 5, Foul.WRONG_FIRST),
        (4, TO_BLUE, 6, Foul.WRONG_FIRST),
        (5, TO_BLUE, 7, Foul.WRONG_FIRST),
    ],
)
def test_after_a_red_the_colour_nominated_is_the_one_on(part, aim, penalty, foul):
    env = frame_state(frame_env(aim="absolute", nominate=True), PLACES, ANY)
    assert env.action_space.shape == (8,)
    info = env.step([-0.9, 0, 0, aim, 0, 0, named(part), 0])[4]
    assert (info["penalty"], info["fouls"]) == (penalty, foul) and env.tables.nominated[0] == AUTO


def test_without_nomination_a_stroke_at_nothing_costs_seven_and_the_colour_struck_is_the_one_meant():
    for aim, penalty in ((TO_NOTHING, 7), (TO_BLUE, 0)):
        env = frame_state(frame_env(aim="absolute"), PLACES, ANY)
        assert env.step([-0.9, 0, 0, aim, 0, 0, 0])[4]["penalty"] == penalty


def test_the_potting_line_is_that_of_the_ball_nominated():
    for part, ball in ((3, BLUE), (4, PINK)):
        env = frame_state(frame_env(nominate=True), PLACES, ANY)
        assert env.step([-0.5, 0, 0, 0, 0, 0, named(part), 0])[4]["first_ball"] == ball


FREE = {"phase": "stroke", "free_ball": True, "scores": (0, 4)}


@pytest.mark.parametrize(("part", "penalty"), [(0, 5), (4, 0), (1, 5), (6, 5)])
def test_a_free_ball_is_nominated_or_declined(part, penalty):
    """With reds on: the blue struck first is fair as the free ball, worth a red, else it costs its five."""
    env = frame_state(frame_env(aim="absolute", nominate=True), PLACES, FREE)
    assert env.step([-0.9, 0, 0, TO_BLUE, 0, 0, named(part, 7), 0])[4]["penalty"] == penalty


def test_the_ball_on_itself_as_the_free_ball_declines_it():
    for part, penalty in ((0, 0), (4, 0), (5, 5), (6, 5)):  # blue is on
        env = frame_state(frame_env(aim="absolute", nominate=True), COLOURS, FREE | {"ball_on": BallOn.BLUE})
        assert env.step([-0.9, 0, 0, TO_BLUE, 0, 0, named(part, 7), 0])[4]["penalty"] == penalty, part


def test_at_other_times_a_nomination_is_ignored():
    for part in range(6):
        env = frame_state(frame_env(aim="absolute", nominate=True), PLACES, {})
        assert env.step([-0.9, 0, 0, TO_BLUE, 0, 0, named(part), 0])[4]["fouls"] == Foul.WRONG_FIRST


def blocks(env):
    """Which nominations the mask allows."""
    mask = env.action_masks()
    return [n for n in range(7) if mask[540 * n : 540 * (n + 1)].any()]


def test_masks_allow_what_may_be_nominated():
    env = frame_env(action="discrete", decision=False, placement=False, nominate=True)
    assert env.action_space.n == 3780
    assert blocks(frame_state(env, PLACES, {})) == [0]
    assert blocks(frame_state(env, PLACES, ANY)) == [1, 4, 5, 6]  # green and brown are not on the table
    assert blocks(frame_state(env, PLACES, FREE)) == [0, 1, 4, 5, 6]
    assert blocks(frame_state(env, COLOURS, FREE | {"ball_on": BallOn.BLUE})) == [0, 5, 6]
    for n, ball in ((4, BLUE), (5, PINK)):
        env = frame_state(env, PLACES, ANY)
        assert env.step(540 * n + 67)[4]["first_ball"] == ball
    refused(lambda: env.step(3780), "action", "3780", "must be an integer in [0, 3780)")


# Declarations


SAID = {"concede": True, "claim": True, "lot": True}
CHOICES = {"action": "discrete", "decision": False, "placement": False}


@pytest.mark.parametrize("only", ["concede", "claim", "lot"])
def test_each_declaration_alone_lengthens_the_action_by_one(only):
    assert frame_env(**{only: True}).action_space.shape == (8,)
    assert frame_env(**SAID).action_space.shape == (8,)
    assert sn.SnookerEnv(task="frame", action="discrete", **{only: True}).action_space.n == 541


def test_who_concedes_loses_without_a_stroke():
    for options, say in (({}, [0] * 7 + [-0.7]), (CHOICES, 540)):
        env = frame_env(opponent="ghost_ball", reward="win", **SAID | options)
        frame_state(env, PLACES, {"scores": (50, 0)})
        _, reward, terminated, _, info = env.step(say)
        assert (reward, terminated, info["winner"], info["events"]) == (-1.0, True, 1, 0)
    env = frame_state(frame_env(claim=True), PLACES, {})
    assert env.step([-0.5] + [0] * 6 + [-1.0])[4]["events"] > 0  # without the option it is no concession


@pytest.mark.parametrize(("scores", "won"), [((20, 12), True), ((20, 13), False)])
def test_the_frame_is_claimed_with_the_black_left_and_more_than_seven_ahead(scores, won):
    for options in ({}, CHOICES):
        env, frame = frame_env(**SAID | options), {"ball_on": BallOn.BLACK, "scores": scores}
        frame_state(env, {CUE: (0.3, 1.1), BLACK: (0.6, 1.4)}, frame)
        assert not options or env.action_masks()[540:].tolist() == [True, won, False]
        _, _, terminated, _, info = env.step(541 if options else [-1.0] + [0] * 6 + [0.7])
        assert (terminated and info["events"] == 0) == won and (not won or info["winner"] == 0)


@pytest.mark.parametrize("options", [{}, CHOICES])
def test_the_winner_of_the_lot_says_who_begins(options):
    pytest.importorskip("pettingzoo")
    black = {"phase": "lot", "respotted_black": True, "ball_on": BallOn.BLACK}
    level = black | {"scores": (20, 20), "in_hand": True, "striker": 1}
    places = {CUE: (0.0, -1.2), BLACK: SPOTS[BLACK]}
    for other in (False, True):
        env = frame_state(sn.match_env(lot=True, **options), places, level)
        assert env.agent_selection == "player_1" and env.observe("player_1")[121 + 12] == 1.0
        if options:
            assert env.action_mask("player_1")[-1] == 1
            env.step(540 if other else 0)
        else:
            env.step(np.array([-1.0] + [0.0] * 6 + [-0.1 if other else 0.0]))
        assert env.strokes == (not other) and env.frame.phase != "lot"
        assert not other or env.agent_selection == "player_0"
    with pytest.raises(ValueError, match=r"state\.frame\.phase"):
        frame_state(sn.match_env(), places, level)


@pytest.mark.parametrize("opponent", ["random", "ghost_ball"])
@pytest.mark.parametrize("action", ["box", "discrete"])
def test_the_built_in_players_play_with_everything_said(opponent, action):
    """They nominate, begin at the lot, and do not concede."""
    options = SAID | {"task": "match", "frames": 3, "nominate": True, "layout": "pots:easy", "aim": "target"}
    many = {"opponent": opponent, "autoreset_mode": "SameStep", "threads": 1}
    tables = sn.SnookerVectorEnv(20, action=action, **options, **many)
    tables.reset(seed=1)
    rng, ended = np.random.default_rng(0), 0
    for _ in range(40):
        if action == "discrete":
            masks = tables.action_masks()
            masks[:, 3780] = False
            a = np.array([rng.choice(np.flatnonzero(mask)) for mask in masks])
        else:
            a = rng.uniform(-1, 1, (20, 6)) * (1, 0.3, 0.3, 1, 1, 0.6)
        ended += int(tables.step(a)[2].sum())
    assert ended > 3


# What it costs to give a frame up: with points as the reward, those that are left on the table


LEFT = 2 * 8 + 6 + 7
"""On the table of ``STANDING``: two reds, pink and black."""
GIVES_UP = [0.0] * 7 + [-1.0]


def test_to_concede_costs_what_is_left_on_the_table():
    env = frame_state(frame_env(concede=True, opponent="ghost_ball"), STANDING, {"scores": (10, 30)})
    _, reward, terminated, _, info = env.step(GIVES_UP)
    assert (reward, terminated, info["winner"]) == (-LEFT, True, 1)
    assert (info["score"], info["opponent_score"]) == (10.0, 30.0)  # the score stands


def test_from_the_start_it_costs_147():
    env = sn.SnookerEnv(task="frame", concede=True)
    env.reset(seed=1)
    assert env.step([0.0] * 4 + [-1.0])[1] == -147.0


def test_what_was_not_paid_yet_is_paid_with_it():
    env = frame_env(concede=True, opponent="ghost_ball")
    state = frame_state(env, STANDING, {"scores": (10, 30)}).get_state() | {"unpaid": -5}
    env.reset(options={"state": plain(state)})
    assert env.step(GIVES_UP)[1] == -5 - LEFT


@pytest.mark.parametrize("striker", [0, 1])
def test_of_two_players_the_other_one_gets_it(striker):
    match = frame_state(sn.match_env(concede=True), STANDING, {"scores": (10, 30), "striker": striker})
    match.step(GIVES_UP)
    assert match.rewards == {f"player_{striker}": -LEFT, f"player_{1 - striker}": LEFT}


@pytest.mark.parametrize(("reward", "expected"), [("win", -1.0), ("frames", -1.0), ("points", -(147 + LEFT))])
def test_of_a_match_each_frame_given_up_is_paid_once(reward, expected):
    env = sn.SnookerEnv(task="match", frames=3, concede=True, aim="target", reward=reward)
    env.reset(seed=1)
    total = env.step([0.0] * 4 + [-1.0])[1]
    state = env.get_state()
    assert state["frames"] == [0, 1]
    frame = state["frame"] | {"on_table": 2 | 4 | 1 << PINK | 1 << BLACK, "in_hand": False}
    env.reset(options={"state": state | layout(STANDING) | {"frame": frame}})
    total += env.step([0.0] * 4 + [-1.0])[1]
    assert total == {"frames": 2 * expected}.get(reward, expected)


def test_a_frame_lost_by_a_third_miss_is_given_up_too():
    """Each failure costs four; the red, the brown and the black are left."""
    _, (_, reward, terminated, _, info) = after_failures("clear_path", 3)
    assert terminated and info["opponent_score"] == 12.0
    assert reward == -4 - (8 + 4 + 7)
