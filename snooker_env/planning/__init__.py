"""Planning: play many strokes on copies of positions, under given noise samples; find strokes by geometry.

A planner works in two steps:

1. Find strokes: ``pots``, ``action_masks``, ``obstructions``, ``clear_paths``, ``pot_aim``. A stroke is five
   numbers in SI: cue speed, side, top, direction of the cue ball, elevation. ``Planner.strokes_of`` and
   ``Planner.actions_of`` decode and encode actions.
2. Play them: ``Planner.play`` returns points and afterstates; ``Planner.stops`` also returns where each ball
   stopped.

The caller assigns a value to each afterstate. ``prospects_of`` is a rule of thumb for that.
"""

from ..tasks.threads import processors
from .geometry import Pots, clear_paths, obstructions, pots
from .planner import Outcomes, Planner
from .position import Position
from .positions import Positions
from .proposals import Proposals, at_pots
from .prospects import RULE_OF_THUMB, SURE, prospects_of, spread_of
from .stroke_search import Ranked, StrokeSearch
from .strokes import Stops, action_masks, actions_of, as_actions, pot_aim

__all__ = [
    "RULE_OF_THUMB",
    "SURE",
    "Outcomes",
    "Planner",
    "Position",
    "Positions",
    "Pots",
    "Proposals",
    "Ranked",
    "Stops",
    "StrokeSearch",
    "action_masks",
    "actions_of",
    "as_actions",
    "at_pots",
    "clear_paths",
    "obstructions",
    "pot_aim",
    "pots",
    "processors",
    "prospects_of",
    "spread_of",
]
