"""What is one stroke? ``CueStroke``: speed, tip, aim, elevation and, with the cue ball in hand, its place; checked, and as an action."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from math import hypot, pi, sqrt
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .._check import array, choice, number, refuse_what
from .._types import Place
from ..game.in_hand import within_d
from ..geometry import BAULK_Y, D_RADIUS
from ..tasks.box_actions import MAX_ELEVATION, MAX_SPEED, MIN_SPEED

FARTHEST = 0.5
"""How far off the middle the tip may meet the ball, over R: the miscue limit, the end of the scale of an action."""
(SPEED, SIDE, TOP, AIM, ELEVATION) = range(5)
"""Columns of strokes as rows of numbers."""


@dataclass(frozen=True, kw_only=True)
class CueStroke:
    """One stroke as a player intends it. It is checked when it is made, and never changes.

    Parameters
    ----------
    speed : float
        Of the cue [m/s], 0.2 to 7.
    side, top : float
        Tip offset over R, right and up as the player sees it, within the disc of radius 0.5.
    aim : float
        Direction in which the cue ball leaves [rad], anticlockwise from +x. Squirt is made up for, as a player does: this is what
        ``aim="absolute"`` means in an action, and with side not quite the direction of the cue.
    elevation : float
        Of the butt [rad], 0 to 30 degrees.
    place : (float, float), optional
        Where in the D the cue ball is put first, if it is in hand [m]. None: it is played from where it lies.

    Raises
    ------
    ValueError
        If a number is not finite or out of range.

    Examples
    --------
    >>> from snooker_env.advice import CueStroke
    >>> CueStroke(speed=1.8, aim=0.5, top=-0.2).to_dict()["top"]
    -0.2
    """

    speed: float
    aim: float
    side: float = 0.0
    top: float = 0.0
    elevation: float = 0.0
    place: Place | None = None

    def __post_init__(self) -> None:
        put: Any = lambda name, value: object.__setattr__(self, name, value)  # noqa: E731
        put("speed", number("speed", self.speed, MIN_SPEED, MAX_SPEED))
        put("aim", number("aim", self.aim))
        for name in ("side", "top"):
            put(name, number(name, getattr(self, name), -FARTHEST, FARTHEST))
        if hypot(self.side, self.top) > FARTHEST + 1e-9:
            raise refuse_what("side, top", f"({self.side:g}, {self.top:g})", f"must lie within the disc of radius {FARTHEST}")
        put("elevation", number("elevation", self.elevation, 0.0, MAX_ELEVATION))
        if self.place is not None:
            put("place", tuple(array("place", self.place, (2,)).tolist()))
            if not within_d(*self.place):
                raise refuse_what("place", f"({self.place[0]:g}, {self.place[1]:g})", "must be on or within the lines of the D")

    @classmethod
    def of(cls, stroke: "StrokeLike") -> "CueStroke":
        """What users may pass as a stroke.

        Parameters
        ----------
        stroke : CueStroke, dict, or anything with ``speed``, ``side``, ``top``, ``aim``, ``elevation`` and ``place``
            A dict holds fields of ``CueStroke``.

        Returns
        -------
        CueStroke

        Raises
        ------
        ValueError
            For anything else.
        """
        if isinstance(stroke, cls):
            return stroke
        names = [f.name for f in fields(cls)]
        if isinstance(stroke, Mapping):
            for key in stroke:
                choice("field of the stroke", key, names)
            given = dict(stroke)
        else:
            given = {name: getattr(stroke, name) for name in names if hasattr(stroke, name)}
        for name in ("speed", "aim"):
            if name not in given:
                raise refuse_what("stroke", f"a {type(stroke).__name__} without {name!r}", "must be a CueStroke or a dict of its fields")
        return cls(**given)

    def to_dict(self) -> dict[str, Any]:
        """The stroke as JSON types; ``CueStroke(**...)`` makes it again.

        Returns
        -------
        dict
        """
        return asdict(self) | {"place": self.place and list(self.place)}

    def numbers(self) -> NDArray[np.float64]:
        """The stroke without its place, as a row of numbers.

        Returns
        -------
        float64 (5,)
            Speed, side, top, aim, elevation.
        """
        return np.array([self.speed, self.side, self.top, self.aim, self.elevation])

    def action(self, *, elevation: bool = False, placement: bool = False, decision: bool = False) -> NDArray[np.float32]:
        """The stroke as an action of an environment with ``aim="absolute"`` and these options.

        Parameters
        ----------
        elevation, placement, decision : bool
            As the environment has them. A stroke without a place puts the cue ball in the middle of the baulk line; the decision after
            a foul is to play.

        Returns
        -------
        float32 (4 to 8,)

        Examples
        --------
        >>> from snooker_env.advice import CueStroke
        >>> CueStroke(speed=3.6, aim=0.0, top=0.25).action(placement=True).tolist()
        [0.0, 0.0, 0.5, 0.0, 0.0, -1.0]
        """
        row = actions_of_strokes(self.numbers()[None])[0]
        parts = [row if elevation else row[:4]]
        if placement:
            x, y = self.place or (0.0, BAULK_Y)
            across = min(1.0, max(-1.0, x / D_RADIUS))
            depth = D_RADIUS * sqrt(1.0 - across * across)
            back = min(1.0, max(0.0, (BAULK_Y - y) / depth)) if depth > 1e-9 else 0.0
            parts.append(np.array([across, 2.0 * back - 1.0]))
        if decision:
            parts.append(np.zeros(1))
        return np.concatenate(parts).astype(np.float32)


StrokeLike: TypeAlias = CueStroke | Mapping[str, Any] | Any
"""What users may pass as a stroke, see ``CueStroke.of``."""


def actions_of_strokes(strokes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rows of strokes (n, 5) as actions of ``aim="absolute", elevation=True``: (n, 5)."""
    actions = np.empty((len(strokes), 5))
    turns = strokes[:, AIM] / pi
    actions[:, 0] = 2.0 * (strokes[:, SPEED] - MIN_SPEED) / (MAX_SPEED - MIN_SPEED) - 1.0
    actions[:, 1], actions[:, 2] = 2.0 * strokes[:, SIDE], 2.0 * strokes[:, TOP]
    actions[:, 3] = turns - 2.0 * np.round(0.5 * turns)
    actions[:, 4] = 2.0 * strokes[:, ELEVATION] / MAX_ELEVATION - 1.0
    return np.clip(actions, -1.0, 1.0)  # what lies beyond by rounding
