"""Is what RLlib's runners collect what the tables play, and does its policy play by our protocol?"""

import numpy as np
import pytest

from agents.players.trained import load_player
from snooker_env import SnookerEnv
from snooker_env.benchmark import play_visits
from tests.processes import ROOT
from tests.trainers import needed

ray = needed("ray")
example = needed("examples.ppo_rllib")


@pytest.mark.slow
def test_what_runners_collect_is_what_single_tables_play():
    """Each table has a seed of its own; steps that only reset are left out; every choice was available."""
    ray.init("local", num_cpus=3, runtime_env={"env_vars": {"PYTHONPATH": str(ROOT)}}, log_to_driver=False)
    algorithm, first, matched = example.algorithm_of(2, 8, 4), {}, set()
    samples = algorithm.env_runner_group.foreach_env_runner(
        lambda runner: runner.sample(num_timesteps=160), local_env_runner=False
    )
    algorithm.stop()
    ray.shutdown()
    options = {"action": "discrete", "observation": "masked", **example.OPTIONS}
    for runner in (1, 2):
        for seed in np.random.SeedSequence(4, spawn_key=(runner,)).generate_state(8, np.uint64).tolist():
            first[SnookerEnv(**options).reset(seed=seed)[0]["observations"].tobytes()] = seed
    assert len(first) == 16
    for episode in (one.to_numpy() for episodes in samples for one in episodes):
        seen, actions = episode.get_observations(), np.asarray(episode.get_actions())
        assert np.take_along_axis(seen["action_mask"][:-1], actions[:, None], axis=1).all()
        assert len(seen["observations"]) == len(actions) + 1 and not episode.is_truncated
        seed = first.get(seen["observations"][0].tobytes())
        if seed is None:
            continue  # a later visit of some table
        matched.add(seed)
        env = SnookerEnv(**options)
        row, _ = env.reset(seed=seed)
        for t, action in enumerate(actions):
            assert np.array_equal(row["observations"], seen["observations"][t])
            row, reward, terminated, _, _ = env.step(int(action))
            assert reward == episode.get_rewards()[t]
            assert terminated == (episode.is_terminated and t == len(actions) - 1)
        assert np.array_equal(row["observations"], seen["observations"][-1])
    assert matched == set(first.values())


def test_it_trains_and_its_policy_plays(tmp_path, monkeypatch):
    monkeypatch.chdir(ROOT)
    example.main(["--steps", "1", "--out", str(tmp_path / "rllib.npz")])
    player = load_player(tmp_path / "rllib.npz")
    assert player.model.num_timesteps >= 8192 and len(play_visits(player, 4).points) >= 4
