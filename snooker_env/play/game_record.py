"""How is a whole game passed on? As its first table, with its random stream, and what was asked for from there.

Played again, strokes meet the same execution errors, so each act must lead to the scores and places written with it."""

from typing import Any, cast

import numpy as np

from .._lib.check import choice, number, refuse, refuse_what, truth
from .._lib.types import CueKind
from ..advice import CueStroke
from ..game.balls import NAMES
from ..game.fouls import AUTO
from ..players.requests import read_colour, read_place
from ..simulation import SimulationError
from ..tasks.noise import LEVELS
from ..tasks.options import CUES
from .session import DECLINED, Session

MOST_ACTS = 1000
NEAR = 1e-3  # how far balls may lie from where they were written down [m]
STROKE = ("speed", "aim", "side", "top", "elevation", "place", "nominate", "noise", "practice", "cue")


def record_game(session: Session) -> dict[str, Any]:
    """The game from its last new table on: a ``Session.save`` of the first table, and "acts" with what each left."""
    acts = session.acts[: session.at]
    first = max(k for k, act in enumerate(acts) if not act.asked)
    states = [act.state for act in acts[first:]]
    asked = zip(acts[first + 1 :], states, states[1:], strict=False)
    told = [act.asked | {"left": _list_changes(before, after)} for act, before, after in asked]
    return session.save() | {"state": acts[first].state, "acts": told}


def open_game(session: Session, saved: object) -> None:
    """Restore a result of ``record_game`` or ``Session.save``; ValueError if it is invalid, nothing has changed."""
    if not isinstance(saved, dict) or "acts" not in saved:
        session.load(saved)
        return
    game = dict(saved)
    acts = game.pop("acts")
    if not isinstance(acts, list) or len(acts) > MOST_ACTS:
        raise refuse_what("saved.acts", "something else", f"must be a list of at most {MOST_ACTS}")
    with session.as_a_whole():
        session.load(game)
        noise, practice, cue = list(session.noise), session.practice, session.cue
        for k, act in enumerate(acts):
            try:
                if not isinstance(act, dict):
                    raise refuse("act", act, "must be an object")
                before, asked = session.state, dict(act)
                left = asked.pop("left", None)
                _do(session, asked)
                _compare(left, before, session.state)
            except (ValueError, SimulationError) as error:
                raise ValueError(f"saved.acts[{k}].{error}") from None
        session.noise, session.practice, session.cue = noise, practice, cue  # as at the end


def _do(session: Session, act: dict[str, Any]) -> None:
    """Do what was asked for; ValueError names the field that is invalid."""
    kind = next((name for name in ("choice", "declare") if name in act), None)
    for name in act:
        choice("field", name, STROKE if kind is None else (kind,))
    if kind == "choice":
        session.choose(act["choice"])
    elif kind == "declare":
        getattr(session, choice("declare", act["declare"], ("concede", "claim")))()
    else:
        _play(session, act)


def _play(session: Session, act: dict[str, Any]) -> None:
    """Play a stroke as it was asked for, with the errors, the practice and the cue of then."""
    stroke = CueStroke.of({name: act[name] for name in STROKE[:5] if name in act})
    level: Any = choice("noise", act.get("noise"), LEVELS)
    session.noise[session.frame.striker] = level
    session.practice = truth("practice", act.get("practice"))
    session.cue = cast(CueKind, choice("cue", act.get("cue"), CUES))
    if act.get("place") is not None:
        session.place(*read_place("place", act["place"]))
    named = act.get("nominate")
    nominated = AUTO if named is None else DECLINED if named == "none" else read_colour("nominate", named)
    session.play(stroke, nominated=nominated)


def _list_changes(before: dict[str, Any], after: dict[str, Any]) -> dict[str, Any]:
    """What an act leaves: the scores, and the place of each ball that it moved, to 0.1 mm."""
    was = _places(before)
    return {name: place for name, place in _places(after).items() if place != was[name] or name == "scores"}


def _places(state: dict[str, Any]) -> dict[str, Any]:
    """The scores, and where each ball lies; None: it is off the table, or in hand."""
    hand, balls = state["frame"]["in_hand"], zip(NAMES, state["positions"], state["on_table"], strict=True)
    places = {
        name: np.round(at, 4).tolist() if on and not (hand and name == "cue") else None
        for name, at, on in balls
    }
    return {"scores": list(state["frame"]["scores"])} | places


def _compare(left: object, before: dict[str, Any], after: dict[str, Any]) -> None:
    """ValueError names what an act was said to leave and does not leave here."""
    if not isinstance(left, dict):
        raise refuse("left", left, 'must be an object: {"scores": [0, 0], "cue": [x, y], ...}')
    said, here = _places(before) | left, _places(after)
    for name, place in said.items():
        if not _alike(place, here[choice("field of left", name, here)]):
            led = "off the table" if here[name] is None else here[name]
            allowed = f"must be {led}: that is what this act leads to here, maybe another version played it"
            raise refuse(f"left.{name}", place, allowed)


def _alike(one: object, other: object) -> bool:
    """Whether these are the same scores, or the same place to within ``NEAR``."""
    if not isinstance(one, list) or not isinstance(other, list) or len(one) != len(other):
        return one is other
    return all(abs(number("left", a) - b) < NEAR for a, b in zip(one, other, strict=True))
