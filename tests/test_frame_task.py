"""Is ``task="frame"`` a whole frame by the rules? Opponents, turns, decisions, rewards, seeds, states, and fifty frames to their end."""

import copy
import inspect
import json
import pickle
from dataclasses import replace

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env, data_equivalence

from benchmarks import frames
from snooker_env.envs import observations
from snooker_env.envs.frame_table import FrameTable
from snooker_env.envs.opponents import GhostBall, algorithm
from snooker_env.envs.shooting import shooter_of
from snooker_env.envs.snooker import SnookerEnv
from snooker_env.game.balls import BLACK, BLUE, CUE, D_RADIUS, N_BALLS, PINK, SPOTS, YELLOW, BallOn
from snooker_env.game.frame import Frame
from snooker_env.game.ruling import Foul

TO_BLUE = 0.0
"""Absolute aim along +x."""


def frame_env(**options):
    return SnookerEnv(**{"task": "frame", "aim": "target", "decision": True, "placement": True} | options)


def put(env, places, frame, **state):
    """Put balls {id: (x, y)} and nothing else on the table, in the middle of a ``Frame`` given by its fields."""
    positions, on_table = SPOTS.copy(), np.zeros(N_BALLS, bool)
    for ball, place in places.items():
        positions[ball], on_table[ball] = place, True
    env.reset(seed=1)
    mask = sum(1 << ball for ball in places if ball)
    fields = {"on_table": mask, "in_hand": False, "miss": env.frames.table.miss} | frame
    plain = Frame(**fields).to_dict()
    saved = {"positions": positions.tolist(), "on_table": on_table.tolist(), "frame": plain}
    env.reset(options={"state": env.get_state() | saved | state})
    return env


# Whole frames


@pytest.mark.parametrize(("kind", "miss", "count"), [("random", "off", 30), ("random", "clear_path", 10), ("ghost_ball", "off", 10)])
def test_whole_frames_end_by_the_rules_with_every_point_and_ball_accounted_for(kind, miss, count):
    tallies = [frames.play_frame(seed, kind, miss) for seed in range(count)]
    ends = {t.ending for t in tallies}
    assert ends <= {"black potted", "foul on the black", "re-spotted black", "third miss"}
    assert ("third miss" in ends) == (miss == "clear_path")
    assert sum(t.fouls for t in tallies) > 0 and all(t.strokes >= 3 for t in tallies)


class Spoiled(GhostBall):
    """A player at whose tenth stroke something goes wrong."""

    def __init__(self, how):
        self.how, self.n = how, 0

    def play(self, table, observe, rng, path):
        played = super().play(table, observe, rng, path)
        self.n += 1
        if self.n == 10:
            self.how(table)
        return played


def _points(table):
    table.frame = replace(table.frame, scores=(table.frame.scores[0] + 1, table.frame.scores[1]))


def _lost(table):
    table.on_table[BLACK] = False


def _doubled(table):
    table.positions[BLACK] = table.positions[PINK]


@pytest.mark.parametrize("how", [_points, _lost, _doubled])
def test_the_checks_of_whole_frames_can_fail(how, monkeypatch):
    monkeypatch.setitem(frames.PLAYERS, "ghost_ball", Spoiled(how))
    with pytest.raises((AssertionError, ValueError)):
        frames.play_frame(3, "ghost_ball", "off")


def test_a_replay_that_differs_is_noticed():
    table = FrameTable(shooter_of("target", False, True, True, "none", "paper", "match", "standard"))
    rng = np.random.default_rng(0)
    table.start(*frames.break_off(rng), breaker=0, in_hand=True)
    text = frames.as_json(table, rng)
    frames.turn(table, frames.PLAYERS["random"], rng)
    want = frames.as_json(table, rng)
    fresh = lambda: FrameTable(table.shooter)  # noqa: E731
    frames.check_replay(text, [want], frames.PLAYERS["random"], fresh)
    with pytest.raises(AssertionError, match="played on otherwise"):
        frames.check_replay(text, [want.replace("0.", "0.1", 1)], frames.PLAYERS["random"], fresh)


# Gymnasium


@pytest.mark.parametrize("observation", observations.OBSERVATIONS)
@pytest.mark.parametrize("opponent", ["none", "random", "ghost_ball"])
def test_gymnasium_checks_it(observation, opponent):
    env = gymnasium.make("Snooker-v0", task="frame", opponent=opponent, observation=observation, layout="random:2", decision=True)
    check_env(env.unwrapped, skip_render_check=True)
    assert env.spec.to_json() and gymnasium.make(gymnasium.envs.registration.EnvSpec.from_json(env.spec.to_json())).spec == env.spec


def test_the_spaces_grow_and_those_of_a_visit_do_not():
    assert SnookerEnv().observation_space.shape == (121,) and SnookerEnv().action_space.shape == (4,)
    assert frame_env().observation_space.shape == (130,) and frame_env().action_space.shape == (7,)
    assert frame_env(observation="balls").observation_space["state"].shape == (20,)
    assert frame_env(decision=False, placement=False).action_space.shape == (4,)
    assert len(observations.FRAME_ENTRIES) == 9


def test_the_default_layout_is_that_of_the_task():
    assert SnookerEnv().layout == "opened" and frame_env().layout == "break_off"
    env = frame_env(layout="colours")
    env.reset(seed=0)
    assert env.ball_on == BallOn.YELLOW and not env.in_hand


def play(env, seed, steps=40):
    rng = np.random.default_rng(seed)
    out = [env.reset(seed=seed)]
    for _ in range(steps):
        out.append(env.reset() if env.over else env.step(rng.uniform(-1, 1, env.action_space.shape)))
    return out


@pytest.mark.parametrize("opponent", ["none", "random", "ghost_ball"])
def test_the_seed_decides_everything(opponent):
    runs = [play(frame_env(opponent=opponent, noise="club", layout="random:3"), seed) for seed in (1, 1, 2)]
    assert data_equivalence(runs[0], runs[1], exact=True)
    assert not data_equivalence(runs[0], runs[2], exact=True)


def test_who_breaks_is_drawn_from_the_seed():
    env = frame_env(opponent="ghost_ball")
    strokes = [env.reset(seed=seed)[1]["opponent_strokes"] for seed in range(30)]
    assert 5 < sum(n > 0 for n in strokes) < 25
    alone = frame_env()
    assert not any(alone.reset(seed=seed)[1]["opponent_strokes"] for seed in range(10))


def test_infos_have_the_same_keys_and_types_at_all_times():
    env = frame_env(opponent="random", layout="random:4")
    infos = [out[-1] for out in play(env, 3, 150)]
    assert len({tuple(sorted((k, type(v).__name__) for k, v in info.items())) for info in infos}) == 1
    assert {"score", "opponent_score", "opponent_strokes", "winner", "choice", "free_ball", "needs_snookers"} <= set(infos[0])
    assert {info["winner"] for info in infos} > {-1} and {info["choice"] for info in infos} == {True, False}


# Turns


PLACES = {CUE: (0.3, 1.1), 1: (0.6, 1.4), 2: (-0.5, 0.2), BLACK: SPOTS[BLACK], PINK: SPOTS[PINK]}
"""Red 1 can be potted along the target line, red 2 is out of the way."""


def test_a_step_ends_when_the_agent_is_to_play_or_the_frame_is_over():
    env = frame_env(opponent="random", layout="random:3")
    for seed in range(10):
        env.reset(seed=seed)
        while not env.over:
            assert env.frames.table.frame.striker == 0
            _, _, terminated, truncated, info = env.step(env.action_space.sample())
            assert terminated == env.over and truncated is False
            assert (info["winner"] >= 0) == terminated
        with pytest.raises(gymnasium.error.ResetNeeded):
            env.step(np.zeros(7))


def test_the_agent_stays_while_it_scores_and_the_opponent_comes_after_a_miss():
    env = put(frame_env(opponent="ghost_ball"), PLACES, {})
    _, reward, _, _, info = env.step([-0.5, 0, 0, 0, 0, 0, 0])
    assert (reward, info["points"], info["opponent_strokes"], env.ball_on) == (1.0, 1.0, 0, BallOn.ANY_COLOUR)
    _, _, _, _, info = env.step([-0.9, 0, 0, 1.0, 0, 0, 0])
    assert info["points"] == 0.0 and info["opponent_strokes"] > 0


def test_alone_a_miss_and_a_foul_hand_the_table_back():
    places = {CUE: (0.0, -0.5), 1: (0.6, 1.4), BLUE: (0.3, -0.5), PINK: SPOTS[PINK], BLACK: SPOTS[BLACK]}
    env = put(frame_env(aim="absolute"), places, {})
    before = env.positions[BLUE].copy()
    _, reward, terminated, _, info = env.step([-0.9, 0, 0, TO_BLUE, 0, 0, 0])
    assert (reward, info["fouls"], info["opponent_score"], info["opponent_strokes"]) == (-5.0, Foul.WRONG_FIRST, 5.0, 0)
    assert not terminated and not env.frames.table.frame.free_ball and env.frames.table.frame.phase == "stroke"
    assert not np.array_equal(env.positions[BLUE], before)  # from where the balls lie


def test_a_cue_ball_in_hand_stands_in_the_d_and_is_played_from_where_it_is_placed():
    env = put(frame_env(opponent="ghost_ball"), {1: (0.6, 1.4), BLACK: SPOTS[BLACK], CUE: (D_RADIUS / 2, -1.0475)}, {"in_hand": True})
    assert env.in_hand and env.on_table[CUE]
    env.render_mode = "ansi"
    env.step([-0.9, 0, 0, 0, -1.0, -1.0, 0])
    twin = put(frame_env(), {1: (0.6, 1.4), BLACK: SPOTS[BLACK], CUE: (D_RADIUS / 2, -1.0475)}, {"in_hand": True})
    twin.render_mode = "ansi"
    twin.step([-0.9, 0, 0, 0, -1.0, -1.0, 0])
    assert np.allclose(twin.last_shot.at(0.0)[0][CUE], (-D_RADIUS, -1.0475))


# Decisions


FOULED = {"phase": "choice", "striker": 0, "scores": (0, 4)}


@pytest.mark.parametrize(("decision", "own"), [(0.0, True), (-0.33, True), (1.0, True), (-0.34, False), (-1.0, False)])
def test_after_a_foul_the_action_decides(decision, own):
    """Without a miss called, "replace" is no option and means to play."""
    env = put(frame_env(opponent="ghost_ball"), PLACES, FOULED)
    assert env.frames.observe()[-3] == 1.0  # a decision is open
    _, _, _, _, info = env.step([-0.5, 0, 0, 0, 0, 0, decision])
    assert (info["events"] > 0) == own
    assert own or info["opponent_strokes"] > 0


def test_without_the_option_the_agent_always_plays():
    env = put(frame_env(opponent="ghost_ball", decision=False), PLACES, FOULED)
    assert env.step([-0.5, 0, 0, 0, -1.0, -1.0])[4]["events"] > 0


def test_replacing_after_a_miss_brings_the_balls_back():
    shooter = shooter_of("absolute", False, True, True, "none", "paper", "match", "standard")
    table, rng = FrameTable(shooter, miss="clear_path"), np.random.default_rng(0)
    table.start(*frames.break_off(rng), breaker=0, in_hand=True)
    table.place(*SPOTS[CUE])
    before = table.positions.tobytes()
    table.play((1.0, 0.0, 0.0, -np.pi / 2, 0.0), rng)  # at the bottom cushion, hitting nothing
    assert table.frame.choices == ("play", "play_again", "replace") and table.positions.tobytes() != before
    after = json.loads(json.dumps(table.get_state()))
    table.set_state(after)
    assert table.act([0, 0, 0, 0, 0, 0, 1.0], rng) is None
    assert table.positions.tobytes() == before and table.frame.striker == 0 and table.frame.in_hand


def test_a_free_ball_is_seen_and_scores():
    places = {CUE: (0.3, 1.1), BLUE: (0.6, 1.4), 1: (-0.5, -1.2), PINK: SPOTS[PINK], BLACK: (0.0, 0.0)}
    env = put(frame_env(opponent="ghost_ball"), places, FOULED | {"free_ball": True})
    assert env.on >> BLUE & 1 and env.on >> 1 & 1 and env.frames.observe()[-4] == 1.0
    _, reward, _, _, info = env.step([-0.5, 0, 0, 0, 0, 0, 0])
    assert (reward, info["points"], env.ball_on) == (1.0, 1.0, BallOn.ANY_COLOUR)
    assert np.array_equal(env.positions[BLUE], SPOTS[BLACK])  # it came back; its own spot is taken
    plain = put(frame_env(opponent="ghost_ball"), places, FOULED)
    assert not plain.on >> BLUE & 1


# Rewards


@pytest.mark.parametrize("opponent", ["none", "random", "ghost_ball"])
def test_points_add_up_to_the_difference_and_win_says_who_won(opponent):
    for seed in range(4):
        totals = {}
        for reward in ("points", "win"):
            env = frame_env(opponent=opponent, reward=reward, layout="random:2", noise="club")
            env.reset(seed=seed)
            start = env.frames.table.frame.scores
            rng, total, steps = np.random.default_rng(seed), 0.0, 0
            while not env.over:
                _, r, _, _, info = env.step(rng.uniform(-1, 1, 7))
                total, steps = total + r, steps + 1
                assert reward == "points" or (r == 0.0) != env.over
            totals[reward] = total
        assert totals["points"] == info["score"] - info["opponent_score"] - (start[0] - start[1])
        assert totals["win"] == (1.0 if info["winner"] == 0 else -1.0)


# Opponents


def test_any_callable_may_play_and_sees_the_table_from_its_own_side():
    seen = []

    def opponent(observation, rng):
        seen.append(observation)
        return np.array([-0.9, 0, 0, rng.uniform(-1, 1), 0, 0, 0])

    env = put(frame_env(opponent=opponent), PLACES, {"scores": (31, 62)})
    env.step([-0.9, 0, 0, 1.0, 0, 0, 0])
    assert seen and env.observation_space.contains(seen[0])
    own, other, lead = seen[0][121:124] * 155
    assert own == pytest.approx(62 + env.frames.table.frame.scores[1] - env.frames.table.frame.scores[1], abs=7.1)
    assert other == pytest.approx(31, abs=7.1) and lead == pytest.approx(own - other, abs=1e-3)


def test_what_a_callable_answers_is_checked():
    env = frame_env(opponent=lambda observation, rng: np.zeros(3))
    with pytest.raises(ValueError, match=r"the opponent's action = .*must have shape \(7,\)"):
        [env.reset(seed=seed) for seed in range(10)]


def test_the_ghost_ball_player_pots_what_is_there():
    rng, potted = np.random.default_rng(0), 0
    shooter = shooter_of("absolute", False, False, False, "none", "paper", "match", "standard")
    for _ in range(60):
        table = FrameTable(shooter)
        table.start(*frames_layout("pots:easy", rng), breaker=0, in_hand=False)
        potted += GhostBall().play(table, None, rng, False).verdict.points
    assert potted > 30


def frames_layout(name, rng):
    from snooker_env.game.layouts import layout

    return layout(name, rng)


def test_the_ghost_ball_player_beats_the_random_one():
    wins = 0
    for seed in range(8):
        env = frame_env(opponent="ghost_ball", decision=False)
        env.reset(seed=seed)
        rng = np.random.default_rng(seed)
        while not env.over:
            env.step(rng.uniform(-1, 1, 6))
        wins += env.frames.table.frame.winner
    assert wins >= 7


@pytest.mark.parametrize("name", ["A2C", "TD3", "DDPG", "TQC", "TRPO"])
def test_who_saved_a_model_is_read_from_it(tmp_path, name):
    library = pytest.importorskip("sb3_contrib" if name in ("TQC", "TRPO") else "stable_baselines3")
    getattr(library, name)("MlpPolicy", SnookerEnv(), device="cpu").save(tmp_path / "model.zip")
    assert issubclass(getattr(library, name), algorithm(tmp_path / "model.zip"))  # DDPG is a TD3


@pytest.mark.parametrize(("task", "name"), [("visit", "PPO"), ("frame", "SAC")])
def test_a_saved_model_may_play(tmp_path, task, name):
    sb3 = pytest.importorskip("stable_baselines3")
    options = {"aim": "target", "placement": True, "layout": "random:2"}
    trained = getattr(sb3, name)("MlpPolicy", SnookerEnv(task=task, **options), seed=1, device="cpu")
    path = str(tmp_path / "model.zip")
    trained.save(path)
    assert algorithm(path) is getattr(sb3, name)
    for decision in (False, True):
        env = SnookerEnv(task="frame", opponent=path, decision=decision, **options)
        runs = []
        for one in (env, copy.deepcopy(env), pickle.loads(pickle.dumps(env))):
            one.reset(seed=2)
            out = [one.step(np.zeros(one.action_space.shape)) for _ in range(3) if not one.over]
            runs.append(out)
            assert one.frames.opponent.policy._model is not None
        assert data_equivalence(runs[0], runs[1], exact=True) and data_equivalence(runs[0], runs[2], exact=True)


def test_a_model_of_another_environment_is_refused(tmp_path):
    sb3 = pytest.importorskip("stable_baselines3")
    sb3.PPO("MlpPolicy", "CartPole-v1", device="cpu").save(tmp_path / "cart.zip")
    env = frame_env(opponent=str(tmp_path / "cart.zip"), layout="random:2")
    with pytest.raises(ValueError, match=r"opponent = .*must be a model for observation"):
        [env.reset(seed=seed) for seed in range(10)]


# States


@pytest.mark.parametrize("opponent", ["none", "random", "ghost_ball"])
def test_a_saved_state_plays_on_bit_for_bit(opponent):
    options = {"opponent": opponent, "noise": "club", "miss": "clear_path", "layout": "random:6"}
    env = frame_env(**options)
    play(env, 5, 7)
    text = json.dumps(env.get_state())
    other = frame_env(**options)
    obs, _ = other.reset(options={"state": json.loads(text)})
    assert data_equivalence(obs, env.frames.observe(), exact=True) and json.dumps(other.get_state()) == text
    for _ in range(30):
        if env.over:
            break
        action = np.random.default_rng(0).uniform(-1, 1, 7)
        assert data_equivalence(env.step(action), other.step(action), exact=True)
    assert json.dumps(other.get_state()) == json.dumps(env.get_state())


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda s: s.pop("frame"), "missing"),
        (lambda s: s["frame"].update(miss="clear_path"), "as this environment plays"),
        (lambda s: s["on_table"].__setitem__(YELLOW, False), "must hold the cue ball"),
        (lambda s: s["frame"].update(phase="end"), "phase"),
    ],
)
def test_states_that_are_not_sound_are_refused(change, message):
    env = frame_env()
    env.reset(seed=1)
    state = json.loads(json.dumps(env.get_state()))
    change(state)
    with pytest.raises(ValueError, match=message):
        env.set_state(state)


@pytest.mark.parametrize("mode", ["rgb_array", "ansi"])
def test_pictures(mode):
    if mode == "rgb_array":
        pytest.importorskip("pygame")
    env, plain = frame_env(render_mode=mode, opponent="ghost_ball"), frame_env(opponent="ghost_ball")
    env.reset(seed=1), plain.reset(seed=1)
    first = env.render()
    assert data_equivalence(env.step(np.zeros(7)), plain.step(np.zeros(7)), exact=True)  # looking changes nothing
    assert not np.array_equal(first, env.render())
    assert mode != "ansi" or " - " in env.render()


def test_every_argument_is_documented():
    for name in inspect.signature(SnookerEnv.__init__).parameters:
        assert name in SnookerEnv.__doc__ or name == "self"
