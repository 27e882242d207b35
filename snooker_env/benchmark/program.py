"""How does an external program play? JSON lines: the state of ``docs/play/protocol.md`` on its standard input, a stroke on its output.

The program is started once and plays one episode after the other. For each decision it gets one line, the object of ``GET api/state``, and
answers with one line, an object as ``POST api/stroke`` takes it. In a task the colour first struck after a red counts as nominated, so that
"nominate" is refused. In phase "choice" of a frame it answers with a "choice"; after "play" alone it gets the state once more, for its
stroke. Its standard error goes to that of this process.
"""

import contextlib
import json
import os
import queue
import shlex
import subprocess
import threading
import time
from typing import Any

import numpy as np

from .._check import choice, number, refuse
from .._types import Bools, Floats
from ..game.balls import CUE
from ..planning import Positions
from ..play.report import report
from ..play.routes import STROKE, stroke_asked
from ..play.seats import Seats
from ..play.server import RefusedError, parsed
from ..play.service import Service
from ..play.session import STATE, Session
from ..play.wishes import DECISIONS, action_of

OPTIONS: dict[str, Any] = {"aim": "absolute", "elevation": True, "placement": True}
"""How a program's strokes become actions."""

LONGEST = 1 << 20
"""The longest answer [bytes]."""


class AgentError(RuntimeError):
    """An agent that stopped playing: a program that died, was too slow, or answered something that is no stroke."""


class ProgramPlayer:
    """An external program as a player.

    Parameters
    ----------
    command : str
        The command line, split as by a shell; no shell runs it.
    frame : bool
        Whether it plays frames: then an answer may contain "choice".
    timeout : float
        The longest time of an answer [s], in (0, 1e6].

    Raises
    ------
    ValueError
        If the command is empty, or the timeout is out of range.
    AgentError
        If the program cannot be started.

    Examples
    --------
    >>> from snooker_env.benchmark import ProgramPlayer
    >>> ProgramPlayer("")
    Traceback (most recent call last):
    ...
    ValueError: agent = 'program:': must name a program: program:"python my_player.py"
    """

    frames: bool = True

    def __init__(self, command: str, *, frame: bool = False, timeout: float = 60.0):
        try:
            words = shlex.split(command, posix=os.name == "posix")
        except ValueError as error:
            raise refuse("agent", f"program:{command}", f"must be a command line ({error})") from None
        if not words:
            raise refuse("agent", f"program:{command}", 'must name a program: program:"python my_player.py"')
        self.options: dict[str, Any] = OPTIONS | ({"decision": True} if frame else {})
        self._command, self._timeout = command, number("timeout", timeout, 0.0, 1e6, open_low=True)
        try:
            self._process: Any = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        except OSError as error:
            raise AgentError(f"the program {command!r} cannot be started: {error}") from None
        self._lines: queue.Queue[bytes] = queue.Queue(2)  # a program that prints on and on has to wait
        self._states: queue.Queue[bytes] = queue.Queue()
        self._taken = threading.Event()  # the program has read all that was written
        self._taken.set()
        self._reader = threading.Thread(target=self._read, daemon=True, name="answers of the program")
        self._writer = threading.Thread(target=self._write, daemon=True, name="states for the program")
        self._reader.start()
        self._writer.start()
        self._session = Session()
        self._service = Service(self._session, Seats({}))

    def act(self, tables: Any, observations: Any, going: Bools) -> Floats:
        """The program's answer for each table on which the episode goes on.

        Parameters
        ----------
        tables : SnookerVectorEnv
            The n tables.
        observations : float32 (n, k)
            Their observations, which are not used.
        going : bool (n,)
            Tables on which the episode goes on.

        Returns
        -------
        float64 (n, k)
            Actions of the box action space, 0 where the episode is over.

        Raises
        ------
        AgentError
            If the program ends, is too slow, or its answer is no stroke.
        """
        actions = np.zeros((len(going), tables.options.rules.actions.size))
        for k in np.flatnonzero(going).tolist():
            self._stand(tables, k)
            given = self._asked()
            if given == {"choice": "play"} and self._session.frame.phase == "choice":
                self._session.choose("play")  # its stroke comes with the next answer
                self._service.revision += 1
                given = self._asked()
            actions[k] = self._row(given, frame="decision" in self.options)[: actions.shape[1]]
        return actions

    def close(self) -> None:
        """End the program."""
        self._service.close()
        if not self._taken.is_set():  # it does not read: the end of its input would not reach it
            self._process.kill()
        self._states.put(b"")
        self._writer.join(2.0)
        if not self._writer.is_alive():
            with contextlib.suppress(OSError):  # it has gone already
                self._process.stdin.close()
        try:
            self._process.wait(2.0)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        until = time.monotonic() + 2.0
        while self._reader.is_alive() and time.monotonic() < until:
            with contextlib.suppress(queue.Empty):  # what it still had to say
                self._lines.get(timeout=0.02)
        if not self._reader.is_alive():  # a child of the program may hold its output open
            self._process.stdout.close()

    def _read(self):
        line = b" "
        while line and len(line) <= LONGEST:
            line = self._process.stdout.readline(LONGEST + 1)
            self._lines.put(line)

    def _write(self):
        """Write states, in a thread of its own: a program that does not read stops whoever writes to it."""
        pipe = self._process.stdin.fileno()
        while text := self._states.get():
            with contextlib.suppress(OSError):  # nobody reads; the reader reports that it ended
                while text:
                    text = text[os.write(pipe, text) :]
                self._taken.set()

    def _stand(self, tables, k):
        """The session as table k stands."""
        session, noise = self._session, tables.options.noise
        if tables.options.task == "frame":
            state = tables.tables.get_state(k)
            state = {name: state[name] for name in STATE}
            state["frame"] = state["frame"] | {"miss": "clear_path"}  # as a session plays; nothing is called for what was before
            session.load({"format": "snooker-game", "version": 1, "practice": False, "noise": [noise, noise], "state": state})
        else:
            position = Positions.of(tables)[k]
            session.set_up(position, scores=(position.points, 0), striker=0, free_ball=False)
            session.noise[:] = [noise, noise]
        self._service.revision += 1

    def _asked(self):
        """The program's answer to the table as it stands: an object."""
        line = json.dumps(report(self._service), separators=(",", ":")).encode() + b"\n"
        until = time.monotonic() + self._timeout
        try:
            answer = self._lines.get_nowait()
        except queue.Empty:
            self._taken.clear()
            self._states.put(line)
            try:
                answer = self._lines.get(timeout=self._timeout)
            except queue.Empty:
                raise AgentError(f"the program {self._command!r} gave no stroke within {self._timeout:g} s") from None
            if answer and not self._taken.wait(max(0.0, until - time.monotonic())):
                raise AgentError(f"the program {self._command!r} did not read its state within {self._timeout:g} s") from None
        else:
            if answer:
                raise AgentError(f"the program {self._command!r} answered {_short(answer)} without a state: one line for each")
        if len(answer) > LONGEST:
            raise AgentError(f"the program {self._command!r} answered a line of more than {LONGEST:,} bytes")
        if not answer:
            try:
                code = self._process.wait(2.0)
            except subprocess.TimeoutExpired:
                raise AgentError(f"the program {self._command!r} closed its output") from None
            raise AgentError(f"the program {self._command!r} ended with exit code {code} instead of a stroke")
        try:
            return parsed(answer.strip())
        except RefusedError as error:
            raise AgentError(f"the program {self._command!r} answered {_short(answer)}, which is no stroke: {error}") from None

    def _row(self, given: dict[str, Any], *, frame: bool) -> Floats:
        """An answer as a row of ``Actions("absolute", elevation=True, placement=True, decision=True)``."""
        try:
            for name in given:
                choice("field", name, (*STROKE, "revision", *(("choice",) if frame else ())))
            twin = self._session.twin()
            said = given.get("choice", "play")
            if "choice" in given or twin.frame.phase == "choice":
                twin.choose(said)
            if said != "play":
                return np.append(np.zeros(7), DECISIONS[said])
            stroke = stroke_asked(twin, given)
            return action_of(stroke, tuple(twin.tables.positions[0, CUE].tolist()))
        except ValueError as error:
            raise AgentError(f"the program {self._command!r} answered {_short(json.dumps(given))}, which is refused: {error}") from None


def _short(text):
    text = text.decode(errors="replace") if isinstance(text, bytes) else text
    text = text.strip()
    return repr(text if len(text) <= 80 else text[:77] + "...")
