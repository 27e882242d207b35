"""What may a model's file do to whoever loads it? Nothing without consent: it is read as plain data, and only then unpickled.

A zip of Stable-Baselines3 or sb3-contrib holds weights and ``data``: JSON in which whatever is not a plain value is a pickle (of
cloudpickle, in base64). To load it whole, as ``PPO.load`` does, is to run the code in these pickles, whatever it is. ``Saved`` reads what
stands there in plain, which is enough to refuse a model that does not fit; ``SavedModel.network`` alone unpickles, and asks for consent.
"""

import json
import zipfile
from dataclasses import dataclass
from pathlib import Path

from gymnasium import spaces

from .._check import refuse

__all__ = ["PLAIN", "SavedModel", "by_train", "entries", "outline", "part"]

MOST = 2**26
"""Bytes of JSON that are read at most (SB3 keeps the last observations there): a small zip can unpack to more than a machine has, and JSON
to objects 25 times as large."""
PLAIN = "model.json"
"""What stands in place of ``data`` in the zips that ``agents.publish`` writes, which hold no pickles."""

_ALGORITHMS = (
    ("sb3_contrib", "TQC", {"top_quantiles_to_drop_per_net"}), ("sb3_contrib", "TRPO", {"cg_max_steps"}),
    ("sb3_contrib", "CrossQ", {"target_entropy", "policy_delay"}), ("stable_baselines3", "SAC", {"target_entropy"}),
    ("stable_baselines3", "TD3", {"policy_delay"}), ("stable_baselines3", "DQN", {"exploration_fraction"}),
    ("stable_baselines3", "PPO", {"clip_range", "rollout_buffer_class"}),
    ("stable_baselines3", "A2C", {"gae_lambda", "rollout_buffer_class"}),
)  # fmt: skip
"""Library, class, and what only its models save besides that of those above; a recurrent one has no class of rollout buffers."""


def part(path, name, most=MOST):
    """The bytes of one part of a zip file. Raises whatever ``zipfile`` does, and ValueError if there are more of them than ``most``."""
    with zipfile.ZipFile(path) as file:
        if file.getinfo(name).file_size > most:
            raise ValueError(f"{name} is larger than {most} bytes")
        return file.read(name)


def entries(path):
    """What a model's file says of itself, pickles left as text: a dict. Raises whatever ``zipfile`` and ``json`` do."""
    with zipfile.ZipFile(path) as file:
        name = PLAIN if PLAIN in file.namelist() else "data"
    found = json.loads(part(path, name))
    if not isinstance(found, dict):
        raise ValueError(f"{name} holds no object")
    return found


def by_train(found):
    """Whether these ``entries`` are of a model of ``train.py``, which tells what it needs in plain."""
    return "recipe" in found


def outline(space):
    """Kind and size of a space, as far as Stable-Baselines3 writes them in plain."""
    if isinstance(space, spaces.Dict):
        return "Dict", str(space.spaces)
    if isinstance(space, spaces.Discrete):
        return "Discrete", str(space.n)
    return type(space).__name__, list(space.shape or ())


def _told(described):
    """``outline`` of a space by what stands beside its pickle."""
    kind = described[":type:"].rpartition(".")[2].removesuffix("'>")
    if kind == "Dict":
        return kind, described["spaces"]
    return kind, str(described["n"]) if kind == "Discrete" else list(described["_shape"])


@dataclass(frozen=True)
class SavedModel:
    """A file of Stable-Baselines3, nothing of it unpickled. ``field``: what the complaints about it name."""

    path: Path
    field: str
    data: dict
    """Its ``data``, in which pickles are text."""
    observation: tuple
    action: tuple
    """``outline`` of its spaces, by what it says itself."""

    @classmethod
    def of(cls, path, field):
        """Read a file. Raises ValueError if it is none of Stable-Baselines3."""
        try:
            data = entries(path)
            ours = by_train(data)
            told = [] if ours else [_told(data[key]) for key in ("observation_space", "action_space")]
        except Exception as error:  # whatever zip and JSON make of a file that is something else
            raise refuse(field, str(path), f"must be a model saved by Stable-Baselines3 ({error})") from None
        if ours:
            allowed = "must be a model that sees what the environment shows and nothing else; the agents of train.py see more"
            raise refuse(field, str(path), allowed)
        return cls(Path(path), field, data, *told)

    def refused(self, allowed):
        """The complaint about this file."""
        return refuse(self.field, str(self.path), allowed)

    @property
    def algorithm(self):
        """Library and class that saved it, told by the names of what it holds. Raises ValueError for any other."""
        held = {name for name, value in self.data.items() if value is not None}
        for library, name, own in _ALGORITHMS:
            if own <= held:
                buffers = self.data.get("rollout_buffer_class")
                masked = isinstance(buffers, dict) and "maskable" in str(buffers.get("__module__"))
                return ("sb3_contrib", "MaskablePPO") if masked else (library, name)
        raise self.refused("must be a model of MaskablePPO, " + ", ".join(name for _, name, _ in _ALGORITHMS))

    def network(self, trust, consent):
        """Its network (an SB3 policy), loaded: the code in its pickles runs. ``consent``: how a user says that he wants that.

        Raises ValueError, before anything runs, without ``trust``; ValueError, too, if it cannot be loaded, ImportError without SB3.
        """
        library, name = self.algorithm
        if not trust:
            why = f"holds pickled Python code, which runs when it is loaded: must be a file that you trust, and come with {consent}"
            raise self.refused(why)
        try:
            if library == "sb3_contrib":
                import sb3_contrib as module
            else:
                import stable_baselines3 as module
        except ImportError as error:
            line = 'pip install -e ".[train]"'
            raise ImportError(f"{self.field} = {str(self.path)!r} needs {library}; in a clone of the repository: {line}") from error
        only_played = {"seed": None, "n_envs": 1, "buffer_size": 1}  # the caller's random numbers stay, nothing is to be learned
        try:
            return getattr(module, name).load(self.path, device="cpu", **only_played).policy
        except Exception as error:  # it is the file's own code
            why = str(error).partition("\n")[0]
            raise self.refused(f"must be a model that {name} can load ({type(error).__name__}: {why})") from error
