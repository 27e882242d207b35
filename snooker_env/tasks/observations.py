"""What does the agent observe? The balls, or the pots, and the state of the game, as float32 arrays."""

from collections import namedtuple
from math import acos, hypot, log10, pi
from typing import Any

import numpy as np
from gymnasium import spaces

from .._lib.check import refuse
from .._lib.jit import kernel
from .._lib.types import Bools, Masks, Observation, ObservationKind, Singles
from ..game.balls import N_BALLS, REDS_MASK, VALUES, BallOn, bits, count
from ..game.pots import COS_CUT, GHOST_X, GHOST_Y, POT_BALL, POT_POCKET, TOLERANCE, find_pots
from ..geometry import AIM_X, AIM_Y, BALL_RADIUS, HALF_LENGTH, HALF_WIDTH, POCKET_AIMS
from ..physics.conditions import COLUMNS as CONDITIONS_SIZE
from .lines import POTS
from .noise import Spread
from .pot_chance import plain_chance
from .stroke_menu import menu_size

OBSERVATIONS: tuple[ObservationKind, ...] = ("pots", "flat", "balls", "masked", "strokes")
"""The kinds of observations: one array of pots, or of balls; a dict of two; a dict of the flat one and the available
choices; one array of strokes. "pots" is of visits alone."""
BALL_COLUMNS = ("x", "y", "on_table", "value", "ball_on")
"""Columns of the table of balls: x / 0.889 m and y / 1.7845 m (0 when off the table), 1 if on the table,
value / 7, 1 if it may be struck first (a ball on; with a free ball every colour)."""
STATE_ENTRIES = ("reds", *(ball.name.lower() for ball in BallOn if ball >= 0), "in_hand", "break")
"""Entries of the state of the game: reds left / 15; the ball on as one-hot, from "any_colour" to "black"; 1
if the cue ball is in hand; points of this break / 155."""
FRAME_ENTRIES = (
    *("score", "opponent_score", "lead", "available", "to_play", "free_ball", "choice", "miss_called"),
    *("respotted_black", "broke", "failures", "warned", "in_lot"),
    *("frames_won", "opponent_frames", "frames_needed", "clock", "misses", "anywhere"),
)
"""Entries that a frame adds, of one player's side, in [-1, 1] and never clipped; docs/environment/specification.md has them."""
REPLACED_COLUMNS = ("x", "y", "on_table")
"""Columns of the layout that "replace" restores, one row a ball; 0 unless a miss has just been called."""
REACH = 1.1
"""Bound of the spaces that hold places. The noses are at 1; a ball in the mouth of a pocket lies up to 1.013
on snooker's own tables, and within this bound on any that an environment takes (``options.table_of``)."""
_COLUMNS = len(BALL_COLUMNS)
BALLS_SIZE = N_BALLS * _COLUMNS  # numbers in the table of balls, the first part of a flat observation
SIZE = BALLS_SIZE + len(STATE_ENTRIES)
"""Numbers in the flat observation of a visit (121). Public as ``snooker_env.tasks.OBSERVATION_SIZE``."""
FRAME_SIZE = SIZE + len(FRAME_ENTRIES)  # numbers in the flat observation of a frame without a miss rule (140)
REPLACED_SIZE = N_BALLS * len(REPLACED_COLUMNS)
"""Numbers that a miss rule adds to it (66): the layout that "replace" restores."""
_SIZES = SIZE, FRAME_SIZE, FRAME_SIZE + REPLACED_SIZE
POT_ENTRIES = (
    *("chance", "log_chance", "cut", "tolerance", "value"),
    *("x", "y", "cos", "sin", "distance", "pocket_x", "pocket_y"),
)
"""Entries of each of the ``POTS`` widest pots, widest first, as ``find_pots`` lists them; the specification says what they are."""
SHOWN_SPEED = 2.0  # the cue speed whose chances observations show [m/s]
POTS_SIZE = POTS * len(POT_ENTRIES) + 2 + len(STATE_ENTRIES)
"""Numbers in the observation "pots" (61): the pots, the cue ball's place (0 when off the table), the state of the game."""
STROKE_ENTRIES = (
    *("there", "pot", "chance", "log_chance", "points", "speed", "top", "cut", "tolerance"),
    *("x", "y", "noses", "balls", "run", "lost", "missed", "near", "reach"),
    *("prospects", "best", "second", "foul", "promise"),
)
"""Entries of each stroke on the menu, of which ``foreseen`` writes them; docs/environment/specification.md says what they are."""
STROKE_SIZE = len(STROKE_ENTRIES)
_FAR, _HALF = 4.0, 0.01  # longer than any path of the cue ball [m]; a middling tolerance [rad]


View = namedtuple("View", "pots spread rails")
"""How visits are observed: whether pots are, in place of the balls; the player's ``Spread`` at ``SHOWN_SPEED``; rails as in a
cue's row."""
FLAT = View(False, Spread(1.0), np.empty(0))  # the balls


@kernel
def scale_log(chance):
    """log10 of a chance / 2, at least -1."""
    return max(-1.0, 0.5 * log10(max(chance, 1e-9)))


@kernel
def scale_room(angle):
    """A tolerance or another room for errors [rad] within [0, 1): a half for ``_HALF``."""
    return angle / (angle + _HALF)


@kernel
def observe_state_into(row, at, on_table, ball_on, in_hand, points):
    """Write ``STATE_ENTRIES`` from the place ``at`` on."""
    for c in range(at, at + len(STATE_ENTRIES)):
        row[c] = 0.0
    row[at] = count(bits(on_table) & REDS_MASK) / 15.0
    if ball_on >= 0:
        row[at + 1 + ball_on] = 1.0
    row[at + 9] = in_hand
    row[at + 10] = points / 155.0


@kernel
def observe_into(row, positions, on_table, ball_on, on, in_hand, points):
    """Write the flat observation (SIZE,). ``on``: mask of the balls on; ``points``: the break so far."""
    for i in range(N_BALLS):
        at, here = i * _COLUMNS, on_table[i]
        row[at] = positions[i, 0] / HALF_WIDTH if here else 0.0
        row[at + 1] = positions[i, 1] / HALF_LENGTH if here else 0.0
        row[at + 2] = 1.0 if here else 0.0
        row[at + 3] = VALUES[i] / 7.0
        row[at + 4] = (on >> i) & 1
    observe_state_into(row, BALLS_SIZE, on_table, ball_on, in_hand, points)


@kernel
def observe_pots_into(row, positions, on_table, ball_on, on, in_hand, points, view, pots):
    """Write the observation "pots" (POTS_SIZE,); ``pots`` (POTS, POT_COLUMNS): work space."""
    size, cx, cy = len(POT_ENTRIES), positions[0, 0], positions[0, 1]
    many = find_pots(positions, on_table, on, BALL_RADIUS, pots) if on_table[0] else 0
    for k in range(POTS):
        at = k * size
        for c in range(at, at + size):
            row[c] = 0.0
        row[at + 1] = -1.0
        if k >= many:
            continue
        ball, pocket = int(pots[k, POT_BALL]), int(pots[k, POT_POCKET])
        chance = plain_chance(positions, on_table, pots[k], view.spread, view.rails)
        x, y, px, py = positions[ball, 0], positions[ball, 1], pots[k, GHOST_X] - cx, pots[k, GHOST_Y] - cy
        tx, ty, far = POCKET_AIMS[pocket, AIM_X], POCKET_AIMS[pocket, AIM_Y], hypot(px, py)
        cut, left = acos(min(1.0, pots[k, COS_CUT])), px * (ty - y) - py * (tx - x) > 0.0
        row[at], row[at + 1] = chance, scale_log(chance)
        row[at + 2] = (cut if left else -cut) / (0.5 * pi)
        row[at + 3], row[at + 4] = scale_room(pots[k, TOLERANCE]), VALUES[ball] / 7.0
        row[at + 5], row[at + 6] = x / HALF_WIDTH, y / HALF_LENGTH
        row[at + 7], row[at + 8] = px / far, py / far
        row[at + 9], row[at + 10], row[at + 11] = far / _FAR, tx / HALF_WIDTH, ty / HALF_LENGTH
    at, here = POTS * size, on_table[0]
    row[at], row[at + 1] = cx / HALF_WIDTH if here else 0.0, cy / HALF_LENGTH if here else 0.0
    observe_state_into(row, at + 2, on_table, ball_on, in_hand, points)


def size_of(kind: str, frame: bool, *, replaced: bool, speeds: int, conditions: bool = False) -> int:
    """Numbers in an observation; ``replaced``: whether it holds the layout that "replace" restores, if of balls."""
    entries = len(STATE_ENTRIES) + len(FRAME_ENTRIES) * frame
    sizes = {"pots": POTS_SIZE, "strokes": STROKE_SIZE * menu_size(speeds, frame) + entries}
    return sizes.get(kind, BALLS_SIZE + entries + REPLACED_SIZE * replaced) + CONDITIONS_SIZE * conditions


def space(kind: ObservationKind, size: int, choices: int) -> spaces.Space[Any]:
    """The space of observations of so many numbers: within 1.1 where balls may lie in the mouths of pockets, else within 1."""
    shown = arrange(kind, np.empty(size, np.float32), np.empty(choices, np.int8))
    if not isinstance(shown, dict):
        return spaces.Box(-REACH, REACH, shown.shape, np.float32)
    boxes: dict[str, spaces.Space[Any]] = {}
    for name, part in shown.items():
        most = 1.0 if name in ("state", "conditions") else REACH
        boxes[name] = spaces.Box(-most, most, part.shape, np.float32)
    if kind == "masked":
        boxes["action_mask"] = spaces.Box(0, 1, (choices,), np.int8)
    return spaces.Dict(boxes)


def arrange(kind: ObservationKind, rows: Singles, masks: Masks | Bools | None = None) -> Observation:
    """Observations (..., k) in a kind: "pots" and "flat" are ``rows`` itself, "balls" has new arrays."""
    if kind in ("pots", "strokes", "flat"):
        return rows
    if kind == "masked":
        if masks is None:
            raise refuse("masks", None, 'must be the available choices, with the kind "masked"')
        return {"observations": rows, "action_mask": masks.astype(np.int8, copy=False)}
    lead = rows.shape[:-1]
    end = rows.shape[-1]
    if with_conditions := end - CONDITIONS_SIZE in _SIZES:
        end -= CONDITIONS_SIZE
    balls = rows[..., :BALLS_SIZE].reshape(*lead, N_BALLS, _COLUMNS)
    parts = {"balls": np.array(balls), "state": np.array(rows[..., BALLS_SIZE : min(end, FRAME_SIZE)])}
    if end > FRAME_SIZE:
        replaced = rows[..., FRAME_SIZE:end].reshape(*lead, N_BALLS, len(REPLACED_COLUMNS))
        parts["replaced"] = np.array(replaced)
    if with_conditions:
        parts["conditions"] = np.array(rows[..., end:])
    return parts
