"""How does any player of this project play as the opponent in frames? Seen from his own side, by his own action options, in one call.

A player is an object with ``options`` (how its actions are read) and ``act(tables, observations, going)``. ``tables`` are his own: a
``SnookerVectorEnv`` of visits that shows the strokes to come (``envs.at_frames``). So agents trained on visits and planning players can
play frames. A player whose attribute ``frames`` is True gets tables of frames.

* After a foul he plays on, unless his options hold ``decision``; he begins after a lot that he has won.
* Without ``placement`` in his options, a cue ball in hand stands where "ghost_ball" would put it. So it does for any player of visits where
  it may stand anywhere, and he sees it as a cue ball that is not in hand: the places that he knows are those of the D.
* With a free ball, a player of visits sees that any colour is on.
* What he strikes first after a red is the colour nominated, unless his own options hold ``nominate``.

A player with a method ``begin(seed)`` is called for each table by itself, after ``begin`` with a seed from that table's stream: his strokes
then depend on that table alone, and a saved state plays on exactly. Any other one is called once for all tables that wait.
"""

import copy
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import numpy as np

from .. import _entry_points
from .._check import choice, refuse, refuse_what
from .._jit import entry
from .._types import Floats, Ints
from ..game.balls import bits
from ..game.frame_columns import ANYWHERE, IN_HAND, strikeable
from ..game.philox import pair
from ..game.pots import POT_COLUMNS
from ..game.sides import as_visits
from ..physics.parameters import Physics
from .box_actions import Actions
from .discrete_actions import Choices
from .ghost_ball import put
from .lines import LINE_ROWS
from .stroke import ShotBuffers

if TYPE_CHECKING:
    from .frame import Frames

SEEDS = 1024
"""Seeds of ``begin`` are below this."""
_VISITS = ("action", "aim", "observation", "elevation", "placement", "decision")
_FRAMES = (*_VISITS, "nominate", "concede", "claim", "lot")
_ROW = np.zeros(1, np.int64)
_KINDS = (ValueError, TypeError, ImportError)


@entry(what="the places of the opponent's cue ball", seconds=2)
def put_in_hand(which, positions, on_table, game, streams, within_d):
    """Place the cue balls in hand on the tables ``which``; without ``within_d``, only those that may stand anywhere."""
    found = np.empty((LINE_ROWS, POT_COLUMNS))
    for j in range(which.shape[0]):
        k = which[j]
        if game[k, IN_HAND] and (within_d or game[k, ANYWHERE]):
            put(positions[k], on_table[k], strikeable(game[k], bits(on_table[k]) & ~1), game[k, ANYWHERE], found, streams[k])


@entry
def drawn(which, streams, out):
    """One uniform number in [0, 1) from the stream of each of the tables ``which``: out (len(which),)."""
    for j in range(which.shape[0]):
        out[j], _ = pair(streams[which[j]])


def is_player(thing: Any) -> bool:
    """Whether that is a player: with ``options``, a mapping, and ``act``."""
    return isinstance(getattr(thing, "options", None), Mapping) and callable(getattr(thing, "act", None))


class PlayerOpponent:
    """A player as the opponent.

    ``game``: the options of the frames that his own tables share. ``name``: what errors call him.

    Raises ValueError if his options are not those of a player.
    """

    def __init__(self, player: Any, physics: Physics, game: Mapping[str, Any], name: str | None = None):
        self.player: Any = player
        self.game: dict[str, Any] = dict(game)
        self.name: str = name or type(player).__name__
        self.frames: bool = getattr(player, "frames", False) is True
        options = dict(player.options)
        for key in options:
            choice(f"key of the options of opponent {self.name}", key, _FRAMES if self.frames else _VISITS)
        if options.get("observation", "flat") != "flat":
            raise refuse(f"observation of opponent {self.name}", options["observation"], 'must be "flat": players get flat observations')
        said = {key: options[key] for key in ("nominate", "concede", "claim", "lot") if self.frames and key in options}
        if choice("action", options.get("action", "box"), ("box", "discrete")) == "discrete":
            self.actions: Actions | Choices = Choices(physics, **said)
        else:
            elevation, placement, decision = (options.get(key, False) for key in ("elevation", "placement", "decision"))
            self.actions = Actions(options.get("aim", "absolute"), elevation, placement, physics, decision, **said)
        self._seats: Any = WeakKeyDictionary()

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"_seats": None}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state, _seats=WeakKeyDictionary())

    def ask(self, frames: "Frames", which: Ints, generators: Sequence[np.random.Generator]) -> Floats:
        """His actions on the tables ``which``: (n, k). Raises ValueError, naming him, for invalid ones."""
        if not (self.actions.placement and self.frames):
            put_in_hand(which, frames.positions, frames.on_table, frames.game, frames.streams, not self.actions.placement)
        alone = callable(getattr(self.player, "begin", None))
        seat = self._seats.get(frames)
        if seat is None:
            n = 1 if alone else frames.n
            seat = self._seats[frames] = _entry_points.load(_entry_points.SEAT)(self.player, n, self.game)
        actions = np.zeros((frames.n, self.actions.size))
        if not alone:
            seat.show(frames, which, side=1)
            going = np.zeros(frames.n, np.bool_)
            going[which] = True
            actions[which] = self._checked(self._raising(seat.act, self.player, going), which, frames.n)
            return actions
        numbers = np.empty(len(which))
        drawn(which, frames.streams, numbers)
        for j, k in enumerate(which.tolist()):
            self._raising(self.player.begin, int(SEEDS * numbers[j]))
            seat.show(frames, which[j : j + 1], _ROW, side=1)
            actions[k] = self._checked(self._raising(seat.act, self.player, np.ones(1, np.bool_)), _ROW, 1)
        return actions

    def _raising(self, call, *args):
        """What the player's own code returns. An error that it raises names him, and is of the same kind where callers tell kinds apart."""
        try:
            return call(*args)
        except Exception as error:
            kind = next((kind for kind in _KINDS if isinstance(error, kind)), RuntimeError)
            raise kind(f"opponent {self.name} raised {type(error).__name__}: {error}") from error

    def _checked(self, answer, which, n):
        """The valid actions of the tables ``which`` among n answers."""
        try:
            answers = np.asarray(answer)
            if answers.ndim == 0 or len(answers) != n:
                raise refuse_what("actions", f"array of shape {answers.shape}", f"must be {n}, one for each table")
            return self.actions.check_many(answers[which], len(which))
        except ValueError as error:
            raise ValueError(f"opponent {self.name}: {error}") from None

    def prepare(self, frames: "Frames", which: Ints, actions: Floats, buffers: ShotBuffers) -> Ints:
        """Carry his strokes out up to the strike; returns the tables with a stroke."""
        own = copy.copy(frames)  # the same tables, and his actions
        own.rules = replace(frames.rules, actions=self.actions)
        own.packed = (self.actions.pack(), *frames.packed[1:])
        if self.frames:
            return own.prepare(which, actions, buffers)
        which = own.say(which, actions)  # before the free ball is hidden from him: it is void for an offender who plays again
        before = frames.game[which]
        frames.game[which] = as_visits(before)
        try:
            own.address(which, actions, buffers)
        finally:
            frames.game[which] = before
        own.hold_late(which, buffers)
        return which
