"""How are the arguments of an environment read? Its options, as tables with players; those of a reset."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias, cast

import numpy as np

from .._lib.check import choice, integer, refuse, refuse_what
from .._lib.types import Bools, Floats, Ints
from ..game.balls import mask_of_present, points_available
from ..game.frame import MOST_BREAK
from ..game.frame_columns import BALL_ON, POINTS
from ..tasks.frames import TABLES, Frames, Seat
from ..tasks.options import NEVER, OBJECT, Options, options_of
from ..tasks.states import FrameState, State
from ..tasks.tables import Tables

STARTS = ("state", "states", "position", "positions")  # reset options that say where an episode starts
ONE = ("state", "position", "breaker")
MANY = ("reset_mask", *STARTS, "breaker")  # keys of the reset options of one table and of many
Start: TypeAlias = State | FrameState | tuple[Floats, Bools, Ints]
"""The start of an episode that is not dealt: a valid state, or the arrays of a valid position."""


def game_of(options: Options | None, keywords: Mapping[str, Any]) -> tuple[Options, Any]:
    """The ``Options`` of an environment, and the opponent that was passed as an object, else None."""
    opponent = keywords.get("opponent")
    if opponent is None or isinstance(opponent, str | Path):
        return options_of(options, keywords), None
    rest = {name: value for name, value in keywords.items() if name != "opponent"}
    if options is None:
        return options_of(None, rest | {"opponent": OBJECT}), opponent
    return options_of(options, rest).but(opponent=OBJECT), opponent


def match_options(options: Options | None, keywords: Mapping[str, Any]) -> Options:
    """``Options`` for two players: box actions hold placement and decision; with ``frames`` it is a match."""
    if options is None:
        box = keywords.get("action", "box") == "box"
        task = "match" if "frames" in keywords else "frame"
        keywords = {"task": task, "placement": box, "says": ("decision",) * box, **keywords}
    options = options_of(options, keywords)
    if options.task == "visit" or options.opponent != "none" or options.trust or options.one_stroke:
        names = "task", "opponent", "trust", "one_stroke"
        what = ", ".join(f"{name}={getattr(options, name)!r}" for name in names)
        allowed = 'must be task="frame" or "match", opponent="none", trust=False and one_stroke=False'
        raise refuse_what("options", what, f"{allowed}: a match has two players")
    return options


def match_tables(options: Options, differences: Any, n: int) -> Frames:
    """n tables of two players; ``differences``: None, or what differs for each, two dicts."""
    seats, made = [Seat.of(options.rules)] * 2, cast(type[Frames], TABLES[options.task])
    if differences is None:
        return made(options.rules, n, seats=seats)
    pair = isinstance(differences, list | tuple) and len(differences) == 2
    if not pair or not all(isinstance(one, Mapping) for one in differences):
        raise refuse("seats", differences, "must be None, or two dicts of options, one for each player")
    allowed = (*Options.group("action"), "noise")
    for k, changes in enumerate(differences):
        for name in changes:
            choice(f"key of seats[{k}]", name, allowed)
        box_only: dict[str, Any] = {}
        if changes.get("action", "box") != "box":
            menu = changes["action"] == "strokes"  # it says nothing beside its choices
            says = tuple(name for name in options.says if name != "decision" and not menu)
            box_only = {"elevation": False, "placement": False, "says": says}
        try:
            seats[k] = Seat.of(options.but(**box_only | dict(changes)).rules)
        except ValueError as error:
            raise ValueError(f"seats[{k}].{error}") from None
    return made(options.rules, n, seats=seats)


def tables_of(options: Options, opponent: Any, n: int, limit: int = NEVER) -> Tables:
    """n tables of a game; ``opponent``: who was passed as an object, or None."""
    kind: Any = TABLES[options.task]
    if options.task == "visit":
        return kind(options.rules, n, limit=limit)
    if options.opponent == OBJECT and opponent is None:
        words = "must come with the object: pass it as opponent=... beside the options"
        raise refuse("opponent", OBJECT, words)
    seats = [Seat.of(options.rules)]
    if options.opponent != "none":
        from ..players.opponents import opponent_of  # planning is loaded where there is an opponent

        player = opponent_of(options.opponent if opponent is None else opponent, options)
        seats.append(Seat.of(options.rules, player))
    return kind(options.rules, n, limit=limit, seats=seats)


def seeds_of(seed: object, n: int) -> list[int | None]:
    """A seed or None for each of n tables, from the argument ``seed`` as in ``SyncVectorEnv.reset``."""
    if seed is None:
        return [None] * n
    if isinstance(seed, (int, np.integer)):
        return [int(seed) + k for k in range(n)]
    allowed = f"must be an int, None, or {n} of them"
    if not isinstance(seed, (list, tuple, np.ndarray)):
        raise refuse("seed", seed, allowed)
    if len(seed) != n:
        raise refuse_what("seed", f"{len(seed)} seeds", allowed)
    return list(seed)


def mask_of(options: dict[str, Any], n: int) -> Bools:
    """The tables to reset: (n,) bool, all without "reset_mask"."""
    if "reset_mask" not in options:
        return np.ones(n, np.bool_)
    mask = options["reset_mask"]
    if not isinstance(mask, np.ndarray) or mask.shape != (n,) or mask.dtype != np.bool_ or not mask.any():
        raise refuse('options["reset_mask"]', mask, f"must be a bool array of shape ({n},), not all False")
    return mask.copy()


def known_options(options: object, known: tuple[str, ...]) -> dict[str, Any]:
    """The options of a reset as a dict; ValueError unless each is ``known``."""
    if options is None:
        return {}
    if not isinstance(options, dict):
        raise refuse("options", options, "must be None or a dict with " + " or ".join(map(repr, known)))
    for key in options:
        choice("options", key, known)
    return options


def breakers_of(options: dict[str, Any], tables: Tables) -> dict[str, Ints]:
    """Who breaks instead of the draw: ``breakers`` of ``Frames.reset``; empty without "breaker"."""
    if "breaker" not in options:
        return {}
    breaker, field, n = options["breaker"], 'options["breaker"]', tables.n
    for start in (key for key in STARTS if key in options):
        words = f'must be left out with "{start}": it says who breaks where balls are dealt'
        raise refuse(field, breaker, words)
    if not isinstance(tables, Frames) or len(tables.seats) == 1:
        raise refuse(field, breaker, "must be left out: there is no opponent, and nothing is drawn")
    if isinstance(breaker, list | tuple | np.ndarray) and np.ndim(breaker) > 0:
        if len(breaker) != n:
            raise refuse_what(field, f"{len(breaker)} numbers", f"must be 0, 1, or {n} of them")
        each = [integer(f"{field}[{k}]", one, 0, 1) for k, one in enumerate(breaker)]
        return {"breakers": np.array(each, np.int64)}
    return {"breakers": np.full(n, integer(field, breaker, 0, 1), np.int64)}


def begin_at(
    start: Start | None, tables: Tables, k: int, rng: np.random.Generator, *, seeded: bool, keyed: bool
) -> bool:
    """Begin on table k with ``start``, if not None, and its stream, or a key from ``rng`` -> whether ``rng`` took a state."""
    if isinstance(start, State | FrameState):
        tables.set_state(k, start)
        if not seeded:
            rng.bit_generator.state = start.rng
            return True
    elif start is not None:
        tables.set_position(k, *start)
    if seeded or not keyed:
        tables.seed(k, rng)
    if type(start) is tuple:  # a position, on a table that is drawn
        tables.draw_conditions(np.array([k]))
    return False


def starts_of(
    options: dict[str, Any], tables: Tables, generator: np.random.Generator, *, to_play: bool = True
) -> Sequence[Start] | None:
    """The validated start of each table; None to deal them."""
    keys = [key for key in STARTS if key in options]
    if not keys:
        return None
    if len(keys) > 1:
        raise refuse("keys of options", keys, "must be only one of them: each says where to start")
    (key,), n = keys, tables.n
    value, field = options[key], f'options["{key}"]'
    if key == "state":
        return [tables.check_state(value, generator, to_play=to_play)] * n
    if key == "position":
        return [_position(field, value, tables)] * n
    if not isinstance(value, list | tuple) or len(value) != n:
        length = f" of {len(value)}" if isinstance(value, list | tuple) else ""
        raise refuse_what(field, f"{type(value).__name__}{length}", f"must be a list of {n} {key}")
    if key == "states":
        return [tables.check_state(state, generator, to_play=to_play) for state in value]
    return [_position(f"{field}[{k}]", one, tables) for k, one in enumerate(value)]


def _position(field, position, tables):
    """The arrays of a ``Position`` or its ``to_dict()``, validated; ``field``: its name in errors."""
    from ..planning import Position

    if isinstance(position, Position):
        position = position.to_dict()
    if not isinstance(position, Mapping):
        raise refuse(field, position, "must be a snooker_env.Position, or a dict as its to_dict() gives")
    names = list(Position.__dataclass_fields__)
    names.remove("table")
    for name in position:
        choice(f"keys of {field}", name, names)
    if position.get("over", False) is True:
        raise refuse(f"{field}.over", True, "must be False: the visit has ended, there is no stroke to play")
    try:
        arrays = Position.from_dict(position, table=tables.rules.table).arrays()
    except ValueError as error:
        raise ValueError(f"{field}.{error}") from None
    _, on_table, game = arrays
    most = MOST_BREAK - points_available(mask_of_present(on_table), int(game[BALL_ON]))
    if game[POINTS] > most:
        words = f"must be at most {most}: the balls on the table offer {MOST_BREAK - most} more"
        raise refuse(f"{field}.points", int(game[POINTS]), words)
    return arrays
