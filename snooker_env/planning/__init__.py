"""Planning: find strokes by geometry, play many on copies of positions under given noise samples, search for the best.

A stroke is five numbers in SI, see ``Planner``. What positions are worth is said by a judge, a value or ``prospects_of``."""

from ..tasks.pot_chance import RULE_OF_THUMB, SURE
from ..tasks.threads import processors
from .judges import FrameJudge, VisitJudge
from .planner import Outcomes, Planner
from .position import Position
from .positions import Positions
from .pot_geometry import clear_paths, pots, prospects_of
from .proposals import at_pots
from .search import Ranked, Search
from .strokes import Strokes, action_masks

__all__ = [
    "RULE_OF_THUMB",
    "SURE",
    "FrameJudge",
    "Outcomes",
    "Planner",
    "Position",
    "Positions",
    "Ranked",
    "Search",
    "Strokes",
    "VisitJudge",
    "action_masks",
    "at_pots",
    "clear_paths",
    "pots",
    "processors",
    "prospects_of",
]
