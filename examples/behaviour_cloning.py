"""How is a policy learned from a data set alone? By behaviour cloning of a player's choices, in one file.

    python -m agents.dataset --out runs/data --player stroke_value --form choices --strokes 20000
    python -m examples.behaviour_cloning --data runs/data/snooker/break-stroke_value-choices-v0/data --out runs/cloned.npz
    python -m agents.evaluate --agent runs/cloned.npz

A two-layer network is fitted to the recorded choices among those available, by cross-entropy. One episode in ten is
held out from the fit; the pass that predicts these episodes best is kept.
"""

import argparse
import copy
import json
from pathlib import Path

import minari
import numpy as np
import torch
from torch import nn

from snooker_env.benchmark import play_visits

WIDTH, BATCH, PASSES, RATE, DECAY, DROPPED = 256, 512, 40, 1e-3, 1e-2, 0.2
HELD = 10  # one episode in this many is held out from the fit


class Cloned:
    """A player that takes the best available choice by a network (docs/agents/players.md)."""

    options = {"action": "discrete", "observation": "flat"}  # noqa: RUF012

    def __init__(self, network):
        self.network = network

    def act(self, observations, masks, seeds):
        """A choice for each observation (n, 121) with its mask (n, 540)."""
        with torch.no_grad():
            scores = self.network(torch.as_tensor(observations)).numpy()
        return np.where(masks, scores, -np.inf).argmax(axis=1)


def strokes_of(data):
    """Read observations, masks and choices of all strokes in a data set, and the episode of each."""
    parts = []
    for episode in data.iterate_episodes():
        n, seen = len(episode), episode.observations
        parts.append(
            (seen["observations"][:n], seen["action_mask"][:n] != 0, episode.actions, np.full(n, episode.id))
        )
    return map(np.concatenate, zip(*parts, strict=True))


def fitted(observations, masks, choices, episodes, seed=0):
    """Fit the network. Returns it and the share of held-out strokes that it predicts."""
    torch.manual_seed(seed)
    rng, held = np.random.default_rng(seed), episodes % HELD == 0
    x, m, y = torch.as_tensor(observations), torch.as_tensor(masks), torch.as_tensor(choices)
    hidden = [nn.Linear(x.shape[1], WIDTH), nn.ReLU(), nn.Dropout(DROPPED)]
    hidden += [nn.Linear(WIDTH, WIDTH), nn.ReLU(), nn.Dropout(DROPPED)]
    network = nn.Sequential(*hidden, nn.Linear(WIDTH, m.shape[1]))
    optimiser = torch.optim.AdamW(network.parameters(), RATE, weight_decay=DECAY)

    def scores(rows):
        return network(x[rows]).masked_fill(~m[rows], -1e9)

    used, kept, best = np.flatnonzero(~held), np.flatnonzero(held), (np.inf, None)
    for k in range(PASSES):
        network.train()
        for rows in np.array_split(rng.permutation(used), max(1, len(used) // BATCH)):
            loss = nn.functional.cross_entropy(scores(rows), y[rows])
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
        network.eval()
        with torch.no_grad():
            off = nn.functional.cross_entropy(scores(kept), y[kept]).item()
        if off < best[0]:
            best = off, copy.deepcopy(network.state_dict())
        print(f"pass {k + 1} of {PASSES}: loss {off:.3f} on held-out strokes", flush=True)
    network.load_state_dict(best[1])
    with torch.no_grad():
        same = (scores(kept).argmax(dim=1) == y[kept]).float().mean().item()
    return network, same


def save(file, network, data, strokes, seed):
    """Write the policy as plain weights, which ``agents.evaluate`` plays."""
    linear = [one for one in network if isinstance(one, nn.Linear)]
    arrays = {f"weight_{k}": one.weight.detach().numpy() for k, one in enumerate(linear)}
    arrays |= {f"bias_{k}": one.bias.detach().numpy() for k, one in enumerate(linear)}
    env = {"noise": data.recover_environment().unwrapped.options.noise, "cue": "real"}
    about = {"trainer": "behaviour cloning", "env_options": env, "activation": "relu"}
    about |= {"shots": strokes, "gamma": 1.0, "seed": seed}
    Path(file).parent.mkdir(parents=True, exist_ok=True)
    np.savez(file, about=json.dumps(about), **arrays)


def main(words=None):
    """Fit, compare with the expert on held-out tables, and save. Returns the share of the expert's points."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--data", required=True, help="folder `data` of a data set of choices")
    parser.add_argument("--out", help="file for the policy")
    parser.add_argument("--visits", type=int, default=500, help="held-out tables in the comparison [500]")
    parser.add_argument("--seed", type=int, default=0)
    args = parser.parse_args(words)
    if not Path(args.data, "main_data.hdf5").is_file():
        parser.error(f"data = {args.data!r}: must be the folder `data` of a Minari data set")
    torch.set_num_threads(1)
    data = minari.MinariDataset(args.data)
    observations, masks, choices, episodes = strokes_of(data)
    network, same = fitted(observations, masks, choices, episodes, args.seed)
    print(f"{len(choices):,} strokes; {100 * same:.0f} % of the held-out strokes are predicted")
    points = {}
    expert = data.storage.metadata["algorithm_name"]
    for name, player in (("cloned", Cloned(network)), (expert, expert), ("random", "random")):
        noise = data.recover_environment().unwrapped.options.noise
        visits = play_visits(player, args.visits, noise=noise, cue="real")
        each = visits.a_visit(visits.points)
        points[name] = each.mean()
        print(f"{name}: {each.mean():.2f} +- {each.std() / len(each) ** 0.5:.2f} points a visit")
    share = points["cloned"] / points[expert]
    print(f"{100 * share:.0f} % of its expert's points")
    if args.out:
        save(args.out, network, data, len(choices), args.seed)
    return share


if __name__ == "__main__":
    main()
