"""Where are trained models? There are pre-trained ones, the model of a run's folder, and weights to start from."""

import io
from pathlib import Path

from agents._lib.files import read_json
from snooker_env.checks import refuse

from .hyperparameters import ACTION_OPTIONS
from .model_files import read

POLICY = "policy.npz"
"""File name of a policy made by another trainer, see ``policy_files``."""
PRETRAINED = Path(__file__).parents[2] / "results" / "weights"
CHECKPOINT = "checkpoint.pkl"
"""A run's folder holds this file from the first save on."""


def pretrained_names():
    """The names of the pre-trained models."""
    return sorted(file.stem for file in PRETRAINED.glob("*.zip"))


def file_of(path, field):
    """The model's file for a path to a file or a run's folder. The ValueError names ``field``."""
    here = [path / name for name in ("model.zip", POLICY)] if path.is_dir() else [path]
    file = next((file for file in here if file.is_file()), here[0])
    if not file.is_file():
        ends = ""
        if (path / CHECKPOINT).is_file():
            ends = f"; this run has not ended: continue it with python train.py --resume --out {path}"
        raise refuse(field, str(path), f"must be a model's .zip or a folder with model.zip{ends}")
    return file


def load_trained(path, field):
    """Read the ``Trained`` of a .zip or a run. If train.py did not make it, the ValueError names ``field``."""
    file = file_of(path, field)
    if file.suffix == ".npz":
        wanted = "must be a model that train.py saved, its .zip or a run's folder"
        raise refuse(field, str(file), f"{wanted}: an .npz holds only plain weights")
    trained = read(file, field)
    if trained is None:
        raise refuse(field, str(file), "must be a model that train.py saved")
    return trained


def load_weights(model, path):
    """Load the weights of another model with this network and actions; ``model.start`` records their origin.

    Raises ValueError.
    """
    other = load_trained(path, "start")
    if not isinstance(other.policy, type(model.policy)):
        wanted = f"must be a model of {model.recipe}, or of another agent with the same network"
        raise refuse("start", str(path), f"{wanted}, not of {other.recipe}")
    if other.policy.observation_space != model.policy.observation_space:
        seen = "must be a model with the same observation as this one: both with the table's constants, or both without"
        raise refuse("start", str(path), seen)
    spaces = other.action_space == model.action_space
    if not spaces or any(other.env_options.get(key) != model.env_options.get(key) for key in ACTION_OPTIONS):
        both = [one.env_options for one in (model, other)]
        mine, its = ({key: one[key] for key in ACTION_OPTIONS if key in one} for one in both)
        raise refuse("start", str(path), f"must be a model with actions {mine}, not {its}")
    weights = other.policy.state_dict()
    model.policy.load_state_dict({name: weights[name] for name in model.policy.state_dict()})
    model.start = {"model": str(path), "shots": other.num_timesteps}
    model.start |= {
        "imitated": other.imitated,
        "start": other.start,
        "simulated_shots": _count_training_shots(path),
    }


def _count_training_shots(path):
    """All shots simulated in the training of a run's model, from the run's figures; None if unknown."""
    file = path / "results.json" if path.is_dir() else path.with_name("results.json")
    if not path.is_dir() and path.name != "model.zip":
        return None
    try:
        shots = read_json("start", file, "must be JSON")["simulated_shots"]
    except (ValueError, KeyError, TypeError):
        return None
    return shots if isinstance(shots, int) else None


def zip_model(model):
    """An SB3 model as the bytes of its zip file."""
    file = io.BytesIO()
    model.save(file)
    return file.getvalue()
