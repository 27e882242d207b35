"""How well does plain PPO do with 50,000 shots of training? A baseline for each task: masked PPO over 540 strokes.

    python -m agents.baseline SnookerBreak-v0 [--seeds 5] [--out runs/baseline]

writes ``TASK.SEED.zip`` for each training seed; those that are there are left as they are. The settings are README's, the
same for all tasks: nothing is tuned. Frames are trained against ghost_ball, whose strokes count as shots; of ``planner``
every decision would count as 118.
"""

import argparse
from pathlib import Path

import torch
from sb3_contrib import MaskablePPO

from snooker_env.benchmark import TASKS, count_shots
from snooker_env.sb3 import SnookerVecEnv

SHOTS, TABLES = 49_152, 256
"""Of one training at most, the budget "50k"; and tables at once."""
SETTINGS = {"n_steps": 16, "batch_size": 1024, "n_epochs": 4, "learning_rate": 2e-3, "gamma": 0.9}
SETTINGS |= {"gae_lambda": 0.5, "vf_coef": 0.05, "ent_coef": 0.003}


def train(task, seed):
    """The agent of a training seed; its tables begin below those of the judging."""
    options = TASKS[task].options(action="discrete", observation="flat")
    if TASKS[task].frame:
        options = options.but(opponent="ghost_ball")
    envs = SnookerVecEnv(TABLES, options=options, seed=10_000 * seed)
    agent = MaskablePPO("MlpPolicy", envs, seed=seed, device="cpu", **SETTINGS)
    before, rollouts = count_shots(), 0
    while (count_shots() - before) * (rollouts + 1) <= SHOTS * rollouts:  # room for one more
        agent.learn(TABLES * SETTINGS["n_steps"], reset_num_timesteps=False)
        rollouts += 1
    assert count_shots() - before <= SHOTS, "a rollout took more shots than those before it"
    envs.close()
    return agent


def main():
    """Train what is missing."""
    parser = argparse.ArgumentParser("python -m agents.baseline", description=str(__doc__).splitlines()[0])
    parser.add_argument("task", choices=TASKS, help="id of the task")
    parser.add_argument("--seeds", type=int, default=5, help="training seeds [5]")
    parser.add_argument("--out", type=Path, default=Path("runs/baseline"), help="folder [runs/baseline]")
    args = parser.parse_args()
    if not 1 <= args.seeds <= 99:  # the tables of the hundredth would be those of the judging
        parser.error(f"seeds = {args.seeds}: must be in [1, 99]")
    torch.set_num_threads(1)
    args.out.mkdir(parents=True, exist_ok=True)
    for seed in range(args.seeds):
        file = args.out / f"{args.task}.{seed}.zip"
        if not file.exists():
            partial = file.with_suffix(".partial.zip")
            train(args.task, seed).save(partial)
            partial.replace(file)
        print(file, flush=True)


if __name__ == "__main__":
    main()
