"""How long does a player take to decide, on one table and on many at once?

    python -m benchmarks.decisions [--agents planner search ...] [--tables 1 256] [--repeats 9] [--seed 0]
    [--json FILE] [--out FOLDER]

Opened tables, a professional's errors. Milliseconds a decision, on the clock and of all processors together:
medians over the repeats, each on new tables; on several tables the time of all divided by their number. The
first decision is not timed.
"""

import time

import numpy as np

import snooker_env as sn
from snooker_env.planning import Positions
from snooker_env.players import VISITS

from ._common.command import Command, at_least, run, save_json

AGENTS = (
    "ghost_ball",
    "ppo_value",
    "stroke_value",
    "search",
    "planner_30",
    "planner_60",
    "planner",
    "planner_500",
    "planner_2000",
    "search_2000",
)


def milliseconds(player, tables, repeats, seed):
    """Milliseconds a decision on so many tables, of each repeat: on the clock, of all processors."""
    env, taken = sn.SnookerVectorEnv(tables, noise="professional", **VISITS), []
    player = player.at(env)
    for k in range(repeats + 1):
        env.reset(seed=np.random.SeedSequence([seed, k]).generate_state(tables).tolist())
        at, seeds = Positions.of(env), np.arange(tables)
        start = time.perf_counter(), time.process_time()
        player.play(at, seeds)
        ends = time.perf_counter(), time.process_time()
        taken.append([1e3 * (end - began) / tables for began, end in zip(start, ends, strict=True)])
    env.close()
    return dict(zip(("clock", "processors"), map(list, zip(*taken[1:], strict=True)), strict=True))


def main():
    """Measure and print."""
    parser = Command("decisions", __doc__, seed=0)
    parser.add_argument("--agents", nargs="+", default=AGENTS, help=f"names of players [{' '.join(AGENTS)}]")
    parser.add_argument(
        "--tables", nargs="+", type=at_least(1), default=(1, 256), help="numbers of tables at once [1 256]"
    )
    parser.add_argument("--repeats", type=at_least(1), default=9, help="decisions of each [9]")
    args = parser.options()
    players = {name: sn.player(name) for name in args.agents}
    sn.warmup()
    print(
        f"{'ms a decision':20s}" + "".join(f"{f'{n:,} tables':>13s}{'processors':>13s}" for n in args.tables)
    )
    found = {}
    for name, player in players.items():
        found[name] = {n: milliseconds(player, n, args.repeats, args.seed) for n in args.tables}
        medians = [np.median(taken) for both in found[name].values() for taken in both.values()]
        print(f"{name:20s}" + "".join(f"{median:13.2f}" for median in medians), flush=True)
    save_json(args.json, found)
    return 0


if __name__ == "__main__":
    run(main)
