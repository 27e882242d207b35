"""Against whom does a person play, and what does the person's own file hold? Frames against the agents, and the strokes that the
coach reads. It is read before each use and written whole, so two servers may share it. One that is not sound is an error."""

import json
from collections.abc import Callable
from datetime import date
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

from .._lib.check import integer, refuse, truth
from .._lib.files import MOST_JSON, read_bytes, strict_json, write_atomic
from .._lib.types import NoiseName
from ..advice import Recorded
from ..advice.recorded import strokes_of
from ..replays import replay
from .session import Session

Change: TypeAlias = Callable[[dict[str, Any]], object]  # of what the file holds
EMPTY: dict[str, Any] = {"format": "snooker-person", "version": 1, "name": "", "frames": [], "strokes": []}
MOST_STROKES, MOST_NAME = 600, 40
RATED_WITH = "amateur"  # the person's errors in frames that are rated
PLACE = ("cue", "physics", "table")  # what strokes must share to be read by the coach together


class Level(NamedTuple):
    """An opponent: the agent that plays as it, with whose errors, how it plays in a line, and its measured strength."""

    name: str
    agent: str
    noise: NoiseName
    style: str
    elo: int  # docs/play/page.md says how it was measured; the first has 1000


LEVELS = (
    Level("Pip", "ghost_ball", "beginner", "quick: plays the easiest pot at once, and often misses it", 1000),
    Level("Walter", "tactician_500", "club", "safe: leaves you little, and waits for your mistakes", 1921),
    Level("Rosa", "search_2000", "amateur", "bold: goes for every pot, and for the break", 2148),
    Level("Mia", "tactician_30", "professional", "quick: considers few strokes, but hits them well", 2587),
    Level("Vera", "tactician_500", "professional", "safe: weighs pots and safeties, and seldom errs", 2693),
)
BY_NAME = {level.name: level for level in LEVELS}
USUAL = "Walter"  # who plays against a person unless someone is named


class Person:
    """A person's file: the ``name``, ``frames`` as of ``tell_frame``, and the last ``MOST_STROKES`` ``strokes``."""

    def __init__(self, path: str | Path):
        self.path: Path = Path(path)
        self.read()

    def read(self) -> dict[str, Any]:
        """What the file holds, checked; without a file, nothing. ValueError names what is wrong."""
        try:
            kept = strict_json(read_bytes(self.path, MOST_JSON)) if self.path.exists() else dict(EMPTY)
            _check(kept)
        except (ValueError, TypeError, KeyError, AttributeError) as error:
            why = f"must be a person's file ({error}); move this one away, or name another with --person"
            raise refuse("person", str(self.path), why) from None
        return kept

    def change(self, how: Change | None) -> None:
        """Change what the file holds, check it, and write it whole; None removes the file."""
        kept = self.read()
        if how is not None:
            how(kept)
            _check(kept)
        try:
            if how is None:
                self.path.unlink(missing_ok=True)
            else:
                self.path.parent.mkdir(parents=True, exist_ok=True)
                write_atomic(self.path, json.dumps(kept, allow_nan=False) + "\n")
        except OSError as error:
            allowed = f"must be a file that can be written ({error.strerror})"
            raise refuse("person", str(self.path), allowed) from None

    def strokes(self) -> list[Recorded]:
        """The strokes that share cue, constants and table with the last one."""
        kept = self.read()["strokes"]
        same = [one for one in kept if all(one.get(name) == kept[-1].get(name) for name in PLACE)]
        return [Recorded.from_dict(one) for one in same]


def tell_frame(session: Session, seat: int, opponent: str, *, same: bool) -> Change:
    """Adds a frame that is over, the person's side first, and the person's strokes in it. ``same``: nobody else sat there."""
    sides, played = (seat, 1 - seat), [session.acts[k] for k in session.strokes]
    fair = (
        same
        and (session.options.game, session.options.layout) == ("snooker", "break_off")
        and opponent in BY_NAME
    )
    for act in played if fair else ():  # the strokes of a rated frame
        noise = RATED_WITH if act.player == seat else BY_NAME[opponent].noise
        fair &= (act.asked["cue"], act.asked["practice"], act.asked["noise"]) == ("real", False, noise)
    frame = {
        "date": date.today().isoformat(),
        "opponent": opponent[:MOST_NAME],
        "noise": [session.noise[side] for side in sides],
        "scores": [session.frame.scores[side] for side in sides],
        "won": session.frame.winner == seat,
        "breaks": session.breaks[seat],
        "hints": session.hints[seat],
        "undone": session.undone,
        "rated": fair and bool(played) and not session.hints[seat] and not session.undone,
    }
    strokes = [act.played for act in played if act.played is not None]
    mine = strokes_of(replay(strokes).to_dict(), seat) if any(act.player == seat for act in played) else []

    def add(kept: dict[str, Any]) -> None:
        kept["frames"] = [*kept["frames"], frame]
        kept["strokes"] = [*kept["strokes"], *(one.to_dict() for one in mine)][-MOST_STROKES:]

    return add


def _check(kept: dict[str, Any]) -> None:
    """An error of one of four kinds if this is not what a person's file holds."""
    for name in ("format", "version"):
        if kept[name] != EMPTY[name]:
            raise refuse(name, kept[name], f"must be {EMPTY[name]!r}")
    for text in (kept["name"], *(one["opponent"] for one in kept["frames"])):
        if not isinstance(text, str) or len(text) > MOST_NAME or not text.isprintable():
            raise refuse("name", text, f"must be a line of at most {MOST_NAME} characters")
    for one in kept["frames"]:
        date.fromisoformat(one["date"])
        for name in ("won", "rated"):
            truth(name, one[name])
        for value in (*one["scores"], *one["breaks"], one["hints"], one["undone"]):
            integer("frames", value, 0, 10**6)
    for one in kept["strokes"]:
        Recorded.from_dict(one)
