"""How does a stroke become an action, and what does a choice of ``action="discrete"`` aim at? Strokes without what is said
with them, which ``players.Strokes.actions`` encodes, too. A stroke is a row of five numbers in SI: ``COLUMNS``."""

from dataclasses import replace
from math import pi
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._check import array, integer, number, refuse, refuse_what
from .._jit import entry
from .._types import CueKind, Fidelity, Floats, Integers, Ints, Scalars, Vector, Vectors, Words
from ..game.balls import N_BALLS
from ..geometry import BALL_RADIUS, BAULK_Y, D_RADIUS
from ..physics.conditions import END_MASS_RATIO
from ..physics.cue import MAX_ELEVATION as STEEPEST_CUE
from ..physics.cue import squirt
from ..physics.cue_room import NO_RAILS
from ..physics.impact.contact import parse_fidelity
from ..physics.parameters import Physics, PhysicsLike, pack_into
from ..tasks import stroke
from ..tasks.arrays import CueLaw, StruckArrays, TableArrays
from ..tasks.box_actions import MAX_SPEED, MIN_SPEED, STEEPEST, TARGET_SPAN, Actions, tip_on_disc
from ..tasks.declarations import A_END_MASS, A_MAX_OFFSET
from ..tasks.discrete_actions import SIZE, masks
from ..tasks.lines import new_work
from ..tasks.noise import N_KICK, Noise, drawn_errors, kick_of, with_errors
from ..tasks.options import Options, Rules
from ..tasks.pot_aim import solved_aim
from ..tasks.stroke import ShotBuffers, row_of
from ..tasks.tables import STROKES_ONLY, StepOutput, Tables
from ..tasks.visit import Visits
from .positions import Positions, PositionsLike, rows_of

(SPEED, SIDE, TOP, AIM, ELEVATION) = range(5)
"""Columns of a stroke: cue speed [m/s], tip offset over R to the right and up, direction in which the cue ball
leaves the tip (the cue itself points aside by the squirt of the side; under a raised cue the cloth then turns the
ball), elevation of the cue [rad]."""
COLUMNS = 5
NO_NOISE = Noise()


@entry(what="strokes under given errors", seconds=2)
def _strike(which, strokes, errors, tables, shots, every, noise, silent):
    """Strike the strokes (n, 5) of the tables ``which`` under standard normal errors (n, 5)."""
    tables, shots = TableArrays(*tables), StruckArrays(*shots)
    for j in range(which.shape[0]):
        k = which[j]
        options = every[row_of(k, every)]
        speed, aim, elevation = strokes[k, SPEED], strokes[k, AIM], strokes[k, ELEVATION]
        side, top = tip_on_disc(strokes[k, SIDE], strokes[k, TOP], options[A_MAX_OFFSET])
        p, on, aim = tables.positions[k], tables.on_table[k], aim - squirt(side, options[A_END_MASS])
        meant = stroke.played_in((speed, side, top, aim, elevation), p, on, options, shots.shots[j])
        struck = with_errors(*meant, errors[k], noise)
        stroke.strike_with(meant, struck, p, on, options, j, shots)
        if silent[N_KICK] > 0.0:  # blocks are drawn as for errors, too
            drawn_errors(tables.streams[k])
        shots.kicks[j] = kick_of(silent, tables.streams[k])


@entry
def _off_the_tip(strokes, every):
    """Turn the aims of strikes, the cue's, into the directions in which the cue ball leaves the tip [rad]."""
    for j in range(strokes.shape[0]):
        strokes[j, AIM] += squirt(strokes[j, SIDE], every[row_of(j, every), A_END_MASS])


class Struck(Tables):
    """Tables of one stroke each, filled by ``lay``: of strokes (n, 5) with ``errors`` (n, 5), else of actions."""

    errors: Floats | None = None
    kick: float = 0.0  # the probability of a kick in strokes with ``errors``

    def __init__(self, rules: Rules, n: int):
        super().__init__(replace(rules, drawn=False, observed=False), n)

    def lay(self, after: Positions, streams: Words, errors: Floats | None = None) -> None:
        """Put positions on the tables, with their own constants if they have any; they are played in place."""
        self.n, self.errors, self.streams = len(after), errors, streams
        if after.conditions is not None:
            self.packed = packed_under(after.conditions, self.rules)
        self.positions, self.on_table, self.game = after.positions, after.on_table, after.game

    def address(self, which: Ints, actions: Floats, buffers: ShotBuffers) -> None:
        if self.errors is None:
            super().address(which, actions, buffers)
            return
        (options, noise, _), silent = self.packed, NO_NOISE.pack(1.0)
        if self.kick:
            silent = Noise(kick=self.kick).pack(1.0)
        _strike(which, actions, self.errors, self.arrays, buffers.struck, options, noise, silent)


class TrialVisits(Struck, Visits):
    """Visits of one stroke."""


def decoded(
    rules: Rules, at: Positions, which: Ints, actions: Floats, nominated: Ints | None = None
) -> tuple[Floats, Positions]:
    """Strokes (n, 5) that checked actions mean on ``at[which]``, and n positions with the cue ball so placed.

    ``nominated`` (n,): of frames, what is nominated with each stroke; a choice is a pot of that ball."""
    visits, after, n = TrialVisits(replace(rules, noise=NO_NOISE), 0), at.known_to(rules)[which], len(which)
    visits.lay(after, np.zeros((n, 2), np.uint64))
    if nominated is not None:
        visits.nominated = nominated
    buffers = ShotBuffers(n, 0)
    visits.address(np.arange(n), actions, buffers)
    return meant(buffers, visits.packed[0]), after


def meant(buffers: ShotBuffers, options: Floats) -> Floats:
    """Strokes (n, 5) that were struck without errors; ``options``: packed, of the action, one row for all or each."""
    strokes = buffers.shots[:, stroke.CUE_SPEED : stroke.ROOM].copy()
    changed = buffers.shots[:, stroke.ROOM] != 0  # what is meant does not say how the cue finds room
    strokes[changed] = buffers.shots[changed, stroke.MEANT :]
    _off_the_tip(strokes, options)
    off = np.arctan2(np.sin(strokes[:, AIM]), np.cos(strokes[:, AIM]))
    level = np.arctan2(buffers.shots[:, stroke.VY], buffers.shots[:, stroke.VX])
    strokes[:, AIM] = np.where(changed | (strokes[:, ELEVATION] > 0.0), off, level)
    return strokes


class Stops(NamedTuple):
    """Where n strokes left each ball, as returned by ``Planner.stops``.

    Attributes
    ----------
    places, potted : numpy.ndarray
        float64 (n, 22, 2), centres at rest [m] before colours are respotted, of a potted ball where it fell;
        int64 (n, 22), pocket of each ball, an index into ``snooker_env.POCKETS``, or -1.
    first : numpy.ndarray
        int64 (n,). Id of the ball struck first (the lowest of several at once); -1 if none was.
    points, penalty : numpy.ndarray
        float64 (n,), points scored, 0 for a miss or a foul; int64 (n,), penalty points of a foul, or 0.
    goes_on : numpy.ndarray
        bool (n,). Whether the visit continues after the stroke.
    afterstates : Positions
        n rows: colours respotted, and the ball on for the next stroke.

    Examples
    --------
    >>> from snooker_env.planning import Planner, Position
    >>> stops = Planner({"action": "discrete"}).stops(Position(cue=(0.0, 0.9), black=(0.4, 1.3)), [0], [67])
    >>> int(stops.first[0]), int(stops.potted[0, 21]), stops.points.tolist()
    (21, 3, [7.0])
    """

    places: NDArray[np.float64]
    potted: NDArray[np.int64]
    first: NDArray[np.int64]
    points: NDArray[np.float64]
    penalty: NDArray[np.int64]
    goes_on: NDArray[np.bool_]
    afterstates: Positions


class WatchedVisits(TrialVisits):
    """Trial visits that record where each table's last stroke left the balls."""

    places: Floats
    potted: Ints

    def output(self, **kwargs: Any) -> StepOutput:
        """As ``Tables.output``; also allocates ``places`` and ``potted``."""
        self.places, self.potted = np.zeros((self.n, N_BALLS, 2)), np.zeros((self.n, N_BALLS), np.int64)
        return super().output(**kwargs)

    def run(self, which: Ints, buffers: ShotBuffers) -> list[int]:
        unfinished = super().run(which, buffers)
        m = len(which)
        self.places[which], self.potted[which] = buffers.r[:m], buffers.potted[:m]
        return unfinished

    def again(self, which: Ints, j: int, buffers: ShotBuffers) -> ShotBuffers:
        one = super().again(which, j, buffers)
        self.places[which[j]], self.potted[which[j]] = one.r[0], one.potted[0]
        return one


FARTHEST = 0.5  # largest tip offset over R: the miscue limit, and the end of the scale of an action
NAMES = ("speed", "side", "top", "aim", "elevation")
"""Of the columns of a stroke."""


class Dynamics(NamedTuple):
    """Physical constants, a fidelity as ``parse_fidelity`` returns it, the rails of a real cue (``Rules.rails``), and how
    a player's errors of direction grow with the speed (``Noise.growth``) [s/m]."""

    physics: Physics
    fidelity: tuple[int, int]
    rails: Floats = NO_RAILS
    growth: float = 0.0

    @classmethod
    def of(cls, rules: Rules) -> "Dynamics":
        """Those of a game."""
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


def packed_under(conditions: Floats, rules: Rules) -> tuple[Floats, Floats, Floats]:
    """``Rules.packed`` with a row for each table."""
    options, noise, _ = rules.packed()
    options = np.repeat(options, len(conditions), axis=0)
    options[:, A_END_MASS] = conditions[:, END_MASS_RATIO]
    return options, noise, rows_under(conditions, rules.physics)


def action_masks(positions: PositionsLike, *, cue: CueKind = "free") -> NDArray[np.bool_]:
    """Return which choices of ``action="discrete"`` are available in each position.

    Parameters
    ----------
    positions : PositionsLike
        The m positions: anything that ``Positions.of`` accepts.
    cue : str, optional
        "free" (default) or "real", as of ``Options``: on the table "match", choices whose cue had to be steeper than
        45 degrees are not available, as long as others are.

    Returns
    -------
    numpy.ndarray
        bool (m, 540). Without a direct pot other lines stand for the pots: parts of balls on, or escapes.

    Examples
    --------
    >>> from snooker_env.planning import Position, action_masks
    >>> int(action_masks(Position(cue=(0.0, 0.0), black=(0.0, 1.4605))).sum())
    270
    """
    return available(Positions.of(positions), _rails_of(cue))


def _rails_of(cue: CueKind) -> Floats:
    """Those of the table "match"; ValueError for an unknown cue."""
    return NO_RAILS if cue == "free" else Options(cue=cue).rules.rails


def available(positions: Positions, rails: Floats) -> NDArray[np.bool_]:
    """``action_masks`` with the rails that the cue passes over, ``Rules.rails``."""
    at, options = positions.as_visits(), np.concatenate([STROKES_ONLY, rails])
    out = np.empty((len(at), SIZE), np.bool_)
    masks(np.arange(len(at)), at.positions, at.on_table, at.game, options, out)
    return out


def actions_of(speeds: Vector, aims: Vector, side: Scalars = 0.0, top: Scalars = 0.0) -> NDArray[np.float32]:
    """Convert speeds and aims to actions of ``aim="absolute"``.

    Parameters
    ----------
    speeds, aims : array_like
        float (n,). Cue speeds [m/s], in [0.2, 7]; directions in which the cue ball leaves [rad].
    side, top : array_like or float, optional
        float, scalar or (n,). Tip offsets over R, to the right and up, each in [-0.5, 0.5]; default 0.

    Returns
    -------
    numpy.ndarray
        float32 (n, 4). Actions in [-1, 1].

    Examples
    --------
    >>> from snooker_env.planning import actions_of
    >>> actions_of([3.6], [0.0], top=0.25).tolist()
    [[0.0, 0.0, 0.5, 0.0]]
    """
    fast, turns = array("speeds", speeds, (-1,)), array("aims", aims, (-1,))
    strokes = np.zeros((len(turns), COLUMNS))
    strokes[:, SPEED], strokes[:, SIDE], strokes[:, TOP], strokes[:, AIM] = fast, side, top, turns
    return encoded(_ABSOLUTE, check_strokes(strokes)).astype(np.float32)


def check_strokes(strokes: Any, n: int | None = None) -> Floats:
    """Strokes (n, 5) as float64; ValueError names the first one that is not finite or out of range."""
    a = np.asarray(strokes)
    if a.dtype.kind not in "iuf" or a.ndim != 2 or a.shape[1] != COLUMNS or (n is not None and len(a) != n):
        allowed = f"must be real numbers of shape ({'n' if n is None else n}, 5)"
        raise refuse_what("strokes", f"{a.dtype} array of shape {a.shape}", allowed)
    a = np.ascontiguousarray(a, np.float64)
    most = (MAX_SPEED, FARTHEST, FARTHEST, np.inf, STEEPEST)
    _check_columns(a, (MIN_SPEED, -FARTHEST, -FARTHEST, -np.inf, 0.0), most)
    return a


def _check_columns(strokes: Floats, least: tuple[float, ...], most: tuple[float, ...]) -> None:
    """ValueError names the first number of strokes (n, 5) that is not finite or out of range."""
    fair = np.isfinite(strokes) & (strokes >= least) & (strokes <= most)
    for k, c in np.argwhere(~fair)[:1].tolist():
        number(f"strokes[{k}], {NAMES[c]}", float(strokes[k, c]), least[c], most[c])


def encoded(
    actions: Actions, strokes: Floats, places: Vectors | None = None, lines: Vector | None = None
) -> Floats:
    """Checked strokes (n, 5) as box actions (n, k); what these say beside the stroke is 0: play.

    ``places`` (n, 2) [m]: of a cue ball in hand in the D, by default the middle of the baulk line. ``lines``
    (n,) [rad]: with ``aim="target"``, the direction that each aim is measured from."""
    line = np.zeros(len(strokes)) if lines is None else np.asarray(lines, np.float64)
    out, turned = np.zeros((len(strokes), actions.size)), strokes[:, AIM] - line
    turned = turned - 2.0 * pi * np.round(turned / (2.0 * pi))
    out[:, 0] = 2.0 * (strokes[:, SPEED] - MIN_SPEED) / (MAX_SPEED - MIN_SPEED) - 1.0
    out[:, 1], out[:, 2] = 2.0 * strokes[:, SIDE], 2.0 * strokes[:, TOP]
    out[:, 3] = turned / (pi if lines is None else TARGET_SPAN)
    if (np.abs(out[:, 3]) > 1.0 + 1e-9).any():
        k = int(np.argmax(np.abs(out[:, 3])))
        allowed = f"must be within 3 degrees of the target line, {line[k]:.6g} rad"
        raise refuse(f"strokes[{k}], aim", float(strokes[k, AIM]), allowed)
    if actions.elevation:
        if (steep := strokes[:, ELEVATION].max(initial=0.0)) > actions.steepest + 1e-9:
            allowed = f"must be at most {actions.steepest:.3g} rad, as the option elevation says"
            raise refuse("elevation", float(steep), allowed)
        out[:, 4] = 2.0 * strokes[:, ELEVATION] / actions.steepest - 1.0
    elif strokes[:, ELEVATION].any():
        allowed = "must be 0: actions without elevation=True have a level cue"
        raise refuse("elevation", float(strokes[:, ELEVATION].max()), allowed)
    if actions.placement:
        lie: Any = (0.0, BAULK_Y) if places is None else places
        x, y = np.broadcast_to(lie, (len(strokes), 2)).T
        across = np.clip(x / D_RADIUS, -1.0, 1.0)
        depth = D_RADIUS * np.sqrt(1.0 - across * across)
        back = np.where(depth > 1e-9, np.clip((BAULK_Y - y) / np.maximum(depth, 1e-9), 0.0, 1.0), 0.0)
        at = 4 + actions.elevation
        out[:, at], out[:, at + 1] = across, 2.0 * back - 1.0
    return np.clip(out, -1.0, 1.0)  # removes rounding errors


_ABSOLUTE = Actions("absolute", False, False, Physics())
_ABSOLUTE_RULES = Options().rules


def as_actions(
    positions: PositionsLike,
    rows: Integers,
    choices: Integers,
    *,
    physics: PhysicsLike = None,
    fidelity: Fidelity = "standard",
    cue: CueKind = "free",
) -> NDArray[np.float32]:
    """Convert choices of ``action="discrete"`` to those of ``aim="absolute"``, up to float32's rounding.

    Parameters
    ----------
    positions : PositionsLike
        The m positions: anything that ``Positions.of`` accepts.
    rows, choices : array_like
        int (n,). Row of ``positions`` for each choice, in [0, m); choices, in [0, 540).
    physics : str, dict, Physics or None, optional
        Physical constants with which the aims are solved; default None: the preset "paper".
    fidelity : str, optional
        "fast", "standard" (default), "reference" or "euler:N": how impacts are solved.
    cue : str, optional
        "free" (default) or "real", as of ``Options``: the cue with which the aims are solved, on the table "match".

    Returns
    -------
    numpy.ndarray
        float32 (n, 4). Actions in [-1, 1].

    Examples
    --------
    >>> from snooker_env.planning import Position, as_actions
    >>> as_actions(Position(cue=(0.0, 0.0), black=(0.0, 1.4605)), [0], [67]).shape
    (1, 4)
    """
    options: Any = {"physics": Physics.of(physics), "fidelity": fidelity, "action": "discrete", "cue": cue}
    at = Positions.of(positions).as_visits()
    which = rows_of(at, rows)
    picks = _integers("choices", choices, len(which), 0, SIZE - 1)
    strokes, _ = decoded(Options(**options).rules, at, which, picks[:, None].astype(np.float64))
    return encoded(_ABSOLUTE, strokes).astype(np.float32)


@entry(what="the solving of aims", uses=(solved_aim,))
def _pot_aim(positions, on_table, rows, balls, targets, ghosts, strokes, law, aims):
    (phys, ratios, fidelity, n_steps, most, rails), work = law, new_work()
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
        As for ``as_actions``.

    Returns
    -------
    numpy.ndarray
        float64 (n,). Directions [rad], anticlockwise from +x, as ``actions_of`` takes them.

    Examples
    --------
    >>> from snooker_env.planning import Position, pot_aim
    >>> position = Position(cue=(0.0, 0.0), reds=[(0.5, 0.5)])
    >>> float(pot_aim(position, [0], [1], [(0.8, 0.8)], 2.3)[0].round(3))
    0.785
    """
    dynamics = Dynamics(Physics.of(physics), parse_fidelity(fidelity), _rails_of(cue))
    at = Positions.of(positions).known_to(_ABSOLUTE_RULES)
    return solved_aims(at, rows, balls, targets, strokes, ghosts, dynamics)


def solved_aims(
    at: Positions, rows: Any, balls: Any, targets: Any, strokes: Any, ghosts: Any, dynamics: Dynamics
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
    if np.ndim(strokes) == 2:
        played[:] = array("strokes", strokes, (n, COLUMNS))
    else:
        played[:, SPEED] = array("strokes", strokes, (n,) if np.ndim(strokes) else ())
    most = (np.inf, offset, offset, np.inf, STEEPEST_CUE)
    _check_columns(played, (0.0, -offset, -offset, -np.inf, 0.0), most)
    _pot_aim(at.positions, at.on_table, which, ids, to, behind, played, law_of(dynamics, at), aims)
    return aims


def _integers(field: str, values: Any, n: int, low: int, high: int) -> NDArray[np.int64]:
    """An int64 array (n,) with each number in [low, high]."""
    a = np.asarray(values)
    if a.shape != (n,) or (a.dtype.kind not in "iu" and n):
        raise refuse_what(field, f"{a.dtype} array of shape {a.shape}", f"must be integers of shape ({n},)")
    for k in np.flatnonzero((a < low) | (a > high))[:1].tolist():
        integer(f"{field}[{k}]", int(a[k]), low, high)
    return np.ascontiguousarray(a, np.int64)
