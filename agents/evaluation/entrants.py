"""Who is compared? Players by name and trained models, one for each training seed, and how each was trained."""

import glob
import json
import zipfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from commands.physics_option import physics_text
from snooker_env import Options, SnookerVectorEnv
from snooker_env.checks import number, refuse

from ..learning.hyperparameters import ACTION_OPTIONS, value_of
from ..learning.models import POLICY, PRETRAINED, file_of, pretrained
from ..players.by_name import NAMES, is_player, player_of
from ..players.trained import load_any


@dataclass(frozen=True)
class Entrant:
    """What is compared: a player, or the models of one way to train, one for each seed."""

    label: str
    runs: tuple
    """Names, model files or run folders."""
    trust: bool = False
    """May code in its files run? Models of Stable-Baselines3 that train.py did not make need it."""
    options: tuple = ()
    """How the actions of such models are read: (key, value) of ``hyperparameters.ACTION_OPTIONS``."""
    frames: bool = False
    """Do they play frames, and not visits?"""

    @classmethod
    def of(cls, text, trust=False, options=(), frames=False):
        """From NAME, PATH or LABEL=PATH,PATH,... Raises ValueError."""
        label, equals, paths = text.partition("=") if not Path(text).exists() else ("", "", "")
        if not equals:
            label, paths = "", text
        runs = []
        for path in paths.split(","):
            if path in pretrained():
                path = str(PRETRAINED / f"{path}.zip")
            found = [path] if Path(path).exists() else _players(path) or sorted(glob.glob(path))
            if not found:
                known = ", ".join((*NAMES, *pretrained()))
                allowed = f"must be {known}, MODULE:CLASS, or name existing models: a .zip, a run folder, a pattern"
                raise refuse("agent", path, allowed)
            runs += found
        if equals and not label:
            raise refuse("agent", text, "must have a label before the =")
        if any(map(is_player, runs)) and not all(map(is_player, runs)):
            raise refuse("agent", text, "must be players or trained models, not both under one label")
        if is_player(runs[0]):
            return cls(label or runs[0].rpartition(":")[2], tuple(runs), frames=frames)
        path = Path(runs[0])
        return cls(label or (path.parent if path.name in ("model.zip", POLICY) else path).stem, tuple(runs), trust, options, frames)

    def trained(self):
        """How each run was trained, as far as its files say: a dict a run, {} for a player that was not trained."""
        return [self._training(run) for run in self.runs]

    @property
    def foreign(self):
        """Whether a model is among them that train.py did not make."""
        return not is_player(self.runs[0]) and any(_model(run, self.trust, self.options).foreign for run in self.runs)

    def player(self, k, budget):
        """A fresh player of its run k, or its model, read once. ``budget``: of a search; its seed is k."""
        run = self.runs[k]
        return player_of(run, budget=budget, seed=k, frames=self.frames) if is_player(run) else _model(run, self.trust, self.options)

    def _training(self, run):
        if is_player(run):
            player = player_of(run, frames=self.frames)  # one's own may not be there
            run = getattr(player, "model", None)  # the weights that a planner was given
            if run is None:
                return {}
            run = str(PRETRAINED / f"{run}.zip") if run in pretrained() else run
        model, path = _model(run, self.trust, self.options).model, Path(run)
        card, results = path.with_suffix(".json"), (path if path.is_dir() else path.parent) / "results.json"
        if path.is_file() and card.is_file():
            seconds, imitated = _number_in(card, "hours"), _number_in(card, "imitated")
            seconds = None if seconds is None else 3600.0 * seconds
        else:
            seconds, imitated = _number_in(results, "seconds"), model.imitated
        usual = {"layout": Options().layout, "noise": "none", "fidelity": "standard"}
        return {
            "recipe": model.recipe, "shots": model.num_timesteps, "imitated": imitated, "seconds": seconds, "seed": model.seed,
            "gamma": model.gamma, **{key: model.env_options.get(key, value) for key, value in usual.items()},
            "physics": physics_text(model.env_options.get("physics", "paper")),
        }  # fmt: skip


def options_of(changes):
    """What the "key=value" of --options say, as ``Entrant.options``. Raises ValueError."""
    found = {}
    for change in changes:
        key, equals, value = change.partition("=")
        if not equals or key not in ACTION_OPTIONS or key in found:
            raise refuse("options", change, f"must be KEY=VALUE, KEY once each of {', '.join(ACTION_OPTIONS)}")
        found[key] = value_of(value)
    SnookerVectorEnv(1, **found)  # makes sure of the values
    return tuple(found.items())


def _players(name):
    """The player of that name in a list; several for a planner whose model is a pattern; [] if it is not a player's name."""
    kind, at, pattern = name.partition("@")
    if at and is_player(name):
        return [f"{kind}@{model}" for model in sorted(glob.glob(pattern))] or [name]
    return [name] if is_player(name) else []


@cache
def _model(path, trust, options):
    if not zipfile.is_zipfile(file_of(Path(path), "agent")):
        raise refuse("agent", path, "must be a model's .zip or a folder that holds model.zip")
    return load_any(Path(path), trust, dict(options))


def _number_in(file, name):
    """The number of this name that a JSON file holds; None if it holds none. Raises ValueError."""
    try:
        found = json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}
    except ValueError as error:
        raise refuse("agent", str(file), f"must be JSON ({error})") from None
    if not isinstance(found, dict):
        raise refuse("agent", str(file), f"must hold {name} in an object")
    return None if found.get(name) is None else number(f"{file}: {name}", found[name], 0)
