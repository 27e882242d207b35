"""How far is a long command? Said every few seconds: in lines, or on a terminal in one rewritten line."""

import shutil
import sys
import threading
import time
from collections import deque
from typing import TextIO

__all__ = ["Progress"]

EVERY = 10.0  # seconds between two lines of a file or pipe
REDRAWN = 0.5  # seconds between two states of the line on a terminal
BAR = 20  # characters of the bar on a terminal
RECENT = 5.0  # fewest seconds over which a rate is measured


class Progress:
    """What a part of a long command does, how far it is, how fast, and how long it still takes.

    A thread speaks at the start, every ten seconds (on a terminal twice a second) and at the end, also while
    one step takes long. The time left follows from the rate in the later half of the time so far.

    Parameters
    ----------
    what, total, unit
        The work, in words; how much of it there is; and of what, in the plural.
    done : int
        How much was done before, by a run that is resumed.
    to : text stream, optional
        Default None: ``sys.stderr``.
    quiet : bool
        Whether to say nothing.

    Examples
    --------
    >>> import sys
    >>> from snooker_env.progress import Progress
    >>> with Progress("self-play", 4, "frames", to=sys.stdout) as progress:
    ...     for frame in range(4):
    ...         progress.at(frame + 1, "lead 3.2")  # doctest: +ELLIPSIS
    self-play: 0 of 4 frames
    self-play: 4 of 4 frames, lead 3.2, ... frames/s, 0:00 elapsed
    """

    done: int
    total: int

    def __init__(
        self,
        what: str,
        total: int,
        unit: str,
        *,
        done: int = 0,
        to: TextIO | None = None,
        quiet: bool = False,
    ):
        self.done, self.total = done, total
        self._what, self._unit, self._figures = what, unit, ""
        self._to: TextIO | None = None if quiet else to or sys.stderr
        self._terminal = self._to is not None and self._to.isatty()
        self._began = time.perf_counter()
        self._measured = deque([(self._began, done)])
        self._first = done
        self._error: Exception | None = None
        self._ended = threading.Event()
        self._speaker = threading.Thread(target=self._keep_saying, daemon=True, name="progress")

    def __enter__(self) -> "Progress":
        if self._to is not None:
            self._write(self._state())
            self._speaker.start()
        return self

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        if self._to is None:
            return
        self._ended.set()
        self._speaker.join()
        if self._error is None and (self._terminal or self.done != self._first or self._figures):
            elapsed = time.perf_counter() - self._began
            mean = (self.done - self._first) / max(elapsed, 1e-9)
            self._write(self._state(self._speed(mean), f"{_clock(elapsed)} elapsed"), last=True)
        if self._error is not None and error is None:
            raise self._error

    def at(self, done: int, figures: str = "") -> None:
        """Note how much is done, and ``figures`` to say with it. OSError if the output takes no more."""
        if self._error is not None:
            raise self._error
        now, measured = time.perf_counter(), self._measured
        self.done, self._figures = done, figures
        measured.append((now, done))
        since = now - max(RECENT, 0.5 * (now - self._began))
        while len(measured) > 2 and measured[1][0] <= since:
            measured.popleft()

    @property
    def rate(self) -> float:
        """How much a second, in the later half of the time so far; 0 before anything is done."""
        (began, before), (ended, done) = self._measured[0], self._measured[-1]
        return (done - before) / (ended - began) if ended > began else 0.0

    @property
    def left(self) -> float:
        """Seconds that the rest takes at this rate; infinite before anything is done."""
        if self.rate <= 0.0:
            return float("inf")
        return max(0.0, (self.total - self.done) / self.rate - (time.perf_counter() - self._measured[-1][0]))

    def _keep_saying(self):
        while self._error is None and not self._ended.wait(REDRAWN if self._terminal else EVERY):
            left, elapsed = self.left, f"{_clock(time.perf_counter() - self._began)} elapsed"
            still = "" if left == float("inf") else f"{_clock(left)} left"
            self._write(self._state(self._speed(self.rate), elapsed, still))

    def _state(self, *times):
        """The line: work, figures, and on a terminal first the times: it may be cut."""
        work = f"{self._what}: {self.done:,} of {self.total:,} {self._unit}"
        parts = (work, self._figures, *times)
        if self._terminal and not self._ended.is_set() and times:
            speed, elapsed, left = times
            parts = (left, work, elapsed, speed, self._figures)
        return ", ".join(part for part in parts if part)

    def _speed(self, rate):
        digits = 0 if rate >= 10.0 else 1 if rate >= 1.0 else 2
        return f"{rate:,.{digits}f} {self._unit}/s" if rate > 0.0 else ""

    def _write(self, text, last=False):
        """Write a line; the error of an output that takes no more is kept for ``at`` to raise."""
        if self._terminal:
            width = shutil.get_terminal_size().columns - 1
            full = round(BAR * self.done / max(self.total, 1))
            drawn = f"[{'#' * full:.<{BAR}}] {text}"
            text = f"\r{' ' * width}\r{text}\n" if last else f"\r{drawn[:width]:{width}}"
        else:
            text += "\n"
        assert self._to is not None
        try:
            self._to.write(text)
            self._to.flush()
        except (OSError, ValueError) as error:
            self._error = error


def _clock(seconds):
    """A duration as h:mm:ss, or m:ss below an hour."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"
