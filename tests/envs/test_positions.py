"""Do environments start from a position, with their own random numbers, and refuse a wrong one?"""

from functools import partial

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game.balls import BallOn
from snooker_env.planning import Positions
from tests.refusals import refused
from tests.tables import begun, plain

BALLS = {"cue": (0.1, -0.6), "reds": [(0.3, 0.5), (-0.2, 0.9)], "blue": (0.0, 0.0), "black": (0.0, 1.4605)}
MID_BREAK = sn.Position(**BALLS, on="any colour", points=33)
IN_HAND = sn.Position(reds=[(0.3, 0.5)], black=(0.0, 1.4605), in_hand=True)
OPTIONS = {"noise": "professional", "aim": "target", "observation": "flat"}


def start(position, **more):
    return {"options": {"position": position, **more}}


def is_there(env, position):
    """Whether the environment stands at the position: balls, what is on, in hand, points."""
    p, on_table, game = position.arrays()
    same = np.array_equal(env.positions, p) and np.array_equal(env.on_table, on_table)
    return same and [env.ball_on, env.in_hand, env.points, env.over] == game[:4].tolist()


@pytest.mark.parametrize("position", [MID_BREAK, IN_HAND], ids=["mid-break", "in hand"])
@pytest.mark.parametrize("form", [lambda p: p, lambda p: plain(p.to_dict())], ids=["Position", "dict"])
def test_a_visit_starts_where_the_position_says(position, form):
    env = sn.SnookerEnv(**OPTIONS)
    observation, info = env.reset(seed=1, **start(form(position)))
    assert is_there(env, position) and info["break"] == position.points and info["points"] == 0.0
    assert np.array_equal(observation, Positions.of(position).observations()[0])
    with pytest.raises(ValueError, match=r"keys of options = \['state', 'position'\]: must be only one"):
        env.reset(options={"state": env.get_state(), "position": position})


def ends(env, seeds, position=MID_BREAK):
    out = []
    for seed in seeds:
        env.reset(seed=seed, **start(position))
        out.append(env.step(np.zeros(4))[0].tobytes())
    return out


@pytest.mark.parametrize("task", ["visit", "frame"])
def test_random_numbers_are_those_of_the_seed_or_go_on(task):
    env = sn.SnookerEnv(task=task, **OPTIONS)
    assert len(set(ends(env, [None] * 20))) == 20  # a state would repeat its errors
    assert len(set(ends(env, range(20)))) == 20
    assert ends(env, [5, 9, 5]) == ends(sn.SnookerEnv(task=task, **OPTIONS), [5, 9, 5])
    fresh, other = sn.SnookerEnv(task=task, **OPTIONS), sn.SnookerEnv(task=task, **OPTIONS)
    fresh.reset(seed=7)
    other.reset(seed=7, **start(MID_BREAK))
    assert other.get_state()["stream"][0] == fresh.get_state()["stream"][0] and other.np_random_seed == 7
    stream = other.get_state()["stream"]
    other.reset(**start(MID_BREAK))
    assert other.get_state()["stream"] == stream


@pytest.mark.parametrize("opponent", ["none", "random"])
@pytest.mark.parametrize("position", [MID_BREAK, IN_HAND], ids=["mid-break", "in hand"])
def test_in_a_frame_the_agent_plays_the_position(opponent, position):
    env = begun(sn.SnookerEnv(task="frame", opponent=opponent, **OPTIONS), 3)
    env.step(np.zeros(4))  # the frame before leaves nothing behind
    _, info = env.reset(seed=1, **start(position))
    assert is_there(env, position)
    assert (info["break"], info["winner"]) == (position.points, -1)
    assert info["score"] == info["opponent_score"] == 0
    assert not any(info[key] for key in ("strokes", "opponent_strokes", "choice", "free_ball"))
    frame = env.frame
    assert frame.striker == frame.breaker == 0 and frame.phase == "stroke"
    assert frame.ball_on == BallOn[position.on.upper()]
    again = sn.SnookerEnv(task="frame", opponent=opponent, **OPTIONS)
    again.reset(options={"state": plain(env.get_state())})  # it is a sound state
    assert again.get_state() == env.get_state()
    while not env.over and info["strokes"] < 5:
        *_, info = env.step(np.zeros(4))
    assert info["strokes"] > 0


def test_in_a_match_player_0_plays_the_position():
    match = sn.match_env(noise="club")
    for seed in range(4):
        match.reset(seed=seed, options={"position": MID_BREAK, "of PettingZoo's own": 1})
        assert match.agent_selection == "player_0" and match.frame.scores == (0, 0)
        assert match.frame.break_points == 33
        assert np.array_equal(match.positions, MID_BREAK.arrays()[0])
        assert match.infos["player_0"]["break"] == 33
        stream = match.get_state()["stream"]
        other = begun(sn.match_env(noise="club"), seed)
        assert stream[0] == other.get_state()["stream"][0]
        match.reset(options={"position": MID_BREAK.to_dict()})
        assert match.get_state()["stream"] == stream
        match.step(np.zeros(7))
    with pytest.raises(ValueError, match="keys of options"):
        match.reset(options={"position": MID_BREAK, "state": match.get_state()})


def test_many_tables_start_from_one_position_or_from_one_each():
    env = sn.SnookerVectorEnv(4, threads=1, **OPTIONS)
    singles = [sn.SnookerEnv(**OPTIONS) for _ in range(4)]
    some = [MID_BREAK, IN_HAND.to_dict(), MID_BREAK, IN_HAND]
    for options in ({"position": MID_BREAK}, {"positions": some}):
        observations, infos = env.reset(seed=11, options=options)
        each = options.get("positions", [MID_BREAK] * 4)
        for k, one in enumerate(singles):
            observation, info = one.reset(seed=11 + k, **start(each[k]))
            assert np.array_equal(observations[k], observation) and infos["break"][k] == info["break"]
        observations, rewards, *_ = env.step(np.zeros((4, 4)))
        stepped = [one.step(np.zeros(4)) for one in singles]
        assert np.array_equal(observations, [s[0] for s in stepped])
        assert rewards.tolist() == [s[1] for s in stepped]
        assert len({row.tobytes() for row in observations[::3]}) == 2  # each table draws its own errors
        assert env.get_state() == [one.get_state() for one in singles]


OFF = sn.Position(cue=(0.0, 0.0), reds=[(0.5, 0.5)], black=(0.0, 1.775), table=None)


def changed(**fields):
    return MID_BREAK.to_dict() | fields


FAULTS = [
    (OFF, '"position"].black', "(0.0, 1.775)", "overlaps the cushion"),
    (changed(blue=[0.0, 3.0]), '"position"].blue', "(0.0, 3.0)", "must be"),
    (changed(blue=[0.1, -0.6]), '"position"].blue', "(0.1, -0.6)", "overlaps cue"),
    (changed(on="pink"), '"position"].on', "'pink'", "must"),
    (changed(points=121), '"position"].points', "121", "must be at most"),
    (changed(points=-1), '"position"].points', "-1", "must be an integer"),
    (changed(in_hand=True), '"position"].in_hand', "True", "must be False with the cue ball at (0.1, -0.6)"),
    (changed(over=True), '"position"].over', "True", "must be False: the visit has ended"),
    (changed(reds=5), '"position"].reds', "shape ()", "must"),
    (17, '"position"]', "17", "must be a snooker_env.Position"),
]


@pytest.mark.parametrize(("position", "field", "value", "allowed"), FAULTS)
def test_a_wrong_position_is_refused_by_its_field_and_changes_nothing(position, field, value, allowed):
    single, match, many = sn.SnookerEnv(), sn.match_env(), sn.SnookerVectorEnv(2, threads=1)
    for env in (single, match):
        env.reset(seed=1)
        before = plain(env.get_state())
        refused(partial(env.reset, seed=4, **start(position)), f"options[{field}", value, allowed)
        assert plain(env.get_state()) == before
    many.reset(seed=1)
    before = many.get_state()
    refused(lambda: many.reset(options={"position": position}), f"options[{field}", value, allowed)
    field = field.replace('"position"]', '"positions"][1]')
    both = {"positions": [MID_BREAK, position]}
    refused(partial(many.reset, options=both), f"options[{field}", value, allowed)
    assert many.get_state() == before


def test_other_mistakes_are_named():
    env, many = sn.SnookerEnv(), sn.SnookerVectorEnv(2, threads=1)
    two = "must be a list of 2 positions"
    grey = {"position": changed(grey=[0, 0])}
    reset, reset_many = (lambda **o: env.reset(options=o)), (lambda **o: many.reset(options=o))
    refused(partial(reset, **grey), 'keys of options["position"]', "'grey'", "must be one of 'cue'")
    refused(lambda: reset_many(positions=MID_BREAK), 'options["positions"]', "Position", two)
    refused(lambda: reset_many(positions=[MID_BREAK]), 'options["positions"]', "list of 1", two)
    refused(lambda: reset(positions=[MID_BREAK]), "options", "'positions'", "must be one of 'state', 'pos")


def test_who_breaks_is_said_only_where_balls_are_dealt():
    position = sn.Position(cue=(0.0, 0.0), reds=[(0.5, 1.0)])
    single, match = sn.SnookerEnv(task="frame", opponent="random"), sn.match_env()
    many = sn.SnookerVectorEnv(2, threads=1, task="frame", opponent="random")
    single.reset(seed=1)
    for env, key, value in (
        (single, "position", position),
        (match, "position", position),
        (many, "positions", [position] * 2),
        (single, "state", single.get_state()),
    ):
        allowed = f'must be left out with "{key}": it says who breaks where balls are dealt'
        refused(partial(env.reset, options={key: value, "breaker": 1}), 'options["breaker"]', "1", allowed)
