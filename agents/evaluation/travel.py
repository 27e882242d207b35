"""How does a player travel to another machine? By name, with its model's bytes; a module of one's own must be there."""

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
    """The run ``k`` of an ``Entrant`` as data: a dict of texts, lists and bytes."""
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
    """The player of what ``pack`` made."""
    run = agent["run"]
    if agent["model"] is not None:
        run += _write_model(agent["model"], agent["suffix"])
    one_thread(run)
    return Entrant(run, (run,), agent["trust"], tuple(map(tuple, agent["options"]))).player(0)


def one_thread(run):
    """One thread of PyTorch for a player of one's own, as models have: last bits depend on their number."""
    if ":" in run:
        try:
            import torch
        except ImportError:  # one's own player may do without
            return
        torch.set_num_threads(1)


@cache
def _folder():
    folder = Path(tempfile.mkdtemp(prefix="snooker_env_models_"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


@cache
def _write_model(model, suffix):
    """The path of a file with these bytes, for the life of this process."""
    file = _folder() / f"{hashlib.sha256(model).hexdigest()[:32]}{suffix}"
    write_atomic(file, model)
    return str(file)
