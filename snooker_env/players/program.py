"""How does an external program play? JSON lines: for each stroke a state on its standard input, a stroke on its output, as
``GET api/state`` and ``POST api/stroke`` have them (docs/play/protocol.md). It is started at the first question."""

import contextlib
import json
import os
import queue
import shlex
import subprocess
import time
from _thread import start_new_thread
from concurrent.futures import Future, wait
from typing import Any

import numpy as np

from .._lib.check import choice, number, refuse
from ..game.balls import CUE
from ..game.frame import CHOICES, Frame, frame_of
from ..game.frame_columns import PLAY, Layouts
from ..game.in_hand import place_cue
from ..planning import Positions
from ..planning.positions import seeds_of
from ..planning.worth import apply_decision
from ..tasks.box_actions import MIN_SPEED
from ..tasks.noise import LEVELS
from ..tasks.options import Options
from .cue_stroke import STROKE, read_object, read_place, read_stroke
from .player import BoundPlayer, Strokes
from .seen import begun
from .table_report import report_game, report_turn, say_score, say_table, visit_of

LONGEST = 1 << 20  # the longest answer [bytes]
LABELS = ("Player 1", "Player 2")  # the program is always the first


class AgentError(RuntimeError):
    """An agent that stopped playing: it died, was too slow, or answered something that is no stroke."""


class ProgramPlayer(BoundPlayer):
    """An external program as a player: ``command`` is split as by a shell, but no shell runs it; ``timeout`` of an answer [s].
    All that ``at`` makes of it share one process."""

    def __init__(self, command: str, *, timeout: float = 60.0):
        try:
            words = shlex.split(command, posix=os.name == "posix")
        except ValueError as error:
            raise refuse("player", f"program:{command}", f"must be a command line ({error})") from None
        if not words:
            raise refuse("player", f"program:{command}", 'must name a program: program:"python my_player.py"')
        self.name = f"program:{command}"
        self._lines = _Lines(command, words, number("timeout", timeout, 0.0, 1e6, open_low=True))

    def _bind(self, options: Options) -> None:
        self._noise: Any = choice("noise", options.noise, tuple(LEVELS))

    def play(self, positions: Any, seeds: Any) -> Strokes:
        """Return what the program answers; AgentError if it ends, is too slow, or its answer is no stroke."""
        _ = self.options  # it must be bound
        at = Positions.of(positions)
        keys = seeds_of(seeds, len(at)).tolist()
        if not at.of_frames:
            at = begun(at)
        return Strokes.join([self._stroke(at[[k]], key) for k, key in enumerate(keys)] or [_one_stroke()[:0]])

    def close(self) -> None:
        """End the program; the next question starts it again."""
        self._lines.close()

    def _stroke(self, at: Positions, seed: int) -> Strokes:
        """What the program does in the one position ``at``, of a frame."""
        answer, decided = self._ask(at, seed), "play"
        if answer in ({"choice": "play"}, {"choice": "anywhere"}):
            choices = self._frame(at).choices
            if answer["choice"] in choices:
                decided = answer["choice"]
                at = apply_decision(at, CHOICES.index(decided))
                answer = self._ask(at, seed)  # its stroke
        try:
            return self._read(answer, at, decided)
        except ValueError as error:
            what = f"answered {_short(json.dumps(answer))}, which is refused: {error}"
            raise self._lines.failure(what) from None

    def _read(self, answer: dict[str, Any], at: Positions, decided: str) -> Strokes:
        """The stroke that an answer asks for, after what was ``decided``; ValueError names what is wrong."""
        for name in answer:
            choice("field", name, (*STROKE, "revision", "choice"))
        frame, what = self._frame(at), answer.get("choice", decided)
        if frame.phase == "choice":
            choice("choice", what, frame.choices)
            if what in ("play_again", "replace"):
                return _one_stroke(decision=CHOICES.index(what))
            at = apply_decision(at, CHOICES.index(what))
        elif "choice" in answer:
            raise refuse("choice", what, "must be left out: the other player has not just fouled")
        if "place" in answer:
            x, y = read_place("place", answer["place"])
            if not at.in_hand[0]:
                raise refuse("place", [x, y], "must be left out: the cue ball is not in hand")
            at = at.copy()
            free = bool(at.anywhere[0])
            at.positions[0, CUE] = place_cue(at.positions[0], at.on_table[0], x, y, anywhere=free)
        stroke = read_stroke(answer, visit_of(self._frame(at), at), self.options)
        put = at.positions[0, CUE] if at.in_hand[0] else None
        return _one_stroke(stroke.numbers(), put, CHOICES.index(what))

    def _frame(self, at: Positions) -> Frame:
        rules, saved = self.options.rules, at.saved or Layouts(at.positions, at.on_table)
        return frame_of(at.game[0], rules.miss, saved, 0, rules.game)

    def _state(self, at: Positions) -> dict[str, Any]:
        frame = self._frame(at)
        state = report_game(frame, at.positions[0].tolist(), at.on_table[0].tolist(), LABELS)
        turn, lines = report_turn(frame, at, self.options.rules.table, self._noise)
        state |= turn | {"noise": [self._noise] * 2, "cue": self.options.cue, "game": frame.rules}
        return state | {"text": say_table(state, lines, [state["words"], say_score(state, LABELS)])}

    def _ask(self, at: Positions, seed: int) -> dict[str, Any]:
        state = json.dumps(self._state(at) | {"seed": seed}, separators=(",", ":"))
        answer = self._lines.ask(state.encode() + b"\n")
        try:
            return read_object(answer.strip())
        except ValueError as error:
            raise self._lines.failure(f"answered {_short(answer)}, which is no stroke: {error}") from None


class _Lines:
    """A process that answers each line with one line; it is started by the first."""

    def __init__(self, command: str, words: list[str], timeout: float):
        self.command, self.timeout, self._words = command, timeout, words
        self._process: Any = None

    def ask(self, line: bytes) -> bytes:
        if self._process is None:
            try:
                self._process = subprocess.Popen(self._words, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
            except OSError as error:
                raise self.failure(f"cannot be started: {error}") from None
            self._answers: queue.Queue[bytes] = queue.Queue(2)  # a program that prints on and on has to wait
            start_new_thread(self._read, (self._process, self._answers))
        unasked, until = not self._answers.empty(), time.monotonic() + self.timeout
        self._read_all: Future[bool] = Future()  # whether the program has read all that was written
        start_new_thread(_write, (self._process.stdin.fileno(), line, self._read_all))
        try:
            answer = self._answers.get(timeout=self.timeout)
        except queue.Empty:
            raise self.failure(f"gave no stroke within {self.timeout:g} s") from None
        if not answer:
            try:
                code = self._process.wait(2.0)
            except subprocess.TimeoutExpired:
                raise self.failure("closed its output") from None
            raise self.failure(f"ended with exit code {code} instead of a stroke")
        if unasked:
            raise self.failure(f"answered {_short(answer)} without a state: one line for each")
        if len(answer) > LONGEST:
            raise self.failure(f"answered a line of more than {LONGEST:,} bytes")
        if not (wait([self._read_all], until - time.monotonic()).done and self._read_all.result()):
            raise self.failure(f"did not read its state within {self.timeout:g} s")
        return answer

    def failure(self, what: str) -> AgentError:
        return AgentError(f"the program {self.command!r} {what}")

    def close(self) -> None:
        process, self._process = self._process, None
        if process is None:
            return
        if not self._read_all.done():  # it does not read: the end of its input would not reach it
            process.kill()
        if wait([self._read_all], 2.0).done:
            process.stdin.close()
        try:
            process.wait(2.0)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        with contextlib.suppress(queue.Empty):  # a reader that waits for room goes on, and ends
            self._answers.get_nowait()

    def _read(self, process, answers):
        with process.stdout:
            line = b" "
            while line and len(line) <= LONGEST:
                line = process.stdout.readline(LONGEST + 1)
                if process is self._process:  # once closed, it may still say what it has to
                    answers.put(line)


def _write(pipe, text, read_all):
    """Write a text, in a thread of its own: a program that does not read stops whoever writes to it."""
    with contextlib.suppress(OSError):  # nobody reads; the reader reports that it ended
        while text:
            text = text[os.write(pipe, text) :]
    read_all.set_result(not text)


def _one_stroke(values: Any = (MIN_SPEED, 0, 0, 0, 0), place: Any = None, decision: int = PLAY) -> Strokes:
    places: Any = None if place is None else np.array([place])
    return Strokes(np.array([values]), places, decision=np.array([decision]))


def _short(text: Any) -> str:
    text = (text.decode(errors="replace") if isinstance(text, bytes) else text).strip()
    return repr(text if len(text) <= 80 else text[:77] + "...")
