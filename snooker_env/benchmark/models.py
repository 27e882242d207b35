"""How does a model of Stable-Baselines3 or sb3-contrib play? Its ``.zip``, checked before any code in it runs, as a player of tables."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from .._check import choice, refuse
from .._types import Bools, ObservationKind
from ..tasks.discrete_actions import Choices
from ..tasks.observations import OBSERVATIONS, shaped, space
from ..tasks.options import Options
from ..tasks.saved_models import SavedModel, one_thread, outline
from .tasks import FREE


@dataclass(frozen=True)
class FittingModel:
    """A model's file whose spaces, as the file describes them, are those of an environment with these options.

    Attributes
    ----------
    saved : SavedModel
        The file; nothing in it was unpickled.
    options : dict
        Options of ``FREE`` with which its actions are read.
    observation : str
        Kind of its observation: "flat", "balls" or "masked".
    frame : bool
        Whether its observation is that of a frame.

    Examples
    --------
    >>> from snooker_env.benchmark import FittingModel
    >>> FittingModel.of("nothing.zip", {})
    Traceback (most recent call last):
    ...
    ValueError: agent = 'nothing.zip': must be a model saved by Stable-Baselines3 ([Errno 2] No such file or directory: 'nothing.zip')
    """

    saved: SavedModel
    options: dict[str, Any]
    observation: ObservationKind
    frame: bool

    @classmethod
    def of(cls, path: str | Path, options: dict[str, Any], *, frames: bool = False, field: str = "agent") -> "FittingModel":
        """Read the description in a model's file.

        Parameters
        ----------
        path : str or Path
            The ``.zip`` of Stable-Baselines3 or sb3-contrib.
        options : dict
            Options of ``FREE`` with which its actions are read.
        frames : bool
            Whether a model with the observation of a frame is accepted too.
        field : str
            Name of the model in messages.

        Returns
        -------
        FittingModel
            The file and how it is used.

        Raises
        ------
        ValueError
            If it is no such file, or its spaces are others. No code in it has run.
        """
        saved = SavedModel.of(path, field)
        options = ({"action": "discrete"} if saved.action[0] == "Discrete" else {}) | options
        for frame in (False, True)[: 1 + frames]:
            for kind in OBSERVATIONS:
                if outline(space(kind, frame=frame)) == saved.observation:
                    found = cls(saved, options, kind, frame)
                    if outline(found.actions) != saved.action:
                        raise found.other_actions
                    return found
        raise saved.refused(_VIEW)

    @property
    def actions(self) -> Any:
        """The space of its actions."""
        task: Any = {"task": "frame"} if self.frame or "decision" in self.options else {}
        return Options(**task, **self.options).rules.actions.space

    @property
    def other_actions(self) -> ValueError:
        """The error for a model with another action space; not raised."""
        return self.saved.refused(
            f"must be a model whose actions are {self.actions}: give --options as in its training, for example placement=True"
        )

    def network(self, trust: bool) -> Any:
        """Load its policy. The code in its pickles runs.

        Parameters
        ----------
        trust : bool
            Whether that code may run.

        Returns
        -------
        stable_baselines3 policy
            The policy, on the CPU or the device of its settings.

        Raises
        ------
        ValueError
            Without ``trust``, and for a file whose spaces are not those that it describes.
        ImportError
            If the library that saved it is not installed.
        """
        network = self.saved.network(trust, "--trust")
        if network.observation_space != space(self.observation, frame=self.frame):
            raise self.saved.refused(_VIEW)
        if network.action_space != self.actions:
            raise self.other_actions
        return network


_VIEW = "must be a model trained on the observation of a visit, flat, balls or masked, and nothing else"


class ForeignModelPlayer:
    """A model of Stable-Baselines3 as a player; its actions are deterministic.

    Parameters
    ----------
    path : str or Path
        The ``.zip`` of the model.
    options : dict
        Options of ``FREE`` with which its actions are read.
    trust : bool
        Whether the code in the file may run.

    Raises
    ------
    ValueError
        As ``FittingModel.of`` and ``FittingModel.network``.

    Examples
    --------
    >>> from snooker_env.benchmark import ForeignModelPlayer
    >>> ForeignModelPlayer("nothing.zip", {}, trust=False)
    Traceback (most recent call last):
    ...
    ValueError: agent = 'nothing.zip': must be a model saved by Stable-Baselines3 ([Errno 2] No such file or directory: 'nothing.zip')
    """

    def __init__(self, path: str | Path, options: dict[str, Any], trust: bool):
        found = FittingModel.of(path, options, frames=True)
        self._network = found.network(trust)
        self.frames: bool = found.frame
        self._kind: ObservationKind = found.observation
        self.options: dict[str, Any] = found.options
        self._masked = isinstance(Options(**_visit(self.options)).rules.actions, Choices) and found.saved.algorithm[1] == "MaskablePPO"

    def act(self, tables: Any, observations: Any, going: Bools) -> Any:
        """Choose an action for each table on which the episode goes on.

        Parameters
        ----------
        tables : SnookerVectorEnv
            The n tables.
        observations : float32 (n, k)
            Their flat observations.
        going : bool (n,)
            Tables on which the episode goes on.

        Returns
        -------
        numpy.ndarray
            An action for each table, 0 where the episode is over.
        """
        masks = {"action_masks": tables.action_masks()[going]} if self._masked else {}
        actions = np.zeros(tables.action_space.shape, tables.action_space.dtype)
        shown = tables.action_masks()[going] if self._kind == "masked" else None
        seen = shaped(self._kind, observations[going], shown)
        with one_thread():
            actions[going] = self._network.predict(seen, deterministic=True, **masks)[0]
        return actions


def _visit(options):
    return {name: value for name, value in options.items() if name != "decision"}


def options_of_words(words: list[str]) -> dict[str, Any]:
    """Options from words like "aim=target" and "placement=True". Raises ValueError.

    Parameters
    ----------
    words : list of str

    Returns
    -------
    dict
    """
    found: dict[str, Any] = {}
    for word in words:
        name, equals, value = word.partition("=")
        if not equals or name not in FREE or name in found:
            raise refuse("options", word, f"must be KEY=VALUE, KEY once each of {', '.join(FREE)}")
        truths = {"True": True, "False": False, "true": True, "false": False}
        if name in ("elevation", "placement", "decision"):
            found[name] = truths[choice(f"options.{name}", value, tuple(truths))]
        else:
            found[name] = value
    return found
