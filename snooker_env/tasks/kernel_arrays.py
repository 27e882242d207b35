"""What do the kernels of tasks take? Arrays of tables, shots and a step's results, dynamics, and work space. Python hands
over plain tuples, which a kernel names: a named tuple takes 0.7 us more, and each array 0.1 us."""

from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .._lib.types import Bools, Floats, Ints, Singles, Words
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


class TableArrays(NamedTuple):
    """n tables, as ``Tables`` has them."""

    positions: Floats
    on_table: Bools
    game: Ints
    streams: Words
    nominated: Ints


class StruckArrays(NamedTuple):
    """Shots before they are played, as ``ShotBuffers`` has them."""

    r: Floats
    v: Floats
    w: Floats
    aloft: Floats
    here: Bools
    shots: Floats
    kicks: Floats


class PlayedArrays(NamedTuple):
    """Shots that came to rest, as ``ShotBuffers`` has them."""

    r: Floats
    aloft: Floats
    shots: Floats
    seen: Ints
    potted: Ints
    status: Ints
    duration: Floats
    event_time: Floats
    event_what: NDArray[np.int32]
    n_events: Ints


class OutputArrays(NamedTuple):
    """The results of a step, as ``StepOutput`` has them."""

    observations: Singles
    rewards: Floats
    terminated: Bools
    truncated: Bools
    reals: Floats
    counts: Ints


class CueLaw(NamedTuple):
    """How the cue strikes, and how balls move and collide."""

    phys: Floats  # packed ``Physics``
    end_mass_ratio: float
    fidelity: int  # this and the next as ``parse_fidelity`` returns them
    n_steps: int
    max_offset: float  # of the tip, over R
    rails: Floats  # as in a cue's row


class Work(NamedTuple):
    """Work space of the kernels that seek a line of the cue ball; ``lines.new_work`` makes it."""

    lines: Floats  # (LINE_ROWS, POT_COLUMNS): the pots or lines of a table, and windows
    motion: Floats  # (2, cloth.COLUMNS)
    state: Ints  # (2,) phases of two balls
    series: Floats  # of the solution of an impact
