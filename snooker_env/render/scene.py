"""What is there to draw? A table, its lines, balls and overlays, in metres, without a drawing library."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from .._check import number
from .._types import Flags, Floats, Ints, Vector, Vectors
from ..game.balls import CUE
from ..geometry import BALL_RADIUS
from ..physics.engine import EventKind
from ..physics.table import Table, TableLike
from .outline import outline as outline
from .outline import scene_data as scene_data

if TYPE_CHECKING:
    from ..shot import Shot
else:  # a shot draws itself: its module stands above this one
    Shot = Any

TURN_STEP = 1 / 240  # time between stored rotations [s]: at 100 rad/s a quarter of a right angle


class Turning:
    """The rotation of one ball of a ``Shot``."""

    def __init__(self, shot: Shot, ball: int):
        self._shot, self._ball = shot, int(ball)
        count = int(shot.duration / TURN_STEP) + 1
        spins = shot.at((np.arange(count) + 0.5) * TURN_STEP)[2][:, self._ball]
        turns = rotation(spins * TURN_STEP)
        self._kept = np.empty((count + 1, 4))
        self._kept[0] = 1.0, 0.0, 0.0, 0.0
        for k in range(count):
            self._kept[k + 1] = product(turns[k], self._kept[k])

    def at(self, t: float) -> Floats:
        """The unit quaternion (4,) at a time [s] from the start of the shot."""
        k = min(int(t / TURN_STEP), len(self._kept) - 1)
        rest = t - k * TURN_STEP
        return product(rotation(self._shot.at(k * TURN_STEP + rest / 2)[2][self._ball] * rest), self._kept[k])


def rotation(turn: Floats) -> Floats:
    """The quaternion (..., 4) of a rotation about the axis ``turn`` (..., 3) by its length [rad]."""
    turn = np.asarray(turn, dtype=np.float64)
    angle = np.linalg.norm(turn, axis=-1, keepdims=True)
    return np.concatenate([np.cos(angle / 2), turn * (np.sinc(angle / (2 * np.pi)) / 2)], axis=-1)


def product(a: Floats, b: Floats) -> Floats:
    """The product of two quaternions (4,): the rotation ``b``, then ``a``."""
    (aw, ax, ay, az), (bw, bx, by, bz) = a.tolist(), b.tolist()
    w, x = aw * bw - ax * bx - ay * by - az * bz, aw * bx + ax * bw + ay * bz - az * by
    y, z = aw * by - ax * bz + ay * bw + az * bx, aw * bz + ax * by - ay * bx + az * bw
    return np.array([w, x, y, z])


def matrix(q: Floats) -> Floats:
    """The rotation of a quaternion as a matrix (3, 3)."""
    w, x, y, z = q.tolist()
    across = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])  # of the axis: across @ v is its product with v
    return np.eye(3) + 2 * w * across + 2 * across @ across


@dataclass(frozen=True)
class ScoreBar:
    """The content of a score bar under the table, as on television. None, "" and () leave a part out."""

    players: tuple[str, ...] = ()
    scores: tuple[int, ...] = ()
    striker: int | None = None  # an index of players
    break_points: int | None = None  # of the visit so far
    potted: tuple[int, ...] = ()  # ids of the balls of this visit, in order
    reds_left: int | None = None
    points_on: int | None = None  # what is still on the table
    ball_on: str = ""  # "red", "any colour", "free ball", ...
    words: str = ""  # what just happened, as the referee would say it
    win_chance: float | None = None  # how likely the first player wins the frame


@dataclass(frozen=True, eq=False)
class Scene:
    """One picture, with the k balls that are on the table."""

    table: Table
    ids: Ints  # (k,): 0 the cue ball, 1 to 15 reds, 16 to 21 yellow to black
    positions: Floats  # (k, 2) [m]
    heights: Floats  # (k,) above the bed [m]
    ball_radius: float
    paths: dict[int, Floats]  # ball -> (m, 2) points [m]
    ghosts: dict[int, Floats]  # ball -> (m, 2) earlier places [m], drawn faded
    turns: dict[int, Floats]  # ball -> quaternion (w, x, y, z) since the start; such a ball has spots
    text: str  # one line of status, shown without a bar
    bar: ScoreBar | None
    lettered: bool = False  # whether balls carry their letters, so that colours are not needed


def scene(
    table: TableLike,
    positions: Vectors,
    on_table: Flags | None = None,
    *,
    paths: Mapping[int, Vectors] | None = None,
    ghosts: Mapping[int, Vectors] | None = None,
    turns: Mapping[int, Vector] | None = None,
    text: str = "",
    bar: ScoreBar | None = None,
) -> Scene:
    """One picture: n <= 22 balls, ids 0 to n-1, positions (n, 2) or with heights (n, 3), the rest as in ``Scene``, copied."""
    r, table = np.array(positions, np.float64), Table.of(table)
    heights = r[:, 2] if r.shape[1] == 3 else np.zeros(len(r))
    ids = np.arange(len(r)) if on_table is None else np.flatnonzero(np.array(on_table))
    radius = table.ball_radius or BALL_RADIUS
    drawn = _copies(paths), _copies(ghosts), _copies(turns)
    return Scene(table, ids, r[ids, :2], np.maximum(heights[ids], 0.0), radius, *drawn, text, bar)


def _copies(balls: Mapping[int, Vector] | Mapping[int, Vectors] | None) -> dict[int, Floats]:
    return {int(ball): np.array(points, np.float64) for ball, points in (balls or {}).items()}


def ball_paths(shot: Shot, balls: Iterable[int] = (CUE,), step: float = 0.02) -> dict[int, Floats]:
    """Paths {ball: (m, 2)} [m] of the balls that move; impacts are points of them."""
    return {ball: points for ball, (points, _) in _timed_paths(shot, balls, step).items()}


def _timed_paths(shot, balls, step=0.02):
    """Paths {ball: (points (m, 2) [m], their times (m,) [s])}."""
    times = np.append(np.arange(0.0, shot.duration, step), shot.duration)
    impacts = shot.events["time"][shot.events["kind"] <= EventKind.POT]
    times = np.union1d(times, impacts[impacts < shot.duration])
    r = shot.at(times)[0][..., :2]
    paths = {}
    for ball in balls:
        points = r[:, ball]
        moved = np.append(True, np.any(np.abs(np.diff(points, axis=0)) > 1e-5, axis=1))
        if moved.sum() > 1:
            paths[int(ball)] = points[moved], times[moved]
    return paths


def contacts(shot: Shot, ball: int = CUE) -> Floats:
    """Places (m, 2) [m] where a ball met others, in order; none nearer than a radius to the last."""
    return _timed_contacts(shot, ball)[0]


def _timed_contacts(shot, ball):
    """``contacts`` and their times (m,) [s]."""
    met = shot.events[shot.events["kind"] == EventKind.BALL_BALL]
    met = met[(met["i"] == ball) | (met["j"] == ball)]
    places, kept = shot.at(met["time"])[0][:, ball, :2].reshape(-1, 2), []
    for k, place in enumerate(places):
        if not kept or np.hypot(*(place - places[kept[-1]])) > shot.physics.R:
            kept.append(k)
    return places[kept], met["time"][kept]


class Film:
    """The pictures of a ``Shot`` at any time; some balls have a trail, spots, or faded ghosts."""

    def __init__(
        self,
        table: TableLike,
        shot: Shot,
        *,
        trail: Iterable[int] = (CUE,),
        spots: Iterable[int] = (),
        faded: Iterable[int] = (),
        bar: ScoreBar | None = None,
        text: str = "",
    ):
        self.duration: float = shot.duration
        self._table, self._shot = Table.of(table), shot
        self._bar, self._text = bar, text
        self._paths = _timed_paths(shot, trail)
        self._turning = {int(ball): Turning(shot, ball) for ball in spots}
        self._contacts = {int(ball): _timed_contacts(shot, ball) for ball in faded}
        drops = shot.events[np.isin(shot.events["kind"], (EventKind.POT, EventKind.OFF))]
        self._gone_at = np.where(shot.on_table, np.inf, -1.0)  # -1: not on the table when the shot began
        self._gone_at[drops["i"]] = drops["time"]

    def at(self, t: float) -> Scene:
        """The picture at a time [s] from the start of the shot."""
        r = self._shot.at(t)[0]
        paths = {}
        for ball, (points, times) in self._paths.items():
            so_far = int(np.searchsorted(times, t, side="right"))
            done = points[:so_far]
            if np.any(np.abs(done[-1] - r[ball, :2]) > 1e-5):
                done = np.concatenate([done, r[ball : ball + 1, :2]])
            if len(done) > 1:
                paths[ball] = done
        turns = {ball: turning.at(t) for ball, turning in self._turning.items()}
        ghosts = {ball: places[times <= t] for ball, (places, times) in self._contacts.items()}
        made = scene(self._table, r, self._gone_at > t, paths=paths, ghosts=ghosts, turns=turns)
        return replace(made, ball_radius=self._shot.physics.R, bar=self._bar, text=self._text)

    def scenes(self, fps: float = 30.0, speed: float = 1.0) -> Iterator[Scene]:
        """One picture every speed / fps seconds of the shot's own time, and one of its end."""
        step = number("speed", speed, 0.0, open_low=True) / number("fps", fps, 0.0, open_low=True)
        for t in np.append(np.arange(0.0, self.duration, step), self.duration):
            yield self.at(float(t))
