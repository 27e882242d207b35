"""Which agent is judged? A built-in player, one of the repository, a model's file, MODULE:CLASS or a program, and its training."""

import importlib
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

from .._check import integer, refuse
from ..advice.players import BUILT_IN, OWN, is_known, names, player_of
from ..tasks.saved_models import by_train, entries
from .models import ForeignModelPlayer
from .playing import check_player
from .program import ProgramPlayer
from .schema import LABEL
from .tasks import Task

KINDS = ("built_in", "repository", "model", "class", "program", "object")
"""Kinds of agents: a player of the package, a name of the repository, a ``.zip`` of Stable-Baselines3, MODULE:CLASS, a program of the text
protocol; "object": a player made in Python."""
PROGRAM = "program:"


@dataclass(frozen=True, kw_only=True)
class Agent:
    """An agent to judge; ``Agent.of`` makes one from a text.

    Attributes
    ----------
    label : str
        Its name in tables: 1 to 20 letters, digits or . + - _.
    kind : str
        One of ``KINDS``.
    sources : tuple of str
        Where it comes from: a name, MODULE:CLASS, program:COMMAND, or a file for each training seed.
    options : dict
        Options of ``FREE`` with which the actions of a model of Stable-Baselines3 are read.
    trust : bool
        Whether code in models may run.
    timeout : float
        The longest time of a program for one stroke [s].
    training_shots : int, optional
        Number of simulated shots of its training; None: unknown.
    shots_declared : int, optional
        Simulated shots per decision that this process cannot count; None: nothing is declared.
    maker : callable, optional
        Called without arguments, returns the player; None: the player is made from ``sources``.

    Examples
    --------
    >>> from snooker_env.benchmark import Agent
    >>> agent = Agent.of("random")
    >>> agent.label, agent.kind, agent.training_shots
    ('random', 'built_in', 0)
    """

    label: str
    kind: str
    sources: tuple[str, ...]
    options: dict[str, Any] = field(default_factory=dict)
    trust: bool = False
    timeout: float = 60.0
    training_shots: int | None = None
    shots_declared: int | None = None
    maker: Callable[[], Any] | None = None

    @classmethod
    def of(
        cls, text: str, *, label: str | None = None, options: dict[str, Any] | None = None, trust: bool = False, timeout: float = 60.0,
        training_shots: int | None = None, shots_declared: int | None = None,
    ) -> "Agent":  # fmt: skip
        """The agent that a text names.

        Parameters
        ----------
        text : str
            A name, MODULE:CLASS, program:COMMAND, a file or run folder, or LABEL=FILE,FILE,... with one file for each training seed.
        label : str, optional
            As in ``Agent``; None: made from the text.
        options : dict, optional
            As in ``Agent``; only for models of Stable-Baselines3.
        trust : bool
            As in ``Agent``.
        timeout : float
            As in ``Agent`` [s].
        training_shots, shots_declared : int, optional
            As in ``Agent``. A built-in player has 0 training shots.

        Returns
        -------
        Agent
            The agent. No code of it has run.

        Raises
        ------
        ValueError
            If nothing has that name, or an argument is wrong.
        """
        given = text
        if not text.startswith(PROGRAM) and "=" in text and not Path(text).exists():
            own, _, text = text.partition("=")
            label = label or own
        sources: tuple[str, ...] = (text,) if text.startswith(PROGRAM) else tuple(text.split(","))
        kinds = {_kind(source) for source in sources}
        if not all(sources) or len(kinds) > 1 or (len(sources) > 1 and kinds != {"model"} and kinds != {"repository"}):
            raise refuse("agent", given, "must be one agent, or models with the same label: LABEL=FILE,FILE")
        if len(set(sources)) < len(sources):
            raise refuse("agent", given, "must be different models, one for each training seed")
        kind = kinds.pop()
        if training_shots is None and kind == "built_in":
            training_shots = 0
        if training_shots is not None:
            integer("training_shots", training_shots, 0, 2**53)
        if shots_declared is not None:
            integer("simulated_shots", shots_declared, 0, 2**53)
        if options and kind != "model":
            raise refuse("options", options, "must be left out: it is for models of Stable-Baselines3")
        label = label or _label(next(iter(sources)), kind)
        if not LABEL.fullmatch(label):
            raise refuse("label", label, "must be 1 to 20 letters, digits or . + - _: give --label")
        if is_reserved(label, sources):
            raise refuse("label", label, "must not be the name of another player: give --label")
        return cls(
            label=label, kind=kind, sources=sources, options=options or {}, trust=trust, timeout=timeout, training_shots=training_shots,
            shots_declared=shots_declared,
        )  # fmt: skip

    @property
    def tables_at_once(self) -> int | None:
        """Number of episodes that it plays side by side: 1 for a program, None for the number of the protocol."""
        return 1 if self.kind == "program" else None

    def player(self, task: Task, run: int = 0) -> Any:
        """The player of one training seed, checked for this task. Code of the agent runs.

        Parameters
        ----------
        task : Task
            The task.
        run : int
            Index of the training seed in ``sources``.

        Returns
        -------
        object
            A player, with ``options`` and ``act``.

        Raises
        ------
        ValueError
            If it is no player, or cannot play the task.
        """
        player = self._made(self.sources[run], task)
        if getattr(player, "frames", False) is True and self.kind == "model" and not task.frame:
            raise refuse("agent", self.sources[run], f"must be trained on a visit to play {task.id}: it sees the observation of a frame")
        check_player(player, task)
        return player

    def _made(self, source, task):
        if self.maker is not None:
            return self.maker()
        if self.kind == "program":
            return ProgramPlayer(source.removeprefix(PROGRAM), frame=task.frame, timeout=self.timeout)
        if self.kind == "class":
            return _own(source)
        if self.kind == "model" and not _ours(source):
            return _model(source, tuple(sorted(self.options.items())), self.trust)
        if self.options:
            raise refuse("options", self.options, "must be left out: the file of train.py says how its actions are read")
        return player_of(source, trust=self.trust)


def is_reserved(label: str, sources: Sequence[str]) -> bool:
    """Whether that is the name of a built-in player, or of one of the repository, and these are not that player.

    Parameters
    ----------
    label : str
    sources : sequence of str

    Returns
    -------
    bool
    """
    name = re.sub("[.+-]", "_", label.lower()).strip("_")  # what a reader would take for it
    return (is_known(label) or is_known(name)) and list(sources) != [label]


def plans(name: str) -> bool:
    """Whether the built-in player, or that of the repository, with this name simulates shots when it decides.

    Parameters
    ----------
    name : str

    Returns
    -------
    bool
    """
    return name not in ("random", "random_absolute", "ghost_ball") and (not name.startswith("ppo_") or "foresight" in name)


def kind_by_name(source: str) -> str | None:
    """The kind of an agent whose source is a name or a command; None if it may be a file, a class or an object.

    Parameters
    ----------
    source : str

    Returns
    -------
    str or None
    """
    if source.startswith(PROGRAM):
        return "program"
    return "built_in" if source in BUILT_IN else "repository" if is_known(source) else None


def _kind(source):
    found = kind_by_name(source)
    if found is not None:
        return found
    if Path(source).exists():
        return "model"
    if OWN.fullmatch(source):
        return "class"
    known = ", ".join(names())
    raise refuse("agent", source, f'must be one of {known}, a .zip or run folder, MODULE:CLASS or program:"COMMAND"')


def _label(source, kind):
    if kind == "class":
        label = source.rpartition(":")[2]
    else:
        path = Path((source.removeprefix(PROGRAM).split() or ["program"])[-1] if kind == "program" else source)
        label = path.parent.stem if path.name == "model.zip" and path.parent.name else path.stem
    return re.sub(r"[^\w.+-]", "_", label)[:20]


def _own(name):
    """The player MODULE:CLASS, made without arguments."""
    module, _, maker = name.partition(":")
    try:
        return getattr(importlib.import_module(module), maker)()
    except Exception as error:  # it is the user's code
        raise refuse("agent", name, f"must be MODULE:CLASS of a player ({type(error).__name__}: {error})") from error


def _ours(source):
    """Whether that is a model of train.py, or its run's folder."""
    path = Path(source)
    if path.is_dir():
        return True
    try:
        return by_train(entries(path))
    except Exception as error:
        raise refuse("agent", source, f"must be a model saved by Stable-Baselines3 ({error})") from None


@lru_cache(maxsize=16)
def _model(path, options, trust):
    return ForeignModelPlayer(path, dict(options), trust)
