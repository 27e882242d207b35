"""Who sits at the tables of an environment? The agent and its opponent, or two players, by the options."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, cast

from .._lib.check import choice, refuse, refuse_what
from ..tasks.frames import TABLES, Frames, Seat
from ..tasks.options import NEVER, OBJECT, Options, options_of
from ..tasks.tables import Tables


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
        return made(options, n, seats=seats)
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
    return made(options, n, seats=seats)


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
