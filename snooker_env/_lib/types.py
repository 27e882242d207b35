"""Which types do the annotations share? An annotation says what an array holds; docstrings say its shape."""

from collections.abc import Sequence
from typing import Any, Literal, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

# What the package returns and stores.
Floats: TypeAlias = NDArray[np.float64]
Singles: TypeAlias = NDArray[np.float32]
Ints: TypeAlias = NDArray[np.int64]
Words: TypeAlias = NDArray[np.uint64]
Bytes: TypeAlias = NDArray[np.uint8]
Bools: TypeAlias = NDArray[np.bool_]
Masks: TypeAlias = NDArray[np.int8]  # available choices as observations hold them: 1 or 0

# What callers may pass: arrays, or nested sequences with as many levels as the array would have dimensions. A
# str is none of these.
Real: TypeAlias = float | np.floating[Any] | np.integer[Any]
RealArray: TypeAlias = NDArray[np.floating[Any] | np.integer[Any]]
Vector: TypeAlias = RealArray | Sequence[Real]
Vectors: TypeAlias = RealArray | Sequence[Vector]  # of two dimensions: (n, k)
Batches: TypeAlias = RealArray | Sequence[Vectors]  # of three dimensions: (b, n, k)
Scalars: TypeAlias = Real | Vector  # one number for all, or one for each: shape () or (n,)
Integers: TypeAlias = NDArray[np.integer[Any]] | Sequence[int | np.integer[Any]]
Flag: TypeAlias = bool | np.bool_
Flags: TypeAlias = Bools | Sequence[Flag]
FlagRows: TypeAlias = Bools | Sequence[Flags]  # of two dimensions: (b, n)
Place: TypeAlias = tuple[float, float]  # x and y [m]

# Names.
Fidelity: TypeAlias = Literal["fast", "standard", "reference"] | str
"""How impacts are solved. Any str is allowed: ``"euler:N"`` is the paper's own scheme with N steps."""
Solver: TypeAlias = tuple[int, int]  # a fidelity as the kernels read it: a code, and the N of "euler:N" or 0
PhysicsName: TypeAlias = Literal["paper", "match", "carom"]
TableName: TypeAlias = Literal["match", "tight", "uk8", "pool9", "carom"]
NoiseName: TypeAlias = Literal["none", "professional", "amateur", "club", "beginner", "robot", "olympiad"]
ObservationKind: TypeAlias = Literal["pots", "strokes", "flat", "balls", "masked"]
RenderMode: TypeAlias = Literal["human", "rgb_array", "ansi"]
MissRule: TypeAlias = Literal["off", "clear_path", "attempt"]
CueKind: TypeAlias = Literal["free", "real"]

# These depend on an environment's options, so that no annotation can say more.
Action: TypeAlias = Any  # for a Box an array or sequence of numbers (k,), for ``action="discrete"`` an int
Observation: TypeAlias = Any
"""float32 (k,) with ``observation="pots"`` or "flat"; with "balls" a dict of float32 arrays, "balls" (22, 5) and
"state" (k,); with "masked" a dict of "observations", float32 (k,), and "action_mask", int8 (choices,)."""


class Environment(Protocol):
    """Any environment of Gymnasium, PettingZoo or Stable-Baselines3, wrapped or not."""

    @property
    def unwrapped(self) -> Any:
        """The environment below all wrappers."""
