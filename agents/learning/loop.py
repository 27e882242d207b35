"""How does every training run? Part after part in rounds, until all are done or a signal comes; stopped anywhere and resumed,
it ends with the same bits.

A part says how much it has to do, plays and learns round by round, and asks between two rounds whether to go on. What is
saved then is all that going on needs: by the clock, after a signal, and at the end of a part.
"""

import signal
import sys
import time
from collections.abc import Callable

import rich

from snooker_env.progress import Progress

LEAST, SHARE = 30.0, 0.01
"""Seconds that a kill may lose, and the largest share of the time for saving: a checkpoint may hold 155 MB."""


class Part:
    """One part of a training. A subclass has ``done`` and ``figures``, and ``round`` or a ``play`` of its own."""

    what, unit, now = "", "", "this round"
    """What it does, of what it does so much, and the work that is finished before the run is saved; in words."""
    total = 0
    _spent, _began = 0.0, None

    @property
    def done(self) -> int:
        """How much of ``total``."""
        raise NotImplementedError

    @property
    def figures(self) -> str:
        """How it learns, in words."""
        return ""

    @property
    def seconds(self):
        """Duration so far [s], with the time before a resume."""
        return self._spent + (0.0 if self._began is None else time.perf_counter() - self._began)

    def begin(self):
        """Called once before the first round, also of a resumed run."""

    def round(self):
        """Play and learn."""
        raise NotImplementedError

    def play(self, rest: Callable[[], bool]):
        """Rounds until all is done or ``rest``, called before each, says no."""
        while self.done < self.total and rest():
            self.round()


class Stop:
    """Notes SIGINT and SIGTERM: the run is saved after the current round. A second one acts at once."""

    def __init__(self):
        self.signal = None
        self.now = "this round"
        """The work that is finished before the run is saved, in words."""

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
    """Runs the ``parts`` of a training called ``name``. ``save()`` keeps what going on needs, ``again`` is the command that
    goes on; ``more``: how many parts follow."""

    def __init__(self, name, parts, save, again, more=0):
        self.name, self.again = name, again
        self._parts, self._save, self._many = parts, save, len(parts) + more

    def progress(self, what, total, unit, done=0, number=None):
        """The ``Progress`` of part ``number``; by default of the last one, which follows those of learning."""
        head = f"{self.name}, part {number or self._many} of {self._many}" if self._many > 1 else self.name
        return Progress(f"{head}, {what}", total, unit, done=done, to=sys.stdout)

    def run(self):
        """Play all parts that are left. The signal that stopped it, or None."""
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
