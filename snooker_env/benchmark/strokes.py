"""What did a player play, stroke by stroke? Kept as it is executed, packed for the file of a result, and played again from there.

A choice is kept in two bytes, each number of a box action in the four of its space, float32: the runner rounds to that before it plays.
In a file stand the first bytes of all strokes, then all second bytes and so on, compressed by zlib, in base64.
"""

import base64
import hashlib
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._check import refuse, refuse_what
from .._types import Bools
from ..tasks.discrete_actions import Choices


def dtype_of(actions: Any) -> np.dtype[Any]:
    """How strokes of these actions are kept, little-endian.

    Parameters
    ----------
    actions : Actions or Choices

    Returns
    -------
    numpy.dtype
    """
    return np.dtype("<u2" if isinstance(actions, Choices) else "<f4")


class Keeper:
    """A player whose strokes are kept as they are executed.

    Parameters
    ----------
    player : object
        With ``options`` and ``act``.
    n : int
        Number of tables.
    """

    frames = True

    def __init__(self, player: Any, n: int):
        self._player, self._n = player, n
        self._log: list[tuple[NDArray[Any], NDArray[Any]]] = []

    @property
    def options(self) -> dict[str, Any]:
        """Those of the player."""
        options: dict[str, Any] = self._player.options
        return options

    def act(self, tables: Any, observations: Any, going: Bools) -> NDArray[Any]:
        """The player's actions as they are kept and played. ValueError if one is not in the action space."""
        actions = tables.options.rules.actions
        played = actions.check_many(self._player.act(tables, observations, going), len(going)).astype(dtype_of(actions))
        self._log.append((np.flatnonzero(going), played[going]))
        return played

    def strokes(self) -> list[NDArray[Any]]:
        """What was played on each table, a row for each stroke."""
        if not self._log:
            return [np.empty((0, 1), np.uint8)] * self._n
        tables, played = (np.concatenate(part) for part in zip(*self._log, strict=True))
        ends = np.cumsum(np.bincount(tables, minlength=self._n))
        return np.split(played[np.argsort(tables, kind="stable")], ends[:-1])


class Repeater:
    """Plays the strokes that a file holds, and knows which episodes went on after their last one.

    Parameters
    ----------
    options : dict
        How they are read.
    strokes : list of arrays
        For each table, as ``Keeper.strokes`` returns them.
    """

    frames = True

    def __init__(self, options: dict[str, Any], strokes: list[NDArray[Any]]):
        self.options = options
        self.short: Bools = np.zeros(len(strokes), np.bool_)
        self._strokes, self._next = strokes, 0

    def act(self, tables: Any, observations: Any, going: Bools) -> NDArray[Any]:
        """The next stroke of each episode; zeros after the last."""
        actions = tables.options.rules.actions
        played = np.zeros((len(going), actions.size), dtype_of(actions))
        for k in np.flatnonzero(going).tolist():
            self.short[k] |= self._next >= len(self._strokes[k])
            if not self.short[k]:
                played[k] = self._strokes[k][self._next]
        self._next += 1
        return played


def packed(strokes: list[NDArray[Any]]) -> dict[str, str]:
    """The field ``strokes`` of a file.

    Parameters
    ----------
    strokes : list of arrays
        Of each episode.

    Returns
    -------
    dict of str
    """
    rows = [one for one in strokes if len(one)]
    raw = np.concatenate(rows).view(np.uint8).T.tobytes() if rows else b""
    return {"sha256": hashlib.sha256(raw).hexdigest(), "data": base64.b64encode(zlib.compress(raw, 9)).decode()}


def unpacked(given: dict[str, str], lengths: list[int], actions: Any) -> list[NDArray[Any]]:
    """The strokes of each episode from the field of a file. ValueError if they are damaged, or not in the action space.

    Parameters
    ----------
    given : dict of str
        The field.
    lengths : list of int
        How many strokes each episode has.
    actions : Actions or Choices
        How they are read.

    Returns
    -------
    list of arrays
    """
    kept, n = dtype_of(actions), sum(lengths)
    width = actions.size * kept.itemsize
    size = n * width
    try:
        packing = zlib.decompressobj()
        raw = packing.decompress(base64.b64decode(given["data"], validate=True), size + 1)
    except (zlib.error, ValueError) as error:
        raise refuse_what("strokes.data", f"{len(given['data']):,} characters", f"must be zlib in base64 ({error})") from None
    if len(raw) != size or not packing.eof or packing.unused_data:
        much = f"{len(raw):,} bytes" if packing.eof else f"more than {len(raw) - 1:,} bytes, or cut off"
        raise refuse_what("strokes.data", much, f"must be {size:,} bytes, {width} for each of {n:,} strokes")
    if hashlib.sha256(raw).hexdigest() != given["sha256"]:
        raise refuse("strokes.sha256", given["sha256"], f"must be {hashlib.sha256(raw).hexdigest()}, the digest of the strokes")
    played = np.frombuffer(raw, np.uint8).reshape(width, n).T.copy().view(kept).reshape(n, actions.size)
    try:
        actions.check_many(played, n)
    except ValueError as error:
        raise ValueError(f"strokes.data: {error}") from None
    return np.split(played, np.cumsum(lengths)[:-1]) if lengths else []
