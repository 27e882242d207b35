"""How is the policy of another trainer stored? As the weights of its layers, in an ``.npz`` without code.

RLlib, TorchRL and custom loops have different formats, mostly pickles. For a multilayer perceptron from the flat
observation to the 540 choices, the weights are enough: ``weight_0`` (out, in) and ``bias_0`` (out,) of the first
layer, ``weight_1`` and so on, and ``about``, JSON with the keys ``ABOUT``. ``agents.evaluate`` plays such a file.
"""

import io
import json
from itertools import count
from pathlib import Path

import numpy as np

from agents._lib.files import MOST_NPZ, arrays_in, read_bytes, strict_json, write_atomic
from snooker_env.checks import choice, integer, number, refuse
from snooker_env.planning.learned.dense_layers import ACTIVATIONS, Layers
from snooker_env.tasks import CHOICES, OBSERVATION_SIZE

from .hyperparameters import SHOT_OPTIONS, TRAINING_OPTIONS
from .model_files import Trained

ABOUT = {"trainer": "RLlib", "activation": "tanh", "shots": 0, "seed": 0, "gamma": 0.95, "env_options": {}}
"""The contents of ``about``, with an example; ``env_options`` are the layout, noise, ... of the training."""


def packed_policy(weights, **about):
    """Pack a policy into its file's bytes; ``weights``: of ``dense_layers.Layers``; ``about``: as ``ABOUT``."""
    if set(about) != set(ABOUT):
        raise refuse("about", sorted(about), f"must have the keys {', '.join(ABOUT)}")
    arrays = {}
    for k, (weight, bias) in enumerate(weights):
        arrays |= {f"weight_{k}": np.asarray(weight, np.float32), f"bias_{k}": np.asarray(bias, np.float32)}
    file = io.BytesIO()
    np.savez(file, about=np.array(json.dumps(about)), **arrays)
    return file.getvalue()


def write_policy(path, weights, **about):
    """Write a policy's file, completely or not at all."""
    write_atomic(Path(path), packed_policy(weights, **about))


def read_policy(path, field):
    """Read the ``Trained`` policy in a file, with a ``Layers`` network and no pickles. The ValueError names ``field``."""
    try:
        arrays = arrays_in(read_bytes(path, MOST_NPZ))
        about = strict_json(arrays["about"].item())
        many = next(k for k in count() if f"weight_{k}" not in arrays)
        layers = [(arrays[f"weight_{k}"], arrays[f"bias_{k}"]) for k in range(many)]
        _check_layers(layers)
        return _describe(about, layers)
    except (ValueError, KeyError, TypeError, OSError) as error:
        wanted = "must be a policy's .npz: weights of layers from the flat observation to the choices"
        why = " ".join(str(error).split())[:200]
        raise refuse(field, str(path), f"{wanted}, and about ({why})") from None


def _check_layers(layers):
    size = OBSERVATION_SIZE
    for k, (weight, bias) in enumerate(layers):
        floats = weight.dtype == bias.dtype == np.float32
        if not floats or weight.shape != (len(bias), size) or bias.ndim != 1:
            both = f"weight_{k} {weight.dtype} {weight.shape}, bias_{k} {bias.dtype} {bias.shape}"
            raise ValueError(f"{both} after {size} numbers")
        if not (np.isfinite(weight).all() and np.isfinite(bias).all()):
            raise ValueError(f"layer {k} is not finite")
        size = len(bias)
    if not layers or size != CHOICES:
        raise ValueError(f"the last layer gives {size} numbers, not {CHOICES}")


def _describe(about, layers):
    if not isinstance(about, dict) or set(about) != set(ABOUT):
        raise ValueError(f"about must have exactly the keys {', '.join(ABOUT)}")
    if not isinstance(about["trainer"], str) or not isinstance(about["env_options"], dict):
        raise ValueError("about.trainer is not text, or about.env_options is not an object")
    for key in about["env_options"]:
        choice("key of about.env_options", key, (*SHOT_OPTIONS, *TRAINING_OPTIONS))
    network = Layers(layers, choice("about.activation", about["activation"], ACTIVATIONS))
    numbers = {
        "num_timesteps": integer("about.shots", about["shots"], 0, 10**18),
        "gamma": number("about.gamma", about["gamma"], 0, 1),
        "seed": integer("about.seed", about["seed"], 0, 2**64),
    }
    options = about["env_options"] | {"action": "discrete"}
    return Trained(network, about["trainer"], options, **numbers, imitated=None)
