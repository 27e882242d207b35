"""What is a player? A function of positions and a seed, bound once (``at``), then asked (``play``).

It keeps nothing between two calls: the same position and seed give the same stroke, whether asked for one
table or a thousand."""

import copy
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol, TypeAlias, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from .._check import refuse, refuse_what
from .._types import Bools, Environment, Floats, Integers, Ints
from ..game.balls import YELLOW
from ..game.frame_columns import BALL_ON, PLACE_ANYWHERE, PLAY, PLAY_AGAIN, REPLACE
from ..game.ruling import AUTO
from ..geometry import BAULK_Y, D_RADIUS, HALF_LENGTH, HALF_WIDTH
from ..planning.ghost_ball import put_in_hand
from ..planning.planner import options_in
from ..planning.positions import Positions, PositionsLike, seeds_of
from ..planning.prospects import prospects_of, spread_of
from ..planning.strokes import AIM, ELEVATION, NAMES, SIDE, SPEED, TOP
from ..planning.worth import chosen, decide
from ..tasks.box_actions import MAX_SPEED, MIN_SPEED, STEEPEST, Actions
from ..tasks.declarations import CLAIMS, COLOURS, CONCEDES, OTHER_BEGINS, SAYS_NOTHING
from ..tasks.options import Options

RulesLike: TypeAlias = Environment | Options | Mapping[str, Any]  # a dict: fields of ``Options``
CODES: dict[str, tuple[int, ...]] = {
    "nominate": (AUTO, 0, *range(YELLOW, YELLOW + COLOURS)),
    "decision": (PLAY, PLAY_AGAIN, REPLACE, PLACE_ANYWHERE),
    "declare": (SAYS_NOTHING, CONCEDES, CLAIMS, OTHER_BEGINS),
}  # the codes of what is said with a stroke


@dataclass(frozen=True)
class Strokes:
    """What players do in n positions: a stroke each, and what is said with it.

    Parameters
    ----------
    values : numpy.ndarray
        float64 (n, 5). Cue speed [m/s], side and top (tip offsets over R), direction in which the cue ball
        leaves the tip [rad, anticlockwise from +x; squirt is compensated, what the cloth does to the ball of
        a raised cue is not], elevation of the cue [rad].
    place : numpy.ndarray, optional
        float64 (n, 2). Where a cue ball in hand is placed [m]; NaN (default): it is played from where it
        lies.
    nominate : numpy.ndarray, optional
        int64 (n,). Id of the colour nominated after a red or as a free ball; 0: the free ball is declined; -1
        (default): the colour first struck.
    decision, declare : numpy.ndarray, optional
        int64 (n,). After a foul of the opponent: PLAY (default), PLAY_AGAIN, REPLACE or PLACE_ANYWHERE of
        ``game.frame_columns``; SAYS_NOTHING (default), CONCEDES, CLAIMS or OTHER_BEGINS of
        ``tasks.declarations``.

    Examples
    --------
    >>> import numpy as np
    >>> from snooker_env.players import Strokes
    >>> strokes = Strokes(np.array([[2.0, 0.0, 0.2, 1.5, 0.0]]))
    >>> len(strokes), strokes.speed.tolist(), bool(np.isnan(strokes.place).all())
    (1, [2.0], True)
    """

    values: Floats
    place: Floats = None  # type: ignore[assignment]
    nominate: Ints = None  # type: ignore[assignment]
    decision: Ints = None  # type: ignore[assignment]
    declare: Ints = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        values = np.asarray(self.values, np.float64)
        if values.ndim != 2 or values.shape[1] != 5:
            allowed = "must be (n, 5): speed, side, top, aim, elevation"
            raise refuse_what("values", f"array of shape {values.shape}", allowed)
        n = len(values)
        most = np.array([MAX_SPEED, 0.5, 0.5, np.inf, STEEPEST]) + 1e-9
        least = np.array([MIN_SPEED, -0.5, -0.5, -np.inf, 0.0]) - 1e-9
        fine = np.isfinite(values) & (values >= least) & (values <= most)
        if not fine.all():
            k, c = np.argwhere(~fine)[0].tolist()
            allowed = f"must be finite and in [{least[c]:.3g}, {most[c]:.3g}]"
            raise refuse(f"{NAMES[c]}[{k}]", float(values[k, c]), allowed)
        usual: dict[str, Any] = {
            "place": np.full((n, 2), np.nan),
            "nominate": np.full(n, AUTO, np.int64),
            "decision": np.full(n, PLAY, np.int64),
            "declare": np.full(n, SAYS_NOTHING, np.int64),
        }
        object.__setattr__(self, "values", values)
        for name, default in usual.items():
            array = default if getattr(self, name) is None else np.asarray(getattr(self, name))
            if array.shape != default.shape:
                raise refuse_what(name, f"array of shape {array.shape}", f"must have shape {default.shape}")
            for code in set(array.tolist()).difference(CODES[name]) if name in CODES else ():
                k = array.tolist().index(code)
                raise refuse(f"{name}[{k}]", code, f"must be one of {CODES[name]}")
            object.__setattr__(self, name, array.astype(default.dtype))
        sound = np.isnan(self.place).all(1) | (np.abs(self.place) <= (HALF_WIDTH, HALF_LENGTH)).all(1)
        if not sound.all():
            k, allowed = int(np.argmin(sound)), "must be on the table, or NaN and NaN for none"
            raise refuse(f"place[{k}]", self.place[k].tolist(), allowed)

    def __len__(self) -> int:
        return len(self.values)

    def __getitem__(self, rows: Any) -> "Strokes":
        """Some of the strokes: ``rows`` is a slice, a mask or an array of rows."""
        return Strokes(*(part[rows] for part in self.parts))

    @classmethod
    def join(cls, parts: "Sequence[Strokes]") -> "Strokes":
        """Join several ``Strokes`` in their order."""
        return cls(*map(np.concatenate, zip(*(one.parts for one in parts), strict=True)))

    @property
    def parts(self) -> tuple[NDArray[Any], ...]:
        """The arrays, in the order of the fields."""
        return self.values, self.place, self.nominate, self.decision, self.declare

    @property
    def speed(self) -> Floats:
        """Cue speeds [m/s], float64 (n,)."""
        return self.values[:, SPEED]

    @property
    def side(self) -> Floats:
        """Tip offsets to the right over R, float64 (n,)."""
        return self.values[:, SIDE]

    @property
    def top(self) -> Floats:
        """Tip offsets upwards over R, float64 (n,)."""
        return self.values[:, TOP]

    @property
    def aim(self) -> Floats:
        """Directions in which the cue ball leaves [rad], float64 (n,)."""
        return self.values[:, AIM]

    @property
    def elevation(self) -> Floats:
        """Elevations of the cue [rad], float64 (n,)."""
        return self.values[:, ELEVATION]

    def actions(self, options: Options, at: Positions) -> Floats:
        """Convert to actions of an environment, with all that is said: float64 (n, k) in [-1, 1].

        ``options``: of the environment, with ``action="box"`` and ``aim="absolute"``. ``at``: the n
        positions, on which the meaning of a place and a nomination depends. ValueError if the environment
        reads other actions, or a raised cue, a decision or a declaration that they do not hold; a place and a
        nomination that they do not hold are left out."""
        box = options.rules.actions
        if not isinstance(box, Actions) or box.aim != "absolute":
            what = f"action={options.action!r}, aim={options.aim!r}"
            raise refuse_what("options", what, 'must be "box" and "absolute": strokes are continuous')
        turns = self.aim / np.pi
        parts = [
            2.0 * (self.speed - MIN_SPEED) / (MAX_SPEED - MIN_SPEED) - 1.0,
            2.0 * self.side,
            2.0 * self.top,
            turns - 2.0 * np.round(0.5 * turns),
        ]
        for name, holds, least in (
            ("elevation", box.elevation, 0.0),
            ("decision", box.decision, PLAY),
            ("declare", box.declares, SAYS_NOTHING),
        ):
            if not holds and ((part := getattr(self, name)) > least).any():
                raise refuse(name, part.max().item(), "must be left out: the actions do not hold it")
        if box.elevation:
            if (steep := self.elevation.max(initial=0.0)) > box.steepest + 1e-9:
                allowed = f"must be at most {box.steepest:.3g} rad, as the option elevation says"
                raise refuse("elevation", float(steep), allowed)
            parts.append(2.0 * self.elevation / box.steepest - 1.0)
        if box.placement:
            parts += self._placed(at)
        if box.nominate:
            parts.append(self._nominated(at))
        if box.decision:
            again = np.where(self.decision == PLAY_AGAIN, -1.0, 1.0)
            parts.append(np.where(self.decision == PLAY, 0.0, again))
        if box.declares:
            says = np.where(self.declare == CLAIMS, 1.0, -1.0)
            parts.append(np.where(self.declare == SAYS_NOTHING, 0.0, says))
        return np.clip(np.stack(parts, axis=1), -1.0, 1.0)  # removes rounding errors

    def _placed(self, at: Positions) -> list[Floats]:
        """The two components of the place."""
        x, y = np.where(np.isnan(self.place), at.positions[:, 0], self.place).T
        across = np.clip(x / D_RADIUS, -1.0, 1.0)
        depth = D_RADIUS * np.sqrt(1.0 - across * across)
        back = np.clip((BAULK_Y - y) / np.maximum(depth, 1e-9), 0.0, 1.0)
        return list(np.where(at.anywhere, (x / HALF_WIDTH, y / HALF_LENGTH), (across, 2.0 * back - 1.0)))

    def _nominated(self, at: Positions) -> Floats:
        """The component of the nomination: sixths of the range after a red, sevenths with a free ball."""
        n = np.maximum(self.nominate - YELLOW + 1, 0)  # 0 none, 1 to 6 yellow to black
        after_red = at.game[:, BALL_ON] == 0
        return np.where(after_red, (np.maximum(n, 1) - 0.5) / COLOURS, (n + 0.5) / (1 + COLOURS)) * 2.0 - 1.0


class Ranked(NamedTuple):
    """The strokes that a player considers in one position, best first.

    Attributes
    ----------
    strokes, scores
        m ``Strokes``, and the player's own scores, float64 (m,), or None if it has none.

    Examples
    --------
    >>> import snooker_env as sn
    >>> (one,) = sn.player("search_30").at({}).rank(sn.Position(cue=(0.0, 0.9), black=(0.4, 1.3)), [7])
    >>> len(one.strokes) == len(one.scores)
    True
    """

    strokes: Strokes
    scores: Floats | None


@runtime_checkable
class Player(Protocol):
    """A player: a function of positions and a seed.

    It may also have ``rank(positions, seeds)``, which returns a ``Ranked`` for each position, first of all
    the stroke that ``play`` returns. Advice shows it. One whose ``frames`` is False knows visits alone, and is not
    asked for advice in frames.

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
        """Return what it does in n positions, of visits or of frames as the striker sees them.

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
        """What positions of frames are worth to their strikers, for decisions after fouls: float64 (n,).

        Here by the likeliest pot: who pots more often than not gains by having the next stroke."""
        rules, (visits, _) = self.options.rules, placed(at, np.zeros(len(at), np.int64))
        spread = spread_of(rules.noise, rules.physics)
        return 2.0 * prospects_of(visits, spread, most=_POTS, rails=rules.rails)[1].max(axis=1) - 1.0

    def started(self, positions: Any, seeds: Any) -> tuple[Positions, Floats, Ints]:
        """From where it plays in n positions: visits after its decisions, with placed cue balls; their places (n, 2), else
        NaN; and the decisions (n,), the best by ``worth``."""
        at, code = Positions.of(positions), self.options.rules.rule_set.code
        decisions, rows = np.full(len(at), PLAY), np.flatnonzero(at.choice)
        if len(rows):
            decisions[rows] = decide(self.worth, at[rows].known_to(self.options.rules), code)[0]
            anywhere = rows[decisions[rows] == PLACE_ANYWHERE]
            at = at.copy()
            at.game[anywhere] = chosen(at[anywhere], PLACE_ANYWHERE).game
        return *placed(at, seeds), decisions

    @property
    def options(self) -> Options:
        """Where the player plays; ValueError before ``at``."""
        if self._options is None:
            raise refuse("player", self.name, "must be bound first: player.at(options)")
        return self._options


_POTS = 16  # the most direct pots of a position that are looked at, the widest first


def streams_of(seeds: Any) -> np.ndarray:
    """A random stream for each seed: uint64 (n, 2)."""
    streams = np.zeros((len(seeds), 2), np.uint64)
    streams[:, 0] = seeds
    return streams


def placed(at: Positions, seeds: Any) -> tuple[Positions, np.ndarray]:
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
FRAMES: dict[str, Any] = VISITS | {"decision": True}
"""Those of frames and matches, where nobody concedes and the colour first struck is the one nominated."""
_ODD = np.uint64(0x9E3779B97F4A7C15)


def decision_seeds(seed: int, tables: Ints, decision: int | Ints) -> Ints:
    """Return a seed for each table and decision, the same whichever tables are asked beside it.

    Parameters
    ----------
    seed, tables, decision
        The player's, an int; a number for each table, int (n,), such as the seed that it was dealt from; the
        number of the decision, of all tables or of each.

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


def decided(player: Player, tables: Any, going: Bools, seeds: Ints) -> Floats:
    """Ask a bound player on tables.

    Parameters
    ----------
    player, tables
        The player, bound, and n tables, made with ``VISITS`` or ``FRAMES``.
    going, seeds : numpy.ndarray
        The tables on which it is asked, bool (n,), and the seeds of these decisions, int64 (n,).

    Returns
    -------
    numpy.ndarray
        float64 (n, k). Actions; 0 on the other tables.

    Examples
    --------
    >>> import numpy as np
    >>> import snooker_env as sn
    >>> from snooker_env.players import VISITS, decided
    >>> tables = sn.SnookerVectorEnv(2, **VISITS)
    >>> _ = tables.reset(seed=0)
    >>> decided(sn.player("ghost_ball").at(tables), tables, np.array([True, False]), np.array([1, 2])).shape
    (2, 7)
    """
    rows = np.flatnonzero(going)
    actions = np.zeros((len(going), tables.options.rules.actions.size))
    if len(rows):
        at = Positions.of(tables)[rows]
        actions[rows] = player.play(at, seeds[rows]).actions(tables.options, at)
    return actions
