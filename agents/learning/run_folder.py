"""How does a run continue from its folder? With its settings, its lock and its checkpoint, all checked before use."""

import io
import pickle
from dataclasses import asdict

import numpy as np
import torch
from stable_baselines3.common.save_util import load_from_zip_file

from agents._lib.files import UNFINISHED, read_json, seal, unseal, with_checksum, write_atomic, write_json
from agents._lib.lock import NAME as LOCK
from agents._lib.lock import Lock
from snooker_env.checks import refuse

from .hyperparameters import algorithm_class
from .models import CHECKPOINT, zip_model

SETTINGS = "settings.json"
"""File of the run's settings; a folder with this file is that of a run."""


def claim(out, resume):
    """Lock the folder of a new run (made here) or of one to resume. ValueError if the folder is unfit."""
    if not (out / LOCK).exists():
        _check(out, resume)
    out.mkdir(parents=True, exist_ok=True)
    lock = Lock(out)
    try:
        for file in out.iterdir():
            if UNFINISHED.fullmatch(file.name):
                file.unlink()
        _check(out, resume)  # repeated, because from now on no other run changes it
    except BaseException:
        lock.release()
        raise
    return lock


def _check(out, resume):
    if resume:
        if not (out / SETTINGS).is_file():
            raise refuse(
                "out", str(out), f"must be the folder of a run, with its {SETTINGS}: leave out --resume"
            )
        return
    if out.exists() and not out.is_dir():
        raise refuse("out", str(out), "must be a new or empty folder")
    names = [p.name for p in out.iterdir()] if out.is_dir() else []
    held = sorted(name for name in names if name not in ("tb", LOCK) and not UNFINISHED.fullmatch(name))
    if held:
        others = f"is not empty (it holds {', '.join(held[:3])})"
        raise refuse(
            "out", str(out), f"{others}: continue it with --resume, or choose another folder with --out"
        )


def keep_settings(out, settings):
    """Write the settings of a run, a dataclass."""
    write_json(out / SETTINGS, with_checksum(asdict(settings)))


def kept_settings(out, kind):
    """Read the settings, of this class, of the run in a folder. Raises ValueError."""
    wanted = "must be complete and written by the current train.py"
    try:
        read = read_json("out", out / SETTINGS, wanted, checked=True)
        return kind(**{name: tuple(one) if isinstance(one, list) else one for name, one in read.items()})
    except (TypeError, AttributeError):
        raise refuse("out", str(out / SETTINGS), wanted) from None


def save_checkpoint(out, model, parts):
    """Save the state of parts, model, tables and random generators, so that a resumed run equals an uninterrupted one."""
    tables = model.get_env()
    state = {"parts": [part.get_state() for part in parts], "model": zip_model(model)}
    state |= {"tables": tables.env_method("get_state"), "running": tables.running}
    # SB3 draws from the global generator
    state["random"] = np.random.get_state(), torch.get_rng_state(), model.action_space  # noqa: NPY002
    write_atomic(out / CHECKPOINT, seal(pickle.dumps(state, protocol=pickle.HIGHEST_PROTOCOL), CHECKPOINT))


def _stale(out):
    """Make the ValueError for an unusable checkpoint."""
    wanted = "must be a complete checkpoint of the current train.py"
    return refuse(
        "resume", str(out / CHECKPOINT), f"{wanted}, but this one is damaged or older: start the run again"
    )


def read_checkpoint(out):
    """Read the checkpoint of a run and the options of its tables, which may differ from its recipe's by now. None if nothing
    has been saved. Raises ValueError."""
    if not (out / CHECKPOINT).is_file():
        return None
    try:
        state = pickle.loads(unseal((out / CHECKPOINT).read_bytes(), CHECKPOINT))
        data, *_ = load_from_zip_file(io.BytesIO(state["model"]), device="cpu")
        if not state.keys() >= {"parts", "tables", "running", "random"}:
            raise KeyError
        return state | {"options": dict(data or {})["env_options"]}
    except Exception:  # any error of pickle on a file of another kind
        raise _stale(out) from None


def load_model(out, state, algo, envs, seed):
    """Restore the agent of a checkpoint, its tables and its random generators. Raises ValueError."""
    try:
        # a seed here would reseed the tables
        model = algorithm_class(algo).load(io.BytesIO(state["model"]), env=envs, device="cpu", seed=None)
        model.seed = seed
        numpy_state, torch_state, model.action_space = state["random"]
        np.random.set_state(numpy_state)  # noqa: NPY002
        torch.set_rng_state(torch_state)
        # for the reset at the start of learning or expert iteration
        envs.set_options([{"state": table} for table in state["tables"]])
    except Exception:  # of an older network, or incomplete
        raise _stale(out) from None
    return model
