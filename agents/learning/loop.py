"""How does every training run? Part by part, in rounds, until all parts are done or a signal arrives. A run that was stopped
anywhere and resumed ends with the same bits.

A part states its amount of work, plays and learns round by round, and asks between two rounds whether to continue. The run
is then saved if it is time, after a signal, and at the end of a part.
"""

import signal
import sys
import time
from collections.abc import Callable

import rich

from snooker_env.progress import Progress

LEAST, SHARE = 30.0, 0.01
"""Seconds that a kill may lose, and the largest share of time for saving (a checkpoint may hold 155 MB)."""


class Part:
    """One part of a training. A subclass has ``done`` and ``figures``, and either ``round`` or its own ``play``."""

    what, unit, now = "", "", "this round"
    """In words: the part's work, its unit, and the work to finish before the run is saved."""
    total = 0
    _spent, _began = 0.0, None

    @property
    def done(self) -> int:
        """The amount done of ``total``."""
        raise NotImplementedError

    @property
    def figures(self) -> str:
        """The progress of learning, in words."""
        return ""

    @property
    def seconds(self):
        """Duration so far [s], including the time before a resume."""
        return self._spent + (0.0 if self._began is None else time.perf_counter() - self._began)

    def begin(self):
        """Called once before the first round, also in a resumed run."""

    def round(self):
        """Play and learn."""
        raise NotImplementedError

    def play(self, rest: Callable[[], bool]):
        """Play rounds until all is done or ``rest``, called before each, returns False."""
        while self.done < self.total and rest():
            self.round()


class Stop:
    """Records SIGINT and SIGTERM, so that the run is saved after the current round. A second signal acts at once."""

    def __init__(self):
        self.signal = None
        self.now = "this round"
        """The work to finish before the run is saved, in words."""

    def __enter__(self):
        stops = signal.SIGINT, signal.SIGTERM
        self._before = {number: signal.signal(number, self._note) for number in stops}
        return self

    def __exit__(self, *error) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _note(self, number, frame):
        self.signal = number
        signal.signal(signal.SIGINT, signal.default_int_handler)
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        name = signal.Signals(number).name
        second = "(a second signal stops at once, without saving)"
        rich.get_console().print(f"\n{name}: saving after {self.now} ... {second}")


class Loop:
    """Runs the ``parts`` of a training called ``name``. ``save()`` saves the state, ``again`` is the command that continues,
    and ``more`` is the number of parts that follow."""

    def __init__(self, name, parts, save, again, more=0):
        self.name, self.again = name, again
        self._parts, self._save, self._many = parts, save, len(parts) + more

    def progress(self, what, total, unit, done=0, number=None):
        """The ``Progress`` of part ``number``, by default of the last one, which follows the learning."""
        head = f"{self.name}, part {number or self._many} of {self._many}" if self._many > 1 else self.name
        return Progress(f"{head}, {what}", total, unit, done=done, to=sys.stdout)

    def run(self):
        """Play all remaining parts. Returns the signal that stopped it, or None."""
        with Stop() as stop:
            for number, part in enumerate(self._parts, 1):
                if part.done < part.total:
                    self._play(number, part, stop)
                if stop.signal is not None:
                    print(f"Saved. {self.again}")
                    return stop.signal
        return None

    def _play(self, number, part, stop):
        stop.now, part._began = part.now, time.perf_counter()
        part.begin()
        last, cost = time.perf_counter(), 0.0
        with self.progress(part.what, part.total, part.unit, part.done, number) as progress:

            def rest():
                nonlocal last, cost
                progress.at(part.done, part.figures)
                now = time.perf_counter()
                if stop.signal is not None or now - last > max(LEAST, cost / SHARE):
                    self._save()
                    last = time.perf_counter()
                    cost = last - now
                return stop.signal is None

            part.play(rest)
            progress.at(part.done, part.figures)
        part._spent, part._began = part.seconds, None
        if part.done >= part.total:
            self._save()
