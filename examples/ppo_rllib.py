"""How does RLlib train on this environment? With PPO of its new API stack, masks and vector environments.

    pip install -e ".[rllib]"
    python -m examples.ppo_rllib --out runs/rllib.npz              300,000 shots with one env runner: a few minutes
    python -m agents.evaluate --agent runs/rllib.npz               compare with any other agent

RLlib resets a table in the step after an end (NEXT_STEP) and ignores that step. Its ``ActionMaskingTorchRLModule``
reads ``observation="masked"`` and adds the logarithm of the mask to the scores. Checkpoints are RLlib's:
``algorithm.save_to_path`` and ``restore_from_path``.
"""

import argparse
import os
from pathlib import Path
from typing import Any

import numpy as np
import ray
from ray import tune
from ray.rllib.algorithms.ppo import PPOConfig
from ray.rllib.core import DEFAULT_MODULE_ID
from ray.rllib.core.rl_module.default_model_config import DefaultModelConfig
from ray.rllib.core.rl_module.rl_module import RLModuleSpec
from ray.rllib.examples.rl_modules.classes.action_masking_rlm import ActionMaskingTorchRLModule

import snooker_env
from agents.learning.policy_files import write_policy
from snooker_env.progress import Progress

HIDDEN, GAMMA, OPTIONS = (256, 256), 0.95, {"noise": "professional", "layout": "opened"}
SETTINGS: dict[str, Any] = {"train_batch_size": 8192, "minibatch_size": 2048, "num_epochs": 4, "lr": 1e-3}
SETTINGS |= {"gamma": GAMMA, "lambda_": 0.5, "entropy_coeff": 0.003, "clip_param": 0.2, "use_kl_loss": False}
SETTINGS |= {"vf_loss_coeff": 0.01, "vf_clip_param": 1e6, "grad_clip": 0.5, "grad_clip_by": "global_norm"}


class RunnerTables(snooker_env.SnookerVectorEnv):
    """Make the tables of one runner. RLlib gives runner w the seed + w, which would repeat most tables of the previous runner;
    these tables use 64-bit seeds that no other runner has."""

    own_seeds: list[int | None] | None = None

    def reset(self, *, seed=None, options=None):
        return super().reset(seed=seed if seed is None else self.own_seeds, options=options)


def own_seeds(*, env, env_context, env_runner, **more):
    """RLlib calls this in each runner with tables."""
    if env_runner.config.seed is not None:
        drawn = np.random.SeedSequence(env_runner.config.seed, spawn_key=(env_context.worker_index,))
        env.own_seeds = drawn.generate_state(env.num_envs, np.uint64).tolist()


def algorithm_of(runners, tables, seed, **settings):
    """Make a PPO with ``runners`` processes of ``tables`` tables each."""
    tune.register_env("snooker", lambda context: RunnerTables(**context))
    network = DefaultModelConfig(fcnet_hiddens=list(HIDDEN), fcnet_activation="tanh")
    config = PPOConfig().environment(
        "snooker", env_config={"action": "discrete", "observation": "masked", "threads": 1, **OPTIONS}
    )
    how: dict[str, Any] = {"gym_env_vectorize_mode": "vector_entry_point", "rollout_fragment_length": "auto"}
    config.env_runners(num_env_runners=runners, num_envs_per_env_runner=tables, sample_timeout_s=600.0, **how)
    config.learners(num_learners=0).training(**SETTINGS | settings).debugging(seed=seed, log_level="ERROR")
    config.rl_module(
        rl_module_spec=RLModuleSpec(module_class=ActionMaskingTorchRLModule, model_config=network)
    )
    return config.callbacks(on_environment_created=own_seeds).build_algo()


def layers_of(algorithm):
    """The policy's weights in the form for ``write_policy``."""
    state = algorithm.get_module(DEFAULT_MODULE_ID).get_state()
    names = [f"encoder.encoder.net.mlp.{2 * k}" for k in range(len(HIDDEN))] + ["pi.net.mlp.0"]
    return [(state[f"{name}.weight"], state[f"{name}.bias"]) for name in names]


def train(algorithm, steps):
    """Update until ``shots`` shots are played. Returns their number."""
    shots = 0
    with Progress("RLlib", steps, "shots") as progress:
        while shots < steps:
            sampled = algorithm.train()["env_runners"]
            shots = int(sampled["num_env_steps_sampled_lifetime"])
            progress.at(shots, f"{sampled.get('episode_return_mean', float('nan')):.2f} points a visit")
    return shots


def main(argv=None):
    """Train and write the policy."""
    parser = argparse.ArgumentParser("python -m examples.ppo_rllib", description=__doc__.partition("\n")[0])
    parser.add_argument("--out", type=Path, default=Path("runs/rllib.npz"))
    parser.add_argument("--steps", type=int, default=300_000)
    parser.add_argument("--runners", type=int, default=1)
    parser.add_argument("--seed", type=int, default=0)
    args = parser.parse_args(argv)
    snooker_env.warmup()  # before the runners start, because each would compile everything again
    paths = {"PYTHONPATH": os.getcwd(), "OMP_NUM_THREADS": "1"}
    ray.init("local", num_cpus=args.runners + 1, runtime_env={"env_vars": paths}, log_to_driver=False)
    algorithm = algorithm_of(args.runners, 64, args.seed)
    shots = train(algorithm, args.steps)
    args.out.parent.mkdir(parents=True, exist_ok=True)
    about = {"trainer": "RLlib", "activation": "tanh", "gamma": GAMMA, "shots": shots, "seed": args.seed}
    write_policy(args.out, layers_of(algorithm), **about, env_options=OPTIONS)
    ray.shutdown()
    print(f"{args.out}: {shots:,} shots. Evaluate it with:  python -m agents.evaluate --agent {args.out}")


if __name__ == "__main__":
    main()
