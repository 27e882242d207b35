"""What does a cluster give, and how long must a part last? Shots a second of one and two workers, and the
cost of a part, on this machine.

    python -m benchmarks.cluster [--shots N] [--parts N] [--positions N] [--repeats 3] [--seed 0] [--json
    FILE] [--out FOLDER]

Needs Ray: ``pip install -e ".[cluster]"``. Parts are choices at opened tables under a professional's errors,
judged by a constant. The same parts are played by this process with one thread, by a cluster of one worker
and by one of two. The cost of a part is what a worker spends beside playing it: from parts of one shot, sent
as fast as the driver can. Figures are medians over the repeats; what 100 and 1,000 cores would do is computed
from them.
"""

import os
import time

import numpy as np

import snooker_env as sn
from agents.cluster.job import Here
from agents.cluster.ray_cluster import connected, ray_of
from agents.learning.self_play import positions_given
from snooker_env.planning import Positions, Search, VisitJudge

from ._common.command import Command, at_least, run, save_json

SEARCH = 2000
"""Simulated shots of a decision of "search"."""
SHARE = 0.05
"""The overhead that is allowed."""
CORES = (2, 100, 1000)


def judge(left):
    """Every position is worth the same."""
    return np.ones(len(left), np.float32)


def parts_of(shots, many, seed):
    """Arguments of ``many`` parts of so many shots, and what they share."""
    tables = sn.SnookerVectorEnv(min(shots, 64), action="discrete", noise="professional")
    tables.reset(seed=seed)
    at, masks, rng = Positions.of(tables), tables.action_masks(), np.random.default_rng(seed)
    rows = np.sort(rng.integers(len(at), size=shots))
    picks = np.array([rng.choice(np.flatnonzero(masks[row])) for row in rows])
    given = [
        {
            "at": positions_given(at),
            "rows": rows,
            "picks": picks,
            "keys": rng.integers(0, 2**63, shots, dtype=np.uint64),
        }
        for _ in range(many)
    ]
    return {"run": f"{shots} {seed}", "options": {"noise": "professional"}, "value": None}, given


def seconds(where, shared, given):
    """How long the parts take."""
    began = time.perf_counter()
    where.map("agents.learning.self_play:choices", shared | {"value": judge}, given)
    return time.perf_counter() - began


def measured(args):
    """Seconds of every measurement, a dict of lists."""
    long, short = parts_of(args.shots, args.parts, args.seed), parts_of(1, 50 * args.parts, args.seed)
    here, found = Here(1), {}
    for shared, given in (long, short):
        seconds(here, shared, given[:1])
    search = Search(VisitJudge({"noise": "professional"}, threads=1), SEARCH)
    tables = sn.SnookerVectorEnv(args.positions, noise="professional")
    tables.reset(seed=args.seed)
    at, seeds = Positions.of(tables), np.arange(args.positions)
    search.rank(at[:1], seeds[:1])
    found["search"] = []
    for _ in range(args.repeats):
        began = time.perf_counter()
        search.rank(at, seeds)
        found["search"].append((time.perf_counter() - began) / args.positions)
    for workers in (1, 2):
        began = time.perf_counter()
        cluster = connected("local", workers)
        try:
            joined = time.perf_counter() - began
            for shared, given in (long, short):
                seconds(cluster, shared, given[: 2 * workers])  # its workers have started and compiled
            found[f"{workers} joined"] = [joined]
            # in turns: a busy machine slows both alike
            for name, given in (("long", long), ("short", short)):
                pairs = [(seconds(here, *given), seconds(cluster, *given)) for _ in range(args.repeats)]
                found[f"{workers}, {name}"] = [two for _, two in pairs]
                found[f"{workers} times as fast, {name}"] = [one / two for one, two in pairs]
                found.setdefault(f"here, {name}", []).extend(one for one, _ in pairs)
        finally:
            cluster.close()
    return found


def main():
    """Measure and print."""
    parser = Command("cluster", __doc__, seed=0)
    parser.add_argument("--shots", type=at_least(1), default=20_000, help="shots of a long part [20,000]")
    parser.add_argument(
        "--parts",
        type=at_least(1),
        default=20,
        help="long parts; of the short ones, fifty times as many [20]",
    )
    parser.add_argument("--positions", type=at_least(1), default=20, help="positions of the search [20]")
    parser.add_argument("--repeats", type=at_least(1), default=3, help="of each measurement [3]")
    args = parser.options()
    ray_of()  # before anything is measured
    os.environ["OMP_NUM_THREADS"] = "1"
    sn.warmup()
    found = measured(args)
    middle = {name: float(np.median(values)) for name, values in found.items()}
    shots, short = args.shots * args.parts, 50 * args.parts
    rates = {
        "this process, one thread": shots / middle["here, long"],
        **{f"{n} worker{'s'[: n - 1]}": shots / middle[f"{n}, long"] for n in (1, 2)},
    }
    print(f"{'shots a second, parts of':26s}{args.shots:,} shots ({middle['here, long'] / args.parts:.2f} s)")
    for k, (name, rate) in enumerate(rates.items()):
        times = f"   {middle[f'{k} times as fast, long']:.2f} times this process, paired" if k else ""
        print(f"  {name:26s}{rate:10,.0f}{times}")
    cost = (middle["1, short"] - middle["here, short"]) / short
    sent = short / min(middle["1, short"], middle["2, short"])
    least = max(cost, 0.0) / SHARE
    print(
        f"cost of a part {1e3 * cost:.2f} ms: it must last {1e3 * least:.0f} ms for {SHARE:.0%}; "
        f"the driver sends {sent:,.0f} parts a second"
    )
    print(f"a cluster on this machine is there after {middle['2 joined']:.1f} s")
    position = middle["search"]
    print(
        f"search, {SEARCH:,} shots: {1e3 * position:.0f} ms a position on one core; "
        f"a million positions are {1e6 * position / 3600:,.0f} core-hours"
    )
    print("on paper, workers with a core each, parts of 1 s:")
    for cores in CORES:
        share = 1.0 / (1.0 + cost)
        limited = min(1.0, sent / cores)
        rate, hours = (
            cores * shots / middle["here, long"] * share * limited,
            1e6 * position / 3600 / cores / limited / share,
        )
        print(f"  {cores:5,} cores {rate:14,.0f} shots a second; a million positions in {hours:,.2f} hours")
    save_json(args.json, {"seconds": found, "rates": rates, "cost": cost, "sent": sent, "search": position})
    return 0


if __name__ == "__main__":
    run(main)
