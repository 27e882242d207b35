"""How do persons, programs and agents share one game? Behind one lock, with a revision that grows with every change. Agents think
on copies of it; their strokes are dropped if the game has changed in the meantime."""

import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from functools import partial
from time import monotonic
from typing import Any, cast

import numpy as np

from .._lib.check import choice, refuse, refuse_what
from .._lib.types import NoiseName
from ..advice.ask import AGENT
from ..advice.review import FrameRecord, Review, Reviewed, common_noise, go_through
from ..game.fouls import AUTO
from ..game.frame import CHOICES
from ..game.frame_columns import STROKES
from ..players import Player, Strokes, player
from ..players.cue_stroke import cue_strokes
from ..replays.chances import ChanceJudge, win_chances
from ..simulation import SimulationError
from ..tasks.declarations import CLAIMS, CONCEDES
from ..tasks.noise import LEVELS
from .person import BY_NAME, Person, tell_frame
from .session import Act, Session, nominable

PERSON = "person"  # who sits at the page of the host
FRIEND, WATCHER = "friend", "watcher"  # at other devices: who plays a seat there, and who looks on
LINKED = "friend_by_link"  # who plays elsewhere, from the link of the game
ASKING: ContextVar[str] = ContextVar("who asks", default=PERSON)
"""Who makes the request that this thread answers: the ``PERSON`` (the host), the ``FRIEND`` or a ``WATCHER``."""
OFFERED = (AGENT, "tactician_500", "search_2000", "ghost_ball", "random")  # agents that can always be chosen


class Seats:
    """The two seats, and the players that may take them: ``agents`` by name, ``OFFERED``, the levels, and ``friends``."""

    def __init__(self, agents: Mapping[str, Player], *, friends: bool = False):
        own = {name: player(name) for name in OFFERED if name not in agents}
        self.players: dict[str, Player] = {**agents, **own}
        self.opponents: list[str] = [*agents, *BY_NAME]  # for the menu
        for level in BY_NAME.values():
            self.players.setdefault(level.name, self.players.get(level.agent) or player(level.agent))
        self.persons: list[str] = [PERSON, *[FRIEND] * friends]
        self.who: list[str] = [PERSON, PERSON]  # or ``FRIEND``, ``LINKED`` or the name of an agent
        # who sat here before a game by link, and their errors
        self._before: tuple[list[str], list[NoiseName]] = list(self.who), []

    @property
    def names(self) -> list[str]:
        return [*self.persons, *self.players]

    def advisers(self, practice: bool) -> list[str]:
        """The agents that may be asked for advice: alone at the table all, in a frame those that know frames."""
        known = [name for name in self.players if name not in BY_NAME]
        return [name for name in known if practice or getattr(self.players[name], "frames", True)]

    def level(self, session: Session) -> NoiseName:
        """The errors of both in advice and chances: the largest of the persons' who play, else of the agents' (``common_noise``)."""
        seats = range(1 if session.practice else 2)
        people = [seat for seat in seats if not self.is_agent(seat)]
        errors = [LEVELS[session.noise[seat]] for seat in people or seats]
        found = common_noise(errors if people else [one for one in errors if not one.silent])
        return cast(NoiseName, next(name for name, one in LEVELS.items() if one == found))

    def sit(self, who: list[str]) -> None:
        if not isinstance(who, list) or len(who) != 2:
            raise refuse("players", who, "must be two names")
        self.who = [choice(f"players[{k}]", name, self.names) for k, name in enumerate(who)]

    def is_agent(self, seat: int) -> bool:
        return self.who[seat] not in (PERSON, FRIEND, LINKED)

    def share(self, seat: int | None, noise: list[NoiseName]) -> list[NoiseName]:
        """A person with these errors plays a seat, and a friend by link the other; None: back to who sat here before, and errs so."""
        if seat is None and LINKED in self.who:
            self.who, noise = self._before
        elif seat is not None:
            self._before = self._before if LINKED in self.who else (self.who, noise)
            self.who = [PERSON if k == seat else LINKED for k in (0, 1)]
        return noise

    def seen_by(self, me: str) -> list[str]:
        """Who sits on both seats, as one of the persons sees it: itself as ``PERSON``, another as ``FRIEND``."""
        persons = {PERSON: FRIEND, FRIEND: FRIEND, me: PERSON}
        return [persons.get(who, who) for who in self.who]

    def label(self, seat: int, me: str = PERSON) -> str:
        seen = self.seen_by(me)
        if self.is_agent(seat):
            name = seen[seat].replace("_", " ")  # as the page lists it
            return name if seen[0] != seen[1] else f"{name} {seat + 1}"
        if seen.count(PERSON) != 1:
            return f"Player {seat + 1}"
        return "You" if seen[seat] == PERSON else "Friend"

    def decide(self, name: str, session: Session) -> Strokes:
        """What an agent does in the frame: a decision, a declaration or a stroke, without changing it."""
        options = session.options_with(session.noise[session.frame.striker])
        decided = self.players[name].at(options).play(session.position, session.tables.game[:, STROKES])
        if not isinstance(decided, Strokes) or len(decided) != 1:
            raise refuse_what("strokes", f"a {type(decided).__name__}", "must be Strokes of one stroke")
        return decided


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


class BusyError(RuntimeError):
    """Too many questions are being computed; the client should try again later."""


class StaleError(RuntimeError):
    """A question about a table that has changed since."""


class Service:
    """One game, its seats, and the thread in which agents think."""

    def __init__(self, session: Session, seats: Seats, person: Person | None = None):
        self.session: Session = session
        self.seats: Seats = seats
        self.person: Person | None = person
        self._over, self._sat = 0, set[tuple[str, ...]]()  # the last game that ended; who sat in this one
        self._unwritten: Callable[[], None] | None = None  # keeps a frame that could not be kept yet
        self.unkept: str = ""  # why the frame that is over is not in the person's file
        self._judge: tuple[Any, Any] = None, None  # options, and who judges with them
        self.reviewing: Reviewing | None = None
        self.revision: int = 0
        self.paused: bool = False  # whether an agent waits for ``go_on``
        self.trouble: str = ""  # why the last agent did not play
        self.invites: list[dict[str, Any]] = []  # what the host may pass on, if others can come to the table
        self._changed = threading.Condition(threading.RLock())
        self._asking = threading.BoundedSemaphore(2)
        self._closed = False
        self._thread = threading.Thread(target=self._think, name="snooker agents", daemon=True)
        self._thread.start()

    def close(self) -> None:
        with self._changed:
            self._closed = True
            self._changed.notify_all()
            if self.reviewing:
                self.reviewing.running = False

    @property
    def me(self) -> str:
        return ASKING.get()

    @property
    def labels(self) -> tuple[str, str]:
        """The names of both players, as seen by ``me``; alone at the table a person is "You"."""
        alone = self.session.practice and self.seats.who[0] == self.me
        return "You" if alone else self.seats.label(0, self.me), self.seats.label(1, self.me)

    def check_turn(self) -> None:
        frame = self.session.frame
        if self.seats.who[frame.striker] != self.me and frame.phase != "over":
            raise refuse("turn", self.labels[frame.striker], "must be yours: the other player is to play")

    @contextmanager
    def reading(self, revision: int | None = None) -> Iterator[Session]:
        """The game, for reading: no other thread changes it meanwhile; ``StaleError``: an old revision."""
        with self._changed:
            if revision not in (None, self.revision):
                raise StaleError
            yield self.session

    @contextmanager
    def acting(
        self, revision: int | None = None, *, pause: bool = False, any_turn: bool = False, anew: bool = False
    ) -> Iterator[Session]:
        """The game, for changing it as a whole. ``pause``: agents then wait; ``any_turn``: not mine alone; ``anew``: another game."""
        with self.reading(revision) as session:
            if not (any_turn or anew):
                self.check_turn()
            elif not anew and LINKED in self.seats.who:
                raise refuse("game", "by link", "must not be changed: begin another game first")
            with session.as_a_whole():
                yield session
            self.paused, self.trouble = pause, ""
            self._announce()

    @contextmanager
    def asking(self, revision: int | None = None) -> Iterator[Session]:
        """A copy for trial strokes; ``BusyError``: too many questions, ``StaleError``: an old revision."""
        if not self._asking.acquire(timeout=10.0):
            raise BusyError("other questions are being answered")
        try:
            with self.reading(revision) as session:
                if self.me != PERSON:
                    self.check_turn()  # a guest's questions do not hold up those of the player
                twin = session.twin()
            yield twin
        finally:
            self._asking.release()

    def judge(self) -> ChanceJudge | None:
        """Estimates chances to win with the errors of ``Seats.level``; None in practice."""
        if self.session.practice:
            return None
        options = self.session.options_with(self.seats.level(self.session))
        if self._judge[0] is not options:
            self._judge = options, player("tactician").at(options)
        return self._judge[1]

    def win_chances(self, acts: Sequence[Act]) -> list[float] | list[None]:
        """How likely seat 0 was to win after each of some acts; None in practice."""
        if (judge := self.judge()) is None or not acts:
            return [None] * len(acts)
        return win_chances(judge, [act.standing for act in acts])

    def choice_chances(self) -> list[float | None]:
        """How likely the striker wins after each choice that it has after a foul; None in practice."""
        session = self.session
        chances = self.win_chances([session.twin().choose(what) for what in session.frame.choices])
        return [one if one is None or session.frame.striker == 0 else 1.0 - one for one in chances]

    def own_file(self) -> Person:
        if self.person is None:
            raise refuse("person", None, "must be named: this server keeps no person's file")
        return self.person

    def own_review(self) -> Reviewing:
        if self.reviewing is None or self.reviewing.begun != self.session.begun:
            raise refuse("review", None, "must be begun first: this game has not been reviewed")
        return self.reviewing

    def wait(self, revision: int, seconds: float) -> None:
        """Return when the revision has changed, or after that time."""
        until = monotonic() + seconds
        with self._changed:
            while self.revision == revision and not self._closed and (left := until - monotonic()) > 0:
                self._changed.wait(left)

    def go_on(self) -> None:
        with self._changed:
            if self.paused:  # else it is thinking already: another page was first
                self.paused, self.trouble = False, ""
                self._announce()

    def agent_to_play(self) -> bool:
        frame = self.session.frame
        return frame.phase != "over" and self.seats.is_agent(frame.striker)

    @property
    def thinking(self) -> bool:
        return self.agent_to_play() and not self.paused

    def _keep(self) -> None:
        """Keep a frame of a person against an agent when it ends, if it was played from its beginning."""
        session, seats, person = self.session, self.seats, self.person
        if not session.strokes:
            self._sat.clear()
        self._sat.add(tuple(seats.who))
        try:
            if person is not None and session.frame.phase == "over" and self._over != session.begun:
                self._over, self.unkept = session.begun, ""
                people = [seat for seat in (0, 1) if not seats.is_agent(seat)]
                dealt = all(act.what not in ("set_up", "load") for act in session.acts[: session.at])
                if len(people) == 1 and dealt and not session.practice:
                    other, same = seats.who[1 - people[0]], len(self._sat) == 1
                    self._unwritten = partial(person.change, tell_frame(session, people[0], other, same=same))
            if self._unwritten is not None:
                self._unwritten()
                self._unwritten, self.unkept = None, ""
        except ValueError as error:
            self.unkept = f"The frame was not kept: {error}."

    def _announce(self):
        self._keep()
        self.revision += 1
        self._changed.notify_all()

    def _think(self):
        while True:
            with self._changed:
                while not (self._closed or self.thinking):
                    self._changed.wait()
                if self._closed:
                    return
                revision = self.revision
                who, twin = self.seats.who[self.session.frame.striker], self.session.twin()
            decided, trouble = None, ""
            try:
                decided = self.seats.decide(who, twin)
            # a custom player may raise anything: it is reported, and the game waits
            except Exception as error:
                trouble = f"{who} failed to choose a stroke ({type(error).__name__}: {error})"
            with self._changed:
                if self.revision != revision or self._closed:
                    continue
                if decided is not None:
                    trouble = self._carry_out(decided)
                self.trouble, self.paused = trouble, bool(trouble) or all(map(self.seats.is_agent, (0, 1)))
                self._announce()

    def _carry_out(self, decided: Strokes) -> str:
        """What an agent has decided; why it could not be carried out, or ""."""
        session, frame = self.session, self.session.frame
        declared, what = int(decided.declare[0]), CHOICES[int(decided.decision[0])]
        try:
            with session.as_a_whole():
                if declared == CONCEDES:
                    session.concede()
                elif declared == CLAIMS and frame.may_claim:
                    session.claim()
                elif frame.phase == "choice" and what != "play" and what in frame.choices:
                    session.choose(what)
                else:
                    if frame.phase == "choice":
                        session.choose("play")
                    (stroke,) = cue_strokes(decided, session.position)
                    if session.frame.in_hand and np.isfinite(decided.place[0]).all():
                        session.place(*decided.place[0].tolist())
                    named, open_to = int(decided.nominate[0]), nominable(session.frame)
                    session.play(stroke, nominated=named if named in open_to else AUTO)
        except (ValueError, SimulationError) as error:
            return str(error)
        return ""
