"""Planning: play many strokes on copies of positions, under given noise samples; find strokes by geometry.

A planner works in two steps:

1. Find strokes: ``pots``, ``action_masks``, ``obstructions``, ``clear_paths``, ``pot_aim``. A stroke is five
   numbers in SI: cue speed, side, top, direction of the cue ball, elevation. ``Strokes.actions`` encodes strokes as
   actions, ``Planner.strokes_of`` decodes actions.
2. Play them: ``Planner.play`` plays actions, ``Planner.play_strokes`` strokes; both return points, afterstates and
   where each ball stopped.

The caller assigns a value to each afterstate, for example by the rule of thumb ``prospects_of``. ``Search`` combines these
steps and returns the best strokes by a judge, of visits (``VisitJudge``) or of frames (``FrameJudge``).
"""

from ..tasks.pot_chance import RULE_OF_THUMB, SURE
from ..tasks.threads import processors
from .aims import pot_aim
from .frame_judge import FrameJudge
from .planner import Outcomes, Planner
from .position import Position
from .positions import Positions
from .pot_geometry import Pots, clear_paths, obstructions, pots
from .proposals import Proposals, at_pots
from .prospects import prospects_of
from .search import Ranked, Search
from .strokes import Strokes, action_masks
from .visit_judge import VisitJudge

__all__ = [
    "RULE_OF_THUMB",
    "SURE",
    "FrameJudge",
    "Outcomes",
    "Planner",
    "Position",
    "Positions",
    "Pots",
    "Proposals",
    "Ranked",
    "Search",
    "Strokes",
    "VisitJudge",
    "action_masks",
    "at_pots",
    "clear_paths",
    "obstructions",
    "pot_aim",
    "pots",
    "processors",
    "prospects_of",
]
