"""How well does a standard agent do on the tasks of the benchmark within a budget of training shots?

    python -m agents.baseline SnookerBreak-v0 --form strokes --shots 50000 [--seeds 5] [--out runs/baseline]

writes ``TASK.FORM.SHOTS.SEED.zip`` for each training seed and keeps existing files. FORM "pot" is plain PPO on the default
action; "strokes" is MaskablePPO on the menu. Both use the settings of ``agents.curves`` for all tasks, without tuning. In frames
the opponent is ghost_ball, whose strokes count as shots; each decision of ``planner`` would count as 118.
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
    """Train the agent of a seed for at most this number of shots; its table seeds lie below those of the evaluation."""
    options = TASKS[task].options(
        **({"action": "strokes", "observation": "strokes"} if row.form == "strokes" else {})
    )
    if TASKS[task].frame:
        options = options.but(opponent="ghost_ball")
    tables = SnookerVecEnv(row.tables or 1, options=options, seed=10_000 * seed)
    agent, before, rollouts = row.new_agent(tables, seed), count_shots(), 0
    while (count_shots() - before) * (rollouts + 1) <= shots * rollouts:  # room for another rollout
        agent.learn(1, reset_num_timesteps=False)  # one rollout
        rollouts += 1
    assert count_shots() - before <= shots, "a rollout took more shots than the previous ones"
    tables.close()
    return agent


def main(argv: Sequence[str] | None = None):
    """Train the missing agents."""
    parser = argparse.ArgumentParser("python -m agents.baseline", description=str(__doc__).splitlines()[0])
    parser.add_argument("task", choices=TASKS, help="id of the task")
    parser.add_argument("--form", choices=FORMS, default="strokes", help="form of the action [strokes]")
    parser.add_argument("--shots", type=int, default=50_000, help="training budget in shots [50000]")
    parser.add_argument("--seeds", type=int, default=5, help="training seeds [5]")
    parser.add_argument("--out", type=Path, default=Path("runs/baseline"), help="folder [runs/baseline]")
    args = parser.parse_args(argv)
    if not 1 <= args.seeds <= 99:  # seed 100 would reach the tables of the evaluation
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
