"""How does RLlib train on this environment? PPO of the new API stack, with masks, on vector environments.

An env runner is a process of Ray with one ``SnookerVectorEnv``, which RLlib resets in the step after an end
(NEXT_STEP) and leaves that step out by itself. Its own ``ActionMaskingTorchRLModule`` reads
``observation="masked"``, adds the logarithm of the mask to the scores, and is for PPO alone.
"""

from typing import Any

import numpy as np
import ray
from ray import tune
from ray.rllib.algorithms.ppo import PPOConfig
from ray.rllib.core import DEFAULT_MODULE_ID
from ray.rllib.core.rl_module.default_model_config import DefaultModelConfig
from ray.rllib.core.rl_module.rl_module import RLModuleSpec
from ray.rllib.examples.rl_modules.classes.action_masking_rlm import ActionMaskingTorchRLModule

from snooker_env import SnookerVectorEnv

ENV = "snooker_env-masked"
HIDDEN, ACTIVATION = (256, 256), "tanh"
BATCH = 8192
"""Shots between two updates, of all runners together."""
GAMMA = 0.95
SETTINGS: dict[str, Any] = {"train_batch_size": BATCH, "minibatch_size": 2048, "num_epochs": 4, "lr": 1e-3}
SETTINGS |= {"gamma": GAMMA, "lambda_": 0.5, "entropy_coeff": 0.003, "clip_param": 0.2, "use_kl_loss": False}
SETTINGS |= {"vf_loss_coeff": 0.01, "vf_clip_param": 1e6, "grad_clip": 0.5, "grad_clip_by": "global_norm"}
"""Of ``hyperparams/ppo_mask.yml``, as RLlib has them; its clipping of values and KL penalty are off."""
PATIENCE = 600.0
"""Seconds in which a runner must give its sample: RLlib's own minute is too short for a busy machine."""
MEMORY = 2**28
"""Bytes of Ray's object store: a sample of 8,192 shots takes 10 MB."""


class RunnerTables(SnookerVectorEnv):
    """The tables of one runner. RLlib gives runner w the seed + w, and so nearly the tables of the one before:
    these begin with ``seeds_of_runner``."""

    own_seeds: list[int | None] | None = None

    def reset(self, *, seed=None, options=None, out=None):
        """As ``SnookerVectorEnv.reset``, with the runner's own seeds."""
        return super().reset(seed=seed if seed is None else self.own_seeds, options=options, out=out)


def seeds_of_runner(seed, runner, n):
    """Seeds of its n tables, 64 bits each: nothing in common with other runners and runs."""
    return np.random.SeedSequence(seed, spawn_key=(runner,)).generate_state(n, np.uint64).tolist()


def _tables(context):
    return RunnerTables(**context)


def _own_seeds(*, env, env_context, env_runner, **more):
    """RLlib calls it in each runner that has its tables; ``worker_index`` 0 is the main process."""
    if env_runner.config.seed is not None:
        env.own_seeds = seeds_of_runner(env_runner.config.seed, env_context.worker_index, env.num_envs)


def started(runners, paths):
    """Start Ray on this machine, for so many runners, whose processes find modules in ``paths``."""
    variables = {"PYTHONPATH": paths, "OMP_NUM_THREADS": "1", "SNOOKER_ENV_QUIET": "1"}
    quiet = {"include_dashboard": False, "log_to_driver": False, "logging_level": "ERROR"}
    small = {"num_cpus": runners + 1, "object_store_memory": MEMORY}
    ray.init("local", runtime_env={"env_vars": variables}, **small, **quiet)


def algorithm_of(settings, seed):
    """A new PPO of RLlib, by ``rllib_run.RunSettings``; ``seed``: of weights, tables and exploration."""
    tune.register_env(ENV, _tables)
    network = DefaultModelConfig(fcnet_hiddens=list(HIDDEN), fcnet_activation=ACTIVATION)
    options = {"action": "discrete", "observation": "masked", "threads": 1, **settings.env_options}
    config = (
        PPOConfig()
        .environment(ENV, env_config=options)
        .env_runners(
            num_env_runners=settings.runners,
            num_envs_per_env_runner=settings.envs,
            gym_env_vectorize_mode="vector_entry_point",
            rollout_fragment_length="auto",
            sample_timeout_s=PATIENCE,
        )
        .learners(num_learners=0)
        .training(**SETTINGS)
        .rl_module(rl_module_spec=RLModuleSpec(module_class=ActionMaskingTorchRLModule, model_config=network))
        .callbacks(on_environment_created=_own_seeds)
        .debugging(seed=seed, log_level="ERROR")
    )
    return config.build_algo()


def restore(algorithm, folder):
    """Go on from a checkpoint, its weights sent at once: RLlib's runners would begin with new ones."""
    algorithm.restore_from_path(str(folder))
    learner = algorithm.learner_group
    algorithm.env_runner_group.sync_weights(
        from_worker_or_learner_group=learner, timeout_seconds=PATIENCE, inference_only=True
    )


def layers_of(algorithm):
    """The weights of its policy, as ``dense_layers.Layers`` takes them."""
    state = algorithm.get_module(DEFAULT_MODULE_ID).get_state()
    names = [f"encoder.encoder.net.mlp.{2 * k}" for k in range(len(HIDDEN))] + ["pi.net.mlp.0"]
    return [(state[f"{name}.weight"], state[f"{name}.bias"]) for name in names]
