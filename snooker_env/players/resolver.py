"""Which player does a name stand for? The only place that answers."""

import importlib
import importlib.util
import re
from collections.abc import Callable, Mapping, Sequence
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import Any

from .._lib.check import refuse, refuse_what, truth
from ..planning import VisitJudge
from ..planning.search import BUDGET, MOST
from .choices import GhostBall, Random
from .player import Player
from .program import ProgramPlayer
from .saved_models import LEFT_OUT, check_model_options, of_others
from .search_player import SearchPlayer, StrokeValuePlayer, Tactician

GROUP = "snooker_env.players"  # entry points for players: NAME = MODULE:MAKER, called without arguments
READERS = "snooker_env.models"  # entry points that read models, called with a path; None if it is not theirs
BUILT_IN = ("random", "ghost_ball", "best_pot", "search", "planner", "tactician", "stroke_value", "strokes")
OWN = re.compile(r"[^\W\d]\w*(\.[^\W\d]\w*)*:[^\W\d]\w*")  # MODULE:CLASS
PROGRAM = "program:"
_KINDS = "best_pot|search|tactician|stroke_value|planner"
_SEARCHING = re.compile(rf"({_KINDS})(?:_(\d+))?(?:@(.+))?")


def players() -> list[str]:
    """Return the names of players: those in the package, then those that installed packages bring.

    Returns
    -------
    list of str
        Names that ``player`` accepts; those that search also take a number of simulated shots: "search_2000".

    Examples
    --------
    >>> import snooker_env as sn
    >>> sn.players()[:3]
    ['random', 'ghost_ball', 'best_pot']
    """
    return [*BUILT_IN, *(name for name in _find_entry_points() if name not in BUILT_IN)]


def player(name: object, *, trust: bool = False, options: Mapping[str, Any] | None = None) -> Player:
    """Return the player with a name.

    Parameters
    ----------
    name : str, Path or player
        One of:

        * a name of ``players()``, for players that search optionally with a number of simulated shots
          ("planner_500") and for a planner with a model ("planner@runs/ppo_value-0"); for ``stroke_value`` with a network of
          ``train.py`` ("stroke_value@runs/stroke_value-0/strokes.npz");
        * "MODULE:CLASS" of a player of your own, made without arguments; its module is imported;
        * a ``.zip`` of Stable-Baselines3 or sb3-contrib, or a run's folder or files of ``train.py``;
        * "program:COMMAND", an external program (docs/play/protocol.md);
        * a player, or an object with ``options`` and ``act(observations, masks, seeds)``.
    trust : bool
        Whether code in a model's ``.zip`` may run.
    options : dict, optional
        How the actions of a model of Stable-Baselines3 are read, which its file does not say: "aim", "elevation",
        "placement", "action" and, of frames, "says", as the environment of its training had them. What is
        left out is that of ``Snooker-v0``.

    Returns
    -------
    Player
        Not yet bound: ``player(name).at(options).play(positions, seeds)``. ValueError if nothing has that
        name, the file holds no player, it holds code and ``trust`` is False, its actions are not those that
        ``options`` say, or ``options`` are given for what is no model of Stable-Baselines3.

    Examples
    --------
    >>> import snooker_env as sn
    >>> sn.player("ghost_ball").at({}).play(sn.Position(cue=(0.0, 0.9), black=(0.4, 1.3)), [7]).values.shape
    (1, 5)

    A model that was trained with ``aim="target"``:

    >>> sn.player("ppo.zip", trust=True, options={"aim": "target"})  # doctest: +SKIP
    """
    truth("trust", trust)
    read, text = check_model_options(options), str(name)
    if read and (not isinstance(name, str | Path) or is_name(text)):
        raise refuse("options", read, LEFT_OUT)
    if not isinstance(name, str | Path):
        return _of_object(name)
    if (built_in := _built_in(text)) is not None:
        return built_in
    if text.startswith(PROGRAM):
        return ProgramPlayer(text.removeprefix(PROGRAM))
    if (entry := _find_entry_points().get(text)) is not None:
        return _of_object(_make(text, entry.load))
    if text and Path(text).exists():
        return _of_file(Path(text), trust, read)
    if OWN.fullmatch(text):
        module, _, maker = text.partition(":")
        return _of_object(_make(text, lambda: getattr(importlib.import_module(module), maker)))
    if Path(text).suffix in (".zip", ".npz") or "/" in text or "\\" in text:
        raise refuse("player", text, "must be a file or folder that is there: it is missing")
    known = ", ".join(map(repr, players()))
    others = "MODULE:CLASS, a model's file, a run's folder or program:COMMAND"
    raise refuse("player", text, f"must be one of {known}, {others}")


def players_of(names: Sequence[str], trust: bool, options: Mapping[str, Any]) -> list[Player]:
    """The players that a command line names; ``options`` apply to the models of Stable-Baselines3 among them."""
    models = [of_others(name) for name in names]
    its = [options if model else None for model in models]
    made = [player(name, trust=trust, options=one) for name, one in zip(names, its, strict=True)]
    if options and not any(models):
        raise refuse("options", dict(options), LEFT_OUT)
    return made


def is_name(text: str) -> bool:
    """Whether a text is the name of a player, MODULE:CLASS or a program, and not a file."""
    if _SEARCHING.fullmatch(text) is not None or text.startswith(PROGRAM) or text in players():
        return True
    return OWN.fullmatch(text) is not None and not Path(text).exists()


def _built_in(name: str) -> Player | None:
    if name in (Random.name, GhostBall.name):
        return Random() if name == Random.name else GhostBall()
    if name == "strokes":
        from .seen import MenuPlayer

        return MenuPlayer()
    form = _SEARCHING.fullmatch(name)
    if form is None:
        return None
    kind, budget, model = form.groups()
    if kind == StrokeValuePlayer.name:
        if budget:
            raise refuse("player", name, "must not name a number of shots: stroke_value simulates none")
        return StrokeValuePlayer(None if model is None else _strokes(name, Path(model)))
    if model is not None and kind != "planner":
        raise refuse("player", name, f"must not name a model: {kind} has learned nothing")
    if budget and not VisitJudge.least <= int(budget) <= MOST:
        raise refuse(
            "player", name, f"must end in a number of simulated shots from {VisitJudge.least} to {MOST:,}"
        )
    if kind == Tactician.kind:
        return Tactician(int(budget) if budget else BUDGET)
    learned = None if model is None else _load_networks(model)
    return SearchPlayer(kind, int(budget) if budget else BUDGET, learned)


def _find_entry_points() -> dict[str, EntryPoint]:
    """The players of installed packages by name, as far as their modules are there."""
    return {one.name: one for one in entry_points(group=GROUP) if _importable(one.module)}


def _importable(module: str) -> bool:
    """Whether a module can be imported: a wheel names this repository's ``agents`` but does not hold them."""
    try:
        return importlib.util.find_spec(module) is not None
    except ModuleNotFoundError:
        return False


def _make(name: str, maker: Callable[[], Any]) -> Any:
    """An instance of what a name means; ValueError if the user's code raises."""
    try:
        return maker()()
    except Exception as error:
        if isinstance(error, ImportError) and not error.name:  # its text says what to install
            raise
        allowed = f"must be MODULE:CLASS of a player ({type(error).__name__}: {error})"
        raise refuse("player", name, allowed) from error


def _of_object(thing: object) -> Player:
    """A player as it is, or what makes one of an object that acts on observations."""
    if isinstance(thing, Player) and not isinstance(thing, type):
        return thing
    if callable(getattr(thing, "act", None)) and not isinstance(thing, type):
        from .seen import SeenPlayer

        return SeenPlayer(thing, dict(getattr(thing, "options", {})), type(thing).__name__)
    allowed = "must be a player: at(rules) and play(positions, seeds), or act(observations, masks, seeds)"
    if callable(getattr(thing, "predict", None)):  # a model of Stable-Baselines3, or one like it
        allowed += "; wrap its predict in act(observations, masks, seeds)"
    raise refuse_what("player", f"a {type(thing).__name__}", allowed)


def _read(path: Path) -> Any:
    for one in entry_points(group=READERS):
        if _importable(one.module) and (made := one.load()(path)) is not None:
            return made
    return None


def _of_file(path: Path, trust: bool, options: dict[str, Any]) -> Player:
    made = _read(path)
    if made is None:
        from .saved_models import saved_player

        return saved_player(path, options, trust)
    if options:
        raise refuse("options", options, f"{LEFT_OUT}, and {path} says itself how its actions are read")
    return _of_object(made)


def _strokes(name: str, path: Path) -> Any:
    """The layers of the networks that ``train.py --agent stroke_value`` has written."""
    from .weights import learned_strokes

    try:
        return learned_strokes(path)
    except (OSError, KeyError, ValueError) as error:
        allowed = f"must name a strokes.npz of train.py --agent stroke_value ({error})"
        raise refuse("player", name, allowed) from None


def _load_networks(model: str) -> Any:
    """Policy and value of a planner's model: a level of the package's weights, a file or a run's folder."""
    from .weights import learned_at, levels

    if model in levels():
        return learned_at(model)
    made = _read(Path(model)) if Path(model).exists() else None
    learned = getattr(made, "learned", None)
    if learned is None:
        allowed = f"must name a model with policy and value: {', '.join(levels())} or its file"
        raise refuse("player", f"planner@{model}", allowed)
    return learned
