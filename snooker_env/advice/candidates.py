"""Which strokes are candidates? Those at the direct pots; where there is none, contacts with the balls on and a fan of all directions."""

from math import pi

import numpy as np
from numpy.typing import NDArray

from ..geometry import BALL_RADIUS
from ..planning import Positions, action_masks, as_actions, pots
from ..tasks.discrete_actions import SIDES, SPEEDS, STROKES, TOPS
from .practice import Practice

SAFE_SPEEDS = (0.7, 1.0, 1.4, 1.9, 2.6, 3.6)
"""Cue speeds [m/s] of strokes at balls on where there is no pot."""
CONTACTS = (-0.97, -0.85, -0.6, -0.3, 0.0, 0.3, 0.6, 0.85, 0.97)
"""Where a ball on is struck: distance of its centre from the line of the cue ball, over 2 R; 0 is full, near 1 is thin."""
NEAREST = 6
"""Number of balls on, the nearest ones, that are struck in this way."""
FAN_SPEEDS = (1.6, 2.8, 4.5)
"""Cue speeds [m/s] of the fan, which finds escapes off cushions."""
FAN, FINE_FAN = 180, 1440
"""Directions of the fan, and of the finer fan that is tried if the first finds no fair contact."""
FEW = np.isin(np.arange(STROKES) // (len(SIDES) * len(TOPS)), (1, 2, 3, 4, 5, 6)) & (np.arange(STROKES) // len(TOPS) % len(SIDES) == 1)
"""The strokes that are tried from each of several places: usual speeds, no side."""


def rows_of_choices(practice: Practice, at: Positions, rows: NDArray[np.int64], choices: NDArray[np.int64]) -> NDArray[np.float64]:
    """Choices of ``action="discrete"`` on ``at[rows]`` as rows of strokes (n, 5)."""
    stroke = choices % STROKES
    out = np.zeros((len(choices), 5))
    out[:, 0] = np.array(SPEEDS)[stroke // (len(SIDES) * len(TOPS))]
    out[:, 1], out[:, 2] = np.array(SIDES)[stroke // len(TOPS) % len(SIDES)], np.array(TOPS)[stroke % len(TOPS)]
    rules = practice.options.rules
    out[:, 3] = pi * as_actions(at, rows, choices, physics=rules.physics, fidelity=practice.options.fidelity)[:, 3].astype(np.float64)
    return out


def at_pots(practice: Practice, at: Positions) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
    """All usual strokes at the direct pots of positions: rows (n,), strokes (n, 5), and the chance of each pot by the rule of thumb.

    From one place these are all choices of ``action="discrete"``; from several places, those without side at usual speeds.
    """
    masks = action_masks(at) & (pots(at, most=1).ball >= 0)
    if len(at) > 1:
        masks &= np.tile(FEW, masks.shape[1] // STROKES)
    rows, choices = np.nonzero(masks)
    _, chances = practice.prospects(at)
    return rows, practice.chosen(at, rows, choices), chances[rows, choices // STROKES]


def at_balls(at: Positions, row: int) -> NDArray[np.float64]:
    """Strokes (n, 5) without spin that send the cue ball straight at parts of the nearest balls on in one position."""
    here = at.positions[row, 0]
    balls = np.flatnonzero(at.balls_on[row])
    to = at.positions[row, balls] - here
    far = np.hypot(*to.T)
    near = np.argsort(far, kind="stable")[:NEAREST]
    reach = np.arcsin(np.minimum(1.0, 2.0 * BALL_RADIUS / far[near]))
    aims = (np.arctan2(to[near, 1], to[near, 0])[:, None] + np.array(CONTACTS) * reach[:, None]).ravel()
    return plain(aims, SAFE_SPEEDS)


def fan(directions: int) -> NDArray[np.float64]:
    """Strokes (n, 5) without spin in that many directions, at the speeds of the fan."""
    return plain(2.0 * pi * np.arange(directions) / directions - pi, FAN_SPEEDS)


def plain(aims: NDArray[np.float64], speeds: tuple[float, ...]) -> NDArray[np.float64]:
    """Strokes (n, 5) without spin: each of ``aims`` [rad] at each of ``speeds`` [m/s]."""
    out = np.zeros((len(aims) * len(speeds), 5))
    out[:, 0], out[:, 3] = np.tile(speeds, len(aims)), np.repeat(aims, len(speeds))
    return out
