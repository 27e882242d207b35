"""Which tables does a reset begin anew, and with which seeds? The arguments of the vector environment's ``reset``, checked."""

from typing import Any

import numpy as np

from .._check import refuse, refuse_what
from .._types import Bools


def seeds_of(seed: Any, n: int) -> list[int | None]:
    """A seed for each of n tables, or None, of what ``SyncVectorEnv.reset`` takes."""
    if seed is None:
        return [None] * n
    if isinstance(seed, (int, np.integer)):
        return [int(seed) + k for k in range(n)]
    if len(seed) != n:
        raise refuse_what("seed", f"{len(seed)} seeds", f"must be an int, None, or {n} of them")
    return list(seed)


def mask_of(options: dict[str, Any], n: int) -> Bools:
    """Which of n tables are meant: (n,), all without "reset_mask"."""
    if "reset_mask" not in options:
        return np.ones(n, np.bool_)
    mask = options["reset_mask"]
    if not isinstance(mask, np.ndarray) or mask.shape != (n,) or mask.dtype != np.bool_ or not mask.any():
        raise refuse('options["reset_mask"]', mask, f"must be a bool array of shape ({n},), not all False")
    return mask.copy()


def states_of(options: dict[str, Any], n: int) -> tuple[list[Any] | tuple[Any, ...], int] | None:
    """The states to start n tables from, not checked yet, and for how many tables each is; None without any."""
    if "state" in options:
        return [options["state"]], n
    if "states" not in options:
        return None
    states = options["states"]
    if not isinstance(states, list | tuple) or len(states) != n:
        found = f"{type(states).__name__} of {len(states)}" if isinstance(states, list | tuple) else type(states).__name__
        raise refuse_what('options["states"]', found, f"must be a list of {n} states")
    return states, 1
