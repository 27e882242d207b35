"""How does a stroke become an action? Choices of ``action="discrete"`` and plain aims as rows of the box action space, and the aim solver.

Each row has the four numbers of ``aim="absolute"`` without elevation and placement: cue speed, side, top, direction.
"""

from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._check import array, integer, number, refuse, refuse_what
from .._jit import entry
from .._types import Fidelity, Integers, Scalars, Vector, Vectors
from ..game.balls import N_BALLS, balls_on_kernel, bits
from ..game.frame_columns import BALL_ON
from ..geometry import BALL_RADIUS
from ..physics.cue import MAX_ELEVATION, squirt
from ..physics.impact.contact import parse_fidelity
from ..physics.parameters import Physics, PhysicsLike
from ..tasks.arrays import Law
from ..tasks.box_actions import MAX_SPEED, MIN_SPEED
from ..tasks.discrete_actions import SIZE, chosen, masks
from ..tasks.lines import new_work
from ..tasks.pot_aim import solved_aim
from ..tasks.tables import STROKES_ONLY
from .positions import Positions, PositionsLike, rows_of

Dynamics = tuple[Physics, tuple[int, int]]
"""Physical constants, and a fidelity as ``parse_fidelity`` returns it."""


def dynamics_of(physics: PhysicsLike, fidelity: Fidelity) -> Dynamics:
    """The physics and fidelity that a caller gave, checked."""
    return Physics.of(physics), parse_fidelity(fidelity)


def action_masks(positions: PositionsLike) -> NDArray[np.bool_]:
    """Return which choices of ``action="discrete"`` are available in each position.

    Parameters
    ----------
    positions : PositionsLike
        The m positions: anything that ``Positions.of`` accepts.

    Returns
    -------
    numpy.ndarray
        bool (m, 540). True for each available choice. In a position without a direct pot other lines of the cue ball stand for the
        pots: parts of balls on that it sees, or escapes over cushions.

    Raises
    ------
    ValueError
        If ``positions`` holds no positions.

    Examples
    --------
    >>> from snooker_env.planning import Position, action_masks
    >>> int(action_masks(Position(cue=(0.0, 0.0), black=(0.0, 1.4605))).sum())
    270
    """
    at = Positions.of(positions)
    out = np.empty((len(at), SIZE), np.bool_)
    masks(np.arange(len(at)), at.positions, at.on_table, at.game, STROKES_ONLY, out)
    return out


def actions_of(speeds: Vector, aims: Vector, side: Scalars = 0.0, top: Scalars = 0.0) -> NDArray[np.float32]:
    """Convert speeds and aims to actions of ``aim="absolute"``.

    Parameters
    ----------
    speeds : array_like
        float (n,). Cue speeds [m/s], in [0.2, 7].
    aims : array_like
        float (n,). Directions in which the cue ball leaves [rad], anticlockwise from +x.
    side, top : array_like or float, optional
        float, scalar or (n,). Tip offsets over R, to the right and up, each in [-0.5, 0.5]; default 0.

    Returns
    -------
    numpy.ndarray
        float32 (n, 4). Actions in [-1, 1].

    Raises
    ------
    ValueError
        If a number is not finite or out of range.

    Examples
    --------
    >>> from snooker_env.planning import actions_of
    >>> actions_of([3.6], [0.0], top=0.25).tolist()
    [[0.0, 0.0, 0.5, 0.0]]
    """
    fast, turns = array("speeds", speeds, (-1,)), array("aims", aims, (-1,)) / pi
    if len(fast) and not (fast.min() >= MIN_SPEED and fast.max() <= MAX_SPEED):
        number("speeds", float(fast.min() if fast.min() < MIN_SPEED else fast.max()), MIN_SPEED, MAX_SPEED)
    actions = np.zeros((len(turns), 4), np.float32)
    actions[:, 0] = 2.0 * (fast - MIN_SPEED) / (MAX_SPEED - MIN_SPEED) - 1.0
    actions[:, 1], actions[:, 2] = 2.0 * np.asarray(side, np.float64), 2.0 * np.asarray(top, np.float64)
    actions[:, 3] = turns - 2.0 * np.round(turns / 2.0)
    if not (np.abs(actions) <= 1.0).all():
        raise refuse("side, top", float(0.5 * np.abs(actions[:, 1:3]).max()), "must be finite and within 0.5")
    return actions


@entry(what="the choices as actions", uses=(chosen,))
def _as_actions(positions, on_table, game, rows, picks, phys, end_mass_ratio, fidelity, n_steps, out):
    law, work = Law(phys, end_mass_ratio, fidelity, n_steps), new_work()
    for i in range(len(rows)):
        k = rows[i]
        on = balls_on_kernel(game[k, BALL_ON], bits(on_table[k]))
        speed, side, top, aim, _ = chosen(picks[i], positions[k], on_table[k], on, law, work)
        out[i, 0] = 2.0 * (speed - MIN_SPEED) / (MAX_SPEED - MIN_SPEED) - 1.0
        out[i, 1], out[i, 2] = 2.0 * side, 2.0 * top
        turned = (aim + squirt(side, end_mass_ratio)) / pi
        out[i, 3] = turned - 2.0 * round(0.5 * turned)


def as_actions(
    positions: PositionsLike, rows: Integers, choices: Integers, *, physics: PhysicsLike = None, fidelity: Fidelity = "standard"
) -> NDArray[np.float32]:
    """Convert choices of ``action="discrete"`` to actions of ``aim="absolute"``: the same strokes, up to the rounding of float32.

    Parameters
    ----------
    positions : PositionsLike
        The m positions: anything that ``Positions.of`` accepts.
    rows : array_like
        int (n,). Row of ``positions`` for each choice, in [0, m).
    choices : array_like
        int (n,). Choices, in [0, 540).
    physics : str, dict, Physics or None, optional
        Physical constants with which the aims are solved; default None: the preset "paper".
    fidelity : str, optional
        "fast", "standard" (default), "reference" or "euler:N": how impacts are solved.

    Returns
    -------
    numpy.ndarray
        float32 (n, 4). Actions in [-1, 1].

    Raises
    ------
    ValueError
        If a row or a choice is out of range, or if ``physics`` or ``fidelity`` is invalid.

    Examples
    --------
    >>> from snooker_env.planning import Position, as_actions
    >>> as_actions(Position(cue=(0.0, 0.0), black=(0.0, 1.4605)), [0], [67]).shape
    (1, 4)
    """
    return solved_choices(Positions.of(positions), rows, choices, dynamics_of(physics, fidelity))


def solved_choices(at: Positions, rows: Integers, choices: Integers, dynamics: Dynamics) -> NDArray[np.float32]:
    """``as_actions`` with checked physics and fidelity."""
    which = rows_of(at, rows)
    picks = _integers("choices", choices, len(which), 0, SIZE - 1)
    out = np.empty((len(which), 4), np.float32)
    physics, (code, n_steps) = dynamics
    _as_actions(at.positions, at.on_table, at.game, which, picks, physics.pack(), physics.end_mass_ratio, code, n_steps, out)
    return out


@entry(what="the solving of aims", uses=(solved_aim,))
def _pot_aim(positions, rows, balls, targets, ghosts, strokes, phys, end_mass_ratio, fidelity, n_steps, aims):
    law, work = Law(phys, end_mass_ratio, fidelity, n_steps), new_work()
    for i in range(len(rows)):
        stroke = strokes[i, 0], strokes[i, 1], strokes[i, 2], strokes[i, 3]
        target, ghost = (targets[i, 0], targets[i, 1]), (ghosts[i, 0], ghosts[i, 1])
        aims[i] = solved_aim(positions[rows[i]], balls[i], target, ghost, stroke, law, work)


def pot_aim(
    positions: PositionsLike,
    rows: Integers,
    balls: Integers,
    targets: Vectors,
    speeds: Scalars,
    *,
    side: Scalars = 0.0,
    top: Scalars = 0.0,
    elevation: Scalars = 0.0,
    ghosts: Vectors | None = None,
    physics: PhysicsLike = None,
    fidelity: Fidelity = "standard",
) -> NDArray[np.float64]:
    """Solve the direction in which the cue ball must leave to send a ball to a point, with throw, swerve and the ball's own curve.

    Only the cue ball and that ball are simulated, on unbounded cloth, until the ball rolls. Secant steps correct the direction until the
    ball passes the point by less than 1e-6 rad (``snooker_env.tasks.pot_aim``). If no direction succeeds (the stroke is too soft to
    arrive or the cut too thin), the best direction tried is returned.

    Parameters
    ----------
    positions : PositionsLike
        The m positions: anything that ``Positions.of`` accepts.
    rows : array_like
        int (n,). Row of ``positions`` for each ball, in [0, m).
    balls : array_like
        int (n,). Id of the ball to send, in [1, 21].
    targets : array_like
        float (n, 2). Where to send it [m]; the aim points of the pockets are ``snooker_env.geometry.POCKET_AIMS[:, :2]``.
    speeds : array_like or float
        float, scalar or (n,). Cue speeds [m/s], at least 0.
    side, top : array_like or float, optional
        float, scalar or (n,). Tip offsets over R, to the right and up, within the miscue limit of the physics; default 0.
    elevation : array_like or float, optional
        float, scalar or (n,). Elevation of the cue [rad], at least 0; default 0.
    ghosts : array_like, optional
        float (n, 2). Ghost-ball centres of the straight line [m]; default: 2 R behind the ball as seen from the target.
    physics : str, dict, Physics or None, optional
        Physical constants; default None: the preset "paper".
    fidelity : str, optional
        "fast", "standard" (default), "reference" or "euler:N": how impacts are solved.

    Returns
    -------
    numpy.ndarray
        float64 (n,). Directions [rad], anticlockwise from +x, as ``actions_of`` takes them.

    Raises
    ------
    ValueError
        If a number is out of range, a ball is off the table, or an array has the wrong shape.

    Examples
    --------
    >>> from snooker_env.planning import Position, pot_aim
    >>> position = Position(cue=(0.0, 0.0), reds=[(0.5, 0.5)])
    >>> float(pot_aim(position, [0], [1], [(0.8, 0.8)], 2.3)[0].round(3))
    0.785
    """
    at = Positions.of(positions)
    return solved_aims(
        at, rows, balls, targets, speeds, side, top, elevation, ghosts, dynamics_of(physics, fidelity)
    )  # fmt: skip


def solved_aims(
    at: Positions, rows: Integers, balls: Integers, targets: Vectors, speeds: Scalars, side: Scalars, top: Scalars,
    elevation: Scalars, ghosts: Vectors | None, dynamics: Dynamics,
) -> NDArray[np.float64]:  # fmt: skip
    """``pot_aim`` with checked physics and fidelity."""
    which = rows_of(at, rows)
    n, (physics, (code, n_steps)) = len(which), dynamics
    ids, to = _integers("balls", balls, n, 1, N_BALLS - 1), array("targets", targets, (n, 2))
    there = at.on_table[which, ids] & at.on_table[which, 0]
    if not there.all():
        raise refuse(f"balls[{int(np.argmin(there))}]", int(ids[np.argmin(there)]), "must be on the table, and the cue ball too")
    if ghosts is None:
        lie = at.positions[which, ids]
        along = to - lie
        behind = lie - 2.0 * BALL_RADIUS * along / np.maximum(np.hypot(*along.T), 1e-9)[:, None]
    else:
        behind = array("ghosts", ghosts, (n, 2))
    strokes = np.empty((n, 4))
    high = (np.inf, physics.max_offset, physics.max_offset, MAX_ELEVATION)
    given: dict[str, Any] = {"speeds": speeds, "side": side, "top": top, "elevation": elevation}
    for c, (name, value) in enumerate(given.items()):
        strokes[:, c] = array(name, value, (n,) if np.ndim(value) else ())
        low = -high[c] if name in ("side", "top") else 0.0
        if n and not (low <= strokes[:, c].min() and strokes[:, c].max() <= high[c]):
            number(name, float(strokes[:, c].min() if strokes[:, c].min() < low else strokes[:, c].max()), low, high[c])
    out = np.empty(n)
    _pot_aim(at.positions, which, ids, to, behind, strokes, physics.pack(), physics.end_mass_ratio, code, n_steps, out)
    return out


def _integers(field: str, values: Any, n: int, low: int, high: int) -> NDArray[np.int64]:
    """An int64 array (n,) with each number in [low, high]."""
    a = np.asarray(values)
    if a.shape != (n,) or (a.dtype.kind not in "iu" and n):
        raise refuse_what(field, f"{a.dtype} array of shape {a.shape}", f"must be integers of shape ({n},)")
    for k in np.flatnonzero((a < low) | (a > high))[:1].tolist():
        integer(f"{field}[{k}]", int(a[k]), low, high)
    return np.ascontiguousarray(a, np.int64)
