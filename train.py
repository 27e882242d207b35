"""How does an agent learn to play Snooker-v0? Train one, check it against random play on tables it never saw, and say what it learned.

    python train.py                                    a few minutes: PPO, aim at the best potting line
    python train.py --algo sac --seed 1 --out runs/mine
    python train.py --resume --out runs/mine           go on after Ctrl-C, a kill or a power cut, exactly where the last checkpoint was

A run folder holds ``checkpoint.pkl`` (all that a resumed run needs; like every pickle, load only your own), ``model.zip`` (for
``stable_baselines3``), ``results.json`` (every figure) and ``tb/`` (``tensorboard --logdir runs``). What an agent sees and how it is judged
is in ``agents/visits.py``; here follow, top to bottom: settings, recipes, checkpoints, the run.
"""

import argparse
import importlib.metadata
import io
import json
import os
import pickle
import platform
import signal
import subprocess
import sys
import time
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path

import numpy as np

import snooker_env
from agents.view import make_env, make_envs
from agents.visits import evaluate_all, lesson, show

try:
    import rich.progress
    import stable_baselines3 as sb3
    import tensorboard  # noqa: F401 - stable_baselines3 would miss it only after the tables are set up
    import torch
    from stable_baselines3.common.callbacks import BaseCallback
    from stable_baselines3.common.utils import LinearSchedule
except ImportError as error:
    raise SystemExit(f'train.py: {error.name} is missing; train.py needs:  pip install "snooker-env[train]"') from None

# settings ------------------------------------------------------------------------------------------------------------------------


def option(default, text, **more):
    """A dataclass field that is also a command-line option."""
    return field(default=default, metadata={"help": text, **more})


@dataclass(frozen=True)
class Settings:
    """What makes a run the run it is."""

    algo: str = option("ppo", "what learns", choices=("ppo", "sac"))
    steps: int = option(0, "shots in all; 0: 400000 for ppo, 60000 for sac")
    envs: int = option(16, "tables played side by side")
    parallel: str = option("auto", "threads for the tables: auto (once called processes) is one a processor; the same shots come out",
                           choices=("auto", "processes", "one"))  # fmt: skip
    seed: int = option(0, "of tables, weights and exploration")
    aim: str = option("target", "how the aim is read: target or absolute (much harder)")
    layout: str = option("opened", "where training visits start")
    noise: str = option("none", "execution noise: none, professional, amateur, club or olympiad")
    fidelity: str = option("standard", "of the simulation: fast, standard, reference or euler:N")
    eval_visits: int = option(500, "held-out visits each agent plays at the end")
    checkpoint_every: int = option(20_000, "shots from one checkpoint to the next")


FREE_ON_RESUME = ("steps", "parallel", "eval_visits", "checkpoint_every")  # how long and where, not what; lr falls over the new steps
DEFAULT_STEPS = {"ppo": 400_000, "sac": 60_000}


def parse(argv):
    """(parser, options given on the command line, the rest)."""
    parser = argparse.ArgumentParser("train.py", "python train.py [options]", (__doc__ or "").partition("\n")[0])
    for f in fields(Settings):
        parser.add_argument(
            "--" + f.name.replace("_", "-"), type=type(f.default), choices=f.metadata.get("choices"), default=argparse.SUPPRESS,
            metavar=None if "choices" in f.metadata else f.name.split("_")[-1].upper(), help=f"{f.metadata['help']} [{f.default}]",
        )  # fmt: skip
    parser.add_argument("--out", type=Path, help="the run's folder [runs/ALGO-SEED]")
    parser.add_argument("--resume", action="store_true", help="go on with the run in that folder; what is not given is as it was")
    parser.add_argument("--no-progress", action="store_true", help="no progress bar")
    given = vars(parser.parse_args(argv))
    rest = {name: given.pop(name) for name in ("out", "resume", "no_progress")}
    for name, low in (("steps", 0), ("envs", 1), ("seed", 0), ("eval_visits", 2), ("checkpoint_every", 1)):
        if given.get(name, low) < low:
            parser.error(f"--{name.replace('_', '-')} is {given[name]}, must be at least {low}")
    rest["out"] = rest["out"] or Path("runs", f"{given.get('algo', Settings.algo)}-{given.get('seed', Settings.seed)}")
    return parser, given, argparse.Namespace(**rest)


# recipes -------------------------------------------------------------------------------------------------------------------------


def make_model(settings, envs, tensorboard_log):
    """The untrained agent. A shot's consequence is mostly the next shot: hence the short horizon gamma 0.95, and lambda 0.5."""
    common = {
        "policy": "MlpPolicy", "env": envs, "gamma": 0.95, "learning_rate": LinearSchedule(1e-3, 0.0, 1.0), "seed": settings.seed,
        "tensorboard_log": tensorboard_log, "device": "cpu", "stats_window_size": 500,  # nets this small are slower on a GPU
    }  # fmt: skip
    if settings.algo == "sac":
        # one gradient step for four shots: shots are cheap here, gradient steps are not
        return sb3.SAC(
            **common, buffer_size=100_000, learning_starts=min(1000, settings.steps // 4), train_freq=1,
            gradient_steps=max(1, settings.envs // 4), policy_kwargs={"net_arch": [128, 128]},
        )  # fmt: skip
    rollout = min(2048, max(64, settings.steps // 8))  # a run of any length has some updates
    n_steps = max(8, rollout // settings.envs // 8 * 8)
    model = sb3.PPO(
        **common, n_steps=n_steps, batch_size=n_steps * settings.envs // 8, n_epochs=10, gae_lambda=0.5,
        policy_kwargs={"log_std_init": -1.5, "net_arch": [64, 64]},
    )  # fmt: skip
    if settings.aim == "target":  # a pot's tolerance is about half a degree of the three that the aim spans: explore within it
        model.policy.log_std.data[3] = -3.0
    return model


# checkpoints ---------------------------------------------------------------------------------------------------------------------


def write_atomic(path, data):
    """Write bytes so that ``path`` holds either the old or the new content, whole, whenever the process or the machine dies."""
    temporary = path.with_name(path.name + ".tmp")
    with open(temporary, "wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
    os.replace(temporary, path)


def zipped(model):
    """An SB3 model as the bytes of its zip file."""
    file = io.BytesIO()
    model.save(file)
    return file.getvalue()


def save_checkpoint(path, settings, model, seconds, curve):
    """All that training depends on, tables and random generators included: a resumed run equals an uninterrupted one."""
    state = {
        "settings": asdict(settings), "seconds": seconds, "curve": curve, "model": zipped(model),
        "replay": getattr(model, "replay_buffer", None), "tables": model.get_env().env_method("get_state"),
        "random": (np.random.get_state(), torch.get_rng_state(), model.action_space),  # noqa: NPY002 - SB3 draws from the global one
    }  # fmt: skip
    write_atomic(path, pickle.dumps(state, protocol=pickle.HIGHEST_PROTOCOL))


def load_model(state, settings, envs):
    """The agent of a checkpoint, its tables and random generators as they were."""
    model = {"ppo": sb3.PPO, "sac": sb3.SAC}[settings.algo].load(io.BytesIO(state["model"]), env=envs, device="cpu")
    if state["replay"] is not None:
        model.replay_buffer = state["replay"]
    numpy_state, torch_state, model.action_space = state["random"]
    np.random.set_state(numpy_state)  # noqa: NPY002
    torch.set_rng_state(torch_state)
    envs.set_options([{"state": table} for table in state["tables"]])  # for the reset with which learn() begins
    return model


class Keeper(BaseCallback):
    """Keeps the run: progress bar, learning curve, checkpoints, and an orderly stop after SIGINT or SIGTERM."""

    def __init__(self, path, settings, seconds, curve, progress):
        super().__init__()
        self.path, self.settings, self.seconds_before, self.curve = path, settings, seconds, curve
        self.bar = rich.progress.Progress(
            "[progress.description]{task.description}", rich.progress.BarColumn(), rich.progress.MofNCompleteColumn(),
            rich.progress.TimeElapsedColumn(), rich.progress.TextColumn("left"), rich.progress.TimeRemainingColumn(), disable=not progress,
        )  # fmt: skip
        self.signal, self.stop, self.saved = None, False, None

    def on_signal(self, number, frame):
        """Only note it: the save comes when the running update is done. A second signal acts at once."""
        self.signal = number
        signal.signal(number, signal.SIG_DFL if number != signal.SIGINT else signal.default_int_handler)
        self.bar.console.print(f"\n{signal.Signals(number).name}: saving after this update ...")

    @property
    def seconds(self):
        """Training time, with that before a resume."""
        return self.seconds_before + time.perf_counter() - self.started

    def _on_training_start(self):
        self.started = time.perf_counter()
        self.bar.start()
        self.task = self.bar.add_task(self.settings.algo.upper(), total=self.settings.steps, completed=self.num_timesteps)

    def _on_rollout_start(self):
        # here, and only here, everything played so far has been learned from: a checkpoint loses nothing
        recent = [visit["r"] for visit in self.model.ep_info_buffer or ()]
        if recent and self.num_timesteps >= len(self.curve) * self.settings.steps // 20:
            self.curve.append({"steps": self.num_timesteps, "points": round(float(np.mean(recent)), 3)})
        if recent:
            self.bar.update(self.task, description=f"{self.settings.algo.upper()} {np.mean(recent):.2f} points a visit")
        self.stop = self.signal is not None
        if self.stop or self.saved is None or self.num_timesteps - self.saved >= self.settings.checkpoint_every:
            self.save()

    def _on_step(self):
        self.bar.update(self.task, completed=min(self.num_timesteps, self.settings.steps))
        return not self.stop  # SB3 can stop only here; the one shot played since the save is played again after a resume

    def _on_training_end(self):
        self.seconds_before, self.started = self.seconds, time.perf_counter()
        if not self.stop:
            self.save()

    def save(self):
        """Write the checkpoint."""
        save_checkpoint(self.path, self.settings, self.model, self.seconds, self.curve)
        self.saved = self.num_timesteps


# the run -------------------------------------------------------------------------------------------------------------------------


def provenance():
    """What computed these figures."""
    versions = {"python": platform.python_version(), "platform": platform.platform()}
    for name in ("snooker-env", "numpy", "numba", "gymnasium", "stable-baselines3", "torch"):
        try:
            versions[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            versions[name] = "not installed: source tree"
    git = ["git", "-C", str(Path(__file__).resolve().parent), "describe", "--always", "--dirty", "--abbrev=40", "--exclude=*"]
    try:
        commit = subprocess.run(git, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        commit = None
    return {"versions": versions, "git_commit": commit, "processors": os.cpu_count()}


def open_run(parser, given, out, resume):
    """(settings, checkpoint or None); every reason not to start ends here with one message."""
    checkpoint = out / "checkpoint.pkl"
    if not resume:
        kept = [p.name for p in out.iterdir() if p.name not in ("tb", "checkpoint.pkl.tmp")] if out.is_dir() else []
        if kept or out.is_file():
            parser.error(f"{out} is not empty (it holds {', '.join(sorted(kept)[:3])}): --resume goes on with it, --out names another")
        return Settings(**given), None
    if not checkpoint.is_file():
        parser.error(f"{out} holds no checkpoint: start the run without --resume")
    state = pickle.loads(checkpoint.read_bytes())
    was = state["settings"]
    for name, value in given.items():
        if value != was[name] and name not in FREE_ON_RESUME:
            parser.error(f"--{name.replace('_', '-')} is {value!r} but the run in {out} has {was[name]!r}: give the same or leave it out")
    return Settings(**{**was, **given}), state


def main(argv=None):
    """Train, evaluate, save. Exit code 0, or 128 + the signal that stopped it."""
    parser, given, rest = parse(argv)
    out = rest.out
    settings, state = open_run(parser, given, out, rest.resume)
    if settings.steps == 0:
        settings = Settings(**{**asdict(settings), "steps": DEFAULT_STEPS[settings.algo]})
    print("Compiling ...", flush=True)
    snooker_env.warmup()
    try:
        make_env(settings)  # a bad option ends here, with the environment's own words
    except ValueError as error:
        parser.error(str(error))
    torch.set_num_threads(1)  # a network this small gains nothing from more, and the tables need the processors
    envs = make_envs(settings, threads=1 if settings.parallel == "one" else None)
    try:
        out.mkdir(parents=True, exist_ok=True)
        model = load_model(state, settings, envs) if state else make_model(settings, envs, str(out / "tb"))
        model.tensorboard_log = str(out / "tb")
        kept = state or {"seconds": 0.0, "curve": []}
        keeper = Keeper(out / "checkpoint.pkl", settings, kept["seconds"], kept["curve"], not rest.no_progress)
        before = {number: signal.signal(number, keeper.on_signal) for number in (signal.SIGINT, signal.SIGTERM)}
        print(f"{settings.algo.upper()} in {out}: {model.num_timesteps:,} of {settings.steps:,} shots played", flush=True)
        if model.num_timesteps < settings.steps:
            try:
                model.learn(settings.steps - model.num_timesteps, keeper, tb_log_name=settings.algo, reset_num_timesteps=state is None)
            finally:
                keeper.bar.stop()  # gives the terminal its cursor back, whatever happened
        for number, handler in before.items():
            signal.signal(number, handler)
    finally:
        envs.close()
    if keeper.signal:
        print(f"Saved at {keeper.saved or model.num_timesteps:,} shots. Go on with:  python train.py --resume --out {out}")
        return 128 + keeper.signal

    steps, seconds = model.num_timesteps, keeper.seconds_before
    print(f"{steps:,} shots in {seconds:.0f} s: {steps / seconds:.0f} a second, learning included. Evaluating ...", flush=True)
    write_atomic(out / "model.zip", zipped(model))
    evaluation = evaluate_all(settings, model)
    learned = lesson(settings, steps, evaluation)
    results = {
        "settings": asdict(settings), "steps": steps, "seconds": seconds, "steps_per_second": steps / seconds,
        "learned": learned, "evaluation": evaluation, "curve": keeper.curve, **provenance(),
    }  # fmt: skip
    write_atomic(out / "results.json", json.dumps(results, indent=1).encode())
    show(evaluation)
    print(f"{learned}\nFigures: {out / 'results.json'}   curves: tensorboard --logdir {out / 'tb'}")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit("Interrupted. If there is a checkpoint it is whole: --resume goes on from it.")
