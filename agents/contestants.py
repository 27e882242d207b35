"""Who is compared? Players by name and trained models, one for each training seed, with what is known of how they were made."""

import glob
import json
import zipfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from snooker_env._check import refuse

from .models import PRETRAINED, pretrained
from .players import NAMES, player_of
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
            found = [path] if path in NAMES or Path(path).exists() else sorted(glob.glob(path))
            if not found:
                known = ", ".join((*NAMES, *pretrained()))
                allowed = f"must be {known}, or name models that are there: a .zip, a run folder, a pattern"
                raise refuse("agent", path, allowed)
            runs += found
        if equals and not label:
            raise refuse("agent", text, "must have a label before the =")
        path = Path(runs[0])
        return cls(label or (path.parent if path.name == "model.zip" else path).stem, tuple(runs))

    def trained(self):
        """What is known of how each run was made: a dict a run, {} for a player that was not trained."""
        return [_training(run) for run in self.runs]


@cache
def _model(path):
    if Path(path).is_file() and not zipfile.is_zipfile(path):
        raise refuse("agent", path, "must be a model's .zip or a folder that holds model.zip")
    return player_of(path)


def player_for(run, budget, seed):
    """A fresh player, or a model, read once."""
    return player_of(run, budget=budget, seed=seed) if run in NAMES else _model(run)


def _training(run):
    if run in NAMES:
        return {}
    model = _model(run).model
    folder = Path(run) if Path(run).is_dir() else Path(run).parent
    results, card = folder / "results.json", Path(run).with_suffix(".json")
    seconds = json.loads(results.read_text()).get("seconds") if results.is_file() else None
    if Path(run).is_file() and card.is_file():
        seconds = 3600.0 * json.loads(card.read_text())["hours"]
    return {
        "recipe": model.recipe, "shots": model.num_timesteps, "seconds": seconds, "seed": model.seed, "gamma": model.gamma,
        **{key: model.env_options.get(key, usual) for key, usual in (("noise", "none"), ("fidelity", "standard"))},
        "physics": text_of(model.env_options.get("physics", "paper")),
    }  # fmt: skip
