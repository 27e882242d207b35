"""How do a page, a program and thinking agents share one game? Behind one lock: each act is atomic, and agents think on copies.

A number, the revision, grows with every change; a request that waits for a change names the last revision it has seen. The agent's thread
is notified when it is its turn, and its stroke is dropped if the game has changed in the meantime.
"""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from time import monotonic

from ..simulation import SimulationError
from .seats import Seats
from .session import Session

LONGEST_WAIT = 25.0
"""How long a request may wait for a change [s]."""


class BusyError(RuntimeError):
    """Too many questions are being computed; the client should try again later."""


class StaleError(RuntimeError):
    """A question about a table that has changed since."""


class Service:
    """One game, its seats, and the thread in which agents think.

    Parameters
    ----------
    session : Session
        The game.
    seats : Seats
        The players.
    """

    paused: bool
    """Whether an agent whose turn it is waits for ``go_on``: after an undo, a load or a position set up, and between two agents."""
    trouble: str
    """Why the last agent did not play, or ""."""

    def __init__(self, session: Session, seats: Seats):
        self.session: Session = session
        self.seats: Seats = seats
        self.revision: int = 0
        self.paused, self.trouble = False, ""
        self._changed = threading.Condition(threading.RLock())
        self._asking = threading.BoundedSemaphore(2)
        self._closed = False
        self._thread = threading.Thread(target=self._think, name="snooker agents", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Stop the agents."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()

    # for requests -----------------------------------------------------------------------------------------------------------

    @contextmanager
    def reading(self) -> Iterator[Session]:
        """The game, for reading: no other thread changes it meanwhile."""
        with self._changed:
            yield self.session

    @contextmanager
    def acting(self, revision: int | None = None, *, pause: bool = False, any_turn: bool = False) -> Iterator[Session]:
        """The game, for changing it. ``pause``: an agent whose turn it is then waits; ``any_turn``: allowed also during an agent's turn.

        Raises ValueError during an agent's turn, StaleError if the revision is out of date. After an error inside, nothing has changed.
        """
        with self._changed:
            if revision not in (None, self.revision):
                raise StaleError
            if not any_turn and self.agent_to_play():
                raise ValueError(f"turn = {self.seats.label(self.session.frame.striker)!r}: must be a person's: an agent is to play")
            yield self.session
            self.paused, self.trouble = pause, ""
            self._moved()

    @contextmanager
    def asking(self, revision: int | None = None) -> Iterator[Session]:
        """A copy of the game for trial strokes; ``BusyError`` for too many questions, ``StaleError`` for an old revision."""
        if not self._asking.acquire(timeout=10.0):
            raise BusyError("other questions are being answered")
        try:
            with self._changed:
                if revision not in (None, self.revision):
                    raise StaleError
                twin = self.session.twin()
            yield twin
        finally:
            self._asking.release()

    def wait(self, revision: int, seconds: float) -> None:
        """Return when the revision has changed, or after that time."""
        until = monotonic() + min(seconds, LONGEST_WAIT)
        with self._changed:
            while self.revision == revision and not self._closed and (left := until - monotonic()) > 0:
                self._changed.wait(left)

    def go_on(self) -> None:
        """Let the agent play whose turn it is."""
        with self._changed:
            if not self.paused:
                return  # it is thinking already: another page was first
            self.paused, self.trouble = False, ""
            self._moved()

    # agents -----------------------------------------------------------------------------------------------------------------

    def agent_to_play(self) -> bool:
        """Whether it is an agent's turn."""
        frame = self.session.frame
        return frame.phase != "over" and self.seats.is_agent(frame.striker)

    @property
    def thinking(self) -> bool:
        """Whether an agent is thinking about its stroke, or about to."""
        return self.agent_to_play() and not self.paused

    def _moved(self):
        self.revision += 1
        self._changed.notify_all()

    def _think(self):
        while True:
            with self._changed:
                while not (self._closed or self.thinking):
                    self._changed.wait()
                if self._closed:
                    return
                session, revision = self.session, self.revision
                if session.frame.phase == "choice":
                    session.choose("play")
                    self.revision = revision = revision + 1
                seat = session.frame.striker
                who, twin = self.seats.who[seat], session.twin()
            stroke = None
            trouble = ""
            try:
                stroke = self.seats.stroke(who, twin)
            except Exception as error:  # a custom player may raise anything: it is reported, and the game waits
                trouble = f"{who} gave no stroke ({type(error).__name__}: {error})"
            with self._changed:
                if self.revision != revision or self._closed:
                    continue
                if stroke is not None:
                    trouble = self._play(stroke)
                self.trouble, self.paused = trouble, bool(trouble) or all(map(self.seats.is_agent, (0, 1)))
                self._moved()

    def _play(self, stroke):
        """The agent's stroke; why it could not be played, or ""."""
        try:
            if stroke.place is not None and self.session.frame.in_hand:
                self.session.place(*stroke.place)
            self.session.play(stroke)
        except (ValueError, SimulationError) as error:
            return str(error)
        return ""
