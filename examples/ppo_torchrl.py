"""How does TorchRL train on this environment? With PPO in one file, using its collector, advantage and loss on the
native vector environment.

    pip install -e ".[torchrl]"
    python -m examples.ppo_torchrl --steps 300000 --out runs/torchrl.npz
    python -m agents.evaluate --agent runs/torchrl.npz

``observation="masked"`` provides the masks for ``MaskedCategorical``. TorchRL accepts a vector environment only with
``autoreset_mode="SameStep"``: it keeps the first observation of the next visit and replaces it by ``final_obs``.
"""

import argparse
import json
import time
from itertools import pairwise
from pathlib import Path

import gymnasium
import numpy as np
import torch
from tensordict.nn import TensorDictModule
from torch import nn
from torchrl.collectors import Collector
from torchrl.envs import DTypeCastTransform, GymWrapper, RewardSum
from torchrl.modules import MaskedCategorical, ProbabilisticActor, ValueOperator
from torchrl.objectives import ClipPPOLoss
from torchrl.objectives.value import GAE

from snooker_env.tasks import LEVELS  # snooker_env registers Snooker-v0

TABLES, STEPS = 64, 128  # a rollout: shots on each table, and tables
BATCH, EPOCHS = 2048, 4
LEARNING_RATE, GAMMA, LAMBDA, CLIP = 1e-3, 0.95, 0.5, 0.2
ENTROPY, VALUE, GRADIENT = 0.003, 0.01, 0.5


def mlp(*sizes):
    """Linear layers with tanh between them."""
    layers = []
    for a, b in pairwise(sizes):
        layers += [nn.Linear(a, b), nn.Tanh()]
    return nn.Sequential(*layers[:-1])


def tables(noise, seed):
    """Make the tables as a TorchRL environment: int8 masks become bool, and ``episode_reward`` counts the points of the
    visit (one turn at the table)."""
    envs = gymnasium.make_vec(
        "snooker_env:Snooker-v0",
        num_envs=TABLES,
        vectorization_mode="vector_entry_point",
        autoreset_mode="SameStep",
        action="discrete",
        observation="masked",
        noise=noise,
    )
    made = GymWrapper(envs, categorical_action_encoding=True)
    made.append_transform(RewardSum())
    made.append_transform(DTypeCastTransform(torch.int8, torch.bool, in_keys=["action_mask"]))
    made.set_seed(seed)
    return made


def save(path, actor, about):
    """Write the actor as plain weights, which ``python -m agents.evaluate`` reads."""
    layers = [layer for layer in actor if isinstance(layer, nn.Linear)]
    arrays = {f"weight_{k}": layer.weight.detach().numpy() for k, layer in enumerate(layers)}
    arrays |= {f"bias_{k}": layer.bias.detach().numpy() for k, layer in enumerate(layers)}
    np.savez(path, about=np.array(json.dumps(about)), **arrays)


def main(argv=None):
    """Train. Returns the mean points of the last rollout's visits."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument(
        "--steps", type=int, default=300_000, help="shots, rounded up to whole rollouts [300000]"
    )
    parser.add_argument("--seed", type=int, default=0, help="seed of tables, weights and exploration [0]")
    parser.add_argument(
        "--noise", default="professional", choices=tuple(LEVELS), help="execution noise [professional]"
    )
    parser.add_argument("--out", default="policy.npz", help="file for the policy [policy.npz]")
    args = parser.parse_args(argv)
    if args.steps < 1:
        parser.error(f"--steps is {args.steps}, must be at least 1")
    Path(args.out).parent.mkdir(parents=True, exist_ok=True)  # check this before the training
    torch.manual_seed(args.seed)
    torch.set_num_threads(1)

    envs = tables(args.noise, args.seed)
    numbers, choices = (
        envs.observation_spec["observations"].shape[-1],
        envs.observation_spec["action_mask"].shape[-1],
    )
    network, critic = mlp(numbers, 256, 256, choices), mlp(numbers, 256, 256, 1)
    actor = ProbabilisticActor(
        TensorDictModule(network, ["observations"], ["logits"]),
        in_keys={"logits": "logits", "mask": "action_mask"},
        out_keys=["action"],
        distribution_class=MaskedCategorical,
        distribution_kwargs={"neg_inf": torch.finfo(torch.float32).min},
        return_log_prob=True,
    )
    value = ValueOperator(critic, in_keys=["observations"])
    advantage = GAE(gamma=GAMMA, lmbda=LAMBDA, value_network=value, average_gae=False)
    loss = ClipPPOLoss(
        actor,
        value,
        clip_epsilon=CLIP,
        entropy_bonus=True,
        entropy_coeff=ENTROPY,
        critic_coeff=VALUE,
        loss_critic_type="l2",
        normalize_advantage=True,
    )
    optimiser = torch.optim.Adam(loss.parameters(), lr=LEARNING_RATE)

    updates, played, points, began = -(-args.steps // (STEPS * TABLES)), 0, 0.0, time.perf_counter()
    collector = Collector(
        envs,
        actor,
        frames_per_batch=STEPS * TABLES,
        total_frames=updates * STEPS * TABLES,
        auto_register_policy_transforms=True,
    )
    for update, rollout in enumerate(collector):
        for group in optimiser.param_groups:  # decreases to nearly 0
            group["lr"] = LEARNING_RATE * (1.0 - update / updates)
        with torch.no_grad():
            advantage(rollout)
        rows = rollout.reshape(-1)
        for _ in range(EPOCHS):
            for batch in torch.randperm(len(rows)).split(BATCH):
                parts = loss(rows[batch])
                total = parts["loss_objective"] + parts["loss_critic"] + parts["loss_entropy"]
                optimiser.zero_grad()
                total.backward()
                nn.utils.clip_grad_norm_(loss.parameters(), GRADIENT)
                optimiser.step()
        played += len(rows)
        ended = rows["next", "done"].squeeze(-1)
        points = rows["next", "episode_reward"][ended].mean().item()
        print(
            f"{played:,} shots, {points:.2f} points a visit, "
            f"{played / (time.perf_counter() - began):.0f} shots/s",
            flush=True,
        )

    collector.shutdown()
    options = {"noise": args.noise, "layout": "opened"}
    about = {
        "trainer": "TorchRL",
        "activation": "tanh",
        "shots": played,
        "seed": args.seed,
        "gamma": GAMMA,
        "env_options": options,
    }
    save(args.out, network, about)
    return points


if __name__ == "__main__":
    main()
