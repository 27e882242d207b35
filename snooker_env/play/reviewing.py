"""How is a frame on the page reviewed while the game goes on? In a thread of its own, on what was played until then."""

import threading
from collections.abc import Sequence
from typing import Any

from .._lib.check import refuse
from ..advice.review import FrameRecord, Review, Reviewed, go_through
from .session import Act, Session


class Reviewing:
    """A review of the acts of a game, which is made while it is ``running``."""

    def __init__(self, session: Session, frame: FrameRecord, players: Sequence[int], **how: Any):
        self.begun: int = session.begun
        self.acts: list[Act] = session.acts[: session.at]
        self._strokes: list[int] = session.strokes
        self.found: tuple[int, int, Review | None] = 0, 1, None  # done, of how many, what is known
        self.trouble: str = ""
        self.running: bool = True
        ended = self.acts[-1].what in ("concede", "claim")
        end = self.acts[-2 if ended else -1].standing
        steps = go_through(frame, players, winner=session.frame.winner, end=end, **how)
        threading.Thread(target=self._run, args=(steps,), name="snooker review", daemon=True).start()

    def report(self) -> dict[str, Any]:
        done, total, found = self.found
        told = {"running": self.running, "done": done, "total": total, "trouble": self.trouble}
        return told if found is None else told | found.to_dict()

    def act_of(self, number: object) -> tuple[int, Reviewed, float]:
        """Of a stroke: the index of its act, what is known, and the first player's chance before; ValueError for no such."""
        found = self.found[2]
        for one in found.strokes if found else ():
            if found and one.number == number:
                return self._strokes[one.number - 1], one, found.win_chance[one.number - 1]
        raise refuse("stroke", number, "must be the number of a stroke that was reviewed")

    def _run(self, steps):
        try:
            for found in steps:
                if not self.running:
                    return
                self.found = found
        except Exception as error:  # a custom agent may raise anything: the page says it
            self.trouble = f"{type(error).__name__}: {error}"
        self.running = False
