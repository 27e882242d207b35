"""How is a frame on the page reviewed while the game goes on? In a thread of its own, on copies of what was played."""

import threading
from collections.abc import Sequence
from typing import Any

from .._lib.check import refuse
from ..advice.review import FrameRecord, Review, Reviewed, go_through
from .session import Session


class Reviewing:
    """A review that is being made, or is done, of the acts of a game."""

    def __init__(self, session: Session, frame: FrameRecord, players: Sequence[int], **how: Any):
        self.begun: int = session.begun
        self.acts, self.strokes = (
            session.acts[: session.at],
            session.strokes,
        )  # what was played; which are strokes
        self.found: Review | None = None
        self._steps = go_through(frame, players, winner=session.frame.winner, **how)
        self._changed = threading.Condition()
        self._version, self._done, self._total, self._running, self._trouble = 0, 0, 1, True, ""
        threading.Thread(target=self._run, name="snooker review", daemon=True).start()

    def stop(self) -> None:
        """End it after the stroke that is being judged."""
        self._note(running=False)

    def report(self, after: int, seconds: float) -> dict[str, Any]:
        """What is known, as soon as that is newer than the version ``after``, at most so many seconds later."""
        with self._changed:
            self._changed.wait_for(lambda: self._version != after or not self._running, seconds)
            names = ("version", "running", "done", "total", "trouble")
            told: dict[str, Any] = {name: getattr(self, f"_{name}") for name in names}
            if (found := self.found) is None:
                return told
        strokes = [
            one.to_dict() | {"meant": one.meant.figure, "best": one.best.figure} for one in found.strokes
        ]
        return told | found.to_dict() | {"strokes": strokes}

    def act_of(self, number: object) -> tuple[int, Reviewed]:
        """The index of the act that a stroke is, and what is known of it; ValueError if it was not reviewed."""
        strokes = self.found.strokes if self.found else []
        one = next((one for one in strokes if one.number == number), None)
        if one is None:
            raise refuse(
                "stroke", number, f"must be one of {[one.number for one in strokes]}: those were reviewed"
            )
        return self.strokes[one.number - 1], one

    def _run(self):
        try:
            for done, total, found in self._steps:
                if not self._running:
                    return
                self._note(done=done, total=total, found=found)
        # a custom agent may raise anything: the page says it
        except Exception as error:
            self._note(trouble=f"{type(error).__name__}: {error}")
        self._note(running=False)

    def _note(self, found: Review | None = None, **what: Any) -> None:
        with self._changed:
            self.found = found or self.found
            self.__dict__.update({f"_{name}": value for name, value in what.items()})
            self._version += 1
            self._changed.notify_all()
