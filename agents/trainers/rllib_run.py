"""How is an agent trained with RLlib from the command line? Train, save, resume, judge on held-out tables.

    python -m agents.train_rllib                             300,000 shots with one env runner: some minutes
    python -m agents.train_rllib --runners 2 --out runs/two  two env runners, each with its own tables
    python -m agents.train_rllib --resume --out runs/two     go on after Ctrl-C or a kill
    python -m agents.evaluate --agent runs/two               our protocol, beside any other agent

Files of a run folder: ``policy.npz``, the policy as plain weights; ``untrained.npz``, the same before the
first update; ``results.json``, every figure; ``state.json`` and a folder ``checkpoint-N`` of RLlib's own,
from which a run goes on. It holds pickles, whose loading runs code: --resume only your own runs.

A resumed run has the weights, the optimiser and the counters of the checkpoint. It is not bit for bit the
uninterrupted one: RLlib saves neither the tables nor the random generators of its runners. They begin anew,
with seeds that no earlier part of the run has used.
"""

import argparse
import hashlib
import logging
import os
import re
import shutil
import sys
import time
from contextlib import ExitStack
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import Any

from commands.lifecycle import command, needs

with needs("agents.train_rllib"):
    import ray
    import torch

    for part in ("ray", "ray.rllib"):  # before RLlib is imported, which warns of its own parts
        logging.getLogger(part).setLevel(logging.ERROR)

    import snooker_env
    from commands.files import read_json, sealed, with_checksum, write_json
    from commands.lock import NAME as LOCK
    from commands.lock import Lock
    from snooker_env import Options
    from snooker_env.benchmark import play_visits, summary
    from snooker_env.benchmark.provenance import software
    from snooker_env.benchmark.tasks import tables_of
    from snooker_env.checks import integer, refuse
    from snooker_env.game import HELD_OUT
    from snooker_env.progress import Progress

    from ..evaluation.training_summary import show
    from ..learning.callback import Stop
    from ..learning.hyperparameters import not_held_out
    from ..learning.models import POLICY
    from ..learning.policy_files import read_policy, write_policy
    from ..players.trained import player_of_model
    from .rllib_config import ACTIVATION, BATCH, GAMMA, PATIENCE, algorithm_of, layers_of, restore, started

STATE, UNTRAINED, RESULTS = "state.json", "untrained.npz", "results.json"
_CHECKPOINT = re.compile(r"checkpoint-\d+(\.tmp)?")
SEEDS = 10**6
"""Seeds that each part of a run has to itself, from one resume to the next."""


@dataclass(frozen=True)
class RunSettings:
    """The settings of a run."""

    steps: int = 300_000
    runners: int = 1
    envs: int = 64
    seed: int = 0
    noise: str = "professional"
    layout: str = "opened"
    eval_visits: int = 500
    checkpoint_every: int = 50_000

    @property
    def env_options(self):
        """Options of the environment that are the user's choice."""
        return {"noise": self.noise, "layout": self.layout}


OPTIONS = {
    "steps": ("total number of shots, rounded up to whole updates", 1, 10**12),
    "runners": ("env runners, each a process", 1, 1024),
    "envs": ("tables of a runner", 1, BATCH),
    "seed": ("of weights, tables and exploration", 0, 2**31),
    "noise": ("execution noise: none, professional, amateur, club, robot or olympiad",),
    "layout": ("of the training tables",),
    "eval_visits": ("visits of the final evaluation on held-out tables", 2, HELD_OUT),
    "checkpoint_every": ("shots between two checkpoints", 1, 10**12),
}
"""What each is, and the least and largest of those that are numbers."""
FREE_ON_RESUME = ("steps", "runners", "eval_visits", "checkpoint_every")


def parse(argv):
    """(parser, options given on the command line, the rest)."""
    about = (__doc__ or "").partition("\n")[0]
    parser = argparse.ArgumentParser("python -m agents.train_rllib", description=about)
    for f in fields(RunSettings):
        how: dict[str, Any] = {"type": type(f.default), "help": f"{OPTIONS[f.name][0]} [{f.default}]"}
        parser.add_argument("--" + f.name.replace("_", "-"), default=argparse.SUPPRESS, **how)
    parser.add_argument("--out", type=Path, help="the run's folder [runs/rllib-SEED]")
    what = "go on with the run in that folder; options left out keep their values"
    parser.add_argument("--resume", action="store_true", help=what)
    given = vars(parser.parse_args(argv))
    out, resume = given.pop("out"), given.pop("resume")
    return parser, given, out or Path("runs", f"rllib-{given.get('seed', RunSettings.seed)}"), resume


def checked(settings):
    """The settings. Raises ValueError."""
    for name, (_, *ends) in OPTIONS.items():
        if ends:
            integer(name, getattr(settings, name), *ends)
    not_held_out(settings.layout)
    Options(action="discrete", observation="masked", **settings.env_options)
    return settings


@dataclass
class Counters:
    """How far a run has come: what ``state.json`` holds beside the settings."""

    shots: int = 0
    updates: int = 0
    seconds: float = 0.0
    parts: int = 0
    """How often it was started."""
    checkpoint: str | None = None
    """The folder of RLlib's."""
    digest: str | None = None
    """Of all files in it."""


def digest_of(folder):
    """A digest of all files in a folder, their names too."""
    files = {file.relative_to(folder).as_posix(): file for file in folder.rglob("*") if file.is_file()}
    made = hashlib.sha256()
    for name in sorted(files):
        made.update(sealed(files[name].read_bytes(), name)[-32:])
    return made.hexdigest()


def opened(out, given, resume):
    """(settings, progress) of a new run or of the one in the folder. Raises ValueError."""
    if not resume:
        return checked(RunSettings(**given)), Counters()
    try:
        found = read_json("out", out / STATE, "must be whole", checked=True)
        was, progress = checked(RunSettings(**found["settings"])), Counters(**found["progress"])
        if digest_of(out / str(progress.checkpoint)) != progress.digest:
            raise ValueError(f"{progress.checkpoint} is missing or damaged")
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise refuse("out", str(out), f"must be the folder of a run with a checkpoint ({error})") from None
    for name, value in given.items():
        if value != getattr(was, name) and name not in FREE_ON_RESUME:
            raise refuse(name, value, f"must be {getattr(was, name)!r}, as in the run in {out}, or left out")
    return checked(replace(was, **given)), progress


def claimed(out, resume):
    """The ``Lock`` on the run's folder. Raises ValueError if it is in use, or not new."""
    if out.exists() and not out.is_dir():
        raise refuse("out", str(out), "must be a folder, new or empty")
    out.mkdir(parents=True, exist_ok=True)
    held = sorted(file.name for file in out.iterdir() if file.name != LOCK)
    if held and not resume:
        others = f"is not empty (it holds {', '.join(held[:3])})"
        raise refuse("out", str(out), f"{others}: --resume continues it, --out names another folder")
    return Lock(out)


def save(out, settings, progress, algorithm):
    """A checkpoint: RLlib's folder first, then the file that names it: a kill leaves a whole one."""
    name = f"checkpoint-{progress.updates:06d}"
    if progress.checkpoint != name:
        half = (out / f"{name}.tmp").absolute()
        shutil.rmtree(half, ignore_errors=True)
        algorithm.save_to_path(str(half))
        shutil.rmtree(out / name, ignore_errors=True)
        os.replace(half, out / name)
        progress.checkpoint, progress.digest = name, digest_of(out / name)
    _write(out / POLICY, settings, progress, algorithm)
    write_json(out / STATE, with_checksum({"settings": asdict(settings), "progress": asdict(progress)}))
    for file in out.iterdir():
        if _CHECKPOINT.fullmatch(file.name) and file.name != name:
            shutil.rmtree(file, ignore_errors=True)


def _write(file, settings, progress, algorithm):
    about = {"trainer": "RLlib", "activation": ACTIVATION, "gamma": GAMMA, "shots": progress.shots}
    about |= {"seed": settings.seed, "env_options": settings.env_options}
    write_policy(file, layers_of(algorithm), **about)


def train(out, settings, progress, algorithm, stop):
    """Updates until all shots are played or a signal comes, with checkpoints."""
    saved, before, began = progress.shots, progress.seconds, time.perf_counter()
    with Progress("RLlib", settings.steps, "shots", done=progress.shots, to=sys.stdout) as shown:
        while progress.shots < settings.steps and stop.signal is None:
            sampled = algorithm.train().get("env_runners")
            if not sampled or "num_env_steps_sampled_lifetime" not in sampled:  # RLlib goes on without one
                save(out, settings, progress, algorithm)
                why = f"no env runner gave a sample in {PATIENCE:.0f} s; saved at {progress.shots:,} shots"
                raise SystemExit(f"agents.train_rllib: {why}")
            progress.shots = int(sampled["num_env_steps_sampled_lifetime"])
            progress.updates += 1
            progress.seconds = before + time.perf_counter() - began
            points = sampled.get("episode_return_mean", float("nan"))
            shown.at(progress.shots, f"update {progress.updates:,}, {points:.2f} points a visit")
            if progress.shots - saved >= settings.checkpoint_every:
                save(out, settings, progress, algorithm)
                saved = progress.shots
    save(out, settings, progress, algorithm)


def judge(out, settings, progress):
    """Held-out visits of the policy, trained and not, and of simple players: ``results.json`` and a table."""
    files = {"trained": POLICY, "untrained": UNTRAINED}
    players = {name: player_of_model(read_policy(out / file, "out")) for name, file in files.items()}
    players |= {name: snooker_env.player(name) for name in ("ghost_ball", "random")}
    seeds = tables_of("held_out", settings.eval_visits)
    figures = {
        name: summary(play_visits(player, settings.eval_visits, first_seed=seeds, noise=settings.noise))
        for name, player in players.items()
    }
    rate = progress.shots / max(progress.seconds, 1e-9)
    results = {"settings": asdict(settings), **asdict(progress), "shots_per_second": rate}
    results |= {"versions": {"ray": ray.__version__, **software()}, "evaluation": figures}
    write_json(out / RESULTS, results)
    show(figures)
    print(f"Figures: {out / RESULTS}   by our protocol: python -m agents.evaluate --agent {out}")


@command("agents.train_rllib")
def main(argv=None):
    """Train, save, judge. Exit code 0, or 128 + the signal that stopped it."""
    parser, given, out, resume = parse(argv)
    with ExitStack() as ending:
        try:
            settings, progress = opened(out, given, resume)
            lock = claimed(out, resume)
            ending.callback(lock.release)
        except ValueError as error:
            parser.error(str(error))
        except OSError as error:
            parser.error(f"out = {str(out)!r}: must be a folder that can be written ({error.strerror})")
        if progress.shots >= settings.steps:
            print(f"All {progress.shots:,} shots are played: nothing left to train.")
            judge(out, settings, progress)
            return 0
        snooker_env.warmup()  # before the runners start: each would compile everything for itself
        torch.set_num_threads(1)
        ending.callback(ray.shutdown)
        roots = Path(snooker_env.__file__).parents[1], Path(__file__).parents[2]
        started(settings.runners, os.pathsep.join(map(str, roots)))
        algorithm = algorithm_of(settings, settings.seed + SEEDS * progress.parts)
        ending.callback(algorithm.stop)
        progress.parts += 1
        if progress.checkpoint:
            restore(algorithm, (out / progress.checkpoint).absolute())
        else:
            _write(out / UNTRAINED, settings, progress, algorithm)
        with Stop() as stop:
            stop.running = f"this update of {BATCH:,} shots"
            print(f"RLlib in {out}: {progress.shots:,} of {settings.steps:,} shots played", flush=True)
            train(out, settings, progress, algorithm, stop)
    if stop.signal:
        again = f"python -m agents.train_rllib --resume --out {out}"
        print(f"Saved at {progress.shots:,} shots. Continue with:  {again}")
        return 128 + stop.signal
    judge(out, settings, progress)
    return 0


if __name__ == "__main__":
    sys.exit(main())
