"""Advice: the strokes that a player would play in a position, and their outcomes, as data and in words.

In words the ``snooker_env.POCKETS`` are called green pocket, yellow pocket, right middle, top right, top left
and left middle. Left and right are as seen from the baulk end: right is the yellow side (+x)."""

from ..players.cue_stroke import CueStroke
from .ask import advise
from .coach import coach
from .outcomes import Suggestion, destinations
from .recorded import Recorded, read_strokes, write_strokes
from .stroke_words import POCKET_WORDS

__all__ = [
    "POCKET_WORDS",
    "CueStroke",
    "Recorded",
    "Suggestion",
    "advise",
    "coach",
    "destinations",
    "read_strokes",
    "write_strokes",
]
