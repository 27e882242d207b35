"""How well does a stranger's agent do on the tasks of the benchmark, for a budget of training shots?

    python -m agents.baseline SnookerBreak-v0 --form strokes --shots 50000 [--seeds 5] [--out runs/baseline]

writes ``TASK.FORM.SHOTS.SEED.zip`` for each training seed; those that are there are left as they are. FORM "pot" is plain PPO
on the default action, "strokes" is MaskablePPO on the menu, both with the settings of ``agents.curves``, the same for all
tasks: nothing is tuned. Frames are trained against ghost_ball, whose strokes count as shots; of ``planner`` every decision
would count as 118.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

import torch
from stable_baselines3.common.base_class import BaseAlgorithm

from snooker_env.benchmark import TASKS, count_shots
from snooker_env.sb3 import SnookerVecEnv

from .evaluation.curve_rows import ROWS, Row

FORMS = {"pot": ROWS["pot_ppo"], "strokes": ROWS["strokes_maskable"]}


def train(task: str, row: Row, shots: int, seed: int) -> BaseAlgorithm:
    """The agent of a training seed after at most so many shots; its tables begin below those of the judging."""
    options = TASKS[task].options(
        **({"action": "strokes", "observation": "strokes"} if row.form == "strokes" else {})
    )
    if TASKS[task].frame:
        options = options.but(opponent="ghost_ball")
    tables = SnookerVecEnv(row.tables or 1, options=options, seed=10_000 * seed)
    agent, before, rollouts = row.new_agent(tables, seed), count_shots(), 0
    while (count_shots() - before) * (rollouts + 1) <= shots * rollouts:  # room for one more
        agent.learn(1, reset_num_timesteps=False)  # one rollout
        rollouts += 1
    assert count_shots() - before <= shots, "a rollout took more shots than those before it"
    tables.close()
    return agent


def main(argv: Sequence[str] | None = None):
    """Train what is missing."""
    parser = argparse.ArgumentParser("python -m agents.baseline", description=str(__doc__).splitlines()[0])
    parser.add_argument("task", choices=TASKS, help="id of the task")
    parser.add_argument("--form", choices=FORMS, default="strokes", help="form of the action [strokes]")
    parser.add_argument("--shots", type=int, default=50_000, help="budget of training [50000]")
    parser.add_argument("--seeds", type=int, default=5, help="training seeds [5]")
    parser.add_argument("--out", type=Path, default=Path("runs/baseline"), help="folder [runs/baseline]")
    args = parser.parse_args(argv)
    if not 1 <= args.seeds <= 99:  # the tables of the hundredth would be those of the judging
        parser.error(f"seeds = {args.seeds}: must be in [1, 99]")
    torch.set_num_threads(1)
    args.out.mkdir(parents=True, exist_ok=True)
    for seed in range(args.seeds):
        file = args.out / f"{args.task}.{args.form}.{args.shots}.{seed}.zip"
        if not file.exists():
            partial = file.with_suffix(".partial.zip")
            train(args.task, FORMS[args.form], args.shots, seed).save(partial)
            partial.replace(file)
        print(file, flush=True)


if __name__ == "__main__":
    main()
