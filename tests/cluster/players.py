"""Which players do the tests of the cluster send? Some note what they play, others fail at it."""

import os
import time
from dataclasses import fields
from pathlib import Path

import numpy as np


def note(decision, n):
    """Note this process and its decision for n tables in the file of $NOTED, and take the time of $SLOW for it.

    If the file of $HANGS is there, a node with $DIES says so in it and hangs, to be killed; the others wait."""
    if "NOTED" in os.environ:
        with Path(os.environ["NOTED"]).open("a") as file:
            file.write(f"{os.getpid()} {decision} {n}\n")
        time.sleep(float(os.environ.get("SLOW", "0")))
    hangs, began = Path(os.environ.get("HANGS", "none")), time.monotonic()
    if hangs.exists() and "DIES" in os.environ:
        hangs.write_text(str(os.getpid()))
    while hangs.exists() and time.monotonic() - began < 60:
        if "DIES" not in os.environ and hangs.read_text():
            break
        time.sleep(0.05)


AT = {
    "layout": "held_out",
    "noise": "professional",
    "fidelity": "standard",
    "physics": "paper",
    "cue": "real",
}


def same(a, b):
    """Whether two plays are alike in all that does not measure time."""
    names = [f.name for f in fields(a) if f.name not in ("decision_seconds", "simulated")]
    return all(np.array_equal(getattr(a, name), getattr(b, name), equal_nan=name == "cue") for name in names)


class Noted:
    """Plays one soft stroke a table, slowly, and notes each decision."""

    options = {"action": "discrete"}  # noqa: RUF012 - read, never changed

    def __init__(self):
        self._decisions = 0

    def act(self, observations, masks, seeds):
        note(self._decisions, len(seeds))
        self._decisions += 1
        return np.full(len(seeds), 20)


class Failing(Noted):
    """Has an error of its own."""

    def act(self, observations, masks, seeds):
        raise RuntimeError("a fault of mine")


class Deadly(Noted):
    """Ends its process, as the kernel does with one that takes too much memory."""

    def act(self, observations, masks, seeds):
        os.kill(os.getpid(), 9)
