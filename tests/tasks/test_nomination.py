"""What is a nominated colour worth, and what may be nominated and declared when?"""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game.balls import BLACK, BLUE, BROWN, CUE, GREEN, PINK, SPOTS, YELLOW, BallOn, mask_of
from snooker_env.game.fouls import AUTO, Foul
from snooker_env.geometry import BAULK_Y, D_RADIUS
from tests.miss_paths import paths
from tests.refusals import refused
from tests.tables import PLACES as STANDING
from tests.tables import acting, begun, frame_env, frame_state, layout

COLOURS = {CUE: (0.0, -0.5), BLUE: (0.3, -0.5), PINK: SPOTS[PINK], BLACK: SPOTS[BLACK]}
PLACES = COLOURS | {1: (0.6, 1.4), YELLOW: SPOTS[YELLOW]}
TO_BLUE, TO_NOTHING = 0.0, -0.8
ANY = {"ball_on": BallOn.ANY_COLOUR}


def named(n, of=6):
    """The middle of part n of a range cut in equal parts."""
    return -1 + (2 * n + 1) / of


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
    env = frame_state(frame_env(aim="absolute", says=["nominate", "decision"]), PLACES, ANY)
    assert env.action_space.shape == (8,)
    info = env.step([-0.9, 0, 0, aim, 0, 0, named(part), 0])[4]
    assert (info["penalty"], info["fouls"]) == (penalty, foul) and env.tables.nominated[0] == AUTO


FREE = {"phase": "stroke", "free_ball": True, "scores": (0, 4)}


@pytest.mark.parametrize(("part", "penalty"), [(0, 5), (4, 0), (1, 5), (6, 5)])
def test_a_free_ball_is_nominated_or_declined(part, penalty):
    """With reds on: the blue struck first is fair as the free ball, worth a red, else it costs its five."""
    env = frame_state(frame_env(aim="absolute", says=["nominate", "decision"]), PLACES, FREE)
    assert env.step([-0.9, 0, 0, TO_BLUE, 0, 0, named(part, 7), 0])[4]["penalty"] == penalty


def blocks(env):
    """Which nominations the mask allows."""
    mask = env.action_masks()
    return [n for n in range(7) if mask[540 * n : 540 * (n + 1)].any()]


def test_masks_allow_what_may_be_nominated():
    env = frame_env(action="discrete", placement=False, says=["nominate"])
    assert env.action_space.n == 3780
    assert blocks(frame_state(env, PLACES, {})) == [0]
    assert blocks(frame_state(env, PLACES, ANY)) == [1, 4, 5, 6]  # green and brown are not on the table
    assert blocks(frame_state(env, PLACES, FREE)) == [0, 1, 4, 5, 6]
    assert blocks(frame_state(env, COLOURS, FREE | {"ball_on": BallOn.BLUE})) == [0, 5, 6]
    for n, ball in ((4, BLUE), (5, PINK)):
        env = frame_state(env, PLACES, ANY)
        assert env.step(540 * n + 67)[4]["first_ball"] == ball
    refused(lambda: env.step(3780), "action", "3780", "must be an integer in [0, 3780)")


DECLARED = ["concede", "claim", "lot"]
SAID = {"says": ["decision", *DECLARED]}
CHOICES = {"action": "discrete", "says": DECLARED, "placement": False}


def test_who_concedes_loses_without_a_stroke():
    for options, say in (({}, [0] * 7 + [-0.7]), (CHOICES, 540)):
        env = frame_env(opponent="ghost_ball", reward="win", **SAID | options)
        frame_state(env, PLACES, {"scores": (50, 0)})
        _, reward, terminated, _, info = env.step(say)
        assert (reward, terminated, info["winner"], info["events"]) == (-1.0, True, 1, 0)
    env = frame_state(frame_env(says=["decision", "claim"]), PLACES, {})
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
        env = frame_state(sn.match_env(**{"says": ["decision", "lot"]} | options), places, level)
        assert env.agent_selection == "player_1" and env.observe("player_1")[121 + 12] == 1.0
        if options:
            assert env.action_mask("player_1")[-1] == 1
            env.step(542 if other else 0)
        else:
            env.step(np.array([-1.0] + [0.0] * 6 + [-0.1 if other else 0.0]))
        assert env.get_state()["strokes"] == (not other) and env.frame.phase != "lot"
        assert not other or env.agent_selection == "player_0"
    with pytest.raises(ValueError, match=r"state\.frame\.phase"):
        frame_state(sn.match_env(), places, level)


# What it costs to give a frame up: with points as the reward, those that are left on the table


LEFT = 2 * 8 + 6 + 7
"""On the table of ``STANDING``: two reds, pink and black."""
GIVES_UP = [0.0] * 7 + [-1.0]


def test_to_concede_costs_what_is_left_on_the_table():
    env = frame_env(says=["decision", "concede"], opponent="ghost_ball")
    env = frame_state(env, STANDING, {"scores": (10, 30)})
    _, reward, terminated, _, info = env.step(GIVES_UP)
    assert (reward, terminated, info["winner"]) == (-LEFT, True, 1)
    assert (info["score"], info["opponent_score"]) == (10.0, 30.0)  # the score stands


@pytest.mark.parametrize(("reward", "expected"), [("win", -1.0), ("frames", -1.0), ("points", -(147 + LEFT))])
def test_of_a_match_each_frame_given_up_is_paid_once(reward, expected):
    env = begun(sn.SnookerEnv(task="match", frames=3, says=["concede"], aim="target", reward=reward))
    total = env.step([0.0] * 4 + [-1.0])[1]
    state = env.get_state()
    assert state["frames"] == [0, 1]
    frame = state["frame"] | {"on_table": 2 | 4 | 1 << PINK | 1 << BLACK, "in_hand": False}
    env.reset(options={"state": state | layout(STANDING) | {"frame": frame}})
    total += env.step([0.0] * 4 + [-1.0])[1]
    assert total == {"frames": 2 * expected}.get(reward, expected)


# A miss with the cue ball in hand is judged from every place where it could have been put


TABLE = sn.Table.preset("match")
CUSHIONS = {"noses": TABLE.noses, "jaws": TABLE.jaws}
RED = (0.0, 0.5)
BEHIND_THE_BROWN = [-0.6, 0.0, 0.0, 0.5, 0.0, 1.0, 0.0]
"""A stroke straight up the table from the back of the D, into the brown."""


def table(places, cue=None):
    parts = layout(places if cue is None else places | {CUE: cue})
    return np.array(parts["positions"]), np.array(parts["on_table"])


def asks_again(observation, rng):
    """An opponent who has the balls replaced whenever they may."""
    return [-0.9, 0.0, 0.0, 0.9, 0.0, 0.0, 1.0]


@pytest.mark.parametrize("miss", ["clear_path", "attempt"])
def test_who_hides_in_hand_is_sent_back_warned_and_loses_the_frame(miss):
    """It is given up then: the red, the brown and the black that are left are paid for as well."""
    env = frame_env(aim="absolute", miss=miss, opponent=acting(asks_again, aim="absolute"))
    places = {1: RED, BROWN: SPOTS[BROWN], BLACK: SPOTS[BLACK], CUE: (0.18, BAULK_Y)}
    frame_state(env, places, {"in_hand": True})
    for failures, warned in ((1, False), (2, True)):
        info = env.step(BEHIND_THE_BROWN)[4]
        assert (info["opponent_score"], info["failures"], info["warned"]) == (4 * failures, failures, warned)
        assert env.in_hand
    _, reward, terminated, _, info = env.step(BEHIND_THE_BROWN)
    assert terminated and (info["opponent_score"], info["winner"]) == (12.0, 1)
    assert reward == -4 - (8 + 4 + 7)


@pytest.mark.parametrize("seed", range(3))
def test_no_place_of_the_d_sees_more(seed):
    """Where some place of the D has a clear path, so has the cue ball in hand; touching a ball is none."""
    rng, met = np.random.default_rng(seed), set()
    for _ in range(12):
        at = rng.uniform((-0.5, 0.5), (0.5, 1.3))
        beside = at + rng.uniform((-0.12, -0.3), (0.12, -0.06), (4, 2))
        places = {1: at, **dict(zip((GREEN, YELLOW, BLUE, PINK), beside, strict=True))}
        x = rng.uniform(-D_RADIUS, D_RADIUS, 60)
        d = np.column_stack([x, BAULK_Y - rng.uniform(0, 1, 60) * np.sqrt(D_RADIUS**2 - x**2)])
        found = np.array([paths(*table(places, place), mask_of([1]), **CUSHIONS) for place in d]).any(axis=0)
        in_hand = np.array(paths(*table(places), mask_of([1]), **CUSHIONS))
        assert (in_hand >= found).all()
        met |= {tuple(in_hand.tolist())}
    assert len(met) > 1
