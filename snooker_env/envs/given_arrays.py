"""Which arrays may a step write its results into? Checks the argument ``out`` of the vector environment."""

from collections.abc import Collection, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._check import choice, refuse, refuse_what

OUTPUTS = {
    "observations": "observations",
    "rewards": "rewards",
    "terminations": "terminated",
    "truncations": "truncated",
}
"""Results that a step can write into given arrays, and their names in ``StepOutput``."""
DTYPES: dict[str, type[np.generic]] = {
    "observations": np.float32,
    "rewards": np.float64,
    "terminations": np.bool_,
    "truncations": np.bool_,
}


def arrays_given(
    out: Any, names: Collection[str], n: int, size: int, boxes: Mapping[str, Any] | None
) -> dict[str, NDArray[Any]]:
    """The given arrays of n tables, by their names in ``StepOutput``; ``size``: numbers in a flat
    observation.

    ``boxes``: the spaces of the parts of dict observations, which are written later; None for flat
    observations. Raises ValueError for an array that results cannot be written into.
    """
    if out is None:
        return {}
    if not isinstance(out, dict):
        raise refuse("out", type(out).__name__, f"must be None or a dict of {', '.join(names)}")
    for name in out:
        choice("out", name, names)
    found = {}
    for name, a in out.items():
        if name == "observations" and boxes is not None:
            if not isinstance(a, dict) or set(a) != set(boxes):
                raise refuse(
                    'out["observations"]',
                    type(a).__name__,
                    "must be a dict of " + " and ".join(f'"{part}"' for part in boxes),
                )
            for part, box in boxes.items():
                _check_out(f"observations.{part}", a[part], box.shape, box.dtype.type)
            continue
        if any(np.may_share_memory(a, other) for other in found.values()):
            raise refuse_what(
                f'out["{name}"]', "an array", "must not share memory with another one that is given"
            )
        found[OUTPUTS[name]] = _check_out(
            name, a, (n, size) if name == "observations" else (n,), DTYPES[name]
        )
    return found


def _check_out(name: str, a: Any, shape: tuple[int, ...], dtype: type[np.generic]) -> NDArray[Any]:
    """The array ``out[name]``; ValueError unless results can be written directly into it."""
    fits = isinstance(a, np.ndarray) and a.shape == shape and a.dtype == dtype
    if not fits or not (a.flags.c_contiguous and a.flags.writeable and a.flags.aligned):
        found = f"array of {a.dtype} and shape {a.shape}" if isinstance(a, np.ndarray) else type(a).__name__
        raise refuse_what(
            f'out["{name}"]',
            found,
            f"must be a C-contiguous, writeable array of {np.dtype(dtype)} and shape {shape}",
        )
    return a
