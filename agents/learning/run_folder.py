"""How is a run resumed from its folder? The checkpoint, the lock, and the checks of a folder before use."""

import io
import pickle
import shlex
from dataclasses import asdict

import numpy as np
import torch
from stable_baselines3.common.save_util import load_from_zip_file

from commands.files import UNFINISHED, sealed, unsealed, write_atomic
from commands.lifecycle import python
from commands.lock import NAME as LOCK
from commands.lock import Lock
from snooker_env.checks import refuse

from ..cluster.mirror import copied
from .hyperparameters import algorithm_class
from .models import CHECKPOINT, zipped


def claimed(out, resume, checkpoint=CHECKPOINT):
    """The ``Lock`` on the folder of a new run (made here) or of one to resume, which holds the file ``checkpoint``.
    ValueError if it is unfit."""
    if not (out / LOCK).exists():
        _check(out, resume, checkpoint)
    out.mkdir(parents=True, exist_ok=True)
    lock = Lock(out)
    try:
        for file in out.iterdir():
            if UNFINISHED.fullmatch(file.name):
                file.unlink()
        _check(out, resume, checkpoint)  # again: from now on no other run changes it
    except BaseException:
        lock.release()
        raise
    return lock


def _check(out, resume, checkpoint):
    if resume:
        if not (out / checkpoint).is_file():
            raise refuse("out", str(out), "holds no checkpoint: start the run without --resume")
        return
    if out.exists() and not out.is_dir():
        raise refuse("out", str(out), "must be a folder, new or empty")
    names = [p.name for p in out.iterdir()] if out.is_dir() else []
    held = sorted(name for name in names if name not in ("tb", LOCK) and not UNFINISHED.fullmatch(name))
    if held:
        others = f"is not empty (it holds {', '.join(held[:3])})"
        raise refuse("out", str(out), f"{others}: --resume continues it, --out names another folder")


def go_on(out):
    """The command that continues the run saved there, as a sentence."""
    return f"Continue with:  {shlex.join([python(), 'train.py', '--resume', '--out', str(out)])}"


def kept(out):
    """What was saved of a run that was interrupted, in one sentence."""
    if (out / CHECKPOINT).is_file():
        return f"The last checkpoint is complete. {go_on(out)}"
    return "Nothing was saved yet: start the run again."


def save_checkpoint(out, settings, model, seconds, curve, imitation, imitating=None):
    """Save the state of training, tables and random generators: a resumed run equals an uninterrupted one.

    ``imitating``: of ``Imitation.get_state`` while the agent imitates the search, else None.
    """
    tables = model.get_env()
    state = {"settings": asdict(settings), "seconds": seconds, "curve": curve}
    state |= {"imitation": imitation, "imitating": imitating}
    state |= {"model": zipped(model), "replay": getattr(model, "replay_buffer", None)}
    state |= {"tables": tables.env_method("get_state"), "running": tables.running}
    # SB3 draws from the global generator
    state["random"] = np.random.get_state(), torch.get_rng_state(), model.action_space  # noqa: NPY002
    data = sealed(pickle.dumps(state, protocol=pickle.HIGHEST_PROTOCOL), CHECKPOINT)
    write_atomic(out / CHECKPOINT, data)
    copied(out, data)


def stale(out):
    """The ValueError for a checkpoint that cannot be used."""
    wanted = "must be a complete checkpoint of the current train.py"
    damaged = "this one is damaged or older, start the run again"
    return refuse("resume", str(out / CHECKPOINT), f"{wanted}: {damaged}")


def read_checkpoint(out, settings):
    """The checkpoint and the settings in it, made by the class ``settings``. Raises ValueError."""
    try:
        state = pickle.loads(unsealed((out / CHECKPOINT).read_bytes(), CHECKPOINT))
        was = settings(**state["settings"])
        wanted = {
            "model",
            "tables",
            "random",
            "replay",
            "running",
            "imitation",
            "imitating",
            "curve",
            "seconds",
        }
        if not state.keys() >= wanted or "shots" not in (state["imitating"] or {"shots": 0}):
            raise KeyError
    except Exception:  # any error of pickle on a file of another kind
        raise stale(out) from None
    return state, was


def options_of(out, state):
    """The options of the tables of a checkpoint: its recipe may have others by now. Raises ValueError."""
    try:
        data, *_ = load_from_zip_file(io.BytesIO(state["model"]), device="cpu")
        return dict(data or {})["env_options"]
    except Exception:
        raise stale(out) from None


def load_model(out, state, algo, envs):
    """The agent of a checkpoint, its tables and random generators as they were. Raises ValueError."""
    try:
        # a seed here would reseed the tables
        model = algorithm_class(algo).load(io.BytesIO(state["model"]), env=envs, device="cpu", seed=None)
        model.seed = state["settings"]["seed"]
        if state["replay"] is not None:
            model.replay_buffer = state["replay"]
        numpy_state, torch_state, model.action_space = state["random"]
        np.random.set_state(numpy_state)  # noqa: NPY002
        torch.set_rng_state(torch_state)
        # for the reset at the beginning of learning or imitation
        envs.set_options([{"state": table} for table in state["tables"]])
    except Exception:  # of an older network, or with a part missing
        raise stale(out) from None
    return model
