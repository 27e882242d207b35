"""What is a stroke, and which action means it? ``Strokes`` encodes strokes as actions, ``decode`` reads them."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from .._lib.check import refuse, refuse_what
from .._lib.jit import entry
from .._lib.types import Bools, Floats, Ints, Vectors
from ..game.balls import YELLOW
from ..game.fouls import AUTO
from ..game.frame_columns import BALL_ON, PLACE_ANYWHERE, PLAY, PLAY_AGAIN, REPLACE
from ..geometry import BAULK_Y, D_RADIUS, HALF_LENGTH, HALF_WIDTH
from ..physics.cue import squirt
from ..physics.cue_room import NO_RAILS
from ..physics.parameters import Physics
from ..tasks import box_actions as box
from ..tasks import stroke
from ..tasks.declarations import CLAIMS, COLOURS, CONCEDES, OTHER_BEGINS, SAYS_NOTHING
from ..tasks.discrete_actions import POTS, SIZE, Choices, masks
from ..tasks.frames import sayings
from ..tasks.kernel_arrays import C_END_MASS, pack_cue
from ..tasks.options import Options, Rules
from ..tasks.stroke import ShotBuffers, row_of
from .aims import check_columns
from .positions import Positions, PositionsLike, check_rails
from .stroke_columns import AIM, COLUMNS, ELEVATION, LEAST, MOST, SIDE, SPEED, TOP
from .trials import NO_NOISE, TrialVisits

CODES: dict[str, tuple[int, ...]] = {
    "nominate": (AUTO, 0, *range(YELLOW, YELLOW + COLOURS)),
    "decision": (PLAY, PLAY_AGAIN, REPLACE, PLACE_ANYWHERE),
    "declare": (SAYS_NOTHING, CONCEDES, CLAIMS, OTHER_BEGINS),
}  # the codes of what is said with a stroke
EVERY = "an environment with **snooker_env.players.VISITS, or in frames **snooker_env.players.FRAMES, reads every stroke"
SAME = 1e-6  # how little two strokes differ that are one


def _column(column: int, about: str) -> Any:
    """A property of ``Strokes``: a column of its values."""

    def read(self: "Strokes") -> Floats:
        return self.values[:, column]

    return property(read, doc=about)


@dataclass(frozen=True)
class Strokes:
    """What players do in n positions: a stroke each, and what is said with it.

    Parameters
    ----------
    values : numpy.ndarray
        float64 (n, 5), in SI, see ``Planner``.
    place : numpy.ndarray, optional
        float64 (n, 2). Where a cue ball in hand is placed [m]; NaN (default): it is played from where it lies.
    nominate, decision, declare : numpy.ndarray, optional
        int64 (n,). Id of the colour nominated after a red or as a free ball, 0: the free ball is declined, -1 (default): the
        colour first struck. After a foul of the opponent: PLAY (default), PLAY_AGAIN, REPLACE or PLACE_ANYWHERE of
        ``game.frame_columns``. SAYS_NOTHING (default), CONCEDES, CLAIMS or OTHER_BEGINS of ``tasks.declarations``.

    Examples
    --------
    >>> import numpy as np
    >>> from snooker_env.planning import Strokes
    >>> strokes = Strokes(np.array([[2.0, 0.0, 0.2, 1.5, 0.0]]))
    >>> len(strokes), strokes.speed.tolist(), bool(np.isnan(strokes.place).all())
    (1, [2.0], True)
    """

    values: Floats
    place: Floats = None  # type: ignore[assignment]
    nominate: Ints = None  # type: ignore[assignment]
    decision: Ints = None  # type: ignore[assignment]
    declare: Ints = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        values = check_strokes(self.values)
        n = len(values)
        usual: dict[str, Any] = {
            "place": np.full((n, 2), np.nan),
            "nominate": np.full(n, AUTO, np.int64),
            "decision": np.full(n, PLAY, np.int64),
            "declare": np.full(n, SAYS_NOTHING, np.int64),
        }
        object.__setattr__(self, "values", values)
        for name, default in usual.items():
            array = default if getattr(self, name) is None else np.asarray(getattr(self, name))
            if array.shape != default.shape:
                raise refuse_what(name, f"array of shape {array.shape}", f"must have shape {default.shape}")
            for code in set(array.tolist()).difference(CODES[name]) if name in CODES else ():
                k = array.tolist().index(code)
                raise refuse(f"{name}[{k}]", code, f"must be one of {CODES[name]}")
            object.__setattr__(self, name, array.astype(default.dtype))
        sound = np.isnan(self.place).all(1) | (np.abs(self.place) <= (HALF_WIDTH, HALF_LENGTH)).all(1)
        if not sound.all():
            k, allowed = int(np.argmin(sound)), "must be on the table, or NaN and NaN for none"
            raise refuse(f"place[{k}]", self.place[k].tolist(), allowed)

    def __len__(self) -> int:
        return len(self.values)

    def __getitem__(self, rows: Any) -> "Strokes":
        """Some of the strokes: ``rows`` is a slice, a mask or an array of rows."""
        if isinstance(rows, int | np.integer):
            raise refuse("rows", rows, "must be a slice, a mask or an array of rows")
        return self._of(part[rows] for part in self.parts)

    @classmethod
    def join(cls, parts: "Sequence[Strokes]") -> "Strokes":
        """Join several ``Strokes`` in their order."""
        return cls._of(map(np.concatenate, zip(*(one.parts for one in parts), strict=True)))

    @classmethod
    def _of(cls, parts: Iterable[NDArray[Any]]) -> "Strokes":
        made = object.__new__(cls)
        made.__dict__.update(zip(FIELDS, parts, strict=True))
        return made

    @property
    def parts(self) -> tuple[NDArray[Any], ...]:
        """The arrays, in the order of the fields."""
        return self.values, self.place, self.nominate, self.decision, self.declare

    speed: ClassVar[Floats] = _column(SPEED, "Cue speeds [m/s], float64 (n,).")
    side: ClassVar[Floats] = _column(SIDE, "Tip offsets to the right over R, float64 (n,).")
    top: ClassVar[Floats] = _column(TOP, "Tip offsets upwards over R, float64 (n,).")
    aim: ClassVar[Floats] = _column(AIM, "Directions in which the cue ball leaves [rad], float64 (n,).")
    elevation: ClassVar[Floats] = _column(ELEVATION, "Elevations of the cue [rad], float64 (n,).")

    def actions(self, options: Options, positions: PositionsLike) -> Floats:
        """Convert to actions of an environment, with all that is said: float64 (n, k) in [-1, 1].

        ``options``: of the environment, with ``action="box"``. ``positions``: n of them, on which the meaning of a place, a
        nomination, a pot and an aim from a target line depends. ValueError if the environment reads other actions, or a
        stroke, a decision or a declaration that they do not hold: with ``aim="pot"`` they hold strokes along its lines alone.
        A place and a nomination that they do not hold are left out."""
        reads, at = options.rules.actions, Positions.of(positions)
        if len(at) != len(self):
            allowed = f"must be {len(self)}, one for each stroke"
            raise refuse_what("positions", f"{len(at)} positions", allowed)
        if not isinstance(reads, box.Actions):
            raise refuse("options.action", options.action, f'must be "box": {EVERY}')
        turns, least = self.aim / np.pi, box.MIN_SPEED
        speeds = 2.0 * (self.speed - least) / (box.MAX_SPEED - least) - 1.0
        parts = [speeds, 2.0 * self.side, 2.0 * self.top, turns - 2.0 * np.round(0.5 * turns)]
        if reads.aim == "pot":
            logs = np.log(np.maximum(self.speed, least) / box.SLOWEST) / np.log(box.FASTEST / box.SLOWEST)
            parts[:3] = 2.0 * logs - 1.0, self.side / box.MOST_SIDE, self.top / box.MOST_TOP
        for name, holds, least in (
            ("elevation", reads.elevation, 0.0),
            ("decision", "decision" in reads.says, PLAY),
            ("declare", reads.declares, SAYS_NOTHING),
        ):
            if not holds and ((part := getattr(self, name)) > least).any():
                allowed = "must be left out: the actions do not hold it"
                raise refuse(name, part.max().item(), allowed if name == "declare" else f"{allowed}; {EVERY}")
        if reads.elevation:
            if (steep := self.elevation.max(initial=0.0)) > reads.steepest + 1e-9:
                allowed = f"must be at most {reads.steepest:.3g} rad, as the option elevation says; {EVERY}"
                raise refuse("elevation", float(steep), allowed)
            parts.append(2.0 * self.elevation / reads.steepest - 1.0)
        if reads.placement:
            parts += self._place(at)
        if "nominate" in reads.says:
            parts.append(self._nominate(at))
        if "decision" in reads.says:
            again = np.where(self.decision == PLAY_AGAIN, -1.0, 1.0)
            parts.append(np.where(self.decision == PLAY, 0.0, again))
        if reads.declares:
            says = np.where(self.declare == CLAIMS, 1.0, -1.0)
            parts.append(np.where(self.declare == SAYS_NOTHING, 0.0, says))
        actions = np.stack(parts, axis=1)
        if reads.aim == "target":
            actions[:, 3] = self._off_target(options.rules, at, actions)
        actions = np.clip(actions, -1.0, 1.0)  # removes rounding errors
        if reads.aim == "pot":
            actions[:, 3] = self._picks(options.rules, at, actions)
        return actions

    def _off_target(self, rules: Rules, at: Positions, actions: Floats) -> Floats:
        """The component of an aim from the target line, on which an action with 0 there is played."""
        lines = _read_with(0.0, rules, at, actions.clip(-1.0, 1.0))[:, AIM]
        off = _wrap(self.aim - lines) / box.TARGET_SPAN
        if (far := np.abs(off) > 1.0 + 1e-9).any():
            k = int(np.argmax(far))
            allowed = f"must be within 3 degrees of the target line, {lines[k]:.6g} rad; {EVERY}"
            raise refuse(f"aim[{k}]", float(self.aim[k]), allowed)
        return off

    def _picks(self, rules: Rules, at: Positions, actions: Floats) -> Floats:
        """The component that picks the line of each stroke, the first on which an action is that stroke."""
        picks = np.full(len(self), np.nan)
        for line in range(POTS):
            rows, pick = np.flatnonzero(np.isnan(picks)), (line + 0.5) / POTS
            off = _read_with(pick, rules, at[rows], actions[rows]) - self.values[rows]
            off[:, AIM] = _wrap(off[:, AIM])
            picks[rows[(np.abs(off) < SAME).all(axis=1)]] = pick
        if (lost := np.isnan(picks)).any():
            k = int(np.argmax(lost))
            allowed = f'must be a stroke along one of the lines of aim="pot"; {EVERY}'
            raise refuse(f"strokes[{k}]", self.values[k].round(6).tolist(), allowed)
        return picks

    def _place(self, at: Positions) -> list[Floats]:
        x, y = np.where(np.isnan(self.place), at.positions[:, 0], self.place).T
        across = np.clip(x / D_RADIUS, -1.0, 1.0)
        depth = D_RADIUS * np.sqrt(1.0 - across * across)
        back = np.clip((BAULK_Y - y) / np.maximum(depth, 1e-9), 0.0, 1.0)
        return list(np.where(at.anywhere, (x / HALF_WIDTH, y / HALF_LENGTH), (across, 2.0 * back - 1.0)))

    def _nominate(self, at: Positions) -> Floats:
        """The component of the nomination: sixths of the range after a red, sevenths with a free ball."""
        n = np.maximum(self.nominate - YELLOW + 1, 0)  # 0 none, 1 to 6 yellow to black
        after_red = at.game[:, BALL_ON] == 0
        return np.where(after_red, (np.maximum(n, 1) - 0.5) / COLOURS, (n + 0.5) / (1 + COLOURS)) * 2.0 - 1.0


FIELDS = tuple(each.name for each in fields(Strokes))


def check_strokes(strokes: Vectors, n: int | None = None) -> Floats:
    """Strokes (n, 5) as float64; ValueError names the first number that is not finite or out of range."""
    a = np.asarray(strokes)
    if a.dtype.kind not in "iuf" or a.ndim != 2 or a.shape[1] != COLUMNS or (n is not None and len(a) != n):
        allowed = f"must be real numbers of shape ({'n' if n is None else n}, 5)"
        raise refuse_what("strokes", f"{a.dtype} array of shape {a.shape}", allowed)
    a = np.ascontiguousarray(a, np.float64)
    check_columns(a, LEAST, MOST)
    return a


@entry
def _off_the_tip(strokes, cues):
    """Turn the aims of strikes, the cue's, into the directions in which the cue ball leaves the tip [rad]."""
    for j in range(strokes.shape[0]):
        strokes[j, AIM] += squirt(strokes[j, SIDE], cues[row_of(j, cues), C_END_MASS])


def _wrap(angles: Floats) -> Floats:
    return angles - 2.0 * np.pi * np.round(angles / (2.0 * np.pi))


def _read_with(aim: float, rules: Rules, at: Positions, actions: Floats) -> Floats:
    """The strokes (n, 5) that checked actions mean with this component of the aim."""
    actions = actions.copy()
    actions[:, 3] = aim
    nominated = sayings(rules, actions, at.game)[0] if at.of_frames else None
    return decode(rules, at, np.arange(len(at)), actions, nominated)[0]


def decode(
    rules: Rules, at: Positions, which: Ints, actions: Floats, nominated: Ints | None = None
) -> tuple[Floats, Positions]:
    """Strokes (n, 5) that checked actions mean on ``at[which]``, with what is ``nominated`` (n,) in frames, and n positions
    with the cue ball so placed."""
    visits, after, n = TrialVisits(replace(rules, noise=NO_NOISE), 0), at.known_to(rules)[which], len(which)
    visits.lay(after, np.zeros((n, 2), np.uint64))
    if nominated is not None:
        visits.nominated = nominated
    buffers = ShotBuffers(n, 0)
    visits.address(np.arange(n), actions, buffers)
    return intentions_of(buffers, visits.cues), after


def intentions_of(buffers: ShotBuffers, cues: Floats) -> Floats:
    """Strokes (n, 5) that were struck without errors; ``cues``: packed, one row for all or each."""
    strokes = buffers.shots[:, stroke.CUE_SPEED : stroke.ROOM].copy()
    changed = buffers.shots[:, stroke.ROOM] != 0  # what is meant does not say how the cue finds room
    strokes[changed] = buffers.shots[changed, stroke.MEANT :]
    _off_the_tip(strokes, cues)
    off = np.arctan2(np.sin(strokes[:, AIM]), np.cos(strokes[:, AIM]))
    level = np.arctan2(buffers.shots[:, stroke.VY], buffers.shots[:, stroke.VX])
    strokes[:, AIM] = np.where(changed | (strokes[:, ELEVATION] > 0.0), off, level)
    return strokes


def action_masks(positions: PositionsLike, *, rails: Floats = NO_RAILS) -> Bools:
    """Return which choices of ``action="discrete"`` are available in each position.

    Parameters
    ----------
    positions : PositionsLike
        The m positions, see ``Positions.of``.
    rails : numpy.ndarray, optional
        Those that a real cue passes over, ``Planner.rules.rails``: choices whose cue had to be steeper than 45 degrees are
        not available, as long as others are. Default: a free cue.

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
    at, cue = Positions.of(positions).as_visits(), pack_cue(Physics(), check_rails(rails))
    out = np.empty((len(at), SIZE), np.bool_)
    masks(np.arange(len(at)), at.positions, at.on_table, at.game, Choices().pack(), cue, out)
    return out
