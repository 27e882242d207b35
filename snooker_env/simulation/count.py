"""How many shots has this process simulated? One counter; a shot that is simulated again with a longer log counts once."""

import threading

_LOCK, _SHOTS = threading.Lock(), 0


def count(shots: int) -> None:
    """Add a number of shots; safe in any thread."""
    global _SHOTS
    with _LOCK:
        _SHOTS += shots


def count_shots() -> int:
    """Count the shots that this process has simulated so far.

    Returns
    -------
    int
        Their number: read it before and after a decision. Single impacts are no shots.

    Examples
    --------
    >>> import numpy as np
    >>> import snooker_env as sn
    >>> from snooker_env.benchmark import count_shots
    >>> before = count_shots()
    >>> _ = sn.simulate(np.zeros((1, 2)), np.array([[1.0, 0.0]]), np.zeros((1, 3)))
    >>> count_shots() - before
    1
    """
    return _SHOTS
