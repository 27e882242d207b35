"""Do tables play alike, bit for bit: one and many, on any threads, resumed, copied, against an opponent or between two?"""

import copy
import json
import pickle

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

import snooker_env as sn
from snooker_env import SnookerEnv, SnookerVectorEnv
from snooker_env.envs.match import PLAYERS
from snooker_env.players import OpponentPool
from snooker_env.tasks.frames import Frames, Seat
from tests.envs.one_by_one import MODES, OneByOne, native, same
from tests.tables import acting, begun, jsonable, plain


def policy(observation, rng):
    """An opponent in Python that draws from its generator and reads its observation."""
    drawn = rng.uniform(-1.0, 1.0, 7) * (1.0, 0.3, 0.3, 0.5, 1.0, 1.0, 1.0)
    return np.clip(drawn + 0.01 * observation[0], -1.0, 1.0)


TARGET = {"aim": "target"}
MASKED = {"action": "discrete", "observation": "masked"}
SEEN = {"conditions": "drawn", "observe_conditions": True}
SAID = {"says": ["nominate", "concede", "claim", "lot"]}
FULL = TARGET | {"noise": "club", "placement": True, "says": ["decision"]}
FRAME = FULL | {"task": "frame"}
LONG = {"layout": "break_off", "placement": True, "elevation": True}
VISITS = {
    "pots, a real cue": {"noise": "club", "cue": "real", "layout": "random:5"},
    "errors": TARGET | {"noise": "club", "layout": "random:5", "reward": "points_and_fouls"},
    "long actions": TARGET | LONG | {"observation": "balls", "reward": "pots"},
    "other worlds": TARGET
    | {"noise": "olympiad", "layout": "pots:easy", "physics": "match", "table": "tight"},
    "a limit": TARGET | {"max_episode_steps": 2, "layout": "random:3", "observation": "balls"},
    "masks": MASKED | {"layout": "random:2", "noise": "club", "max_episode_steps": 2},
    "masks, a real cue": MASKED | {"layout": "random:6", "noise": "club", "cue": "real"},
    "kicks, drawn tables": TARGET | SEEN | {"noise": {"aim_deg": 0.3, "kick": 0.3}, "layout": "colours"},
    "snookered": {"noise": {"aim_deg": 0.3}, "layout": "snookered", "fidelity": "fast"},
}
GHOST, SHORT = {"opponent": "ghost_ball"}, {"task": "frame", "max_strokes": 20}
OUT = {"game": "shoot_out", "says": ["decision", "lot"]}
FRAMES = {
    "alone": {"task": "frame", "layout": "random:1", "miss": "attempt", "max_strokes": 25} | TARGET,
    "one stroke": {"task": "frame", "opponent": "random", "one_stroke": True, "layout": "safety"},
    "random": FRAME | {"opponent": "random", "layout": "break_off", "miss": "clear_path"},
    "ghost_ball": FRAME | GHOST | {"layout": "random:1", "observation": "balls", "reward": "win"},
    "in Python": FRAME | {"opponent": acting(policy), "layout": "random:0", "max_strokes": 15},
    "a pool": FRAME | {"opponent": OpponentPool(["random", "ghost_ball"]), "layout": "random:2"},
    "a search, drawn tables": SEEN | SHORT | {"opponent": "best_pot_8", "noise": "club", "max_strokes": 12},
    "masks, all said": MASKED
    | SAID
    | GHOST
    | SHORT
    | {"layout": "random:1", "miss": "clear_path", "cue": "real"},
    "six-red": FRAME | {"game": "six_red", "opponent": "random", "miss": "attempt"},
    "Shoot Out": FRAME | OUT | {"opponent": "random", "time_to_play": 12.0},
    "flight": FRAME | {"layout": "random:2", "physics": {"flight": True}, "elevation": True},
    "a match": FRAME | GHOST | {"task": "match", "frames": 3, "layout": "pots:easy", "max_strokes": 60},
}
KINDS = VISITS | FRAMES


def some_actions(options, shape, masks, rng):
    """Random actions: available choices, or such that some pots come and nobody concedes at once."""
    if masks is not None:
        masks = np.array(masks, bool)
        if "concede" in options.says:
            masks[..., 540 * 7] &= rng.uniform() < 0.02
        return np.array([rng.choice(np.flatnonzero(mask)) for mask in masks.reshape(-1, masks.shape[-1])])
    a = rng.uniform(-1.0, 1.0, shape)
    a[..., 1:4] *= 0.2 if options.task == "visit" else 0.3
    if "concede" in options.says:
        a[..., -1] = np.abs(a[..., -1])
    return a


EVERY_MODE = ("a limit", "masks", "ghost_ball")
EACH = [(k % 3, kind, j, mode) for k, kind in enumerate(KINDS) for j, mode in enumerate(MODES)]
CASES = [(kind, mode) for k, kind, j, mode in EACH if kind in EVERY_MODE or k == j]


@pytest.mark.parametrize(("kind", "mode"), CASES)
def test_many_tables_play_as_single_ones(kind, mode, monkeypatch):
    """Spaces, masks, observations, rewards, ends and infos in Gymnasium's form; three threads, chunks of four."""
    monkeypatch.setattr("snooker_env.tasks.threads.CHUNK", 4)
    options, n, steps = KINDS[kind], 5, 25 if "search" in kind else 45
    ours, theirs = native(n, autoreset_mode=mode, threads=3, **options), OneByOne(n, mode, **options)
    assert ours.observation_space == theirs.observation_space and ours.action_space == theirs.action_space
    assert same(ours.reset(seed=3), theirs.reset(seed=3))
    rng, ends, cut, scored = np.random.default_rng(1), 0, 0, 0.0
    for step in range(steps):
        if mode == AutoresetMode.DISABLED and theirs.done.any():
            again = {"reset_mask": theirs.done.copy()}
            assert same(ours.reset(options=again), theirs.reset(options=again)), step
        masks = ours.action_masks() if "action" in options else None
        if masks is not None:
            assert np.array_equal(masks, [one.unwrapped.action_masks() for one in theirs.envs])
        a = some_actions(ours.options, ours.action_space.shape, masks, rng).astype(ours.action_space.dtype)
        got, want = ours.step(a), theirs.step(a)
        for k, (x, y) in enumerate(zip(got, want, strict=True)):
            assert same(x, y), (step, k, x, y)
        ends, cut, scored = ends + theirs.done.sum(), cut + got[3].sum(), scored + np.maximum(got[1], 0).sum()
    ours.close()
    assert ends > 30 or kind in FRAMES
    assert ends > 0 or kind in ("random", "flight", "six-red", "ghost_ball", "a search, drawn tables")
    assert (cut > 0) == ("max_episode_steps" in options) or kind in FRAMES
    assert scored > 0 or kind == "snookered"


@pytest.mark.parametrize("layout", ["held_out", "line_up", "colours", "random:0", "pots:hard"])
def test_every_layout_is_dealt_alike(layout):
    ours, theirs = (make(5, layout=layout, noise="professional", **TARGET) for make in (native, OneByOne))
    assert same(ours.reset(seed=3), theirs.reset(seed=3))
    for _ in range(10):
        assert same(ours.step(np.zeros((5, 4))), theirs.step(np.zeros((5, 4))))


@pytest.mark.parametrize(("threads", "chunk"), [(2, 128), (8, 3)])
def test_hundreds_of_steps_for_any_number_of_threads_and_any_chunks(threads, chunk, monkeypatch):
    options = TARGET | {"noise": "amateur", "layout": "random:4", "autoreset_mode": "SameStep"}
    one = begun(SnookerVectorEnv(33, threads=1, **options), 3)
    monkeypatch.setattr("snooker_env.tasks.threads.CHUNK", chunk)
    other, rng = begun(SnookerVectorEnv(33, threads=threads, **options), 3), np.random.default_rng(1)
    for _ in range(250):
        a = rng.uniform(-1, 1, (33, 4)) * (1, 0.2, 0.2, 0.2)
        assert same(one.step(a), other.step(a))


COPIES = (copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env)))


def goes_on(one, other, action):
    """The results of both, which play this stroke alike up to every bit of the state after it."""
    for env in (one, other):
        env.action_space.seed(1)
    want, got = one.step(action), other.step(action)
    assert pickle.dumps(jsonable(got)) == pickle.dumps(jsonable(want))
    assert plain(other.get_state()) == plain(one.get_state())
    return want


BLACKLESS = {"cue": (0.2, -0.5), "reds": [(0.5, 1.2)], "yellow": (0.292, -1.0475)}


@pytest.mark.parametrize("kind", KINDS)
def test_every_state_and_every_copy_goes_on_as_the_same(kind):
    """By ``set_state``, by resets of one table and of many; a table that is over by ``set_state`` alone."""
    options = {key: value for key, value in KINDS[kind].items() if key != "max_episode_steps"}
    env, other = SnookerEnv(**options), SnookerEnv(**options)
    many, rng = SnookerVectorEnv(2, threads=1, **options), np.random.default_rng(2)
    for seed in range(3):
        at = {"position": sn.Position(**BLACKLESS)} if seed == 2 and "Python" in kind else None
        seen, _ = env.reset(seed=seed, options=at)
        for k in range(20):
            state = plain(env.get_state())
            other.set_state(state)
            assert plain(other.get_state()) == state
            if env.tables.are_told_over()[0]:
                break
            again, _ = other.reset(options={"state": state})
            assert same(again, seen) and plain(other.get_state()) == state
            many.reset(options={"states": [state, state]})
            assert plain(many.get_state()) == [state, state]
            masks = env.action_masks()[None] if "action" in options else None
            action = some_actions(env.options, (1, *env.action_space.shape), masks, rng)[0]
            twins = [copied(env) for copied in COPIES] if k == 1 else []
            rows = many.step(np.stack([action] * 2))
            seen, reward, *_ = goes_on(env, other, action)
            assert rows[1].tolist() == [reward] * 2
            both, mine = (
                [one | {"rng": 0} for one in plain(each)] for each in (many.get_state(), [env.get_state()])
            )
            assert both == mine * 2
            for twin in twins:
                assert twin.tables.rules.plan.tables is env.tables.rules.plan.tables  # the bank is not copied
                twin.step(action)
                assert plain(twin.get_state()) == plain(env.get_state())


# Two players

PLAIN, COLOURS = FULL | {"layout": "random:1"}, {"layout": "colours", "miss": "attempt"}
EVERYTHING = ["nominate", "decision", "concede", "claim", "lot"]
PAIRS = {
    "misses": PLAIN | {"layout": "random:2", "miss": "clear_path", "reward": "win", "observation": "balls"},
    "everything said": PLAIN | {"says": EVERYTHING, "miss": "clear_path"},
    "a match": PLAIN | {"says": EVERYTHING, "task": "match", "frames": 3, "layout": "random:0"},
    "frames of a match": PLAIN | COLOURS | {"reward": "frames", "task": "match", "frames": 5},
    "masks": MASKED | SAID | {"noise": "amateur", "task": "match", "frames": 3, "layout": "random:1"},
    "masks, six-red": MASKED | {"game": "six_red", "miss": "clear_path", "says": ["nominate"]},
    "masks, drawn and seen": MASKED | SEEN | {"cue": "real"},
    "masks, other errors": MASKED | {"layout": "random:1", "seats": ({}, {"noise": "amateur"})},
    "Shoot Out": PLAIN | OUT | {"layout": "random:2"},
    "position": FULL | {"says": ["decision", "lot"], "miss": "clear_path"},
}
RARE = "frames of a match", "masks", "masks, other errors"


def two_players_act(env, rng):
    """A random action of the player to play."""
    masks = [env.action_mask(env.agent_selection)] if env.options.action == "discrete" else None
    a = some_actions(env.options, (1, *(env.action_space(PLAYERS[0]).shape or ())), masks, rng)[0]
    return int(a) if masks else a


@pytest.mark.parametrize(
    "kind", [pytest.param(kind, marks=[pytest.mark.slow] * (kind in RARE)) for kind in PAIRS]
)
def test_two_players_on_many_tables_play_as_in_a_match_alone(kind):
    """What both see, rewards, ends, infos and states; after resets of all, of some, and from each state of a match."""
    pytest.importorskip("pettingzoo")
    options, rng, n = {"max_strokes": 30} | PAIRS[kind], np.random.default_rng(3), 4
    tables = sn.MatchVectorEnv(n, threads=2, **options)
    alone, resumed = [sn.match_env(**options) for _ in range(n)], sn.match_env(**options)
    start = {"position": sn.Position(**BLACKLESS)} if kind == "position" else None
    seen, infos = tables.reset(seed=2, options=start)
    [one.reset(seed=2 + k, options=start) for k, one in enumerate(alone)]
    ends = 0

    def row(observations, k):
        if "observation" in options:
            return {name: each[k] for name, each in observations.items()}
        return observations[k]

    for step in range(70):
        both = [tables.observe(player) for player in range(2)]
        assert tables.observation_space.contains(seen)
        for k, one in enumerate(alone):
            striker = PLAYERS.index(one.agent_selection)
            assert tables.strikers[k] == striker and same(row(seen, k), one.observe(one.agent_selection))
            assert all(same(row(both[j], k), one.observe(PLAYERS[j])) for j in range(2))
        state = plain(alone[0].get_state())
        resumed.reset(options={"state": state})
        assert plain(resumed.get_state()) == state
        actions = np.array([two_players_act(one, rng) for one in alone])
        seen, rewards, terminated, truncated, infos = tables.step(actions)
        for k, one in enumerate(alone):
            one.step(actions[k])
            assert rewards[k].tolist() == list(one.rewards.values())
            info, ended = one.infos[PLAYERS[0]], (one.terminations[PLAYERS[0]], one.truncations[PLAYERS[0]])
            assert all(infos[name][k] == info[name] for name in {*info} & {*infos} - {"action_mask"})
            assert (terminated[k], truncated[k]) == ended
        resumed.step(actions[0])
        states = plain(tables.get_state())
        for k, one in enumerate([*alone, resumed]):
            assert plain(one.get_state()) | {"rng": 0, "unpaid": 0} == states[k % n] | {"rng": 0, "unpaid": 0}
        over = terminated | truncated
        ends += int(over.sum())
        if over.any():
            seen, _ = tables.reset(options={"reset_mask": over.copy()})
            [alone[k].reset() for k in np.flatnonzero(over)]
        elif step == 20:
            seen, _ = tables.reset(options={"states": states})
            [one.reset(options={"state": state}) for one, state in zip(alone, states, strict=True)]
    assert ends >= 2


class Other:
    """The opponent who plays again what player 1 played, its very actions: they are not made strokes first."""

    def __init__(self, actions):
        self.left = iter(actions)

    def strokes(self, frames, which, crew):
        return np.array([frames.seats[1].actions.check(next(self.left)) for _ in which.tolist()])


@pytest.mark.parametrize("kind", ["misses", "everything said", "a match", "frames of a match", "masks"])
def test_a_frame_between_two_players_goes_as_against_an_opponent(kind, monkeypatch):
    """The observations, sums of rewards, ends and infos of player 0 are those of the agent of ``SnookerEnv``."""
    pytest.importorskip("pettingzoo")
    monkeypatch.setattr(Frames, "carry_out", Frames.prepare)
    flat = {"observation": "flat"} if kind == "masks" else {}  # masks of who waits are zero in a match alone
    options, answered = {"task": "frame"} | PAIRS[kind] | flat, 0
    for seed in range(6):
        match, rng = begun(sn.match_env(**options), seed), np.random.default_rng(seed)
        actions, seen, total = ([], []), [], 0.0
        while not any([*match.terminations.values(), *match.truncations.values()]):
            player = PLAYERS.index(match.agent_selection)
            if player == 0:
                seen.append(match.observe(PLAYERS[0]))
            actions[player].append(two_players_act(match, rng))
            match.step(actions[player][-1])
            total += match.rewards[PLAYERS[0]]
        seen.append(match.observe(PLAYERS[0]))
        env = SnookerEnv(**options, opponent="random")
        env.tables.sit([env.tables.seats[0], Seat.of(env.tables.rules, Other(actions[1]))])
        shown, paid = [env.reset(seed=seed)[0]], 0.0
        for action in actions[0] or [0 * actions[1][0]]:
            one, reward, terminated, truncated, info = env.step(action)
            shown, paid = [*shown, one], paid + reward
        assert not actions[0] or same(shown, seen)
        assert paid == total and terminated == match.terminations[PLAYERS[0]] != truncated
        states = (
            {k: v for k, v in one.get_state().items() if k not in ("unpaid", "due")} for one in (env, match)
        )
        ends = [json.dumps(state) for state in states]
        assert ends[0] == ends[1]
        told = match.infos[PLAYERS[0]]
        names = {"score", "opponent_score", "winner", "frames_won", "strokes", "frame"} & set(told)
        assert {name: info[name] for name in names} == {name: told[name] for name in names}
        answered += len(actions[1])
    assert answered > 20


@pytest.mark.parametrize("seed", [None, 40, [3, None, 8, None]])
def test_a_state_with_seeds_is_what_single_tables_make_of_it(seed):
    """Each seed draws the errors of its table anew; a table without one repeats those of the state."""
    options = {"noise": "professional", "layout": "random:6", "aim": "target"}
    env, other = native(4, **options), OneByOne(4, **options)
    for one in (env, other):
        one.reset(seed=1)
    state, a = env.get_state()[2], np.zeros((4, 4), np.float32)
    for _ in range(2):  # the second time from the middle of other visits
        assert same(*(each.reset(seed=seed, options={"state": state}) for each in (env, other)))
        first = env.step(a)
        assert same(first, other.step(a))
        assert len({row.tobytes() for row in first[0]}) == (1 if seed is None else 4 if seed == 40 else 3)
        assert all(same(env.step(a), other.step(a)) for _ in range(3))
    assert env.get_state() == [one.get_state() for one in other.envs]


def test_a_mask_resets_only_those():
    for mode in MODES:
        env, other = (make(6, layout="random:6", **TARGET) for make in (native, OneByOne))
        assert same(env.reset(seed=1), other.reset(seed=1))
        assert same(env.step(np.zeros((6, 4))), other.step(np.zeros((6, 4))))
        mask = np.array([True, False, True, False, False, True])
        some = (each.reset(seed=20, options={"reset_mask": mask.copy()}) for each in (env, other))
        assert same(*some), mode
