"""Planning: play many strokes on copies of positions, under given noise samples; find strokes by geometry.

A planner works in two steps:

1. Find strokes: ``pots``, ``action_masks``, ``obstructions``, ``clear_paths``, ``pot_aim``. A stroke is five
   numbers in SI: cue speed, side, top, direction of the cue ball, elevation. ``Planner.strokes_of`` and
   ``Planner.actions_of`` decode and encode actions.
2. Play them: ``Planner.play`` returns points and afterstates; ``Planner.stops`` also returns where each ball
   stopped.

The caller assigns a value to each afterstate. ``prospects_of`` is a rule of thumb for that.

>>> import snooker_env as sn
>>> from snooker_env.planning import Planner, Position, pots
>>> position = Position(cue=(0.0, 0.0), reds=[(0.5, 0.8)], black=(0.0, 1.4605), on="red")
>>> int(pots(position).ball[0, 0])
1
>>> planner = Planner({"action": "discrete", "noise": "club"})
>>> outcomes = planner.play(position, rows=[0, 0], actions=[67, 67], keys=[1, 2])
>>> len(outcomes.afterstates), outcomes.observations.shape
(2, (2, 121))
"""

from ..tasks.threads import processors
from .geometry import Paths, Pots, clear_paths, obstructions, pots
from .planner import Outcomes, Planner
from .position import Position
from .positions import Positions
from .proposals import Proposals, at_balls, at_pots, over_cushions, safeties, spread_strokes, strokes_at
from .prospects import RULE_OF_THUMB, SURE, prospects_of, spread_of
from .sobol import sobol_points
from .stroke_search import Ranked, StrokeSearch
from .strokes import Stops, action_masks, actions_of, as_actions, pot_aim

__all__ = [
    "RULE_OF_THUMB",
    "SURE",
    "Outcomes",
    "Paths",
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
    "at_balls",
    "at_pots",
    "clear_paths",
    "obstructions",
    "over_cushions",
    "pot_aim",
    "pots",
    "processors",
    "prospects_of",
    "safeties",
    "sobol_points",
    "spread_of",
    "spread_strokes",
    "strokes_at",
]
