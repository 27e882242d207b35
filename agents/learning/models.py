"""Where are trained models found? Pre-trained ones, the model of a run's folder, and weights to start from."""

import io
from pathlib import Path

from snooker_env.checks import refuse

from .model_files import read

PRETRAINED = Path(__file__).parents[1] / "pretrained"
CHECKPOINT = "checkpoint.pkl"
"""A run's folder holds it from the first save on."""


def pretrained():
    """The names of the pre-trained models."""
    return sorted(file.stem for file in PRETRAINED.glob("*.zip"))


def file_of(path, field):
    """The model's file for a path to a file or a run's folder. Raises ValueError, naming ``field``."""
    file = path / "model.zip" if path.is_dir() else path
    if not file.is_file():
        unfinished = (path / CHECKPOINT).is_file()
        ends = f"; this run has not ended, continue it with: python train.py --resume --out {path}" if unfinished else ""
        raise refuse(field, str(path), f"must be a model's .zip or a folder that holds model.zip{ends}")
    return file


def load_trained(path, field):
    """The ``Trained`` of a model's .zip or a run's folder. Raises ValueError, naming ``field``, if train.py did not make it."""
    file = file_of(path, field)
    trained = read(file, field)
    if trained is None:
        raise refuse(field, str(file), "must be a model that train.py saved")
    return trained


def load_weights(model, path):
    """Load the weights of another model of the same agent into ``model``; ``model.start`` records its origin. Raises ValueError."""
    other = load_trained(path, "start")
    if other.recipe != model.recipe:
        raise refuse("start", str(path), f"must be a model of {model.recipe}, not of {other.recipe}")
    if other.action_space != model.action_space:
        raise refuse("start", str(path), f"must be a model with actions {model.action_space}, not {other.action_space}")
    model.policy.load_state_dict(other.policy.state_dict())
    model.start = {"model": str(path), "shots": other.num_timesteps, "imitated": other.imitated, "start": other.start}


def zipped(model):
    """An SB3 model as the bytes of its zip file."""
    file = io.BytesIO()
    model.save(file)
    return file.getvalue()
