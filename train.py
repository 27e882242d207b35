"""How does an agent learn to play Snooker-v0? Train one, check it against random play on tables it never saw, and say what it learned.

    python train.py                                    four to ten minutes on two cores: PPO that looks one shot ahead
    python train.py --steps 1 --imitate 2000           a few minutes of the same
    python train.py --agent ppo_mask --seed 1 --out runs/mine
    python train.py --resume --out runs/mine           go on after Ctrl-C, a kill or a power cut, exactly where the last checkpoint was

A run folder holds ``checkpoint.pkl`` (all that a resumed run needs; a pickle, and loading one runs what it holds: --resume only your own),
``model.zip`` (for ``python -m agents.evaluate`` and --start, which run nothing of it, and for ``PPO.load`` of ``stable_baselines3``, which
unpickles), ``results.json`` (every figure) and ``tb/`` (``tensorboard --logdir runs``).

What an agent sees is in ``agents/view.py``, how it is made in ``agents/hyperparams/``, how its visits are judged in ``agents/visits.py``,
what is said of them in ``agents/lesson.py``; here follow, top to bottom: settings, checkpoints, the run.
"""

import argparse
import importlib.metadata
import io
import json
import os
import pickle
import platform
import shlex
import signal
import sys
import tempfile
import time
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import Any

import numpy as np

import snooker_env
from snooker_env._check import refuse
from snooker_env.envs.vector import processors
from snooker_env.game.opened import HELD_OUT

try:
    import rich.progress
    import tensorboard  # noqa: F401 - stable_baselines3 would miss it only after the tables are set up
    import torch
    from stable_baselines3.common.callbacks import BaseCallback

    from agents.commit import commit
    from agents.lesson import evaluate, lesson, show
    from agents.models import load_weights, write_atomic, write_model, zipped
    from agents.recipes import Recipe, algorithm, names
    from agents.tables import training_tables
    from agents.world import world
except ImportError as error:
    raise SystemExit(f'train.py: {error.name} is missing; train.py needs:  pip install "snooker-env[train]"') from None

# settings ------------------------------------------------------------------------------------------------------------------------


def option(default, text, **more):
    """A dataclass field that is also a command-line option."""
    return field(default=default, metadata={"help": text, **more})


@dataclass(frozen=True)
class Settings:
    """What makes a run the run it is."""

    agent: str = option("ppo_foresight", "what learns, and how: a file of agents/hyperparams", choices=tuple(names()))
    steps: int = option(0, "shots in all; 0: as many as the recipe says")
    envs: int = option(0, "tables played side by side; 0: as many as the recipe says")
    parallel: str = option("auto", "threads for the tables: auto is one a processor; the same shots come out", choices=("auto", "one"))
    seed: int = option(0, "of tables, weights and exploration")
    layout: str = option("", "where training visits start [the recipe's]")
    noise: str = option("", "execution noise: none, professional, amateur, club or olympiad [the recipe's]")
    fidelity: str = option("", "of the simulation: fast, standard, reference or euler:N [the recipe's]")
    physics: str = option("", "of the tables: paper, match, or with changes as paper,mu_bb=marlow [the recipe's]")
    imitate: int = option(-1, "positions on which it is first taught by the search; -1: as many as the recipe says")
    start: str = option("", "a model of the same agent to start from, its .zip or run folder; nothing in it is run")
    set: tuple = option((), "other hyper-parameters, as gamma=0", nargs="+")
    eval_visits: int = option(500, f"held-out visits each agent plays at the end, each on a table of its own, of {HELD_OUT}")
    checkpoint_every: int = option(100_000, "shots from one checkpoint to the next")


BOUNDS = {
    "steps": (0, 10**12), "envs": (0, 2**24), "seed": (0, 2**32 - 1), "imitate": (-1, 10**9), "eval_visits": (2, HELD_OUT),
    "checkpoint_every": (1, 10**12),
}  # fmt: skip
FREE_ON_RESUME = ("steps", "parallel", "eval_visits", "checkpoint_every")  # how long and where, not what; lr falls over the new steps


def parse(argv):
    """(parser, options given on the command line, the rest)."""
    parser = argparse.ArgumentParser("train.py", "python train.py [options]", (__doc__ or "").partition("\n")[0])
    for f in fields(Settings):
        parser.add_argument(
            "--" + f.name.replace("_", "-"), type=str if f.name == "set" else type(f.default), choices=f.metadata.get("choices"),
            default=argparse.SUPPRESS, metavar=None if "choices" in f.metadata else f.name.split("_")[-1].upper(),
            nargs=f.metadata.get("nargs"), help=f.metadata["help"] + (f" [{f.default}]" if f.default not in ("", (), 0) else ""),
        )  # fmt: skip
    parser.add_argument("--out", type=Path, help="the run's folder [runs/AGENT-SEED]")
    parser.add_argument("--resume", action="store_true", help="go on with the run in that folder; what is not given is as it was")
    parser.add_argument("--no-progress", action="store_true", help="no progress bar")
    given = vars(parser.parse_args(argv))
    rest = {name: given.pop(name) for name in ("out", "resume", "no_progress")}
    for name, (low, high) in BOUNDS.items():
        if not low <= given.get(name, low) <= high:
            parser.error(f"--{name.replace('_', '-')} is {given[name]}, must be an integer in [{low}, {high}]")
    if "set" in given:
        given["set"] = tuple(given["set"])
    rest["out"] = rest["out"] or Path("runs", f"{given.get('agent', Settings.agent)}-{given.get('seed', Settings.seed)}")
    return parser, given, argparse.Namespace(**rest)


def recipe_of(settings):
    """The agent's recipe with what the settings change. Raises ValueError."""
    told = {"layout": settings.layout, "noise": settings.noise, "fidelity": settings.fidelity}
    told["physics"] = world(settings.physics) if settings.physics else ""
    numbers = {"n_timesteps": settings.steps, "n_envs": settings.envs}
    given = {key: value for key, value in numbers.items() if value}
    if settings.start:
        if settings.imitate > 0:
            raise refuse("imitate", settings.imitate, "must be 0 or left out with --start, which brings what was learned before")
        given["imitation"] = 0
    elif settings.imitate >= 0:
        given["imitation"] = settings.imitate
    recipe = Recipe.of(settings.agent, settings.set, {key: value for key, value in told.items() if value}, **given)
    if recipe.imitation and recipe.algo != "ppo_mask":
        raise refuse("imitate", recipe.imitation, f"must be 0 for {recipe.name}: only agents with masks can be taught by the search")
    return recipe


def imitate(model, tables, states, settings, progress):
    """Let the search teach the agent; the curve. It is not checkpointed: a run stopped here begins anew."""
    from agents.imitate import teach

    threads = 1 if settings.parallel == "one" else processors()
    bar = rich.progress.Progress(disable=not progress)
    task = bar.add_task(f"{settings.agent} learns from the search", total=states)
    with bar:
        curve = teach(model, tables, states, settings.seed, threads, lambda done, loss: bar.update(task, completed=done))
    model.imitated = curve[-1]["states"]
    return curve


# checkpoints ---------------------------------------------------------------------------------------------------------------------


def save_checkpoint(path, settings, model, seconds, curve, imitation):
    """All that training and its curve depend on, tables and random generators included: a resumed run equals an uninterrupted one."""
    state = {
        "settings": asdict(settings), "seconds": seconds, "curve": curve, "imitation": imitation, "model": zipped(model),
        "replay": getattr(model, "replay_buffer", None), "tables": model.get_env().env_method("get_state"),
        "running": model.get_env().running,
        "random": (np.random.get_state(), torch.get_rng_state(), model.action_space),  # noqa: NPY002 - SB3 draws from the global one
    }  # fmt: skip
    write_atomic(path, pickle.dumps(state, protocol=pickle.HIGHEST_PROTOCOL))


def stale(path):
    """The complaint about a checkpoint that cannot be used."""
    return refuse("resume", str(path), "must be a whole checkpoint of today's train.py: this one is broken or older, start the run anew")


def load_model(state, algo, envs):
    """The agent of a checkpoint, its tables and random generators as they were."""
    model = algorithm(algo).load(io.BytesIO(state["model"]), env=envs, device="cpu", seed=None)  # it would seed the tables anew
    model.seed = state["settings"]["seed"]
    if state["replay"] is not None:
        model.replay_buffer = state["replay"]
    numpy_state, torch_state, model.action_space = state["random"]
    np.random.set_state(numpy_state)  # noqa: NPY002
    torch.set_rng_state(torch_state)
    envs.set_options([{"state": table} for table in state["tables"]])  # for the reset with which learn() begins
    return model


def goal_of(model, steps):
    """Shots played when training to ``steps`` ends: it goes by whole rollouts."""
    off_policy = hasattr(model, "train_freq")  # their n_steps is that of n-step returns
    rollout = model.n_envs * (model.train_freq.frequency if off_policy else model.n_steps)
    return model.num_timesteps + rollout * -(-max(0, steps - model.num_timesteps) // rollout)


class Keeper(BaseCallback):
    """Keeps the run: progress bar, learning curve, checkpoints, and an orderly stop after SIGINT or SIGTERM."""

    def __init__(self, path, settings, seconds, curve, imitation, running, progress):
        super().__init__()
        self.imitation, self.running = imitation, running
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
        self.bar.console.print(f"\n{signal.Signals(number).name}: saving after this update ... (once more stops at once, without a save)")

    @property
    def seconds(self):
        """Training time, with that before a resume."""
        return self.seconds_before + time.perf_counter() - self.started

    def _on_training_start(self):
        self.started = time.perf_counter()
        if self.running is not None:  # the reset with which learn() began took them for new visits
            tables: Any = self.training_env
            tables.running = self.running
        self.bar.start()
        total = goal_of(self.model, self.settings.steps)
        self.task = self.bar.add_task(self.settings.agent, total=total, completed=self.num_timesteps)

    def _on_rollout_start(self):
        # here, and only here, everything played so far has been learned from: a checkpoint loses nothing
        recent = [visit["r"] for visit in self.model.ep_info_buffer or ()]
        due = self.num_timesteps >= len(self.curve) * self.settings.steps // 20
        if recent and due and self.num_timesteps > (self.curve[-1]["steps"] if self.curve else -1):  # a resume comes here a second time
            self.curve.append({"steps": self.num_timesteps, "points": round(float(np.mean(recent)), 3)})
        if recent:
            self.bar.update(self.task, description=f"{self.settings.agent} {np.mean(recent):.2f} points a visit")
        self.stop = self.signal is not None
        if self.stop or self.saved is None or self.num_timesteps - self.saved >= self.settings.checkpoint_every:
            self.save()

    def _on_step(self):
        self.bar.update(self.task, completed=self.num_timesteps)
        return not self.stop  # SB3 can stop only here; the one shot played since the save is played again after a resume

    def _on_training_end(self):
        self.seconds_before, self.started = self.seconds, time.perf_counter()
        if not self.stop:
            self.save()

    def save(self):
        """Write the checkpoint."""
        save_checkpoint(self.path, self.settings, self.model, self.seconds, self.curve, self.imitation)
        self.saved = self.num_timesteps


# the run -------------------------------------------------------------------------------------------------------------------------


def provenance():
    """What computed these figures."""
    versions = {"python": platform.python_version(), "platform": platform.platform()}
    for name in ("snooker-env", "numpy", "numba", "gymnasium", "stable-baselines3", "sb3-contrib", "torch"):
        try:
            versions[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            versions[name] = "not installed: source tree"
    return {"versions": versions, "git_commit": commit(), "processors": os.cpu_count()}


def command_of(settings):
    """The command that makes this run."""
    words = ["python", "train.py"]
    for f in fields(Settings):
        value = getattr(settings, f.name)
        if f.name == "agent" or (value != f.default and f.name not in ("parallel", "eval_visits", "checkpoint_every")):
            words += [f"--{f.name}", *map(str, value if f.name == "set" else [value])]
    return shlex.join(words)


def refuse_full(parser, out):
    """End with a message if the folder holds another run, or anything."""
    held = sorted(p.name for p in out.iterdir() if p.name not in ("tb", "checkpoint.pkl.tmp")) if out.is_dir() else []
    if held:
        parser.error(f"{out} is not empty (it holds {', '.join(held[:3])}): --resume goes on with it, --out names another")


def open_run(parser, given, out, resume):
    """(settings, checkpoint or None) of a folder and the options given."""
    checkpoint = out / "checkpoint.pkl"
    if not resume:
        if out.exists() and not out.is_dir():
            raise refuse("out", str(out), "must be a folder, new or empty")
        return Settings(**given), None
    if not checkpoint.is_file():
        parser.error(f"{out} holds no checkpoint: start the run without --resume")
    try:
        state = pickle.loads(checkpoint.read_bytes())
        was = asdict(Settings(**state["settings"]))
        if not state.keys() >= {"model", "tables", "random", "replay", "running", "imitation", "curve", "seconds"}:
            raise KeyError
    except Exception:  # whatever pickle makes of a file that is something else
        raise stale(checkpoint) from None
    for name, value in given.items():
        if value != was[name] and name not in FREE_ON_RESUME:
            parser.error(f"--{name.replace('_', '-')} is {value!r} but the run in {out} has {was[name]!r}: give the same or leave it out")
    return Settings(**{**was, **given}), state


# the whole -----------------------------------------------------------------------------------------------------------------------


def prepared(parser, given, out, resume):
    """(settings, recipe, checkpoint or None, tables, model): whatever can be wrong is found here, before anything is compiled or played."""
    try:
        settings, state = open_run(parser, given, out, resume)
        recipe = recipe_of(settings)
        settings = replace(settings, steps=recipe.n_timesteps, envs=recipe.n_envs, imitate=recipe.imitation)
        tables = training_tables(recipe.n_envs, threads=1 if settings.parallel == "one" else None, view=recipe.view, **recipe.env_kwargs)
        if not resume:
            refuse_full(parser, out)  # another folder is no use as long as an option is wrong
        if state:
            try:
                model = load_model(state, recipe.algo, tables)
            except Exception:  # of an older network, or with a part missing
                raise stale(out / "checkpoint.pkl") from None
        else:
            model = recipe.new_model(tables, settings.seed)
            if settings.start:
                load_weights(model, Path(settings.start))
        out.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=out).close()
    except ValueError as error:
        parser.error(str(error))
    except OSError as error:
        parser.error(f"out = {str(out)!r}: must be a folder that can be written ({error.strerror})")
    return settings, recipe, state, tables, model


def main(argv=None):
    """Train, evaluate, save. Exit code 0, or 128 + the signal that stopped it."""
    parser, given, rest = parse(argv)
    out = rest.out
    torch.set_num_threads(1)  # a network this small gains nothing from more, and the tables need the processors
    torch.distributions.Distribution.set_default_validate_args(False)  # checks of every number, a twentieth of the time
    settings, recipe, state, tables, model = prepared(parser, given, out, rest.resume)
    try:
        print("Compiling ...", flush=True)
        snooker_env.warmup()
        began, imitation = time.perf_counter(), state["imitation"] if state else []
        if recipe.imitation and not state:
            imitation = imitate(model, tables, recipe.imitation, settings, not rest.no_progress)
        model.tensorboard_log = str(out / "tb")
        kept = state or {"seconds": time.perf_counter() - began, "curve": [], "running": None}
        keeper = Keeper(
            out / "checkpoint.pkl", settings, kept["seconds"], kept["curve"], imitation, kept["running"], not rest.no_progress
        )  # fmt: skip
        before = {number: signal.signal(number, keeper.on_signal) for number in (signal.SIGINT, signal.SIGTERM)}
        print(f"{settings.agent} in {out}: {model.num_timesteps:,} of {goal_of(model, settings.steps):,} shots played", flush=True)
        if model.num_timesteps >= settings.steps:
            print("Nothing is left to train.", flush=True)
        else:
            try:
                model.learn(settings.steps - model.num_timesteps, keeper, tb_log_name=settings.agent, reset_num_timesteps=state is None)
            finally:
                keeper.bar.stop()  # gives the terminal its cursor back, whatever happened
        for number, handler in before.items():
            signal.signal(number, handler)
    finally:
        tables.close()
    if keeper.signal:
        print(
            f"Saved at {keeper.saved or model.num_timesteps:,} shots. Go on with:  python train.py --resume --out {shlex.quote(str(out))}"
        )
        return 128 + keeper.signal

    steps, seconds = model.num_timesteps, keeper.seconds_before
    print(f"{steps:,} shots in {seconds:.0f} s: {steps / seconds:.0f} a second, learning included. Evaluating ...", flush=True)
    write_model(model, out / "model.zip")
    figures = evaluate(recipe, model, settings.eval_visits, settings.seed)
    learned = lesson(settings.agent, steps, model.imitated, figures, model.start)
    results = {
        "command": command_of(settings), "settings": asdict(settings), "steps": steps, "seconds": seconds,
        "steps_per_second": steps / seconds, "start": model.start, "learned": learned,
        "evaluation": figures, "curve": keeper.curve, "imitation": imitation, **provenance(),
    }  # fmt: skip
    write_atomic(out / "results.json", json.dumps(results, indent=1).encode())
    show(figures)
    print(f"{learned}\nFigures: {out / 'results.json'}   curves: tensorboard --logdir {out / 'tb'}")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit("Interrupted. A run that was saved goes on with --resume, another begins anew.")
