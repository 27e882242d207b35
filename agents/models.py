"""How are trained agents kept and played? Models of Stable-Baselines3, saved whole or not at all, as players."""

import io
import os
from pathlib import Path

import numpy as np

from snooker_env._check import refuse

from .recipes import Recipe, algorithm
from .tables import view_of

PRETRAINED = Path(__file__).parent / "pretrained"


def pretrained():
    """The names of the pre-trained models that there are."""
    return sorted(file.stem for file in PRETRAINED.glob("*.zip"))


class Model:
    """A trained Stable-Baselines3 model that sees the tables through a view of that name; it plays what it thinks best."""

    def __init__(self, model, options, view="pots"):
        self.model, self.options, self._look = model, options, view_of(view)

    def act(self, tables, observations, going):
        """The model's own choice for the tables going."""
        seen = self._look(tables, observations[going], going)
        discrete = self.options.get("action") == "discrete"
        masks = {"action_masks": self._look.masks(tables)[going]} if discrete else {}
        actions = np.zeros(tables.action_space.shape, tables.action_space.dtype)
        actions[going] = self.model.predict(seen, deterministic=True, **masks)[0]
        return actions


def player_options(env_options):
    """Of the options an agent was trained with, those that say how its actions are read."""
    return {key: env_options[key] for key in ("action", "aim") if key in env_options}


def load_player(path):
    """A ``Model`` from a model's .zip or a run's folder. Raises ValueError."""
    from stable_baselines3.common.save_util import load_from_zip_file

    file = path / "model.zip" if path.is_dir() else path
    if not file.is_file():
        raise refuse("agent", str(path), "must be a model's .zip or a folder that holds model.zip")
    data, _, _ = load_from_zip_file(file, device="cpu")
    if not data or "recipe" not in data:
        raise refuse("agent", str(path), "must be a model that train.py saved")
    model = algorithm(Recipe.of(data["recipe"]).algo).load(file, device="cpu")
    return Model(model, player_options(data["env_options"]), data["view"])


def load_weights(model, path):
    """Give a model the weights of another of the same agent. Raises ValueError."""
    other = load_player(path).model
    if other.recipe != model.recipe:
        raise refuse("start", str(path), f"must be a model of {model.recipe}, not of {other.recipe}")
    model.policy.load_state_dict(other.policy.state_dict())


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


def write_model(model, path):
    """Save an SB3 model, whole or not at all."""
    write_atomic(path, zipped(model))
