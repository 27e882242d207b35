"""Is what RLlib's runners collect what the tables play, and are the kept weights those of its module?"""

from pathlib import Path

import numpy as np
import pytest

from snooker_env import SnookerEnv
from snooker_env.planning.learned.dense_layers import Layers
from tests.trainers import needed

ray = needed("ray")
config, run = needed("agents.trainers.rllib_config"), needed("agents.trainers.rllib_run")
ROOT = Path(__file__).parents[3]
SETTINGS = run.RunSettings(runners=2, envs=8, noise="club", layout="random:3", seed=4)


@pytest.fixture(scope="module")
def algorithm():
    """An untrained one with two runners of eight tables."""
    config.started(2, str(ROOT))
    made = config.algorithm_of(SETTINGS, SETTINGS.seed)
    yield made
    made.stop()
    ray.shutdown()


def test_what_runners_collect_is_what_single_tables_play(algorithm):
    """Each table has a seed of its own; steps that only reset are left out; every choice was available."""
    samples = algorithm.env_runner_group.foreach_env_runner(
        lambda runner: runner.sample(num_timesteps=160), local_env_runner=False
    )
    first, ends, matched = {}, 0, set()
    own = [seed for runner in (1, 2) for seed in config.seeds_of_runner(4, runner, SETTINGS.envs)]
    # of both runners, and of worker 0, who has no part in it
    for seed in [*own, *config.seeds_of_runner(4, 0, SETTINGS.envs)]:
        env = SnookerEnv(action="discrete", observation="masked", **SETTINGS.env_options)
        first[env.reset(seed=seed)[0]["observations"].tobytes()] = seed
    for episodes in samples:
        assert sum(len(episode) for episode in episodes) >= 160
        for episode in episodes:
            episode = episode.to_numpy()
            seen, actions = episode.get_observations(), episode.get_actions()
            available = np.take_along_axis(seen["action_mask"][:-1], np.asarray(actions)[:, None], axis=1)
            assert available.all() and len(seen["observations"]) == len(actions) + 1
            ends += episode.is_terminated
            assert not episode.is_truncated
            seed = first.get(seen["observations"][0].tobytes())
            if seed is None:
                continue  # a later visit of some table
            matched.add(seed)
            env = SnookerEnv(action="discrete", observation="masked", **SETTINGS.env_options)
            row, _ = env.reset(seed=seed)
            for t, action in enumerate(actions):
                assert np.array_equal(row["observations"], seen["observations"][t])
                assert np.array_equal(row["action_mask"], seen["action_mask"][t])
                row, reward, terminated, _, _ = env.step(int(action))
                assert reward == episode.get_rewards()[t]
                assert terminated == (episode.is_terminated and t == len(actions) - 1)
            assert np.array_equal(row["observations"], seen["observations"][-1])
            assert np.array_equal(row["action_mask"], seen["action_mask"][-1])
    assert ends > 60 and matched == set(own)


def test_the_weights_that_are_kept_are_those_of_the_module(algorithm):
    torch = needed("torch")
    module = algorithm.get_module("default_policy")
    env = SnookerEnv(action="discrete", observation="masked")
    rows = [env.reset(seed=seed)[0] for seed in range(20)]
    batch = {name: torch.from_numpy(np.stack([row[name] for row in rows])) for name in rows[0]}
    flat, masks = batch["observations"].numpy(), batch["action_mask"].numpy().astype(bool)
    with torch.no_grad():
        found = module.forward_inference({"obs": dict(batch)})["action_dist_inputs"].numpy()
    scores = Layers(config.layers_of(algorithm), config.ACTIVATION)(flat)
    assert np.allclose(found[masks], scores[masks], atol=1e-5) and (found[~masks] < -1e37).all()
    assert not masks.all()


def test_no_two_tables_of_a_run_or_of_neighbouring_runs_have_one_seed():
    """Whatever the number of runners and tables, also after a resume, whose part has a seed of its own."""
    parts = [0, 1, 8, 8192, run.SEEDS, run.SEEDS + 1]
    seeds = [
        one for seed in parts for runner in range(1, 9) for one in config.seeds_of_runner(seed, runner, 8192)
    ]
    assert len(set(seeds)) == len(seeds)
    assert config.seeds_of_runner(3, 2, 5) == config.seeds_of_runner(3, 2, 8)[:5]
