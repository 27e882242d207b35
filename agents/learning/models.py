"""Where are trained models? There are pre-trained ones, and the model of a run's folder."""

import io
from pathlib import Path

from snooker_env.checks import refuse

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


def zip_model(model):
    """An SB3 model as the bytes of its zip file."""
    file = io.BytesIO()
    model.save(file)
    return file.getvalue()
