"""Which tables does a reset begin anew, from where, and with which seeds? Checks the arguments of every
environment's ``reset``."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from .._check import choice, integer, refuse, refuse_what
from .._types import Bools, Floats, Ints
from ..game.balls import mask_of_present, points_available
from ..game.frame import MOST_BREAK
from ..game.frame_columns import BALL_ON, POINTS
from ..tasks.options import Options
from ..tasks.tables import Tables

ONE, MANY = (
    ("state", "position", "breaker"),
    ("reset_mask", "state", "states", "position", "positions", "breaker"),
)
STARTS = ("state", "states", "position", "positions")
"""Allowed keys of the reset options for one table and for many."""


def seeds_of(seed: Any, n: int) -> list[int | None]:
    """A seed or None for each of n tables, from the argument ``seed`` as in ``SyncVectorEnv.reset``."""
    if seed is None:
        return [None] * n
    if isinstance(seed, (int, np.integer)):
        return [int(seed) + k for k in range(n)]
    if len(seed) != n:
        raise refuse_what("seed", f"{len(seed)} seeds", f"must be an int, None, or {n} of them")
    return list(seed)


def mask_of(options: dict[str, Any], n: int) -> Bools:
    """The tables to reset: (n,) bool, all without "reset_mask"."""
    if "reset_mask" not in options:
        return np.ones(n, np.bool_)
    mask = options["reset_mask"]
    if not isinstance(mask, np.ndarray) or mask.shape != (n,) or mask.dtype != np.bool_ or not mask.any():
        raise refuse('options["reset_mask"]', mask, f"must be a bool array of shape ({n},), not all False")
    return mask.copy()


@dataclass(frozen=True)
class Start:
    """The start of an episode that is not dealt: a valid state of a table, or the arrays of a valid
    position."""

    state: Any = None
    """``states.State`` or ``states.FrameState``."""
    arrays: tuple[Floats, Bools, Ints] | None = None
    """``planning.Position.arrays``."""

    def take(self, tables: Tables, k: int) -> dict[str, Any] | None:
        """Put it on table k; returns the state of its NumPy generator, which every state has and no
        position."""
        if self.arrays is not None:
            tables.set_position(k, *self.arrays)
            return None
        tables.set_state(k, self.state)
        return self.state.rng


Check = Callable[[Any], Any]
"""Makes a valid state from a dict, or raises ValueError: ``tasks.tables.Tables.checked``."""


def given_of(options: Any, known: tuple[str, ...]) -> dict[str, Any]:
    """The options of a reset as a dict; ValueError unless each is ``known`` and at most one of them defines
    the start."""
    if options is None:
        return {}
    if not isinstance(options, dict):
        raise refuse("options", options, "must be None or a dict with " + " or ".join(map(repr, known)))
    for key in options:
        choice("options", key, known)
    _one_start(options)
    return options


def breakers_of(
    options: dict[str, Any], n: int, game: Options, *, two_players: bool = False
) -> dict[str, Ints]:
    """Who breaks on each of n tables instead of the draw, as the keyword ``breakers`` of ``Frames.reset``;
    empty without "breaker"."""
    if "breaker" not in options:
        return {}
    given, field = options["breaker"], 'options["breaker"]'
    for start in _starts(options):
        raise refuse(
            field, given, f'must be left out with "{start}": it says who breaks where balls are dealt'
        )
    if game.task == "visit" or (game.opponent == "none" and not two_players):
        raise refuse(field, given, "must be left out: there is no opponent, and nothing is drawn")
    if isinstance(given, list | tuple | np.ndarray) and np.ndim(given) > 0:
        if len(given) != n:
            raise refuse_what(field, f"{len(given)} numbers", f"must be 0, 1, or {n} of them")
        return {
            "breakers": np.array(
                [integer(f"{field}[{k}]", one, 0, 1) for k, one in enumerate(given)], np.int64
            )
        }
    return {"breakers": np.full(n, integer(field, given, 0, 1), np.int64)}


def _starts(options):
    """The keys that say where an episode starts that is not dealt."""
    return [key for key in STARTS if key in options]


def _one_start(options):
    if len(starts := _starts(options)) > 1:
        raise refuse("keys of options", starts, "must be only one of them: each says where to start")


def start_of(options: dict[str, Any], tables: Tables, check: Check) -> Start | None:
    """The validated start of one table; None to deal it."""
    _one_start(options)
    if "state" in options:
        return Start(state=check(options["state"]))
    if "position" in options:
        return Start(arrays=_position('options["position"]', options["position"], tables))
    return None


def starts_of(options: dict[str, Any], n: int, tables: Tables, check: Check) -> list[Start] | None:
    """The validated starts of n tables; None to deal them."""
    one = start_of(options, tables, check)
    if one is not None:
        return [one] * n
    if "states" in options:
        return [Start(state=check(state)) for state in _list_of("states", options, n)]
    if "positions" in options:
        positions = enumerate(_list_of("positions", options, n))
        return [
            Start(arrays=_position(f'options["positions"][{k}]', position, tables))
            for k, position in positions
        ]
    return None


def _list_of(key, options, n):
    given = options[key]
    if not isinstance(given, list | tuple) or len(given) != n:
        found = (
            f"{type(given).__name__} of {len(given)}"
            if isinstance(given, list | tuple)
            else type(given).__name__
        )
        raise refuse_what(f'options["{key}"]', found, f"must be a list of {n} {key}")
    return given


def _position(field, given, tables):
    """The arrays of a ``Position`` or of its ``to_dict()``, validated on the table that is played on;
    ``field``: its name in messages."""
    from ..planning import Position

    if isinstance(given, Position):
        given = given.to_dict()
    if not isinstance(given, Mapping):
        raise refuse(field, given, "must be a snooker_env.Position, or a dict as its to_dict() gives")
    names = list(Position.__dataclass_fields__)
    names.remove("table")
    for name in given:
        choice(f"keys of {field}", name, names)
    if given.get("over", False) is True:
        raise refuse(f"{field}.over", True, "must be False: the visit has ended, there is no stroke to play")
    try:
        arrays = Position.from_dict(given, table=tables.rules.table).arrays()
    except ValueError as error:
        raise ValueError(f"{field}.{error}") from None
    _, on_table, game = arrays
    more = points_available(mask_of_present(on_table), int(game[BALL_ON]))
    if game[POINTS] + more > MOST_BREAK:
        raise refuse(
            f"{field}.points",
            int(game[POINTS]),
            f"must be at most {MOST_BREAK - more}: the balls on the table offer {more} more",
        )
    return arrays
