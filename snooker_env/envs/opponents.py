"""Who sits opposite the agent of a frame? What the option ``opponent`` names, or an object, bound once to the game."""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, TypeAlias, cast

import numpy as np

from .._check import refuse, refuse_what
from .._types import Ints
from ..game.frame_columns import Layouts
from ..game.sides import strikers_own
from ..planning import Positions
from ..players.player import Player, Strokes
from ..players.resolver import player as player_of
from ..players.saved import SAYS, FittingModel, SavedNetwork
from ..players.seen import SeenPlayer
from ..tasks.carry_out import carry_out
from ..tasks.frame import Frames
from ..tasks.ghost_ball import GhostBallOpponent
from ..tasks.kinds import TABLES
from ..tasks.opponent_pool import OpponentPool, PoolOpponent
from ..tasks.opponents import SIDE, AskedOpponent, Opponent, Policy, drawn
from ..tasks.options import NEVER, OBJECT, Options, options_of
from ..tasks.saved_models import by_train, entries
from ..tasks.seats import Seat
from ..tasks.stroke import ShotBuffers
from ..tasks.tables import Tables
from ..tasks.uniform_opponent import UniformOpponent

OpponentLike: TypeAlias = str | Path | Policy | Player | OpponentPool | Opponent | Any
"""What the keyword ``opponent`` of an environment accepts."""
KERNELS: dict[str, type[Opponent]] = {"random": UniformOpponent, "ghost_ball": GhostBallOpponent}
"""Opponents that play as kernels, without a call of Python."""
_ALLOWED = (
    "must be 'none', the name of a player, a model's file, a callable(observation, rng) -> action, a player, an object with "
    "act(observations, masks, seeds), or an OpponentPool"
)
_KINDS = (ValueError, TypeError, ImportError)


class PlayerOpponent(Opponent):
    """A bound player as the opponent: asked once for all tables that wait, with a seed from each table's own stream."""

    def __init__(self, player: Player, name: str):
        self.player, self.name = player, name

    def ask(self, frames: Frames, which: Ints, generators: Sequence[np.random.Generator]) -> tuple[Any, ...]:
        """The arrays of its ``Strokes``, with a row for each table of ``frames``."""
        numbers = np.empty(len(which))
        drawn(which, frames.streams, numbers)
        saved = Layouts(*(each[which] for each in frames.saved))
        at = Positions(frames.positions[which], frames.on_table[which], strikers_own(frames.game[which]), saved)
        try:
            strokes = self.player.play(at, (numbers * 2**32).astype(np.int64))
        except Exception as error:  # of the player's own code: it is named, and the kind kept where callers tell kinds apart
            kind = next((kind for kind in _KINDS if isinstance(error, kind)), RuntimeError)
            raise kind(f"opponent {self.name} raised {type(error).__name__}: {error}") from error
        if not isinstance(strokes, Strokes) or len(strokes) != len(which):
            what = f"{len(strokes)} Strokes" if isinstance(strokes, Strokes) else f"a {type(strokes).__name__}"
            raise refuse_what(f"opponent {self.name}: play(...)", what, f"must be {len(which)} Strokes, one for each position")
        out = []
        for part in (strokes.values, strokes.place, strokes.nominate, strokes.decision, strokes.declare):
            out.append(np.zeros((frames.n, *part.shape[1:]), part.dtype))
            out[-1][which] = part
        return tuple(out)

    def prepare(self, frames: Frames, which: Ints, asked: tuple[Any, ...], buffers: ShotBuffers) -> Ints:
        """Carry its strokes out up to the strike; returns the tables with a stroke."""
        return carry_out(frames, which, asked, buffers, SIDE)


def opponent_of(opponent: OpponentLike, options: Options) -> Opponent:
    """The opponent that a name or an object stands for in frames with these options."""
    if isinstance(opponent, Opponent):
        return opponent
    if isinstance(opponent, OpponentPool):
        return PoolOpponent(opponent, partial(opponent_of, options=options))
    if isinstance(opponent, type):
        raise refuse("opponent", opponent, f"must be an instance and not the class: {opponent.__name__}(...)")
    if isinstance(opponent, str | Path):
        name = str(opponent)
        player = None if name in KERNELS else _named(name, options)
        return KERNELS[name]() if player is None else PlayerOpponent(player.at(options), name)
    if isinstance(opponent, Player):
        return PlayerOpponent(opponent.at(options), getattr(opponent, "name", "") or type(opponent).__name__)
    if callable(opponent) or callable(getattr(opponent, "many", None)):
        return AskedOpponent(cast(Policy, opponent))
    if callable(getattr(opponent, "act", None)):
        return PlayerOpponent(player_of(opponent).at(options), type(opponent).__name__)
    raise refuse("opponent", opponent, _ALLOWED)


def _named(name: str, options: Options) -> Player:
    """The player with a name; errors say that it is the opponent's."""
    if Path(name).suffix == ".zip" and not _of_train(name):
        return _model(name, options)
    try:
        return player_of(name, trust=options.trust)
    except ValueError as error:
        text = str(error).replace("must be one of ", "must be one of 'none', ", 1)
        raise ValueError(f"opponent{text.removeprefix('player')}") from error


def _of_train(name: str) -> bool:
    """Whether that is a model of this repository's ``train.py``; False for what is no sound model's file."""
    try:
        return by_train(entries(name))
    except Exception:  # ``SavedModel`` says what is wrong with it
        return False


def _model(path: str, options: Options) -> Player:
    """A model of Stable-Baselines3: its actions are read as the environment's own, with or without what is said beside the stroke."""
    own = {name: getattr(options, name) for name in ("action", "aim", "elevation", "placement")}
    said = own | {name: True for name in SAYS if getattr(options, name)}
    try:
        model = FittingModel.of(path, said, "opponent")
    except ValueError:
        if said == own or options.nominate:  # a nomination cannot be left out
            raise
        model = FittingModel.of(path, own, "opponent")
    return SeenPlayer(SavedNetwork(model, options.trust), name=path)


def game_of(options: Options | None, keywords: Mapping[str, Any]) -> tuple[Options, Any]:
    """The ``Options`` of an environment, as ``options_of``, and who was passed as an object beside them, else None."""
    opponent = keywords.get("opponent")
    if opponent is None or isinstance(opponent, str | Path):
        return options_of(options, keywords), None
    rest = {name: value for name, value in keywords.items() if name != "opponent"}
    if options is None:
        return options_of(None, rest | {"opponent": OBJECT}), opponent
    return options_of(options, rest).but(opponent=OBJECT), opponent


def tables_of(options: Options, opponent: Any, n: int, limit: int = NEVER) -> Tables:
    """n tables of a game; ``opponent``: who was passed as an object, or None."""
    kind: Any = TABLES[options.task]
    if options.task == "visit":
        return kind(options.rules, n, limit=limit)
    if options.opponent == OBJECT and opponent is None:
        raise refuse("opponent", OBJECT, "must come with the object: pass it as opponent=... beside the options")
    seats = [Seat.of(options.rules)]
    if options.opponent != "none":
        seats.append(Seat.of(options.rules, opponent_of(options.opponent if opponent is None else opponent, options)))
    return kind(options.rules, n, limit=limit, seats=seats)
