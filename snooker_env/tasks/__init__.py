"""Tasks: strokes of visits and frames. Public here: what actions, observations and execution errors mean."""

from .box_actions import MAX_SPEED, MIN_SPEED
from .discrete_actions import POTS, SIDES, SPEEDS, STROKES, TOPS, choice_of
from .discrete_actions import SIZE as CHOICES
from .noise import LEVELS, Noise
from .observations import OBSERVATIONS, STATE_ENTRIES
from .observations import SIZE as OBSERVATION_SIZE

__all__ = [
    "CHOICES",
    "LEVELS",
    "MAX_SPEED",
    "MIN_SPEED",
    "OBSERVATIONS",
    "OBSERVATION_SIZE",
    "POTS",
    "SIDES",
    "SPEEDS",
    "STATE_ENTRIES",
    "STROKES",
    "TOPS",
    "Noise",
    "choice_of",
]
