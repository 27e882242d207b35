"""How does a player sit opposite the agent of a frame? Asked once for all tables that wait."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .._check import refuse_what
from .._types import Ints
from ..game.frame_columns import Layouts
from ..game.sides import strikers_own
from ..planning import Positions
from ..tasks.carry_out import carry_out
from ..tasks.frame import Frames, Opponent
from ..tasks.opponents import SIDE, drawn
from ..tasks.options import Options
from ..tasks.stroke import ShotBuffers
from .model_options import of_others
from .player import Player, Strokes
from .resolver import player as player_of
from .saved import FittingModel, SavedNetwork
from .seen import SeenPlayer

_KINDS = (ValueError, TypeError, ImportError)


class PlayerOpponent(Opponent):
    """A bound player as opponent: asked once for all that wait, with a seed of each table's own stream."""

    def __init__(self, player: Player, name: str):
        self.player, self.name = player, name

    def ask(self, frames: Frames, which: Ints, generators: Sequence[np.random.Generator]) -> tuple[Any, ...]:
        """The arrays of its ``Strokes``, with a row for each table of ``frames``."""
        numbers = np.empty(len(which))
        drawn(which, frames.streams, numbers)
        saved = Layouts(frames.saved.positions[which], frames.saved.on_table[which])
        game = strikers_own(frames.game[which])
        own = frames.conditions[which] if frames.rules.drawn else None
        at = Positions(frames.positions[which], frames.on_table[which], game, saved, own)
        try:
            strokes = self.player.play(at, (numbers * 2**32).astype(np.int64))
        # of the player's own code: it is named, and the kind kept where callers tell kinds apart
        except Exception as error:
            kind = next((kind for kind in _KINDS if isinstance(error, kind)), RuntimeError)
            raise kind(f"opponent {self.name} raised {type(error).__name__}: {error}") from error
        if not isinstance(strokes, Strokes) or len(strokes) != len(which):
            many = len(strokes) if isinstance(strokes, Strokes) else "a"
            allowed = f"must be {len(which)} Strokes, one for each position"
            raise refuse_what(f"opponent {self.name}: play(...)", f"{many} {type(strokes).__name__}", allowed)
        out = []
        for part in strokes.parts:
            out.append(np.zeros((frames.n, *part.shape[1:]), part.dtype))
            out[-1][which] = part
        return tuple(out)

    def prepare(self, frames: Frames, which: Ints, asked: tuple[Any, ...], buffers: ShotBuffers) -> Ints:
        """Carry its strokes out up to the strike; returns the tables with a stroke."""
        return carry_out(frames, which, asked, buffers, SIDE)


def seated(player: Any, options: Options) -> PlayerOpponent:
    """The opponent that a player, or its name, is in frames with these options."""
    one = _named(player, options) if isinstance(player, str) else player_of(player)
    name = player if isinstance(player, str) else getattr(one, "name", "") or type(one).__name__
    return PlayerOpponent(one.at(options), name)


def _named(name: str, options: Options) -> Player:
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
    full = plain | dict.fromkeys(options.says, True)
    try:
        model = FittingModel.of(path, full, "opponent")
    except ValueError:
        if full == plain or "nominate" in options.says:  # a nomination cannot be left out
            raise
        model = FittingModel.of(path, plain, "opponent")
    return SeenPlayer(SavedNetwork(model, options.trust), name=path)
