"""Which players do the tests of the cluster send? One that writes down what it plays, one that needs too much, one that fails."""

import os
import time
from pathlib import Path

import numpy as np


class Noted:
    """Plays one soft stroke a table, slowly, and notes each decision's process in the file of $NOTED."""

    options = {"action": "discrete"}  # noqa: RUF012 - read, never changed

    def __init__(self):
        self._decisions = 0

    def act(self, tables, observations, going):
        if "NOTED" in os.environ:
            with Path(os.environ["NOTED"]).open("a") as file:
                file.write(f"{os.getpid()} {self._decisions} {len(going)}\n")
            time.sleep(float(os.environ.get("SLOW", "0")))
        self._decisions += 1
        return np.full(len(going), 20)


class Failing(Noted):
    """Has an error of its own."""

    def act(self, tables, observations, going):
        raise RuntimeError("a fault of mine")


class Greedy(Noted):
    """Its memory is at an end."""

    def act(self, tables, observations, going):
        raise MemoryError


class Deadly(Noted):
    """Ends its process, as the kernel does with one that takes too much memory."""

    def act(self, tables, observations, going):
        os.kill(os.getpid(), 9)


class Full(Noted):
    """Finds the disk full."""

    def act(self, tables, observations, going):
        raise OSError(28, "No space left on device", "/scratch/x")
