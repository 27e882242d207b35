"""Which players can give advice? Those built into the package, those of the repository, and classes and models of your own."""

import importlib
import re
from pathlib import Path
from types import ModuleType
from typing import Any

from .._check import refuse, truth
from .advisor import Advisor
from .borrowed import Borrowed
from .lookahead import LookaheadAdvisor
from .simple import GhostBallAdvisor, RandomAdvisor

BUILT_IN: dict[str, type[Advisor]] = {maker.name: maker for maker in (LookaheadAdvisor, GhostBallAdvisor, RandomAdvisor)}
"""The players in the package, by name."""
OWN = re.compile(r"[^\W\d]\w*(\.[^\W\d]\w*)*:[^\W\d]\w*")
"""MODULE:CLASS."""


def names() -> list[str]:
    """Return the names that ``player_of`` accepts: the built-in players and, in a clone, those of the repository.

    Returns
    -------
    list of str
        The built-in players come first.

    Examples
    --------
    >>> from snooker_env.advice import names
    >>> names()[:3]
    ['lookahead', 'ghost_ball', 'random']
    """
    return [*BUILT_IN, *(name for name in _others() if name not in BUILT_IN)]


def is_known(name: str) -> bool:
    """Whether this is the name of a player: one of ``names``, or in a clone such as "planner_500"; ``player_of`` checks the rest."""
    by_name = _repository("agents.players.by_name")
    return name in names() or (by_name is not None and OWN.fullmatch(name) is None and by_name.is_player(name))


def player_of(agent: Any, *, trust: bool = False) -> Advisor:
    """Return the player with a name, ready to give advice.

    Parameters
    ----------
    agent : str, Path or player
        One of:

        * "lookahead", "ghost_ball" or "random", which are built in;
        * in a clone of the repository: a name of its players and pre-trained agents (see ``names``), a model's ``.zip``, or the folder of
          a training run;
        * "MODULE:CLASS" of a player of your own; its module is imported;
        * a player: an object with ``options`` and ``act(tables, observations, going)``.
    trust : bool, optional
        Whether code in a model's ``.zip`` may run that was not written by the repository's ``train.py``; default False.

    Returns
    -------
    Advisor
        A player with ``options``, ``act(tables, observations, going)`` and ``rank``.

    Raises
    ------
    ValueError
        If no player has that name, or the file holds none.

    Examples
    --------
    >>> from snooker_env.advice import player_of
    >>> player_of("ghost_ball").name
    'ghost_ball'
    """
    truth("trust", trust)
    if isinstance(agent, Advisor):
        return agent
    if isinstance(agent, str) and agent in BUILT_IN:
        return BUILT_IN[agent]()
    if not isinstance(agent, str | Path):
        return Borrowed(agent, type(agent).__name__)
    name = str(agent)
    if OWN.fullmatch(name) and not Path(name).exists():
        return Borrowed(_own(name), name)
    by_name = _repository("agents.players.by_name")
    if by_name is None:
        allowed = ", ".join(map(repr, BUILT_IN)) + ", MODULE:CLASS or a player; models and other players need a clone of the repository"
        raise refuse("agent", name, f"must be {allowed}")
    if trust and Path(name).exists():
        return Borrowed(importlib.import_module("agents.players.trained").load_any(Path(name), trust, {}), name)
    return Borrowed(by_name.player_of(name), name)


def playing(agent: Any, *, trust: bool = False) -> Any:
    """The player with a name, to play and not to advise: as ``player_of``, without what makes others give advice."""
    player = player_of(agent, trust=trust)
    return player.player if isinstance(player, Borrowed) else player


def _own(name: str) -> Any:
    """An instance of MODULE:CLASS."""
    module, _, maker = name.partition(":")
    try:
        return getattr(importlib.import_module(module), maker)()
    except Exception as error:  # the user's code may raise anything
        raise refuse("agent", name, f"must be MODULE:CLASS of a player ({type(error).__name__}: {error})") from error


def _repository(module: str) -> ModuleType | None:
    """A module of the repository's ``agents``, which no wheel holds; None where Python does not run in a clone.

    It is imported by ``importlib``, as an optional plug-in: the package itself must not depend on it.
    """
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        if (error.name or "").split(".")[0] == "agents":
            return None
        raise


def _others() -> list[str]:
    """Names of the repository's players and pre-trained agents, if it is there."""
    by_name = _repository("agents.players.by_name")
    if by_name is None:
        return []
    try:
        models = importlib.import_module("agents.learning.models").pretrained()
    except ModuleNotFoundError:  # models need the training libraries
        models = []
    return [*by_name.NAMES, *models]
