"""How is a whole game passed on? As its first table, with its random stream, and what was asked for from there.

Played again, strokes meet the same execution errors, so that it must end as it did."""

from typing import Any, cast

import numpy as np

from .._lib.check import choice, refuse, refuse_what, truth
from .._lib.types import CueKind
from ..advice import CueStroke
from ..game.balls import NAMES
from ..game.ruling import AUTO
from ..players.requests import read_colour, read_place
from ..simulation import SimulationError
from ..tasks.noise import LEVELS
from ..tasks.options import CUES
from .session import DECLINED, Session

MOST_ACTS = 1000
NEAR = 1e-3  # how far balls may lie at the end from where they lay [m]
STROKE = ("speed", "aim", "side", "top", "elevation", "place", "nominate", "noise", "practice", "cue")


def record_game(session: Session) -> dict[str, Any]:
    """The game from its last new table on: a ``Session.save`` of the first table, "acts", and the "end"."""
    acts = session.acts[: session.at]
    first = max(k for k, act in enumerate(acts) if not act.asked)
    asked = [act.asked for act in acts[first + 1 :]]
    return session.save() | {"state": acts[first].state, "acts": asked, "end": _end(session)}


def open_game(session: Session, saved: object) -> None:
    """Restore a result of ``record_game`` or ``Session.save``; ValueError if it is invalid, nothing has changed."""
    if not isinstance(saved, dict) or "acts" not in saved:
        session.load(saved)
        return
    game = dict(saved)
    acts, end = game.pop("acts"), game.pop("end", None)
    if not isinstance(acts, list) or len(acts) > MOST_ACTS:
        raise refuse_what("saved.acts", "something else", f"must be a list of at most {MOST_ACTS}")
    with session.as_a_whole():
        session.load(game)
        noise, practice, cue = list(session.noise), session.practice, session.cue
        for k, act in enumerate(acts):
            try:
                _do(session, act)
            except (ValueError, SimulationError) as error:
                raise ValueError(f"saved.acts[{k}].{error}") from None
        if not _same(end, here := _end(session)):
            allowed = f"must be {here}: that is where it ends here, maybe another version played it"
            raise refuse("saved.end", end, allowed)
        session.noise, session.practice, session.cue = noise, practice, cue  # as at the end


def _do(session: Session, act: Any) -> None:
    """Do what was asked for; ValueError names the field that is invalid."""
    if not isinstance(act, dict):
        raise refuse("act", act, "must be an object")
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


def _end(session: Session) -> dict[str, Any]:
    """The scores, and where each ball lies, to 0.1 mm; None: it is off the table, or in hand."""
    state, hand = session.state, session.frame.in_hand
    balls = zip(NAMES, state["positions"], state["on_table"], strict=True)
    lie = {
        name: np.round(at, 4).tolist() if on and not (hand and name == "cue") else None
        for name, at, on in balls
    }
    return {"scores": list(session.frame.scores)} | lie


def _same(end: object, here: dict[str, Any]) -> bool:
    """Whether a game ended ``here``, its balls to within ``NEAR``."""
    if not isinstance(end, dict) or set(end) != set(here):
        return False
    pairs = [(end[name], place) for name, place in here.items()]
    if any((one is None) != (other is None) for one, other in pairs):
        return False
    try:
        return all(
            bool(np.allclose(one, other, rtol=0.0, atol=NEAR)) for one, other in pairs if other is not None
        )
    except (TypeError, ValueError):  # they are no places
        return False
