"""How are trained agents kept and played? Models of Stable-Baselines3, saved whole or not at all, as players."""

import io
import os
from pathlib import Path

import numpy as np

from snooker_env._check import refuse

from .recipes import READ, Recipe, algorithm
from .tables import view_of

PRETRAINED = Path(__file__).parent / "pretrained"


def pretrained():
    """The names of the pre-trained models that there are."""
    return sorted(file.stem for file in PRETRAINED.glob("*.zip"))


class Model:
    """A trained Stable-Baselines3 model that sees the tables through a view of that name; it plays what it thinks best."""

    def __init__(self, model, options, view="pots"):
        self.model, self.options, self._look = model, options, view_of(view)

    @property
    def space(self):
        """What the view shows today."""
        return self._look.space

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
    return {key: env_options[key] for key in READ if key in env_options}


def load_player(path, field="agent"):
    """A ``Model`` from a model's .zip or a run's folder. Raises ValueError, naming ``field``."""
    from stable_baselines3.common.save_util import load_from_zip_file

    file = path / "model.zip" if path.is_dir() else path
    if not file.is_file():
        raise refuse(field, str(path), "must be a model's .zip or a folder that holds model.zip")
    try:
        data, _, _ = load_from_zip_file(file, device="cpu")
    except Exception:  # whatever zip, json and pickle make of a file that is something else
        data = None
    if not data or "recipe" not in data:
        raise refuse(field, str(file), "must be a model that train.py saved")
    try:
        model = algorithm(Recipe.of(data["recipe"]).algo).load(file, device="cpu")
        player = Model(model, player_options(data["env_options"]), data["view"])
        if model.observation_space != player.space:
            raise ValueError
    except Exception:  # weights of other shapes, another view, a recipe or a class that is gone
        raise refuse(field, str(file), f"must be a model of today's {data['recipe']}: this one is older, train it again") from None
    return player


def load_weights(model, path):
    """Give a model the weights of another of the same agent; ``model.start`` tells of it. Raises ValueError."""
    other = load_player(path, "start").model
    if other.recipe != model.recipe:
        raise refuse("start", str(path), f"must be a model of {model.recipe}, not of {other.recipe}")
    if other.action_space != model.action_space:
        raise refuse("start", str(path), f"must be a model with actions {model.action_space}, not {other.action_space}")
    model.policy.load_state_dict(other.policy.state_dict())
    before = {key: getattr(other, key, None) for key in ("imitated", "start")}
    model.start = {"model": str(path), "shots": other.num_timesteps, **before}


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
