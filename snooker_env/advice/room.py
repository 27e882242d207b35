"""Does the cue have room for a stroke? ``Room``: how a stroke is played over rails and balls."""

from dataclasses import asdict, dataclass
from math import degrees
from typing import Any

import numpy as np

from .._lib.types import Floats
from ..game.balls import NAMES
from ..physics.conditions import END_MASS_RATIO
from ..physics.cue_room import MOVED, OVER_NOTHING, OVER_RAIL, RAISED, UNPLAYABLE, in_room_over
from ..planning import Positions
from ..tasks.options import Rules

RAIL = "rail"  # what is in the way if no ball is


@dataclass(frozen=True, kw_only=True)
class Room:
    """How the cue finds room for a stroke, execution errors apart; ``Suggestion`` describes the fields."""

    elevation: float
    side: float
    top: float
    raised: bool
    moved: bool
    unplayable: bool
    over: str | None
    behind: float  # 0 if there is nothing in the way

    @property
    def words(self) -> str:
        """What the cue does for room, in words; "" for nothing, and for less than half a degree."""
        what = self.over and ("a red" if self.over.startswith("red") else f"the {self.over}")
        over = f" over {what}" if what else ""
        if self.unplayable:
            return f"no room for the cue{over}: nobody can play it, raised to {degrees(self.elevation):.0f} degrees"
        parts = []
        if self.raised and degrees(self.elevation) >= 0.5:
            parts.append(f"cue raised to {degrees(self.elevation):.0f} degrees{over}")
        if self.moved:
            tip = f"{abs(self.top):.2f} {'above' if self.top >= 0.0 else 'below'} the middle"
            aside = f", {abs(self.side):.2f} {'right' if self.side > 0 else 'left'}" if self.side else ""
            parts.append(f"tip moved to {tip}{aside}{'' if parts else over}")
        return ", ".join(parts)

    def to_dict(self) -> dict[str, Any]:
        """Return the fields and the words as JSON types."""
        return asdict(self) | {"words": self.words}


def room_for(stroke: Floats, at: Positions, rules: Rules) -> Room:
    """The room for a stroke in the one position ``at``: float64 (5,) as of ``CueStroke.numbers``."""
    physics, tables = rules.physics, at.conditions if rules.drawn else None
    ratio = physics.end_mass_ratio if tables is None else float(tables[0, END_MASS_RATIO])
    # kernels are compiled for arrays that can be written
    places, present, rails = at.positions[0].copy(), at.on_table[0].copy(), np.array(rules.rails)
    numbers = map(float, (physics.R, physics.max_offset, ratio))
    played, done, over, behind = in_room_over(tuple(stroke.tolist()), places, present, rails, *numbers)
    _, side, top, _, elevation = played
    bits = {"raised": RAISED, "moved": MOVED, "unplayable": UNPLAYABLE}
    found: Any = {name: bool(done & bit) for name, bit in bits.items()}
    found["over"] = None if over == OVER_NOTHING else RAIL if over == OVER_RAIL else NAMES[over]
    return Room(elevation=elevation, side=side, top=top, behind=behind, **found)
