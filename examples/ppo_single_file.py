"""How is PPO written in one file? Masked PPO on the native vector environment, from top to bottom, with only Gymnasium,
NumPy and PyTorch.

    python -m examples.ppo_single_file --steps 300000 --out runs/single.npz
    python -m agents.evaluate --agent runs/single.npz

The masks come from ``envs.unwrapped.action_masks()``. With ``autoreset_mode="SameStep"``, the observation after the end
of a visit (one turn at the table) is the first one of the next visit. Every step is then a shot, and only the value
after the end must be left out.
"""

import argparse
import json
import time
from collections import deque
from itertools import pairwise
from pathlib import Path

import gymnasium
import numpy as np
import torch
from torch import nn
from torch.distributions import Categorical

from snooker_env.tasks import LEVELS  # snooker_env registers Snooker-v0

TABLES, STEPS = 64, 128  # a rollout: shots on each table, and tables
BATCH, EPOCHS = 2048, 4
LEARNING_RATE, GAMMA, LAMBDA, CLIP = 1e-3, 0.95, 0.5, 0.2
ENTROPY, VALUE, GRADIENT = 0.003, 0.01, 0.5


class Agent(nn.Module):
    """A separate actor and critic."""

    def __init__(self, numbers, choices):
        super().__init__()
        self.actor = mlp(numbers, 256, 256, choices)
        self.critic = mlp(numbers, 256, 256, 1)

    def policy(self, observations, masks):
        """The distribution over the available choices. Uses the smallest float instead of -inf, because 0 times it is 0
        in the entropy, not NaN."""
        scores = self.actor(observations)
        return Categorical(
            logits=scores.masked_fill(~masks, torch.finfo(scores.dtype).min), validate_args=False
        )

    def value(self, observations):
        """The expected sum of discounted rewards."""
        return self.critic(observations).squeeze(-1)


def mlp(*sizes):
    """Linear layers with tanh between them."""
    layers = []
    for a, b in pairwise(sizes):
        layers += [nn.Linear(a, b), nn.Tanh()]
    return nn.Sequential(*layers[:-1])


def advantages_of(rewards, values, ends, last):
    """Generalised advantages; all arrays are (steps, tables). ``ends``: the visit ended in this step; ``last``: the
    values after the last step."""
    advantages, running = torch.zeros_like(rewards), torch.zeros_like(last)
    for t in reversed(range(len(rewards))):
        goes_on = 1.0 - ends[t]
        after = values[t + 1] if t + 1 < len(rewards) else last
        running = rewards[t] + GAMMA * goes_on * after - values[t] + GAMMA * LAMBDA * goes_on * running
        advantages[t] = running
    return advantages


def save(path, actor, about):
    """Write the actor as plain weights, which ``python -m agents.evaluate`` reads."""
    layers = [layer for layer in actor if isinstance(layer, nn.Linear)]
    arrays = {f"weight_{k}": layer.weight.detach().numpy() for k, layer in enumerate(layers)}
    arrays |= {f"bias_{k}": layer.bias.detach().numpy() for k, layer in enumerate(layers)}
    np.savez(path, about=np.array(json.dumps(about)), **arrays)


def main(argv=None):
    """Train. Returns the mean points of the last 1,000 visits."""
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

    envs = gymnasium.make_vec(
        "Snooker-v0",
        num_envs=TABLES,
        vectorization_mode="vector_entry_point",
        autoreset_mode="SameStep",
        action="discrete",
        observation="flat",
        noise=args.noise,
    )
    numbers, choices = envs.single_observation_space.shape[0], int(envs.single_action_space.n)
    agent = Agent(numbers, choices)
    optimiser = torch.optim.Adam(agent.parameters(), lr=LEARNING_RATE)

    seen, masks = torch.zeros(STEPS, TABLES, numbers), torch.zeros(STEPS, TABLES, choices, dtype=torch.bool)
    actions, logs = torch.zeros(STEPS, TABLES, dtype=torch.long), torch.zeros(STEPS, TABLES)
    rewards, ends, values = (torch.zeros(STEPS, TABLES) for _ in range(3))

    visits, returns = (
        np.zeros(TABLES),
        deque(maxlen=1000),
    )  # rewards of current visits, and of the last visits
    observation, _ = envs.reset(seed=args.seed)
    updates, played, began = -(-args.steps // (STEPS * TABLES)), 0, time.perf_counter()
    for update in range(updates):
        for group in optimiser.param_groups:  # decreases to nearly 0
            group["lr"] = LEARNING_RATE * (1.0 - update / updates)

        # the rollout
        for t in range(STEPS):
            seen[t] = torch.from_numpy(observation)
            masks[t] = torch.from_numpy(envs.unwrapped.action_masks())
            with torch.no_grad():
                policy = agent.policy(seen[t], masks[t])
                actions[t] = policy.sample()
                logs[t], values[t] = policy.log_prob(actions[t]), agent.value(seen[t])
            observation, reward, terminated, truncated, _ = envs.step(actions[t].numpy())
            done = terminated | truncated
            rewards[t], ends[t] = torch.from_numpy(reward), torch.from_numpy(done)
            visits += reward
            returns.extend(visits[done])
            visits[done] = 0.0
        played += STEPS * TABLES

        # advantages and returns
        with torch.no_grad():
            advantages = advantages_of(rewards, values, ends, agent.value(torch.from_numpy(observation)))
        rows = [part.flatten(0, 1) for part in (seen, masks, actions, logs, advantages, advantages + values)]

        # the update
        for _ in range(EPOCHS):
            for batch in torch.randperm(STEPS * TABLES).split(BATCH):
                o, m, a, before, advantage, target = (part[batch] for part in rows)
                policy = agent.policy(o, m)
                ratio = (policy.log_prob(a) - before).exp()
                advantage = (advantage - advantage.mean()) / (advantage.std() + 1e-8)
                gain = torch.min(advantage * ratio, advantage * ratio.clamp(1 - CLIP, 1 + CLIP)).mean()
                error = (agent.value(o) - target).square().mean()
                loss = -gain + VALUE * error - ENTROPY * policy.entropy().mean()
                optimiser.zero_grad()
                loss.backward()
                nn.utils.clip_grad_norm_(agent.parameters(), GRADIENT)
                optimiser.step()

        points = float(np.mean(returns))
        print(
            f"{played:,} shots, {points:.2f} points a visit, "
            f"{played / (time.perf_counter() - began):.0f} shots/s",
            flush=True,
        )

    envs.close()
    options = {"noise": args.noise, "layout": "opened"}
    about = {
        "trainer": "single file",
        "activation": "tanh",
        "shots": played,
        "seed": args.seed,
        "gamma": GAMMA,
        "env_options": options,
    }
    save(args.out, agent.actor, about)
    return points


if __name__ == "__main__":
    main()
