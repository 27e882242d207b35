"""In which direction must the cue ball leave to send a ball to a point, by the engine's own models?"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._lib.check import array, integer, number, refuse, refuse_what
from .._lib.jit import entry
from .._lib.types import CueKind, Fidelity, Floats, Integers, Scalars, Vectors
from ..game.balls import N_BALLS
from ..geometry import BALL_RADIUS
from ..physics.conditions import END_MASS_RATIO
from ..physics.cue import MAX_ELEVATION as STEEPEST_CUE
from ..physics.cue_room import NO_RAILS
from ..physics.impact.contact import parse_fidelity
from ..physics.parameters import Physics, PhysicsLike, pack_into
from ..tasks.kernel_arrays import CueLaw
from ..tasks.lines import new_work
from ..tasks.options import Options, Rules
from ..tasks.pot_aim import solved_aim
from ..tasks.stroke import row_of
from .positions import Positions, PositionsLike, rows_of
from .stroke_columns import COLUMNS, ELEVATION, NAMES, SIDE, SPEED, TOP


class Dynamics(NamedTuple):
    """Physical constants, a fidelity as ``parse_fidelity`` returns it, the rails of a real cue (``Rules.rails``), and how
    a player's errors of direction grow with the speed (``Noise.growth``) [s/m]."""

    physics: Physics
    fidelity: tuple[int, int]
    rails: Floats = NO_RAILS
    growth: float = 0.0

    @classmethod
    def of(cls, rules: Rules) -> "Dynamics":
        return cls(rules.physics, rules.fidelity, rules.rails, rules.noise.growth)


def law_of(dynamics: Dynamics, at: Positions) -> tuple[Floats, Floats, int, int, float, Floats]:
    """The fields of a ``CueLaw``: the first two in one row for all positions or, with constants of their own, in
    one for each."""
    physics, fidelity, rails, _ = dynamics
    rails = np.array(rails)  # kernels are compiled for arrays that can be written
    if at.conditions is None:
        phys, ratios = physics.packed_for(fidelity)[None], np.array([physics.end_mass_ratio])
    else:
        phys, ratios = rows_under(at.conditions, physics), at.conditions[:, END_MASS_RATIO].copy()
    return phys, ratios, *fidelity, physics.max_offset, rails


def rows_under(conditions: Floats, physics: Physics) -> Floats:
    """The packed constants (n, 22) of tables with these conditions (n, 8)."""
    rows = np.tile(physics.pack(), (len(conditions), 1))
    pack_into(rows, np.arange(len(conditions)), conditions, physics)
    return rows


_USUAL = Options().rules
ROUNDING = 1e-9  # how far beyond its bounds a number may be


@entry(what="the solving of aims", uses=(solved_aim,))
def _pot_aim(table, rows, balls, targets, ghosts, strokes, law, aims):
    (positions, on_table), (phys, ratios, fidelity, n_steps, most, rails), work = table, law, new_work()
    for i in range(len(rows)):
        own = row_of(rows[i], phys)
        its = CueLaw(phys[own], ratios[own], fidelity, n_steps, most, rails)
        stroke = strokes[i, SPEED], strokes[i, SIDE], strokes[i, TOP], strokes[i, ELEVATION]
        target, ghost = (targets[i, 0], targets[i, 1]), (ghosts[i, 0], ghosts[i, 1])
        p, on = positions[rows[i]], on_table[rows[i]]
        aims[i] = solved_aim(p, on, balls[i], target, ghost, stroke, its, work)


def pot_aim(
    positions: PositionsLike,
    rows: Integers,
    balls: Integers,
    targets: Vectors,
    strokes: Scalars | Vectors,
    *,
    ghosts: Vectors | None = None,
    physics: PhysicsLike = None,
    fidelity: Fidelity = "standard",
    cue: CueKind = "free",
) -> NDArray[np.float64]:
    """Solve the direction of the cue ball that sends a ball to a point, with throw, swerve and curve.

    Only these two balls are simulated, on unbounded cloth; secant steps correct the direction until the ball
    passes the point by less than 1e-6 rad (``snooker_env.tasks.pot_aim``). If none succeeds (a soft stroke or
    a thin cut), the best direction tried is returned.

    Parameters
    ----------
    positions : PositionsLike
        The m positions: anything that ``Positions.of`` accepts.
    rows, balls : array_like
        int (n,). Row of ``positions`` for each ball, in [0, m); id of the ball to send, in [1, 21].
    targets : array_like
        float (n, 2). Where to send it [m], for a pocket its ``snooker_env.geometry.POCKET_AIMS[:, :2]``.
    strokes : array_like or float
        float (n, 5). Strokes in SI, see ``Planner``, whose aims are not read. Or float, scalar or (n,): cue
        speeds [m/s] of strokes in the middle of the ball.
    ghosts : array_like, optional
        float (n, 2). Ghost-ball centres [m]; default: 2 R behind the ball as seen from the target.
    physics, fidelity, cue : optional
        As for ``Options``.

    Returns
    -------
    numpy.ndarray
        float64 (n,). Directions [rad], anticlockwise from +x, as the aims of strokes.

    Examples
    --------
    >>> from snooker_env.planning import Position, pot_aim
    >>> position = Position(cue=(0.0, 0.0), reds=[(0.5, 0.5)])
    >>> float(pot_aim(position, [0], [1], [(0.8, 0.8)], 2.3)[0].round(3))
    0.785
    """
    rails = NO_RAILS if cue == "free" else Options(cue=cue).rules.rails  # those of the table "match"
    dynamics = Dynamics(Physics.of(physics), parse_fidelity(fidelity), rails)
    at = Positions.of(positions).known_to(_USUAL)
    return solved_aims(at, rows, balls, targets, strokes, ghosts, dynamics)


def solved_aims(
    at: Positions,
    rows: Integers,
    balls: Integers,
    targets: Vectors,
    strokes: Scalars | Vectors,
    ghosts: Vectors | None,
    dynamics: Dynamics,
) -> NDArray[np.float64]:
    """``pot_aim`` with checked physics and fidelity."""
    which, offset = rows_of(at, rows), dynamics[0].max_offset
    n = len(which)
    ids, to = _integers("balls", balls, n, 1, N_BALLS - 1), array("targets", targets, (n, 2))
    present = at.on_table[which, ids] & at.on_table[which, 0]
    if not present.all():
        k = int(np.argmin(present))
        raise refuse(f"balls[{k}]", int(ids[k]), "must be on the table, and the cue ball too")
    if ghosts is None:
        lie = at.positions[which, ids]
        along = to - lie
        behind = lie - 2.0 * BALL_RADIUS * along / np.maximum(np.hypot(*along.T), 1e-9)[:, None]
    else:
        behind = array("ghosts", ghosts, (n, 2))
    played, aims = np.zeros((n, COLUMNS)), np.empty(n)
    depth = np.ndim(strokes)  # type: ignore[arg-type]
    if depth == 2:
        played[:] = array("strokes", strokes, (n, COLUMNS))
    else:
        played[:, SPEED] = array("strokes", strokes, (n,) if depth else ())
    most = (np.inf, offset, offset, np.inf, STEEPEST_CUE)
    check_columns(played, (0.0, -offset, -offset, -np.inf, 0.0), most)
    _pot_aim((at.positions, at.on_table), which, ids, to, behind, played, law_of(dynamics, at), aims)
    return aims


def _integers(field: str, values: Integers, n: int, low: int, high: int) -> NDArray[np.int64]:
    """An int64 array (n,) with each number in [low, high]."""
    a = np.asarray(values)
    if a.shape != (n,) or (a.dtype.kind not in "iu" and n):
        raise refuse_what(field, f"{a.dtype} array of shape {a.shape}", f"must be integers of shape ({n},)")
    for k in np.flatnonzero((a < low) | (a > high))[:1].tolist():
        integer(f"{field}[{k}]", int(a[k]), low, high)
    return np.ascontiguousarray(a, np.int64)


def check_columns(strokes: Floats, least: tuple[float, ...], most: tuple[float, ...]) -> None:
    """ValueError names the first number of strokes (n, 5) that is not finite or out of range."""
    low, high = np.array(least) - ROUNDING, np.array(most) + ROUNDING
    fair = np.isfinite(strokes) & (strokes >= low) & (strokes <= high)
    for k, c in np.argwhere(~fair)[:1].tolist():
        number(f"strokes[{k}], {NAMES[c]}", float(strokes[k, c]), least[c], most[c])
