"""How does a model of Stable-Baselines3 or sb3-contrib play? Its zip is first read as plain data, without running anything: only
``SavedModel.network`` unpickles its ``data``, whose code runs when loaded, and requires consent."""

import zipfile
from argparse import ArgumentParser
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from gymnasium import spaces

from .._lib.check import choice, refuse
from .._lib.command import say
from .._lib.files import MOST_JSON, strict_json, unzip
from .._lib.install import missing
from .._lib.types import Bools, Ints, Observation
from ..tasks.foreseen import STATES
from ..tasks.observations import OBSERVATIONS, STROKE_SIZE, size_of, space
from ..tasks.options import Options
from ..tasks.stroke_menu import SPEEDS, speeds_of
from .seen import SeenPlayer

KEYS = tuple(Options.group("action"))  # what a model's file does not say
LEFT_OUT = "must be left out: it is for models of Stable-Baselines3"
PLAIN = "model.json"  # the part that replaces ``data`` in zips without pickles
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
    description = strict_json(part(path, name, MOST_JSON))  # SB3 stores the last observations there
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
        """Read a ``.zip``; ValueError, naming ``field``, if it is no model of Stable-Baselines3, or one of ``train.py``."""
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
        names = ", ".join(name for _, name, _ in _ALGORITHMS)
        raise self.refuse_file(f"must be a model of MaskablePPO, {names}")

    def network(self, trust: bool) -> Any:
        """Load the model's policy on the CPU, which runs the code in its pickles: ValueError without ``trust``, before anything
        runs, or if it cannot be loaded. ImportError without the library."""
        library, name = self.algorithm
        if not trust:
            why = "holds pickled Python code, which runs when it is loaded: must be a file that you trust"
            raise self.refuse_file(f"{why}, and come with trust=True, or --trust on the command line")
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


def _speeds_seen(outlined: tuple[str, Any], frame: bool) -> int:
    """The speeds of the menu in an observation with this outline; 0: it is no menu's."""
    size = outlined[1][0] if outlined[0] == "Box" and len(outlined[1]) == 1 else 0
    rows, rest = divmod(size - STATES[frame], STROKE_SIZE)
    return 0 if rest else speeds_of(rows, frame)


@dataclass(frozen=True)
class FittingModel:
    """A model's file, not unpickled, with fitting ``options``: how it sees and acts, see ``Seen``."""

    saved: SavedModel
    options: dict[str, Any]

    @classmethod
    def of(cls, path: str | Path, options: dict[str, Any], field: str = "player") -> "FittingModel":
        """Read the description in a model's file; ValueError, naming ``field``, if its spaces are others."""
        saved = SavedModel.of(path, field)
        if saved.action[0] == "Discrete":
            choices = int(saved.action[1])
            speeds = speeds_of(choices, False) or speeds_of(choices, True)
            read = {"action": "strokes", "speeds": speeds} if speeds else {"action": "discrete"}
            options = read | options
        for frame, replaced in ((False, False), (True, False), (True, True)):
            for kind in OBSERVATIONS[frame:]:
                task = {"task": "frame", "miss": "clear_path" if replaced else "off"} if frame else {}
                told = {name: options[name] for name in options if frame or name != "says"}
                model = cls(saved, told | task | {"observation": kind})
                if kind == "strokes" and not replaced:
                    model.options.setdefault("speeds", _speeds_seen(saved.observation, frame) or SPEEDS)
                many, speeds = getattr(model.actions, "n", 0), model.options.get("speeds", SPEEDS)
                size = size_of(kind, frame, replaced=replaced, speeds=speeds)
                if outline(space(kind, size, many)) == saved.observation:
                    if outline(model.actions) != saved.action:
                        told = "give the options of its training, for example placement=True"
                        raise saved.refuse_file(f"must be a model whose actions are {model.actions}: {told}")
                    return model
        view = "must be a model trained on the observation of a visit or a frame, and nothing else"
        raise saved.refuse_file(view)

    @property
    def actions(self) -> Any:
        flat: Any = self.options | {"observation": "flat"}
        return Options(**flat).rules.actions.space

    def network(self, trust: bool) -> Any:
        """Load its policy: the code in its pickles runs. ValueError without ``trust``."""
        network = self.saved.network(trust)
        same_view = outline(network.observation_space) == self.saved.observation
        if not same_view or network.action_space != self.actions:
            raise self.saved.refuse_file("must be a model whose spaces are those that its file describes")
        return network


class SavedNetwork:
    """The policy of a saved model, deterministic, as a ``Seen``; loaded again in another process."""

    def __init__(self, model: FittingModel, trust: bool):
        self.options, self.model, self._trust = model.options, model, trust
        self._network = model.network(trust)
        self._masked = model.saved.algorithm[1] == "MaskablePPO"

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"_network": None}

    def act(self, observations: Observation, masks: Bools | None, seeds: Ints) -> Any:
        """The greedy actions, row by row: the products of a batch round otherwise than those of one row."""
        if self._network is None:
            self._network = self.model.network(self._trust)
        actions = []
        with one_thread():
            for k in range(len(seeds)):
                flat = not isinstance(observations, dict)
                row = observations[k] if flat else {name: part[k] for name, part in observations.items()}
                masked = {"action_masks": masks[k]} if self._masked and masks is not None else {}
                actions.append(self._network.predict(row, deterministic=True, **masked)[0])
        space = self._network.action_space
        answer = np.array(actions).reshape(len(seeds), *space.shape)
        return np.clip(answer, -1.0, 1.0) if space.shape else answer


def saved_player(path: Path, options: dict[str, Any], trust: bool, field: str = "player") -> SeenPlayer:
    """The player of a model's ``.zip``, with ``options``; ValueError for those of ``train.py``."""
    try:
        ours = path.is_dir() or by_train(entries(path))
    except Exception as error:
        raise refuse(field, str(path), f"must be a model saved by Stable-Baselines3 ({error})") from None
    if ours:
        words = "must be read in a clone of the repository, without options"
        raise refuse(field, str(path), f"{words}: it is a model or a run of train.py")
    model = FittingModel.of(path, options, field)
    made = SeenPlayer(SavedNetwork(model, trust), name=str(path))
    say_assumption(path, model.options)
    return made


def say_assumption(path: str | Path, options: Mapping[str, Any]) -> None:
    """Say on stderr, once in a process, that the aim of a model is assumed because its options do not name one."""
    if options.get("action", "box") == "box" and "aim" not in options and not _SAID:
        _SAID.append(str(path))
        told = 'for another aim give --options aim=absolute, or options={"aim": "absolute"}'
        say(f"{path}: aim=pot is assumed, as in Snooker-v0; {told}")


_SAID: list[str] = []  # the model of which that was said


def check_model_options(options: Mapping[str, Any] | None) -> dict[str, Any]:
    """These options as a dict, {} for None; ValueError for others than ``KEYS`` or for values that they cannot have."""
    if not isinstance(options, Mapping | None):
        raise refuse("options", options, 'must be a dict such as {"aim": "absolute"}')
    read = dict(options or {})
    for key in read:
        choice("key of options", key, KEYS)
    Options(task="frame", **read)  # makes sure of the values
    return read


def options_of_words(words: Sequence[str]) -> dict[str, Any]:
    """Options from words like "aim=absolute", "placement=True" and "says=decision,lot"; ValueError for others."""
    options: dict[str, Any] = {}
    for word in words:
        name, equals, value = word.partition("=")
        if not equals or name not in KEYS or name in options:
            raise refuse("options", word, f"must be KEY=VALUE, KEY once each of {', '.join(KEYS)}")
        options[name] = tuple(value.split(",")) if name == "says" else _value(value)
    return check_model_options(options)


def _value(text: str) -> Any:
    """A truth value or a number, else the text itself."""
    try:
        value = strict_json(text.lower())
    except ValueError:
        return text
    return value if isinstance(value, bool | int | float) else text


def add_model_options(parser: ArgumentParser) -> None:
    """Add ``--trust`` and ``--options`` to a command that takes a model's file."""
    trusts = "allow the pickled code in a model's file to run"
    parser.add_argument("--trust", action="store_true", help=trusts)
    how = "how to read the actions of a model of Stable-Baselines3, for example aim=absolute"
    parser.add_argument("--options", nargs="+", default=[], metavar="KEY=VALUE", help=how)


def of_others(path: str | Path) -> bool:
    """Whether a path is a model's ``.zip`` that ``train.py`` did not write, or a broken one."""
    try:
        return Path(path).is_file() and not by_train(entries(path))
    except Exception:  # ``SavedModel`` says what is wrong with it
        return Path(path).suffix == ".zip"
