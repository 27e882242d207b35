"""How does a model of Stable-Baselines3 or sb3-contrib play? Its checked ``.zip``, as a ``Seen``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from .._lib.check import refuse
from .._lib.types import Bools, Ints, Observation
from ..tasks.foreseen import STATES
from ..tasks.observations import OBSERVATIONS, STROKE_SIZE, space
from ..tasks.options import Options
from ..tasks.stroke_menu import SPEEDS, speeds_of
from .model_options import say_assumption
from .saved_models import SavedModel, by_train, entries, one_thread, outline
from .seen import SeenPlayer


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
            options = (
                {"action": "strokes", "speeds": speeds} if speeds else {"action": "discrete"}
            ) | options
        for frame, replaced in ((False, False), (True, False), (True, True)):
            for kind in OBSERVATIONS[frame:]:
                task = {"task": "frame", "miss": "clear_path" if replaced else "off"} if frame else {}
                told = {name: options[name] for name in options if frame or name != "says"}
                model = cls(saved, told | task | {"observation": kind})
                if kind == "strokes" and not replaced:
                    model.options.setdefault("speeds", _speeds_seen(saved.observation, frame) or SPEEDS)
                sizes = {
                    "choices": getattr(model.actions, "n", 0),
                    "speeds": model.options.get("speeds", SPEEDS),
                }
                if outline(space(kind, frame=frame, replaced=replaced, **sizes)) == saved.observation:
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
        network = self.saved.network(trust, "trust=True, or --trust on the command line")
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
