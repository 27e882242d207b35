"""Advice: the strokes that a player would play in a position, and their outcomes, as data and in words.

>>> import snooker_env as sn
>>> position = sn.Position(cue=(0.25, 0.6), reds=[(-0.4, 1.3)], black=(0.0, 1.4605), on="red")
>>> advice = sn.advise(position, n=2, samples=40, visits=8)
>>> print(advice[0].words)  # doctest: +ELLIPSIS
red, top left, ... m/s, ..., pot ... %, ... points expected

In words the ``snooker_env.POCKETS`` are called green pocket, yellow pocket, right middle, top right, top left
and left middle. Left and right are as seen from the baulk end: right is the yellow side (+x).
"""

from .ask import advise, stroke_of
from .coach import Coaching, Drill, coach
from .destinations import Destinations, destinations
from .errors import Estimate, PlayerErrors, estimate_errors
from .recorded import Recorded, read_strokes, strokes_of, write_strokes
from .room import Room
from .strokes import Advice, CueStroke, Suggestion
from .words import POCKET_WORDS

__all__ = [
    "POCKET_WORDS",
    "Advice",
    "Coaching",
    "CueStroke",
    "Destinations",
    "Drill",
    "Estimate",
    "PlayerErrors",
    "Recorded",
    "Room",
    "Suggestion",
    "advise",
    "coach",
    "destinations",
    "estimate_errors",
    "read_strokes",
    "stroke_of",
    "strokes_of",
    "write_strokes",
]
