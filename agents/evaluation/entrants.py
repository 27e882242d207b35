"""Who is compared? Players by name and trained models, one for each training seed, and how each was
trained."""

import glob
import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from commands.physics_option import physics_text
from snooker_env import Options, player, players
from snooker_env.checks import integer, number, refuse
from snooker_env.players import SeenPlayer
from snooker_env.players.resolver import is_name
from snooker_env.players.saved import saved_player
from snooker_env.tasks.saved_models import SavedModel

from ..learning.hyperparameters import ACTION_OPTIONS, value_of
from ..learning.model_files import Trained
from ..learning.models import POLICY, PRETRAINED, file_of, pretrained
from ..players.trained import read_model

UNKNOWN = dict.fromkeys(("layout", "noise", "fidelity", "physics"), "unknown")
"""The training record of a model that train.py did not make."""


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

    @classmethod
    def of(cls, text, trust=False, options=()):
        """From NAME, PATH or LABEL=PATH,PATH,... Raises ValueError."""
        label, equals, paths = text.partition("=") if not Path(text).exists() else ("", "", "")
        if not equals:
            label, paths = "", text
        runs = []
        for path in paths.split(","):
            if path in pretrained():
                path = str(PRETRAINED / f"{path}.zip")
            some = [path] if Path(path).exists() else _names(path) or sorted(glob.glob(path))
            if not some:
                known = ", ".join(players())
                allowed = (
                    f"must be {known}, MODULE:CLASS, or name existing models: a .zip, a run folder, a pattern"
                )
                raise refuse("agent", path, allowed)
            runs += some
        if equals and not label:
            raise refuse("agent", text, "must have a label before the =")
        if any(map(is_name, runs)) and not all(map(is_name, runs)):
            raise refuse("agent", text, "must be players or trained models, not both under one label")
        if is_name(runs[0]):
            return cls(label or runs[0].rpartition(":")[2], tuple(runs))
        path = Path(runs[0])
        return cls(
            label or (path.parent if path.name in ("model.zip", POLICY) else path).stem,
            tuple(runs),
            trust,
            options,
        )

    def trained(self):
        """How each run was trained, as far as its files say: a dict a run, {} for a player that was not
        trained."""
        return [self._training(run) for run in self.runs]

    @property
    def foreign(self):
        """Whether a model is among them that train.py did not make."""
        return not is_name(self.runs[0]) and any(
            isinstance(_model(run, self.trust, self.options), Foreign) for run in self.runs
        )

    def player(self, k):
        """The player of its run k; a model is read once."""
        return (
            player(self.runs[k]) if is_name(self.runs[k]) else _model(self.runs[k], self.trust, self.options)
        )

    def _training(self, run):
        if is_name(run):
            _ = player(run)  # one's own may not be there
            run = run.partition("@")[2]
            if not run or not Path(run).exists():
                return {}
        model, path = _model(run, self.trust, self.options).model, Path(run)
        card, results = path.with_suffix(".json"), (path if path.is_dir() else path.parent) / "results.json"
        if path.is_file() and card.is_file():
            seconds, imitated = _number_in(card, "hours"), _number_in(card, "imitated")
            seconds = None if seconds is None else 3600.0 * seconds
        else:
            seconds, imitated = _number_in(results, "seconds"), model.imitated
        usual = {"layout": Options().layout, "noise": "none", "fidelity": "standard"}
        return {
            "recipe": model.recipe,
            "shots": model.num_timesteps,
            "imitated": imitated,
            "seconds": seconds,
            "seed": model.seed,
            "gamma": model.gamma,
            **{key: model.env_options.get(key, value) for key, value in usual.items()},
            "physics": physics_text(model.env_options.get("physics", "paper")),
        }


def options_of(changes):
    """What the "key=value" of --options say, as ``Entrant.options``. Raises ValueError."""
    chosen = {}
    for change in changes:
        key, equals, value = change.partition("=")
        if not equals or key not in ACTION_OPTIONS or key in chosen:
            raise refuse(
                "options", change, f"must be KEY=VALUE, KEY once each of {', '.join(ACTION_OPTIONS)}"
            )
        chosen[key] = value_of(value)
    Options(**chosen)  # makes sure of the values
    return tuple(chosen.items())


def _names(name):
    """The player of that name in a list; several for a planner whose model is a pattern; [] if it is not a
    player's name."""
    kind, at, pattern = name.partition("@")
    if at and is_name(name):
        return [f"{kind}@{model}" for model in sorted(glob.glob(pattern))] or [name]
    return [name] if is_name(name) else []


class Foreign(SeenPlayer):
    """A model that train.py did not make, and what its file says of its training."""

    def __init__(self, seen, name, data):
        super().__init__(seen, name=name)
        self.model = data


@cache
def _model(path, trust, options):
    file = file_of(Path(path), "agent")
    ours = read_model(file, "agent")
    if ours is not None:
        return ours
    told = _told(SavedModel.of(file, "agent"), dict(options))  # before anything in it runs
    return Foreign(saved_player(file, dict(options), trust, "agent").seen, path, told)


def _told(saved, options):
    """The training record of a model that train.py did not make."""
    try:
        seed = saved.data.get("seed")
        known = {
            "num_timesteps": integer("num_timesteps", saved.data.get("num_timesteps"), 0, 10**18),
            "gamma": number("gamma", saved.data.get("gamma"), 0, 1),
            "seed": seed if seed is None else integer("seed", seed, 0, 2**64),
        }
    except ValueError as error:
        raise saved.refused(f"must be a model saved by Stable-Baselines3 ({error})") from None
    return Trained(None, saved.algorithm[1], "plain", UNKNOWN | options, imitated=None, start=None, **known)


def _number_in(file, name):
    """The number of this name that a JSON file holds; None if it holds none. Raises ValueError."""
    try:
        found = json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}
    except ValueError as error:
        raise refuse("agent", str(file), f"must be JSON ({error})") from None
    if not isinstance(found, dict):
        raise refuse("agent", str(file), f"must hold {name} in an object")
    return None if found.get(name) is None else number(f"{file}: {name}", found[name], 0)
