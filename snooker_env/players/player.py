"""What is a player? A function of positions and a seed, bound once (``at``), then asked (``play``); it keeps nothing."""

import copy
from typing import Any, Protocol, runtime_checkable

import numpy as np

from .._lib.check import refuse
from .._lib.types import Bools, Floats, Integers, Ints
from ..game.frame_columns import PLACE_ANYWHERE, PLAY
from ..planning.ghost_ball import put_in_hand
from ..planning.planner import RulesLike, options_in
from ..planning.positions import Positions, PositionsLike, seeds_of
from ..planning.pot_geometry import prospects_of
from ..planning.search import Ranked
from ..planning.strokes import Strokes
from ..planning.worth import apply_decision, decide
from ..tasks.options import Options

__all__ = ["FRAMES", "VISITS", "BoundPlayer", "Player", "Ranked", "Strokes", "ask_player", "decision_seeds"]


@runtime_checkable
class Player(Protocol):
    """A player: a function of positions and a seed.

    It may also have ``rank(positions, seeds)``, a ``Ranked`` for each position, with the stroke that ``play`` returns first:
    advice shows it. A player whose ``frames`` is False knows only visits and is not asked for advice in frames.

    Examples
    --------
    >>> import snooker_env as sn
    >>> player = sn.player("ghost_ball").at({"noise": "club"})
    >>> player.play(sn.Position(cue=(0.0, 0.9), black=(0.4, 1.3)), [7]).values.shape
    (1, 5)
    """

    def at(self, rules: RulesLike) -> "Player":
        """Return a new player bound to physics, table, fidelity, noise and, for frames, the game.

        Strokes do not depend on how actions are read. ValueError if the player cannot play under the options."""
        ...

    def play(self, positions: PositionsLike, seeds: Integers) -> Strokes:
        """Return what the player does in n positions, of visits or of frames as the striker sees them.

        ``seeds``, int (n,): equal positions and seeds give equal strokes, however many are asked for at once."""
        ...


class BoundPlayer:
    """Base class of players: ``at`` binds a copy to options, for which subclasses have ``_bind``.

    Examples
    --------
    >>> from snooker_env.players import BoundPlayer
    >>> BoundPlayer().at({"noise": "club"}).options.noise
    'club'
    """

    name: str = ""
    training_shots: int | None = None  # all simulated shots of its training; None: not known
    frames: bool = True  # whether it knows frames; False: it plays their strokes as those of visits
    _options: Options | None = None

    def at(self, rules: RulesLike) -> Any:
        """Return a copy of this player bound to where it plays, see ``Player.at``."""
        bound = copy.copy(self)
        bound._options = options_in(rules)
        bound._bind(bound._options)
        return bound

    def _bind(self, options: Options) -> None:
        """What a player makes once for where it plays."""

    def worth(self, at: Positions) -> Floats:
        """Return what positions of frames are worth to their strikers, for decisions after fouls: float64 (n,). By default
        the likeliest pot decides."""
        rules, (visits, _) = self.options.rules, place_cue_balls(at, np.zeros(len(at), np.int64))
        spread = rules.noise.spread(rules.physics)
        return 2.0 * prospects_of(visits, spread, most=_POTS, rails=rules.rails)[1].max(axis=1) - 1.0

    def start_playing(self, positions: PositionsLike, seeds: Integers) -> tuple[Positions, Floats, Ints]:
        """Return n positions as visits after the player's decisions (n,), by ``worth``, with cue balls placed at places (n, 2),
        else NaN."""
        at, code = Positions.of(positions), self.options.rules.rule_set.code
        decisions, rows = np.full(len(at), PLAY), np.flatnonzero(at.choice)
        if len(rows):
            decisions[rows] = decide(self.worth, at[rows].known_to(self.options.rules), code)[0]
            anywhere = rows[decisions[rows] == PLACE_ANYWHERE]
            at = at.copy()
            at.game[anywhere] = apply_decision(at[anywhere], PLACE_ANYWHERE).game
        return *place_cue_balls(at, seeds), decisions

    @property
    def options(self) -> Options:
        """Where the player plays; ValueError before ``at``."""
        if self._options is None:
            raise refuse("player", self.name, "must be bound first: player.at(options)")
        return self._options


_POTS = 16  # the most direct pots of a position that are looked at, the widest first


def streams_of(seeds: Integers) -> np.ndarray:
    """A random stream for each seed: uint64 (n, 2)."""
    streams = np.zeros((len(seeds), 2), np.uint64)
    streams[:, 0] = seeds
    return streams


def place_cue_balls(at: Positions, seeds: Integers) -> tuple[Positions, np.ndarray]:
    """Visits with cue balls in hand put where ``ghost_ball`` does, and these places (n, 2), else NaN."""
    places, keys = np.full((len(at), 2), np.nan), seeds_of(seeds, len(at))
    if not at.in_hand.any():
        return at.as_visits(), places
    moved = at.copy()
    put_in_hand(moved.positions, moved.on_table, moved.game, streams_of(keys))
    hand = at.in_hand
    places[hand] = moved.positions[hand, 0]
    return moved.as_visits(), places


VISITS: dict[str, Any] = {"aim": "absolute", "elevation": True, "placement": True}
"""The options with which an environment of visits reads all that a player does."""
FRAMES: dict[str, Any] = VISITS | {"says": ("decision",)}
"""Those of frames and matches, where nobody concedes and the colour first struck is the one nominated."""
_ODD = np.uint64(0x9E3779B97F4A7C15)


def decision_seeds(seed: int, tables: Ints, decision: int | Ints) -> Ints:
    """Return a seed for each table and decision, the same whichever tables are asked beside it.

    Parameters
    ----------
    seed, tables, decision
        The player's seed, an int; a number for each table, int (n,); that of the decision, one for all tables or for each.

    Returns
    -------
    numpy.ndarray
        int64 (n,), in [0, 2**32).

    Examples
    --------
    >>> from snooker_env.players import decision_seeds
    >>> bool(decision_seeds(0, [5, 6], 3)[1] == decision_seeds(0, [6], 3)[0])
    True
    """
    state = np.uint64(seed & 0xFFFFFFFFFFFFFFFF) + np.zeros(len(tables), np.uint64)
    for part in (np.asarray(tables), np.broadcast_to(np.asarray(decision), len(tables))):
        x = state + _ODD * (part.astype(np.uint64) + np.uint64(1))  # splitmix64 (Steele, Lea & Flood 2014)
        x = (x ^ (x >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        x = (x ^ (x >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        state = x ^ (x >> np.uint64(31))
    return (state >> np.uint64(32)).astype(np.int64)


def ask_player(player: Player, tables: Any, going: Bools, seeds: Ints) -> Floats:
    """Ask a bound player on tables.

    Parameters
    ----------
    player, tables, going, seeds
        The player; n tables, made with ``VISITS`` or ``FRAMES``; on which it is asked, bool (n,); seeds, int64 (n,).

    Returns
    -------
    numpy.ndarray
        float64 (n, k). Actions; 0 on the other tables.

    Examples
    --------
    >>> import numpy as np
    >>> import snooker_env as sn
    >>> from snooker_env.players import VISITS, ask_player
    >>> tables = sn.SnookerVectorEnv(2, **VISITS)
    >>> _ = tables.reset(seed=0)
    >>> ask_player(sn.player("ghost_ball").at(tables), tables, np.array([True, False]), np.array([1, 2])).shape
    (2, 7)
    """
    rows = np.flatnonzero(going)
    actions = np.zeros((len(going), tables.options.rules.actions.size))
    if len(rows):
        at = Positions.of(tables)[rows]
        actions[rows] = player.play(at, seeds[rows]).actions(tables.options, at)
    return actions
