"""Who is compared? Players by name and trained models, one for each training seed, with what is known of how they were made."""

import glob
import json
import zipfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from snooker_env._check import number, refuse
from snooker_env.envs.snooker import LAYOUTS

from .models import PRETRAINED, pretrained
from .players import NAMES, is_player, player_of
from .world import text_of


@dataclass(frozen=True)
class Agent:
    """What is compared: a player, or the models of one way to train, one for each seed."""

    label: str
    runs: tuple
    """Names, model files or run folders."""

    @classmethod
    def of(cls, text):
        """From NAME, PATH or LABEL=PATH,PATH,... Raises ValueError."""
        label, equals, paths = text.partition("=") if not Path(text).exists() else ("", "", "")
        if not equals:
            label, paths = "", text
        runs = []
        for path in paths.split(","):
            if path in pretrained():
                path = str(PRETRAINED / f"{path}.zip")
            found = [path] if is_player(path) or Path(path).exists() else sorted(glob.glob(path))
            if not found:
                known = ", ".join((*NAMES, *pretrained()))
                allowed = f"must be {known}, MODULE:CLASS, or name models that are there: a .zip, a run folder, a pattern"
                raise refuse("agent", path, allowed)
            runs += found
        if equals and not label:
            raise refuse("agent", text, "must have a label before the =")
        if any(map(is_player, runs)) and not all(map(is_player, runs)):
            raise refuse("agent", text, "must be players or trained models, not both under one label")
        if is_player(runs[0]):
            return cls(label or runs[0].rpartition(":")[2], tuple(runs))
        path = Path(runs[0])
        return cls(label or (path.parent if path.name == "model.zip" else path).stem, tuple(runs))

    def trained(self):
        """What is known of how each run was made: a dict a run, {} for a player that was not trained."""
        return [_training(run) for run in self.runs]


@cache
def _model(path):
    if not zipfile.is_zipfile(Path(path, "model.zip") if Path(path).is_dir() else path):
        raise refuse("agent", path, "must be a model's .zip or a folder that holds model.zip")
    try:
        return player_of(path)
    except ImportError:
        raise
    except Exception as error:  # a broken file makes its readers raise anything
        why = str(error).partition("\n")[0]
        raise refuse("agent", path, f"must be a model that train.py saved ({type(error).__name__}: {why})") from error


def _told(file, name):
    """The number of this name that a JSON file holds; None if it holds none. Raises ValueError."""
    try:
        told = json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}
    except ValueError as error:
        raise refuse("agent", str(file), f"must be JSON ({error})") from None
    if not isinstance(told, dict):
        raise refuse("agent", str(file), f"must hold {name} in an object")
    return None if told.get(name) is None else number(f"{file}: {name}", told[name], 0)


def player_for(run, budget, seed):
    """A fresh player, or a model, read once."""
    return player_of(run, budget=budget, seed=seed) if is_player(run) else _model(run)


def _training(run):
    if is_player(run):
        player_of(run)  # one's own may not be there
        return {}
    model, path = _model(run).model, Path(run)
    card, results = path.with_suffix(".json"), (path if path.is_dir() else path.parent) / "results.json"
    if path.is_file() and card.is_file():
        seconds, imitated = _told(card, "hours"), _told(card, "imitated")
        seconds = None if seconds is None else 3600.0 * seconds
    else:
        seconds, imitated = _told(results, "seconds"), getattr(model, "imitated", None)
    usual = {"layout": LAYOUTS["visit"], "noise": "none", "fidelity": "standard"}
    return {
        "recipe": model.recipe, "shots": model.num_timesteps, "imitated": imitated, "seconds": seconds, "seed": model.seed,
        "gamma": model.gamma, **{key: model.env_options.get(key, value) for key, value in usual.items()},
        "physics": text_of(model.env_options.get("physics", "paper")),
    }  # fmt: skip
