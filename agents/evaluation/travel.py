"""How does a player travel to another machine? By name, with its model's bytes; a user's module must be installed there."""

import atexit
import hashlib
import shutil
import tempfile
from functools import cache
from pathlib import Path

from agents._lib.files import write_atomic
from snooker_env.players.resolver import is_name

from .entrants import Entrant


def pack(entrant, k):
    """Pack the run ``k`` of an ``Entrant`` into a dict of texts, lists and bytes."""
    from ..learning.models import file_of, pretrained_names

    run, file = entrant.runs[k], None
    kind, at, path = run.partition("@")
    if is_name(run) and at and path not in pretrained_names():
        file, run = file_of(Path(path), "agent"), f"{kind}@"
    elif not is_name(run):
        file, run = file_of(Path(run), "agent"), ""
    made = {"run": run, "model": file and file.read_bytes(), "suffix": file and file.suffix}
    return made | {"trust": entrant.trust, "options": [list(pair) for pair in entrant.options]}


def unpack(agent):
    """Make the player from the result of ``pack``."""
    run = agent["run"]
    if agent["model"] is not None:
        run += _write_model(agent["model"], agent["suffix"])
    one_thread(run)
    return Entrant(run, (run,), agent["trust"], tuple(map(tuple, agent["options"]))).player(0)


def one_thread(run):
    """Use one PyTorch thread for a user's own player, as for models: the last bits depend on the number of threads."""
    if ":" in run:
        try:
            import torch
        except ImportError:  # a user's own player may not need it
            return
        torch.set_num_threads(1)


@cache
def _folder():
    folder = Path(tempfile.mkdtemp(prefix="snooker_env_models_"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


@cache
def _write_model(model, suffix):
    """Write a file with these bytes for the life of this process, and return its path."""
    file = _folder() / f"{hashlib.sha256(model).hexdigest()[:32]}{suffix}"
    write_atomic(file, model)
    return str(file)
