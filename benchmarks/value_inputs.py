"""What should a value of positions see: features of the pots, or every ball, read by a network of sets?

    python -m benchmarks.value_inputs [--positions 40000] [--steps 3000] [--seed 0] [--json FILE] [--out
    FOLDER]

Both learn the same numbers: for positions of visits by ``search_60`` under a professional's errors, the
mean over 16 fresh noise samples of the points of its stroke plus the rule of thumb's value of what it leaves.
So neither helps to make its own targets. Equal positions, batches and steps; visits of the last fifth of the
tables are kept out. ``features`` is one of the networks of the planner's value; ``sets`` is the encoder of
``ppo_mask`` with a layer for the value. R2: the share of the targets' variance on the visits kept out that
the value explains.
"""

import time

import numpy as np
import torch
from torch import nn

import snooker_env as sn
from agents.learning.networks import CONTEXT, TableReader, ValueHead
from agents.learning.value_network import ValueNetwork
from snooker_env.planning import Positions, Search, VisitJudge
from snooker_env.planning.learned.pot_view import VIEW_SPACE, with_pots
from snooker_env.planning.learned.value_features import value_features

from ._common.command import Command, at_least, run, save_json

SAMPLES, BATCH, RATE, SCALE = 16, 512, 2e-3, 20.0
TABLES = 500


class Sets(nn.Module):
    """The encoder of sets, and a head."""

    def __init__(self):
        super().__init__()
        self.reader, self.head = TableReader(VIEW_SPACE), ValueHead()

    def forward(self, seen):
        """Values [points] (n,)."""
        return SCALE * self.head(self.reader(seen)[:, :CONTEXT])[:, 0]


class Features(nn.Module):
    """One member of a ``ValueNetwork``."""

    def __init__(self):
        super().__init__()
        self.network = ValueNetwork(members=1)

    def forward(self, seen):
        """Values [points] (n,)."""
        logit, follows = self.network(seen)
        return (torch.sigmoid(logit) * follows)[0]


def examples(many, seed):
    """Positions of visits, the targets, and which table each is from."""
    judge, rng = VisitJudge({"noise": "professional"}), np.random.default_rng(seed)
    search = Search(judge, 60)
    at, targets, tables, first = [], [], [], 0
    while sum(map(len, targets)) < many:
        env = sn.SnookerVectorEnv(TABLES, noise="professional")
        env.reset(seed=rng.integers(2**31, size=TABLES).tolist())
        now, running = Positions.of(env), np.arange(first, first + TABLES)
        first += TABLES
        while len(running):
            ranked = search.rank(now, rng.integers(2**32, size=len(now)))
            strokes = np.stack([one.strokes.values[0] for one in ranked])
            rows = np.repeat(np.arange(len(now)), SAMPLES)
            errors = rng.standard_normal((len(rows), 5))
            out = judge.planner.play_strokes(now, rows, strokes[rows], errors=errors)
            gains, on = out.points.copy(), np.flatnonzero(out.goes_on)
            gains[on] += judge.value(out.afterstates[on])
            at.append(now)
            targets.append(gains.reshape(-1, SAMPLES).mean(1))
            tables.append(running)
            goes_on = out.goes_on[::SAMPLES]  # the first sample is played
            now, running = out.afterstates[np.flatnonzero(goes_on) * SAMPLES], running[goes_on]
    positions, on_table, game = (
        np.concatenate([getattr(one, name) for one in at]) for name in ("positions", "on_table", "game")
    )
    return (
        Positions(positions, on_table, game),
        np.concatenate(targets).astype(np.float32),
        np.concatenate(tables),
        judge.spread,
    )


def fitted(network, seen, targets, steps, rng):
    """Fit and return the network, and the seconds it took."""
    optimizer, started = torch.optim.Adam(network.parameters(), RATE), time.perf_counter()
    for step in range(steps):
        for group in optimizer.param_groups:
            group["lr"] = RATE * max(0.02, 1.0 - step / steps)
        rows = rng.integers(len(seen), size=BATCH)
        error = (network(torch.from_numpy(seen[rows])) - torch.from_numpy(targets[rows])) / SCALE
        optimizer.zero_grad()
        error.square().mean().backward()
        optimizer.step()
    return network, time.perf_counter() - started


def main():
    """Measure and print."""
    parser = Command("value_inputs", __doc__, seed=0)
    parser.add_argument(
        "--positions", type=at_least(1000), default=40_000, help="positions, at least [40000]"
    )
    parser.add_argument("--steps", type=at_least(1), default=3000, help="gradient steps of each [3000]")
    args = parser.options()
    torch.set_num_threads(1)
    torch.manual_seed(args.seed)
    at, targets, tables, spread = examples(args.positions, args.seed)
    visits = tables.max() + 1
    learned = tables < 0.8 * visits
    print(
        f"{len(at):,} positions of {visits:,} visits; targets {targets.mean():.1f} points, standard deviation {targets.std():.1f}"
    )
    found = {}
    for name, make, inputs in (
        ("features", Features, lambda at: value_features(at, spread)),
        ("sets", Sets, lambda at: with_pots(at.observations())),
    ):
        inputs(at[:2])  # compiled
        started = time.perf_counter()
        seen = inputs(at)
        reading = time.perf_counter() - started
        network, seconds = fitted(
            make(), seen[learned], targets[learned], args.steps, np.random.default_rng(args.seed)
        )
        kept, truth, started = torch.from_numpy(seen[~learned]), targets[~learned], time.perf_counter()
        with torch.no_grad():
            said = np.concatenate([network(part).numpy() for part in kept.split(1024)])
        forward = time.perf_counter() - started
        error = said - truth
        figures = {
            "r2": 1.0 - float(np.mean(error**2) / truth.var()),
            "rms": float(np.sqrt(np.mean(error**2))),
            "us": 1e6 * (reading / len(seen) + forward / len(kept)),
            "seconds": seconds,
        }
        print(
            name.ljust(10),
            "R2 {r2:.3f}   error {rms:5.2f} points   {us:6.1f} us a position   fitted in {seconds:4.0f} s".format(
                **figures
            ),
        )
        found[name] = figures
    save_json(args.json, found)
    return 0


if __name__ == "__main__":
    run(main)
