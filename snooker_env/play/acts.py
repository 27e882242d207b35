"""How is a whole game written down, and played again? As its first table, with its random stream, and what was asked
for from there.

Played again, strokes meet the same execution errors, so they must lead to the table that is written at the end.
"""

from typing import Any

import numpy as np

from .._check import array, choice, refuse, refuse_what, truth
from ..advice import CueStroke
from ..game.balls import NAMES
from ..game.ruling import AUTO
from ..tasks.noise import LEVELS
from ..tasks.options import CUES
from .questions import colour_named, place_asked
from .session import DECLINED, Session

MOST_ACTS = 1000
NEAR = 1e-3  # how far balls may lie from where they were written down [m]
STROKE = ("speed", "aim", "side", "top", "elevation", "place", "nominate", "noise", "practice", "cue")


def written(session: Session) -> dict[str, Any]:
    """The game from its last new table on: a ``Session.save`` of the first table, "acts" and "end"."""
    acts = session.acts[: session.at]
    first = max(k for k, act in enumerate(acts) if not act.asked)
    begun = session.save() | {"state": acts[first].state}
    return begun | {"acts": [act.asked for act in acts[first + 1 :]], "end": _end(session)}


def opened(session: Session, saved: Any) -> None:
    """Restore a result of ``written`` or ``Session.save``; ValueError if it is invalid, nothing has changed."""
    if not isinstance(saved, dict) or "acts" not in saved:
        session.load(saved)
        return
    game, acts = dict(saved), saved["acts"]
    del game["acts"]
    end = game.pop("end", None)
    if not isinstance(acts, list) or len(acts) > MOST_ACTS:
        raise refuse_what("saved.acts", "something else", f"must be a list of at most {MOST_ACTS}")
    twin = session.twin()
    twin.load(game)
    for k, act in enumerate(acts):
        try:
            _do(twin, act)
        except ValueError as error:
            raise ValueError(f"saved.acts[{k}].{error}") from None
    if not _alike(_end(twin), end):
        allowed = "must be where its acts lead; another version or table of snooker_env may have played them"
        raise refuse_what("saved.end", "another table", allowed)
    twin.noise[:], twin.practice, twin.cue = game["noise"], game["practice"], game.get("cue", "free")
    session.become(twin)


def _do(session: Session, act: Any) -> None:
    """Do what was asked for; ValueError names the field that is invalid."""
    if not isinstance(act, dict):
        raise refuse("act", act, "must be an object")
    says: Any = {"concede": session.concede, "claim": session.claim}
    declare = lambda what: says[choice("declare", what, says)]()  # noqa: E731
    for one, do in (("choice", session.choose), ("declare", declare)):
        if one in act:
            for name in act:
                choice("field", name, (one,))
            do(act[one])
            return
    for name in act:
        choice("field", name, STROKE)
    stroke = CueStroke.of({name: act[name] for name in STROKE[:5] if name in act})
    level: Any = choice("noise", act.get("noise"), LEVELS)
    session.noise[session.frame.striker] = level
    session.practice = truth("practice", act.get("practice"))
    if choice("cue", act.get("cue"), CUES) != session.cue:
        session.cue = act["cue"]
    if act.get("place") is not None:
        session.place(*place_asked("place", act["place"]))
    nominated, named = AUTO, act.get("nominate")
    if named is not None:
        nominated = DECLINED if named == "none" else colour_named("nominate", named)
    session.play(stroke, nominated=nominated)


def _end(session: Session) -> dict[str, Any]:
    """Scores, and the place of each ball on the table to 0.1 mm."""
    places = np.round(session.tables.positions[0], 4).tolist()
    on_table = np.flatnonzero(session.tables.on_table[0])
    return {"scores": list(session.frame.scores), "positions": {NAMES[i]: places[i] for i in on_table}}


def _alike(found: dict[str, Any], end: Any) -> bool:
    """Whether this is the end that was written down."""
    here = found["positions"]
    there = end.get("positions") if isinstance(end, dict) else None
    if not isinstance(there, dict) or there.keys() != here.keys() or end.get("scores") != found["scores"]:
        return False
    places = array("saved.end.positions", [there[name] for name in here], (len(here), 2))
    return bool((np.abs(places - list(here.values())) < NEAR).all())
