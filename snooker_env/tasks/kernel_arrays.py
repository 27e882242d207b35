"""What do the kernels of tasks take? Arrays of tables, shots and a step's results, dynamics, and work space. Python hands
over plain tuples, which a kernel names: a named tuple takes 0.7 us more, and each array 0.1 us."""

from collections import namedtuple
from typing import NamedTuple, TypeAlias

import numpy as np

from .._lib.types import Floats
from ..physics.parameters import Physics

# Columns of a cue's row: one row for all tables, or one for each.
C_END_MASS = 0  # ``Physics.end_mass_ratio``
C_MAX_OFFSET = 1  # ``Physics.max_offset``
C_MU_S = 2  # ``Physics.mu_s``: what a ball that a raised cue strikes rubs against
C_E_T = 3  # ``Physics.bed_restitution``
C_RAILS = 4  # from here on the rails that it passes over (``cue_room.rails_of``); none: it is free


def pack_cue(physics: Physics, rails: Floats) -> Floats:
    """A cue's row for the kernels: float64 (4 + len(rails),), in the columns ``C_*``."""
    law = physics.end_mass_ratio, physics.max_offset, physics.mu_s, physics.bed_restitution
    return np.array([*law, *rails])


Packed: TypeAlias = tuple[Floats, Floats, Floats, Floats]
"""An action's options, of ``declarations``; rows of cues, one or one a table; the noise's deviations; rows of packed
``Physics``, likewise."""


TableArrays = namedtuple("TableArrays", "positions on_table game streams nominated")
"""n tables, as ``Tables`` has them."""
StruckArrays = namedtuple("StruckArrays", "r v w aloft here shots kicks")
"""Shots before they are played, as ``ShotBuffers`` has them."""
PlayedArrays = namedtuple(
    "PlayedArrays", "r aloft shots seen potted status duration event_time event_what n_events"
)
"""Shots that came to rest, as ``ShotBuffers`` has them."""
OutputArrays = namedtuple("OutputArrays", "observations rewards terminated truncated reals counts")
"""The results of a step, as ``StepOutput`` has them."""


class CueLaw(NamedTuple):
    """How the cue strikes, and how balls move and collide."""

    phys: Floats  # packed ``Physics``
    end_mass_ratio: float
    fidelity: int  # this and the next as ``parse_fidelity`` returns them
    n_steps: int
    max_offset: float  # of the tip, over R
    rails: Floats  # as in a cue's row


Work = namedtuple("Work", "lines motion state series")
"""Work space of the kernels that seek a line, of ``lines.new_work``: pots or lines, and windows (LINE_ROWS, POT_COLUMNS); motion
(2, cloth.COLUMNS) and phases (2,) of two balls; the solution of an impact."""
