"""Do frames and matches go alike in ``SnookerEnv``, ``SnookerVectorEnv`` and ``MatchEnv``, bit for bit?"""

import json

import numpy as np
import pytest

import snooker_env as sn
from snooker_env import SnookerVectorEnv
from snooker_env.envs.match import PLAYERS
from snooker_env.tasks.frames import Frames, Seat
from tests.tables import begun, plain

pytest.importorskip("pettingzoo")

SAYS = ["nominate", "decision", "concede", "claim", "lot"]
PLAIN = {"aim": "target", "noise": "club", "placement": True, "says": ["decision"]}
SAID = {"says": ["nominate", "concede", "claim", "lot"]}
CHOICES = {"action": "discrete", "noise": "amateur"}
FRAMES = {"layout": "colours", "reward": "frames", "miss": "clear_path"}
KINDS = {
    "plain": PLAIN | {"task": "frame", "layout": "random:1"},
    "miss": PLAIN | {"task": "frame", "layout": "random:2", "miss": "clear_path", "reward": "win"},
    "everything said": PLAIN | {"says": SAYS} | {"task": "frame", "layout": "random:1", "miss": "clear_path"},
    "a match": PLAIN
    | {"says": SAYS}
    | {"task": "match", "frames": 3, "layout": "random:0", "max_strokes": 90},
    "frames of a match": PLAIN | FRAMES | {"task": "match", "frames": 5},
    "discrete": SAID | CHOICES | {"task": "match", "frames": 3, "layout": "random:1"},
}


class Played:
    """A random frame or match: the actions of both players, and what player 0 was shown at its turns."""

    def __init__(self, options, seed):
        env = begun(sn.match_env(**options), seed)
        self.key = int(env.tables.streams[0, 0])
        self.actions, self.seen = ([], []), []
        self.total, rng = 0.0, np.random.default_rng(seed)
        while not any(env.terminations.values()) and not any(env.truncations.values()):
            player = PLAYERS.index(env.agent_selection)
            if player == 0:
                self.seen.append(env.observe(PLAYERS[0]).tobytes())
            self.actions[player].append(self._action(env, rng))
            env.step(self.actions[player][-1])
            self.total += env.rewards[PLAYERS[0]]
        self.seen.append(env.observe(PLAYERS[0]).tobytes())
        self.end = _end(env.get_state())
        self.ended = any(env.terminations.values()), any(env.truncations.values())
        names = {"score", "opponent_score", "winner", "frames_won", "strokes", "frame"}
        info = env.infos[PLAYERS[0]]
        self.info = {name: info[name] for name in names & set(info)}

    def action(self, step):
        """That of player 0 at its turn, and any one where it had none or the end has come."""
        mine = self.actions[0]
        return mine[step] if step < len(mine) else 0 * (mine or self.actions[1])[0]

    def _action(self, env, rng):
        if env.options.action == "discrete":
            mask = env.action_mask(env.agent_selection)
            if rng.uniform() > 0.02 and "concede" in env.options.says:
                mask[3780] = False
            return int(rng.choice(np.flatnonzero(mask)))
        a = rng.uniform(-1, 1, env.action_space(PLAYERS[0]).shape)
        a[1:4] *= 0.3
        if "concede" in env.options.says and rng.uniform() > 0.02:
            a[-1] = abs(a[-1])
        return a


def _end(state):
    """What must agree at the end, in every bit: nobody is paid in the same places."""
    return json.dumps({key: value for key, value in state.items() if key not in ("unpaid", "due")})


class Other:
    """The opponent who plays again what player 1 played, its very actions: they are not made strokes first."""

    def __init__(self, played):
        self.left = {one.key: iter(one.actions[1]) for one in played}
        self.nothing = 0 * (played[0].actions[0] + played[0].actions[1])[0]

    def strokes(self, frames, which, crew):
        actions = np.zeros((frames.n, frames.seats[1].actions.size))
        for k in which.tolist():
            wished = next(self.left[int(frames.streams[k, 0])], self.nothing)
            actions[k] = frames.seats[1].actions.check(wished)
        return actions


def against(played, env):
    """The environment with that opponent in place of its own."""
    tables = env.tables
    tables.sit([tables.seats[0], Seat.of(tables.rules, Other(played))])
    return env


@pytest.fixture(autouse=True)
def as_actions(monkeypatch):
    """What the opponent is asked for are actions."""
    monkeypatch.setattr("snooker_env.tasks.frames.carry_out", Frames.prepare)


def check_alike(options, seeds):
    played = [Played(options, seed) for seed in seeds]
    for seed, one in zip(seeds, played, strict=True):
        env = against([one], sn.SnookerEnv(**options, opponent="random"))
        shown, _ = env.reset(seed=seed)
        seen, total = [shown.tobytes()], 0.0
        for step in range(max(1, len(one.actions[0]))):
            shown, reward, terminated, truncated, info = env.step(one.action(step))
            seen.append(shown.tobytes())
            total += reward
        if one.actions[0]:
            assert seen == one.seen
        assert (terminated, truncated) == one.ended and total == one.total
        assert _end(env.get_state()) == one.end
        assert {name: info[name] for name in one.info} == one.info
    n = len(seeds)
    tables = begun(against(played, SnookerVectorEnv(n, **options, opponent="random", threads=1)), list(seeds))
    totals, over = np.zeros(n), np.zeros(n, bool)
    for step in range(max(1, *(len(one.actions[0]) for one in played))):
        actions = np.array([one.action(step) for one in played])
        shown, rewards, terminated, truncated, info = tables.step(actions)
        totals += np.where(over, 0.0, rewards)
        for k in np.flatnonzero((terminated | truncated) & ~over).tolist():
            one, over[k] = played[k], True
            assert step + 1 == max(1, len(one.actions[0])) and shown[k].tobytes() == one.seen[-1]
            assert (bool(terminated[k]), bool(truncated[k])) == one.ended
            assert _end(tables.get_state()[k]) == one.end
            assert {name: info[name][k].item() for name in one.info} == one.info
    assert over.all() and totals.tolist() == [one.total for one in played]
    return played


@pytest.mark.parametrize("kind", KINDS)
def test_random_play_ends_alike_in_all_three(kind):
    played = check_alike(KINDS[kind], range(6))
    assert sum(len(one.actions[1]) for one in played) > 20


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_two_hundred_frames_of_random_play_end_alike_in_all_three(kind):
    check_alike(KINDS[kind], range(100, 136))


def test_a_match_goes_on_from_its_state_bit_for_bit():
    """Saved in the middle of the second frame, as JSON, and played on in another environment."""
    options = KINDS["everything said"] | {"task": "match", "frames": 5, "layout": "random:0"}
    env, other = sn.match_env(**options), sn.match_env(**options)
    env.reset(seed=5)
    rng, state = np.random.default_rng(1), None
    for _ in range(3000):
        if any(env.terminations.values()):
            break
        action = rng.uniform(-1, 1, env.action_space("player_0").shape)
        action[-1] = abs(action[-1])
        env.step(action)
        if state is None and env.infos["player_0"]["frame"] == 1 and env.strokes > 3:
            state = plain(env.get_state())
            other.reset(options={"state": state})
        elif state is not None:
            other.step(action)
            assert json.dumps(other.get_state()) == json.dumps(env.get_state())
            assert other.rewards == env.rewards
            assert other.observe("player_1").tobytes() == env.observe("player_1").tobytes()
    assert state is not None and sum(state["frames"]) == 1 and max(env.get_state()["frames"]) == 3
    before = plain(other.get_state())
    for field, wrong in (("frames", [3, 0]), ("first_break", 2), ("frames", 1), ("best_of", 3)):
        with pytest.raises(ValueError, match=rf"state\.{field}"):
            other.reset(options={"state": state | {field: wrong}})
    assert plain(other.get_state()) == before
