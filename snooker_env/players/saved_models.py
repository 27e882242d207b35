"""How is a model's file read safely? As plain data first, without running anything: a zip of
Stable-Baselines3 or sb3-contrib holds weights and ``data``, JSON in which all but plain values is a pickle,
whose code runs when loaded. Only ``SavedModel.network`` unpickles, and requires consent."""

import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gymnasium import spaces

from .._lib.check import refuse
from .._lib.files import MOST_JSON, strict_json, unzip
from .._lib.install import missing

PLAIN = "model.json"
"""The part that replaces ``data`` in the zips of ``results/weights``, which hold no pickles."""
_ALGORITHMS = (
    ("sb3_contrib", "TQC", {"top_quantiles_to_drop_per_net"}),
    ("sb3_contrib", "TRPO", {"cg_max_steps"}),
    ("sb3_contrib", "CrossQ", {"target_entropy", "policy_delay"}),
    ("stable_baselines3", "SAC", {"target_entropy"}),
    ("stable_baselines3", "TD3", {"policy_delay"}),
    ("stable_baselines3", "DQN", {"exploration_fraction"}),
    ("stable_baselines3", "PPO", {"clip_range", "rollout_buffer_class"}),
    ("stable_baselines3", "A2C", {"gae_lambda", "rollout_buffer_class"}),
)
"""Library, class, and what only its models save beside those above; recurrent: no buffers."""
_PLAYED = ("policy_class", "policy_kwargs", "observation_space", "action_space")
"""The pickles that playing needs; others (schedules, callbacks, buffers) may name missing packages."""
_UNPICKLED = {"learning_rate": 0.0, "clip_range": 0.2, "train_freq": 1, "target_entropy": 0.0}
"""What takes the place of a pickle that is left out; else None. Nothing is learned by these."""


@contextmanager
def one_thread() -> Iterator[None]:
    """PyTorch computes on the calling thread alone: on several, networks of a few layers wait for busy cores."""
    import torch

    usual = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(usual)


def part(path: str | Path, name: str, most: int) -> bytes:
    """One part of a zip file; ValueError if it is larger than ``most`` bytes, KeyError if there is none."""
    with zipfile.ZipFile(path) as file:
        if file.getinfo(name).file_size > most:
            raise ValueError(f"{name} is larger than {most:,} bytes")
        return unzip(file, file.getinfo(name))


def entries(path: str | Path) -> dict[str, Any]:
    """The description that a model's ``.zip`` holds of itself, ``PLAIN`` or ``data``; pickles in it stay text."""
    with zipfile.ZipFile(path) as file:
        name = PLAIN if PLAIN in file.namelist() else "data"
    # SB3 stores the last observations there
    description = strict_json(part(path, name, MOST_JSON))
    if not isinstance(description, dict):
        raise ValueError(f"{name} holds no object")
    return description


def by_train(description: dict[str, Any]) -> bool:
    """Whether a model whose ``entries`` these are was written by the repository's ``train.py``."""
    return "recipe" in description


def outline(space: spaces.Space[Any]) -> tuple[str, Any]:
    """Kind and size of a space, as far as Stable-Baselines3 stores them as plain data: a text, or the shape."""
    if isinstance(space, spaces.Dict):
        return "Dict", str(space.spaces)
    if isinstance(space, spaces.Discrete):
        return "Discrete", str(space.n)
    return type(space).__name__, list(space.shape or ())


def _described_outline(described):
    """The ``outline`` of a space, from the plain data beside its pickle."""
    kind = described[":type:"].rpartition(".")[2].removesuffix("'>")
    if kind == "Dict":
        return kind, described["spaces"]
    return kind, str(described["n"]) if kind == "Discrete" else list(described["_shape"])


@dataclass(frozen=True)
class SavedModel:
    """A model's file of Stable-Baselines3 or sb3-contrib, read without unpickling anything."""

    path: Path
    field: str  # the argument that error messages name
    data: dict[str, Any]  # the JSON of ``data``, in which pickles are text
    observation: tuple[str, Any]  # ``outline`` of its space, as the file describes it; and the next
    action: tuple[str, Any]

    @classmethod
    def of(cls, path: str | Path, field: str) -> "SavedModel":
        """Read a ``.zip``; ``field``: the argument that errors name. ValueError if it is no model of
        Stable-Baselines3, or one of ``train.py``, whose agents observe more than the environment shows."""
        try:
            data = entries(path)
            ours = by_train(data)
            spaces_ = () if ours else ("observation_space", "action_space")
            outlines = [_described_outline(data[key]) for key in spaces_]
        except Exception as error:  # zipfile and json raise many kinds for other files
            raise refuse(field, str(path), f"must be a model saved by Stable-Baselines3 ({error})") from None
        if ours:
            allowed = "must be a model that observes what the environment shows and nothing else; the agents of train.py observe more"
            raise refuse(field, str(path), allowed)
        return cls(Path(path), field, data, *outlines)

    def refuse_file(self, allowed: str) -> ValueError:
        """Return, not raise, the ValueError that refuses this file; ``allowed``: what it must be."""
        return refuse(self.field, str(self.path), allowed)

    @property
    def algorithm(self) -> tuple[str, str]:
        """Library and class that saved the model, by the names in ``data``; ValueError for an unknown one."""
        held = {name for name, value in self.data.items() if value is not None}
        for library, name, own in _ALGORITHMS:
            if own <= held:
                buffers = self.data.get("rollout_buffer_class")
                masked = isinstance(buffers, dict) and "maskable" in str(buffers.get("__module__"))
                return ("sb3_contrib", "MaskablePPO") if masked else (library, name)
        raise self.refuse_file(
            "must be a model of MaskablePPO, " + ", ".join(name for _, name, _ in _ALGORITHMS)
        )

    def network(self, trust: bool, consent: str) -> Any:
        """Load the model's policy on the CPU, which runs the code in its pickles: ValueError without
        ``trust``, before anything runs, or if it cannot be loaded. ImportError without the library.
        ``consent``: how a user gives it, as "trust=True", for the error."""
        library, name = self.algorithm
        if not trust:
            why = f"holds pickled Python code, which runs when it is loaded: must be a file that you trust, and come with {consent}"
            raise self.refuse_file(why)
        try:
            if library == "sb3_contrib":
                import sb3_contrib as module
            else:
                import stable_baselines3 as module
        except ImportError as error:
            raise missing(f"{self.field} = {str(self.path)!r} needs {library}", "train") from error
        # keep the caller's random state; no learning
        only_played = {"seed": None, "n_envs": 1, "buffer_size": 1}
        others = [(key, value) for key, value in self.data.items() if key not in _PLAYED]
        pickled = [key for key, value in others if isinstance(value, dict) and ":serialized:" in value]
        left_out = {key: _UNPICKLED.get(key) for key in pickled}
        try:
            kind = getattr(module, name)
            return kind.load(self.path, device="cpu", custom_objects=left_out, **only_played).policy
        except Exception as error:  # the file's own code may raise anything
            why = str(error).partition("\n")[0]
            allowed = f"must be a model that {name} can load ({type(error).__name__}: {why})"
            raise self.refuse_file(allowed) from error
