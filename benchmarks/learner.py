"""How many shots a second does PPO play and learn from, on one core? Of this tree and, with --against, of
another commit in turns with it.

    python -m benchmarks.learner [--against COMMIT] [--rounds 9] [--steps N] [--seed 0] [--json FILE]

The agent is ``ppo_mask``; it begins with the policy of the pre-trained ``ppo_value``, and each tree uses its own
recipe. A round is one rollout of all tables and the update from it. Both trees take turns, round by round, each in a
process of its own with one thread, so that a busy machine slows both alike. The times are processor times:
what other processes take is not counted. Medians over the rounds.
"""

import json
import os
import subprocess
import sys
import tarfile
from contextlib import ExitStack
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from ._common.command import Command, at_least, run, save_json
from ._common.kept import kept_folder

ROOT = Path(__file__).parents[1]
WORKER = Path(__file__).parent / "_common" / "learner_worker.py"
AGENT, WEIGHTS = "ppo_mask", ROOT / "agents" / "pretrained" / "ppo_value.zip"


def tree_of(commit):
    """A folder with the files of a commit, kept for the next time. SystemExit if git has no such commit."""
    found = subprocess.run(
        ["git", "rev-parse", "--verify", f"{commit}^{{commit}}"], cwd=ROOT, capture_output=True, text=True
    )
    if found.returncode:
        raise SystemExit(f"--against = {commit!r}: must be a commit that git finds in {ROOT}")
    name = found.stdout.strip()

    def make(folder):
        archive = subprocess.run(["git", "archive", name], cwd=ROOT, capture_output=True, check=True).stdout
        with tarfile.open(fileobj=BytesIO(archive)) as files:
            safe: Any = {"filter": "data"} if hasattr(tarfile, "data_filter") else {}  # not before 3.11.4
            files.extractall(folder, **safe)

    return kept_folder(f"commit_{name[:16]}", make)


def started(tree, steps, seed):
    """The worker of a tree, once it is ready. SystemExit if it does not start."""
    worker = subprocess.Popen(
        [sys.executable, str(WORKER), AGENT, str(WEIGHTS), str(steps), str(seed)],
        cwd=tree,
        text=True,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env=os.environ | {"PYTHONPATH": str(tree), "OMP_NUM_THREADS": "1"},
    )
    answer(worker, tree, wanted="ready")
    return worker


def answer(worker, tree, wanted=None):
    """The next line of a worker; SystemExit if there is none."""
    line = worker.stdout.readline().strip()
    if not line or (wanted is not None and line != wanted):
        raise SystemExit(f"the training in {tree} has ended: its error is above")
    return line


def measured(trees, steps, rounds, seed):
    """Figures of each round of each tree, in turns."""
    found = {name: [] for name in trees}
    with ExitStack() as ending:
        workers = {}
        for name, tree in trees.items():
            workers[name] = ending.enter_context(started(tree, steps, seed))
            ending.callback(workers[name].stdin.close)
        for _ in range(rounds):
            for name, worker in workers.items():
                worker.stdin.write("\n")
                worker.stdin.flush()
                found[name].append(json.loads(answer(worker, trees[name])))
    return found


def main():
    """Measure and print."""
    parser = Command("learner", __doc__, seed=0)
    parser.add_argument("--against", metavar="COMMIT", help="measure this commit too, in turns")
    parser.add_argument("--rounds", type=at_least(1), default=9, help="rollouts of each [9]")
    parser.add_argument("--steps", type=at_least(2), default=0, help="steps of a rollout [the recipe's]")
    args = parser.options()
    trees = ({args.against: tree_of(args.against)} if args.against else {}) | {"this tree": ROOT}
    print(
        f"{'us of processor time a shot':30s}{'tables':>10s}{'network':>10s}{'update':>10s}{'all':>10s}{'shots/s':>10s}"
    )
    found = measured(trees, args.steps, args.rounds, args.seed)
    for name, rounds in found.items():
        tables, update, everything = (
            float(np.median([1e6 * one[part] / one["shots"] for one in rounds]))
            for part in ("tables", "update", "all")
        )
        parts = f"{tables:10.1f}{everything - tables - update:10.1f}{update:10.1f}{everything:10.1f}{1e6 / everything:10,.0f}"
        print(f"{f'{AGENT}, {name}':30s}{parts}")
    if args.against:
        each = [[one["all"] / one["shots"] for one in found[name]] for name in trees]
        faster = np.median(np.array(each[0]) / each[1])
        print(f"{'':30s}{faster:.2f} times as fast, the median of {args.rounds} pairs")
    save_json(args.json, found)
    return 0


if __name__ == "__main__":
    run(main)
