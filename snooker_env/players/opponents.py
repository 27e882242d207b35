"""Who sits opposite the agent of a frame? A player, asked once for all tables that wait, or one of several in a pool, drawn for
each frame from the table's own stream."""

import os
from collections.abc import Iterable
from pathlib import Path
from typing import TypeAlias

import numpy as np

from .._lib.check import integer, number, refuse, refuse_what
from .._lib.types import Floats, Ints
from ..game.frame_columns import OPPONENT, Layouts, strikers_own
from ..planning import Positions
from ..tasks.frames import Asked, Frames, Opponent
from ..tasks.options import OPPONENTS, Options
from ..tasks.tables import Crew, uniform
from .choices import GhostBall
from .player import Player, Strokes
from .resolver import PROGRAM
from .resolver import player as player_of
from .saved_models import FittingModel, SavedNetwork, of_others
from .seen import SeenPlayer

_KINDS = (ValueError, TypeError, ImportError)
Member: TypeAlias = str | Path | Player  # whom a pool may hold: a player, or its name


class OpponentPool:
    """Several opponents, one of whom is drawn for each table and frame, by their weights: the same seed meets the same.

    Parameters
    ----------
    members, weights : iterable, optional
        Players, or their names; more may be added at any time. One weight for each, at least 0; default 1.

    Examples
    --------
    >>> from snooker_env.players import OpponentPool
    >>> pool = OpponentPool(["random", "ghost_ball"], weights=[1, 3])
    >>> pool.add("random")
    >>> pool.weights
    (1.0, 3.0, 1.0)
    """

    def __init__(self, members: Iterable[Member] | None = None, weights: Iterable[float] | None = None):
        self._members: tuple[Member, ...] = ()
        self._weights: tuple[float, ...] = ()
        listed = [] if members is None else list(members)
        if members is not None and not listed:
            allowed = "must hold one member at least; leave them out where add(...) follows"
            raise refuse("members", listed, allowed)
        each = [1.0] * len(listed) if weights is None else list(weights)
        if len(each) != len(listed):
            raise refuse("weights", each, f"must be {len(listed)} numbers, one for each member")
        for member, weight in zip(listed, each, strict=True):
            self.add(member, weight)
        if listed and not any(self.weights):
            raise refuse("weights", each, "must hold a number above 0: nobody could be drawn")

    @property
    def members(self) -> tuple[Member, ...]:
        """The members, in the order in which they were added."""
        return self._members

    @property
    def weights(self) -> tuple[float, ...]:
        """The weight of each member."""
        return self._weights

    def add(self, member: Member, weight: float = 1.0) -> None:
        """Add a member, which later frames may draw; ValueError for a pool, or a weight below 0."""
        nobody = member is None or (isinstance(member, str) and member == "none")
        if nobody or isinstance(member, OpponentPool):
            raise refuse("member", member, "must be one opponent: a name or a player")
        new = number("weight", weight, 0.0)
        self._members, self._weights = (*self._members, member), (*self._weights, new)

    def set_weight(self, index: int, weight: float) -> None:
        """Change the weight of ``members[index]``, 0: not drawn any more; ValueError for a bad number."""
        k = integer("index", index, 0, len(self.members) - 1)
        self._weights = (*self.weights[:k], number("weight", weight, 0.0), *self.weights[k + 1 :])


def draw_uniform(frames: Frames, which: Ints) -> Floats:
    """Uniform numbers in [0, 1), from the streams of the tables ``which``."""
    numbers = np.empty((len(which), 2))  # they come in pairs
    uniform(which, frames.streams, numbers)
    return numbers[:, 0]


class PlayerOpponent:
    """A bound player as opponent; the seed of each stroke comes from the table's own stream."""

    def __init__(self, player: Player, name: str):
        self.player, self.name = player, name

    def strokes(self, frames: Frames, which: Ints, crew: Crew) -> Asked:
        """See ``Opponent.strokes``; errors name the player."""
        seeds, asked = np.zeros(frames.n, np.int64), _room(frames.n)
        seeds[which] = draw_uniform(frames, which) * 2**32
        player = self.player
        if isinstance(player, GhostBall):  # kernels alone, on several threads: its answer needs no check

            def ask(part, _):
                tables = frames.positions[part], frames.on_table[part], frames.game[part]
                conditions = frames.conditions[part] if frames.rules.drawn else None
                _write(asked, part, player.turns(*tables, conditions, seeds[part])[0])

            crew(which, ask)
        else:
            _write(asked, which, self._answer(frames, which, seeds[which]).parts)
        return asked

    def _answer(self, frames: Frames, which: Ints, seeds: Ints) -> Strokes:
        """What the player answers, checked."""
        saved = Layouts(frames.layouts_before.positions[which], frames.layouts_before.on_table[which])
        game = strikers_own(frames.game[which])
        own = frames.conditions[which] if frames.rules.drawn else None
        at = Positions(frames.positions[which], frames.on_table[which], game, saved, own)
        try:
            strokes = self.player.play(at, seeds)
        # of the player's own code: it is named, and the kind kept where callers tell kinds apart
        except Exception as error:
            kind = next((kind for kind in _KINDS if isinstance(error, kind)), RuntimeError)
            raise kind(f"opponent {self.name} raised {type(error).__name__}: {error}") from error
        if not isinstance(strokes, Strokes) or len(strokes) != len(which):
            many = len(strokes) if isinstance(strokes, Strokes) else "a"
            allowed = f"must be {len(which)} Strokes, one for each position"
            raise refuse_what(f"opponent {self.name}: play(...)", f"{many} {type(strokes).__name__}", allowed)
        return strokes


class PoolOpponent:
    """The members of a pool as opponents in frames with these options; members added later are bound when they play."""

    name = "an OpponentPool"

    def __init__(self, pool: OpponentPool, options: Options):
        self.pool: OpponentPool = pool
        self._options, self._ready = options, list[Opponent]()
        self._complete()

    def _complete(self) -> None:
        for k, member in enumerate(self.pool.members[len(self._ready) :], len(self._ready)):
            try:
                self._ready.append(opponent_of(member, self._options))
            except ValueError as error:
                raise ValueError(f"members[{k}] of the OpponentPool: {error}") from error

    def strokes(self, frames: Frames, which: Ints, crew: Crew) -> Asked:
        """See ``Opponent.strokes``: each table's own member is asked."""
        self._complete()
        new, shares = which[frames.game[which, OPPONENT] == 0], np.cumsum(self.pool.weights)
        if len(new):
            if not len(shares) or shares[-1] <= 0.0:
                raise refuse("opponent", self.name, "must have a member with a weight above 0")
            drawn = draw_uniform(frames, new) * shares[-1]
            frames.game[new, OPPONENT] = 1 + np.searchsorted(shares, drawn, side="right")
        playing, asked = frames.game[which, OPPONENT], _room(frames.n)
        for member in np.unique(playing).tolist():
            if member > len(self._ready):
                allowed = f"must be below {len(self._ready)}, as many as the pool has"
                raise refuse("opponent", f"member {member - 1} of a pool", allowed)
            its = which[playing == member]
            answer = self._ready[member - 1].strokes(frames, its, crew)
            _write(asked, its, tuple(part[its] for part in answer))
        return asked


def _room(n: int) -> Asked:
    nominated, decisions, declared = np.zeros((3, n), np.int64)
    return np.zeros((n, 5)), np.zeros((n, 2)), nominated, decisions, declared


def _write(asked: Asked, rows: Ints, parts: tuple[Floats | Ints, ...]) -> None:
    for whole, part in zip(asked, parts, strict=True):
        whole[rows] = part


def opponent_of(opponent: str | Path | Player | OpponentPool, options: Options) -> Opponent:
    """The opponent that a name, several with commas, a player or a pool stands for in frames with these options."""
    text = opponent if isinstance(opponent, str) else ""
    if "," in text and not text.startswith(PROGRAM) and not os.path.exists(text):
        names = [name.strip() for name in text.split(",")]
        if "none" in names:
            allowed = "must be 'none' alone, or names of players with commas between them"
            raise refuse("opponent", opponent, allowed)
        opponent = OpponentPool(names)
    if isinstance(opponent, OpponentPool):
        return PoolOpponent(opponent, options)
    if isinstance(opponent, type):
        raise refuse("opponent", opponent, f"must be an instance and not the class: {opponent.__name__}(...)")
    if isinstance(opponent, str | Path):
        name = str(opponent)
        return PlayerOpponent(_find_player(name, options).at(options), name)
    if not isinstance(opponent, Player):
        raise refuse("opponent", opponent, OPPONENTS)
    return PlayerOpponent(opponent.at(options), getattr(opponent, "name", "") or type(opponent).__name__)


def _find_player(name: str, options: Options) -> Player:
    """The player with a name; errors say that it is the opponent's."""
    if Path(name).suffix == ".zip" and (of_others(name) or not Path(name).is_file()):
        return _model(name, options)
    try:
        return player_of(name, trust=options.trust)
    except ValueError as error:
        text = str(error)
        if not text.startswith("player = "):  # of what the name stands for
            raise ValueError(f"opponent = {name!r}: {text}") from error
        others = text.removeprefix("player").replace("must be one of ", "must be one of 'none', ", 1)
        raise ValueError(f"opponent{others}") from error


def _model(path: str, options: Options) -> Player:
    """A model of Stable-Baselines3, whose actions are the environment's, with or without what is said."""
    plain = {name: getattr(options, name) for name in Options.group("action", "visit")}
    full = plain | {"says": options.says}
    try:
        model = FittingModel.of(path, full, "opponent")
    except ValueError:
        if not options.says or "nominate" in options.says:  # a nomination cannot be left out
            raise
        model = FittingModel.of(path, plain, "opponent")
    return SeenPlayer(SavedNetwork(model, options.trust), name=path)
