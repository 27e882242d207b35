"""What can you set in a training? The options of ``train.py``."""

import argparse
import shlex
from dataclasses import dataclass, field, fields
from pathlib import Path

from snooker_env.game import HELD_OUT

from .hyperparameters import names
from .learn_strokes import AGENT

AGENTS, CONDITIONS = (*names(), AGENT), ("", "fixed", "drawn")


def option(default, text, **more):
    """A dataclass field that is also a command-line option."""
    return field(default=default, metadata={"help": text, **more})


@dataclass(frozen=True)
class Settings:
    """The settings of a run."""

    agent: str = option("strokes", "the agent: a file of agents/hyperparams, or stroke_value", choices=AGENTS)
    steps: int = option(0, "number of shots, rounded up to whole rollouts; 0: the recipe's")
    envs: int = option(0, "number of parallel tables; 0: the recipe's")
    parallel: str = option(
        "auto", "threads: auto is one per processor; results do not depend on it", choices=("auto", "one")
    )
    seed: int = option(0, "random seed of tables, weights and exploration")
    layout: str = option("", "layout of the training tables [the recipe's]")
    noise: str = option(
        "", "execution noise: none, professional, amateur, club, robot, olympiad [the recipe's]"
    )
    fidelity: str = option(
        "", "fidelity of the simulation: fast, standard, reference or euler:N [the recipe's]"
    )
    physics: str = option(
        "", "physics of the tables: paper, match, or with changes, like paper,mu_bb=marlow [the recipe's]"
    )
    conditions: str = option(
        "", "fixed, or drawn: a different table for each episode [the recipe's]", choices=CONDITIONS
    )
    observe_conditions: bool = option(False, "observe the constants of the table; with --conditions drawn")
    imitate: int = option(-1, "positions of expert iteration before PPO; -1: the recipe's number")
    set: tuple = option((), "change hyperparameters, for example gamma=0", nargs="+")
    eval_visits: int = option(500, f"visits of the final evaluation on held-out tables, at most {HELD_OUT}")

    @property
    def command(self):
        """The command that repeats this run."""
        words = ["python", "train.py"]
        for f in fields(self):
            value = getattr(self, f.name)
            if isinstance(value, bool):
                words += [f"--{f.name.replace('_', '-')}"] * value
            elif f.name == "agent" or (value != f.default and f.name not in ("parallel", "eval_visits")):
                words += [f"--{f.name}", *map(str, value if f.name == "set" else [value])]
        return shlex.join(words)


BOUNDS = {
    "steps": (0, 10**12),
    "envs": (0, 2**24),
    "seed": (0, 2**32 - 1),
    "imitate": (-1, 10**9),
    "eval_visits": (2, HELD_OUT),
}
FREE_ON_RESUME = ("steps", "parallel", "eval_visits")
"""Options of duration and place, free on --resume; the learning rate falls over the new steps."""


def parse(argv):
    """Read the command line: (parser, the given options, the rest: out, resume)."""
    about = "Train an agent, compare it with simple players on held-out tables, and report the result."
    parser = argparse.ArgumentParser("train.py", "python train.py [options]", about)
    for f in fields(Settings):
        name = "--" + f.name.replace("_", "-")
        if isinstance(f.default, bool):
            parser.add_argument(name, action="store_true", default=argparse.SUPPRESS, help=f.metadata["help"])
            continue
        parser.add_argument(
            name,
            type=str if f.name == "set" else type(f.default),
            choices=f.metadata.get("choices"),
            default=argparse.SUPPRESS,
            metavar=None if "choices" in f.metadata else f.name.split("_")[-1].upper(),
            nargs=f.metadata.get("nargs"),
            help=f.metadata["help"] + (f" [{f.default}]" if f.default not in ("", (), 0) else ""),
        )
    parser.add_argument("--out", type=Path, help="folder of the run [runs/AGENT-SEED]")
    what = "continue the run in that folder; other options keep their values"
    parser.add_argument("--resume", action="store_true", help=what)
    given = vars(parser.parse_args(argv))
    rest = argparse.Namespace(**{name: given.pop(name) for name in ("out", "resume")})
    for name, (low, high) in BOUNDS.items():
        if not low <= given.get(name, low) <= high:
            value = f"--{name.replace('_', '-')} is {given[name]}"
            parser.error(f"{value}, must be an integer in [{low}, {high}]")
    if "set" in given:
        given["set"] = tuple(given["set"])
    agent, seed = given.get("agent", Settings.agent), given.get("seed", Settings.seed)
    rest.out = rest.out or Path("runs", f"{agent}-{seed}")
    return parser, given, rest
