"""Is the match of two players a sound PettingZoo environment, and whose turn is it?"""

import json

import gymnasium
import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game.balls import CUE
from snooker_env.render import window
from snooker_env.tasks import observations
from tests.envs.test_frames_alike import KINDS, PLAIN
from tests.processes import ROOT, python
from tests.tables import PLACES, begun, frame_state, plain

pytest.importorskip("pettingzoo")
from pettingzoo.test import api_test, render_test, seed_test

WIN = {"layout": "colours", "aim": "target", "reward": "win"}
CHOICES = {"action": "discrete", "layout": "random:2"}
MATCH = {"frames": 3, "layout": "pots:easy", "says": ["nominate", "concede"]}


@pytest.mark.parametrize("options", [{"aim": "target"}, {"max_strokes": 20}, WIN, CHOICES, MATCH | CHOICES])
def test_pettingzoo_checks_its_interface(options, strict, capsys):
    api_test(sn.match_env(**options), num_cycles=200)
    assert "Passed API test" in capsys.readouterr().out


MASKED = {"action": "discrete", "observation": "masked"}
SAID = {"says": ["nominate", "concede", "claim", "lot"]}


@pytest.mark.parametrize("options", [{"observation": "balls"}, MASKED, MASKED | SAID, MASKED | {"frames": 3}])
def test_pettingzoo_checks_its_interface_with_dicts_of_observations(options, capsys):
    """Random players take the mask from the observation. PettingZoo warns of every Dict observation."""
    with pytest.warns(UserWarning, match="Observation"):
        api_test(sn.match_env(layout="random:3", **options), num_cycles=80)
    assert "Passed API test" in capsys.readouterr().out


@pytest.mark.parametrize("options", [{}, {"action": "discrete"}, MASKED, {"frames": 3}])
def test_nothing_is_observed_before_the_first_reset(options):
    env = sn.match_env(**options)
    for look in (lambda: env.observe("player_0"), env.last, lambda: env.agent_selection):
        with pytest.raises(AttributeError, match=r"^agent_selection cannot be read before reset\(\): call"):
            look()
    if "action" in options:
        with pytest.raises(AttributeError, match=r"before reset\(\)"):
            env.action_mask("player_1")
    with pytest.raises(gymnasium.error.ResetNeeded, match=r"call reset\(\) before step\(\)"):
        env.step(None)
    env.reset(seed=1)
    assert all(env.observation_space(name).contains(env.observe(name)) for name in env.agents)


def test_masked_observations_of_both_players_hold_their_masks():
    """All 0 for the player whose turn it is not, and for both at the end, as in the infos."""
    options = {"action": "discrete", "layout": "random:0", "noise": "club"}
    env, flat = (sn.match_env(observation=kind, **options) for kind in ("masked", "flat"))
    env.reset(seed=2), flat.reset(seed=2)
    rng, turns = np.random.default_rng(0), set()
    while True:
        for name in env.possible_agents:
            seen, mask = env.observe(name), env.action_mask(name)
            assert np.array_equal(seen["observations"], flat.observe(name))
            assert env.observation_space(name).contains(seen)
            assert seen["action_mask"].dtype == np.int8 and np.array_equal(seen["action_mask"], mask)
            assert np.array_equal(mask, env.infos[name]["action_mask"])
            assert np.array_equal(mask, flat.action_mask(name))
            over = any(env.terminations.values())
            assert mask.any() == (name == env.agent_selection and not over)
            seen["action_mask"][:] = 1  # it is the caller's own
        if over:
            break
        turns.add(env.agent_selection)
        action = int(rng.choice(np.flatnonzero(env.action_mask(env.agent_selection))))
        env.step(action), flat.step(action)
    assert len(turns) == 2
    with pytest.raises(ValueError, match="a Box has no masks"):
        sn.match_env().action_mask("player_0")


@pytest.mark.parametrize("options", [{"noise": "club", "layout": "random:3"}, MATCH])
def test_pettingzoo_checks_its_seeds(options, strict):
    seed_test(lambda: sn.match_env(aim="target", **options), num_cycles=60)


def test_pettingzoo_checks_its_pictures(monkeypatch):
    pytest.importorskip("pygame")
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    monkeypatch.setattr(window.Window, "play", lambda self, film, fps=30.0, *, speed=1.0: film.duration > 0)
    render_test(sn.match_env)


@pytest.mark.parametrize(
    ("x", "back", "place"),
    [(0.0, -1.0, (0.0, -1.0475)), (0.0, 1.0, (0.0, -1.3395)), (-1.0, 0.3, (-0.292, -1.0475))],
)
def test_the_place_in_the_d_is_part_of_the_action(x, back, place):
    env = sn.match_env(render_mode="ansi")
    frame_state(env, PLACES | {CUE: (0.1, -1.2)}, {"in_hand": True})
    env.step(np.array([-0.5, 0, 0, 0.2, x, back, 0], np.float32))
    assert env.last_shot.at(0.0)[0][CUE] == pytest.approx(place, abs=1e-6)
    moved = env.positions[CUE].copy()
    env.step(np.array([-0.5, 0, 0, 0.2, x, back, 0], np.float32))  # no longer in hand: not moved first
    assert env.last_shot.at(0.0)[0][CUE] == pytest.approx(moved, abs=1e-12)


def test_each_player_sees_its_own_side():
    env = frame_state(sn.match_env(), PLACES, {"striker": 1, "scores": (31, 62)})
    mine, theirs = env.observe("player_0"), env.observe("player_1")
    assert np.array_equal(mine[:121], theirs[:121]) and mine.shape == (121 + len(observations.FRAME_ENTRIES),)
    assert mine[121:124] == pytest.approx([31 / 178, 62 / 209, -31 / 178])
    assert theirs[121:124] == pytest.approx([62 / 209, 31 / 178, 31 / 178])
    assert (mine[125], theirs[125]) == (0.0, 1.0)
    mine[:] = 0.3
    assert not np.array_equal(env.observe("player_0"), mine)


@pytest.mark.parametrize(("limit", "why"), [(1000, "terminations"), (1, "truncations")])
def test_a_state_of_a_frame_that_has_ended_ends_at_once(limit, why):
    env, other = (sn.match_env(aim="target", layout="random:1", max_strokes=limit) for _ in range(2))
    env.reset(seed=1)
    rng = np.random.default_rng(1)
    while not (any(env.terminations.values()) or any(env.truncations.values())):
        env.step(rng.uniform(-1, 1, 7))
    other.reset(options={"state": plain(env.get_state())})
    assert getattr(env, why) == getattr(other, why) == {"player_0": True, "player_1": True}
    assert other.observe("player_0").tobytes() == env.observe("player_0").tobytes()
    for player in other.agent_iter():
        assert any(other.last()[2:4]) and player in other.possible_agents
        other.step(None)
    assert not other.agents


def test_a_state_repeats_its_errors_and_a_seed_draws_others():
    env = begun(sn.match_env(aim="target", noise="professional", layout="random:6"), 2)
    state, ends = plain(env.get_state()), []
    for seed in (None, None, *range(50), 7):
        env.reset(seed=seed, options={"state": state})
        changed = {key for key, value in env.get_state().items() if value != state[key]}
        assert changed == (set() if seed is None else {"stream"} if seed == 2 else {"rng", "stream"})
        env.step(np.zeros(7, np.float32))
        ends.append(env.positions.tobytes())
    assert ends[0] == ends[1] and len(set(ends)) == 51 and ends[-1] == ends[2 + 7]


def test_pettingzoo_is_loaded_only_when_asked_for_and_its_lack_is_explained():
    lacking = "assert 'pettingzoo' not in sys.modules\nsys.modules['pettingzoo'] = None"
    code = f"import sys, snooker_env as sn\n{lacking}\ntry: sn.match_env()\nexcept ImportError as e: print(e)"
    needs = f'match_env needs PettingZoo; install it, in the clone {ROOT}, with: pip install -e ".[multi]"'
    assert python(code)[0].strip() == needs


# Two players on many tables play what ``match_env`` plays; seats may differ


N = 9


def actions_of(options, rng, masks):
    """Random actions on N tables: near a pot, or available choices."""
    if options.get("action") == "discrete":
        return np.array([rng.choice(np.flatnonzero(mask)) for mask in masks])
    says = options.get("says", ())
    a = rng.uniform(-1, 1, (N, sn.Options(task="frame", placement=True, says=says).rules.actions.size))
    a[:, 1:4] *= 0.3
    if "concede" in says:
        a[:, -1] = np.where(rng.random(N) < 0.98, np.abs(a[:, -1]), a[:, -1])
    return a


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("threads", [pytest.param(1, marks=pytest.mark.slow), 2])
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


LOOKS = {
    "masked": MASKED | {"layout": "colours"},
    "masked, everything said": MASKED | SAID | {"layout": "random:1", "noise": "amateur"},
    "masked match with misses": MASKED | {"frames": 3, "layout": "random:0", "miss": "attempt"},
    "masked six-red": MASKED | {"game": "six_red", "miss": "clear_path", "says": ["nominate"]},
    "masked Shoot Out": MASKED | {"game": "shoot_out", "layout": "random:2"},
    "masked, drawn and seen": MASKED | {"conditions": "drawn", "observe_conditions": True, "cue": "real"},
    "masked, other errors": MASKED | {"layout": "random:1", "seats": ({}, {"noise": "amateur"})},
    "masked, both concede": MASKED | {"layout": "random:0", "seats": ({"says": ["concede"]},) * 2},
    "balls with misses": PLAIN | {"observation": "balls", "layout": "random:1", "miss": "clear_path"},
    "balls, six-red": PLAIN | {"observation": "balls", "game": "six_red", "says": ["nominate", "decision"]},
    "flat Shoot Out": PLAIN | {"game": "shoot_out", "layout": "random:2"},
}


def sees(observations, k, alone):
    """Whether table k of many is seen as a match alone is seen, in every bit and in its space."""
    if not isinstance(observations, dict):
        return observations[k].tobytes() == alone.tobytes()
    same = (observations[name][k].tobytes() == alone[name].tobytes() for name in alone)
    return observations.keys() == alone.keys() and all(same)


@pytest.mark.parametrize("look", LOOKS)
def test_both_players_see_on_each_of_many_tables_what_they_see_in_a_match_alone(look):
    """After resets of all and of some, steps, states and ends: the strikers' observations, and ``observe``."""
    options, rng, n = {"max_strokes": 14} | LOOKS[look], np.random.default_rng(3), 4
    tables = sn.MatchVectorEnv(n, threads=1, **options)
    alone = [sn.match_env(**options) for _ in range(n)]
    seen, _ = tables.reset(seed=2)
    [one.reset(seed=2 + k) for k, one in enumerate(alone)]
    over, ends = np.zeros(n, bool), 0

    def check():
        assert tables.observation_space.contains(seen)
        both = [tables.observe(player) for player in range(2)]
        for k, one in enumerate(alone):
            striker = one.possible_agents.index(one.agent_selection)
            assert sees(seen, k, one.observe(one.agent_selection)) and sees(both[striker], k, one.last()[0])
            assert sees(both[1 - striker], k, one.observe(one.possible_agents[1 - striker]))
            assert one.observation_space(one.agent_selection).contains(one.last()[0])

    check()
    for step in range(44):
        if options.get("action") == "discrete":
            masks = tables.action_masks()
            actions = np.array([rng.choice(np.flatnonzero(mask)) for mask in masks])
        else:
            actions = rng.uniform(-0.4, 0.4, (n, tables.single_action_space.shape[0]))
        seen, _, terminated, truncated, _ = tables.step(actions)
        [one.step(actions[k]) for k, one in enumerate(alone) if not over[k]]
        check()
        ends += int((terminated | truncated)[~over].sum())
        over = terminated | truncated
        if over.sum() > 1:
            seen, _ = tables.reset(options={"reset_mask": over.copy()})
            [alone[k].reset() for k in np.flatnonzero(over)]
            over[:] = False
            check()
        if step == 20:
            states = plain(tables.get_state())
            playing = [state["frame"]["phase"] != "over" and state["strokes"] < 14 for state in states]
            if all(playing):
                seen, _ = tables.reset(options={"states": states})
                [one.reset(options={"state": state}) for one, state in zip(alone, states, strict=True)]
                check()
    assert ends >= 2


def test_seats_with_other_choices_have_masks_of_their_own():
    seats = ({}, {"says": ["concede"]})
    match = begun(sn.match_env(**MASKED, seats=seats, layout="random:1"), 1)
    for name, many in (("player_0", 540), ("player_1", 541)):
        assert match.observe(name)["action_mask"].shape == (many,)
        assert match.observation_space(name).contains(match.observe(name))
    with pytest.raises(ValueError, match=r"^seats = .*: must give both players the same choices"):
        sn.MatchVectorEnv(2, **MASKED, seats=seats, threads=1)


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
