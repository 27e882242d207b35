"""How is a trained agent stored in a file and read again? As JSON and weights, without unpickling.

``train.py`` writes zips of Stable-Baselines3, which ``PPO.load`` reads by running the pickles in their ``data``.
``pack_model`` makes those of ``results/weights``, which hold only ``model.json`` and ``policy.pth``. From either, this module
reads the entries ``KEPT`` as plain JSON and the tensors of ``policy.pth``. The network is that of the current recipe with this
name, so a file cannot run other code.
"""

import io
import json
import zipfile
from dataclasses import dataclass
from typing import Any

from snooker_env import SnookerVectorEnv
from snooker_env.checks import choice, integer, number, refuse
from snooker_env.players.saved_models import PLAIN, by_train, entries, part

from ..features.observed import space_of
from .hyperparameters import ENV_OPTIONS, Recipe, names

WEIGHTS = "policy.pth"


@dataclass
class Trained:
    """A trained agent as described in a file, by the attributes that train.py sets on SB3's models."""

    policy: Any
    """Its network, an SB3 policy."""
    recipe: str
    env_options: dict
    """``SnookerEnv`` arguments of its training."""
    num_timesteps: int
    gamma: float
    seed: int | None
    imitated: int | None
    """Positions of expert iteration; None: unknown."""

    @property
    def action_space(self):
        """The action space of its training tables."""
        return self.policy.action_space


def _options(field, value):
    if not isinstance(value, dict):
        raise refuse(field, value, "must be a dict")
    for key in value:
        choice(f"key of {field}", key, ENV_OPTIONS)
    return value


def _count(field, value):
    return integer(field, value, 0, 10**18)


KEPT = {
    "recipe": lambda field, value: choice(field, value, names()),
    "env_options": _options,
    "num_timesteps": _count,
    "gamma": lambda field, value: number(field, value, 0, 1),
    "seed": _count,
    "imitated": _count,
}
"""The entries read, with the check of each."""
MAY_BE_NONE = ("seed", "imitated")


class _MismatchError(Exception):
    """The weights do not fit the current network."""


def read(path, field):
    """Read the ``Trained`` in a file; None if train.py did not make it. Raises ValueError and ImportError."""
    try:
        found = entries(path)
        if not by_train(found):
            return None
        described: dict[str, Any] = {
            key: None if found.get(key) is None and key in MAY_BE_NONE else check(key, found.get(key))
            for key, check in KEPT.items()
        }
        seen = found["seen"] if "seen" in found else found["observation_space"]["_shape"][0]
    except Exception as error:  # any error of zip or JSON on a file of another kind
        raise refuse(field, str(path), f"must be a model that train.py saved ({str(error)[:300]})") from None
    try:
        return Trained(_network(path, described, seen), **described)
    except _MismatchError:
        wanted = (
            f"must be a model of the current {described['recipe']}, but this one is older: train it again"
        )
        raise refuse(field, str(path), wanted) from None
    except ImportError:
        raise
    except Exception as error:  # any error of zip or torch on weights of another kind
        why = f"its {WEIGHTS} must hold only weights: {type(error).__name__}"
        raise refuse(field, str(path), f"must be a model that train.py saved ({why})") from None


def _network(path, described, seen):
    """The current network with the weights of a file."""
    import torch

    try:
        recipe = Recipe.of(described["recipe"], env_kwargs=described["env_options"])
        tables = SnookerVectorEnv(1, **described["env_options"])
        with torch.random.fork_rng(devices=[]):  # the initial weights are replaced below
            space = space_of(tables, described["env_options"])
            network = recipe.new_network(space, tables.single_action_space)
    except ImportError:
        raise
    except Exception:  # options or parts that no longer exist
        raise _MismatchError from None
    if network.observation_space.shape != (seen,):
        raise _MismatchError
    initial = network.state_dict()
    sizes = (4096 + tensor.numel() * tensor.element_size() for tensor in initial.values())
    weights = _weights(path, 2**16 + sum(sizes))
    if _forms(weights) != _forms(initial):
        raise _MismatchError
    if not all(torch.isfinite(tensor).all() for tensor in weights.values()):
        raise ValueError
    network.load_state_dict(weights)
    return network


def _weights(path, most):
    """The tensors of a file by name; no code runs. ``_MismatchError`` above ``most`` bytes."""
    import torch

    try:
        file = io.BytesIO(part(path, WEIGHTS, most))
    except ValueError:
        raise _MismatchError from None
    with zipfile.ZipFile(file) as inner:
        if sum(info.file_size for info in inner.infolist()) > most:  # compressed twice
            raise _MismatchError
    file.seek(0)
    return torch.load(file, map_location="cpu", weights_only=True)


def _forms(weights):
    return {name: (tensor.shape, tensor.dtype, tensor.layout) for name, tensor in weights.items()}


def pack_model(trained):
    """Pack a ``Trained`` into the bytes of a zip with only ``model.json`` and ``policy.pth``, reproducibly."""
    import torch

    described = {key: getattr(trained, key) for key in KEPT}
    described["seen"] = trained.policy.observation_space.shape[0]
    weights, file = io.BytesIO(), io.BytesIO()
    torch.save(dict(trained.policy.state_dict()), weights)
    with zipfile.ZipFile(file, "w") as made:  # ZipInfo: without a time stamp
        made.writestr(zipfile.ZipInfo(PLAIN), json.dumps(described, indent=1) + "\n")
        made.writestr(zipfile.ZipInfo(WEIGHTS), weights.getvalue())
    return file.getvalue()
