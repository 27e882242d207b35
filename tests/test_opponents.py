"""Who may play against the agent, and how well does he? Callables, the ghost-ball player, saved models."""

import copy
import pickle
from pathlib import Path

import numpy as np
import pytest
from gymnasium.utils.env_checker import data_equivalence

from snooker_env.envs.frame_table import FrameTable
from snooker_env.envs.opponents import GhostBall, algorithm
from snooker_env.envs.shooting import shooter_of
from snooker_env.envs.snooker import SnookerEnv
from snooker_env.game.layouts import layout
from tests.tables import PLACES, frame_env, frame_state


def test_any_callable_may_play_and_sees_the_table_from_its_own_side():
    seen = []

    def opponent(observation, rng):
        seen.append(observation)
        return np.array([-0.9, 0, 0, rng.uniform(-1, 1), 0, 0, 0])

    env = frame_state(frame_env(opponent=opponent), PLACES, {"scores": (31, 62)})
    env.step([-0.9, 0, 0, 1.0, 0, 0, 0])
    assert seen and env.observation_space.contains(seen[0])
    own, other, lead = seen[0][121:124] * 155
    assert (own, other, lead) == pytest.approx((62, 31, 31), abs=1e-3)  # the stroke before was fair and scored nothing


def test_what_a_callable_answers_is_checked():
    env = frame_env(opponent=lambda observation, rng: np.zeros(3))
    with pytest.raises(ValueError, match=r"the opponent's action = .*must have shape \(7,\)"):
        [env.reset(seed=seed) for seed in range(10)]


def test_the_ghost_ball_player_pots_what_is_there():
    rng, potted = np.random.default_rng(0), 0
    shooter = shooter_of("absolute", False, False, False, "none", "paper", "match", "standard")
    for _ in range(60):
        table = FrameTable(shooter)
        table.start(*layout("pots:easy", rng), breaker=0, in_hand=False)
        potted += GhostBall().play(table, None, rng, False).verdict.points
    assert potted > 30


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
    sb3.PPO("MlpPolicy", "Pendulum-v1", device="cpu").save(tmp_path / "pendulum.zip")
    env = frame_env(opponent=str(tmp_path / "pendulum.zip"), layout="random:2")
    with pytest.raises(ValueError, match=r"opponent = .*must be a model that sees observation"):
        [env.reset(seed=seed) for seed in range(10)]


def test_a_model_that_chooses_among_pots_is_refused_at_once():
    """A frame has no such action; before anything is played."""
    pytest.importorskip("sb3_contrib")
    with pytest.raises(ValueError, match=r"opponent = .*ppo_mask.zip': must be a model whose actions are a Box"):
        frame_env(opponent=str(Path(__file__).parents[1] / "agents/pretrained/ppo_mask.zip"))
