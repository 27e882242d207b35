"""Do two players on many tables play what ``match_env`` plays, and what do seats that differ mean?"""

import json

import gymnasium
import numpy as np
import pytest

import snooker_env as sn
from tests.envs.test_frames_alike import KINDS, PLAIN
from tests.tables import begun, plain

pytest.importorskip("pettingzoo")

N = 9


def actions_of(options, rng, masks):
    """Random actions on N tables: near a pot, or available choices."""
    if options.get("action") == "discrete":
        return np.array([rng.choice(np.flatnonzero(mask)) for mask in masks])
    longer = sum(bool(options.get(name)) for name in ("nominate", "decision", "concede"))
    a = rng.uniform(-1, 1, (N, 6 + longer))
    a[:, 1:4] *= 0.3
    if options.get("concede"):
        a[:, -1] = np.where(rng.random(N) < 0.98, np.abs(a[:, -1]), a[:, -1])
    return a


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("threads", [1, 2])
def test_each_table_plays_as_a_match_alone(kind, threads):
    options, rng = KINDS[kind], np.random.default_rng(1)
    tables = sn.MatchVectorEnv(N, **options, threads=threads)
    alone = [sn.match_env(**options) for _ in range(N)]
    observations, infos = tables.reset(seed=5)
    [one.reset(seed=5 + k) for k, one in enumerate(alone)]
    ended, strokes = np.zeros(N, bool), 0
    for _ in range(160):
        for k, one in enumerate(alone):
            name = one.agent_selection
            assert infos["striker"][k] == tables.strikers[k] == one.possible_agents.index(name)
            assert observations[k].tobytes() == one.observe(name).tobytes()
        discrete = options.get("action") == "discrete"
        actions = actions_of(options, rng, tables.action_masks() if discrete else None)
        observations, rewards, terminated, truncated, infos = tables.step(actions)
        for k, one in enumerate(alone):
            if ended[k]:
                assert not rewards[k].any()
            else:
                one.step(int(actions[k]) if discrete else actions[k])
                assert rewards[k].tolist() == list(one.rewards.values())
                info = one.infos["player_0"]
                assert all(infos[name][k] == info[name] for name in set(info) & set(infos))
                strokes += 1
            assert terminated[k] == one.terminations["player_0"]
            assert truncated[k] == one.truncations["player_0"]
            keys = ("positions", "on_table", "frame", "strokes", "stream")
            state = tables.get_state()[k]
            assert {key: state[key] for key in keys} == {key: one.get_state()[key] for key in keys}
        ended = terminated | truncated
        if ended.all():
            break
    assert strokes > 300 and ended.any()


def test_tables_that_have_ended_stand_still_until_they_are_reset():
    tables = begun(sn.MatchVectorEnv(4, layout="random:0", max_strokes=6, threads=1, reward="win"), 0)
    for _ in range(6):
        out = tables.step(np.tile([-0.9, 0, 0, 0.5, 0, 0, 0], (4, 1)))
    assert out[3].all()
    before = json.dumps(tables.get_state())
    _, rewards, terminated, truncated, _ = tables.step(np.zeros((4, 7)))
    assert json.dumps(tables.get_state()) == before and not rewards.any() and truncated.all()
    assert not terminated.any()
    _, infos = tables.reset(options={"reset_mask": np.array([True, False, False, True]), "breaker": 1})
    assert infos["_strokes"].tolist() == [True, False, False, True]
    assert tables.strikers[[0, 3]].tolist() == [1, 1]
    assert tables.step(np.zeros((4, 7)))[3].tolist() == [False, True, True, False]


def test_a_saved_state_plays_on_whoever_is_to_play():
    tables = begun(sn.MatchVectorEnv(N, **PLAIN, layout="random:3", threads=2), 3)
    tables.step(np.full((N, 7), -0.3))
    states = plain(tables.get_state())
    again = sn.MatchVectorEnv(N, **PLAIN, layout="random:3", threads=1)
    seen, _ = again.reset(options={"states": states})
    assert set(tables.strikers.tolist()) == {0, 1}
    assert np.array_equal(seen[tables.strikers == 1], tables.observe(1)[tables.strikers == 1])
    for one, other in zip(tables.step(np.zeros((N, 7)))[:4], again.step(np.zeros((N, 7)))[:4], strict=True):
        assert np.array_equal(one, other)


def test_seats_differ_in_actions_and_errors():
    """Player 1 has choices, and exact strokes: from one position on one seed they are always the same."""
    seats = ({}, {"action": "discrete", "noise": "none"})
    tables = sn.MatchVectorEnv(N, seats=seats, layout="random:3", noise="club", threads=2)
    alone = [sn.match_env(seats=seats, layout="random:3", noise="club") for _ in range(N)]
    tables.reset(seed=1, options={"breaker": np.arange(N) % 2})
    [one.reset(seed=1 + k, options={"breaker": k % 2}) for k, one in enumerate(alone)]
    assert alone[0].action_space("player_0") == gymnasium.spaces.Box(-1.0, 1.0, (7,))
    assert alone[0].action_space("player_1").n == 540
    for _ in range(6):
        for one in alone:
            if not (one.terminations["player_0"] or one.truncations["player_0"]):
                one.step(67 if one.agent_selection == "player_1" else np.full(7, 0.1))
        tables.step((np.full((N, 7), 0.1), np.full(N, 67)))
        assert all(np.array_equal(tables.tables.positions[k], one.positions) for k, one in enumerate(alone))
    places = []
    for seed in range(3):
        for breaker in (0, 1):
            one = sn.match_env(seats=seats, layout="random:3", noise="club")
            one.reset(seed=7, options={"breaker": breaker})
            state = one.get_state()
            one.reset(seed=seed, options={"state": state})
            one.step(67 if breaker else [-0.5, 0, 0, 0.5, 0, 0, 0])
            places.append(one.positions[0].tolist())
    assert places[1] == places[3] == places[5] and len({tuple(place) for place in places[::2]}) == 3


def test_a_reset_is_needed_and_actions_are_one_array_a_seat():
    tables = sn.MatchVectorEnv(2, threads=1)
    with pytest.raises(gymnasium.error.ResetNeeded):
        tables.step(np.zeros((2, 7)))
    with pytest.raises(ValueError, match="must be two arrays"):
        sn.MatchVectorEnv(2, seats=({}, {"action": "discrete"}), threads=1).step(np.zeros((2, 7)))
