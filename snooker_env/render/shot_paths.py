"""What does a diagram show of a shot? Paths within ``STRAY``, contacts, speeds, and the tip."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from .._types import Floats
from ..physics.cloth import AIR, AX, AY, BEND, FALLING, ROLL, SEGMENT_BALL, SEGMENT_STATE, SLIDE, T0, VX, VY
from ..physics.columns import AXIS_X, FALL_X, FALL_Y, JAW_X, JAW_Y, NOSE_AXIS, NOSE_LEVEL, NOSE_SIDE
from ..physics.engine import EventKind
from ..physics.parameters import Physics
from ..physics.trajectory import check_path

if TYPE_CHECKING:
    from ..shot import Shot
else:  # a shot draws itself: its module stands above this one
    Shot = Any

STRAY = 1e-4  # the largest distance of a path from the lines that are drawn [m]
STILL = 1e-3  # A ball that moved less than this is drawn as one that did not move [m]

Kind = Literal["slide", "roll", "fall", "fly"]
_KINDS: dict[int, Kind] = {SLIDE: "slide", ROLL: "roll", BEND: "roll", FALLING: "fall", AIR: "fly"}


class Piece(NamedTuple):
    """A part of a ball's path in which it does one thing: slides, rolls, flies, or falls into a pocket."""

    kind: Kind
    times: Floats  # (m,) times [s]
    points: Floats  # (m, 2) positions at these times, from ``Shot.at`` [m]


class Meeting(NamedTuple):
    """A ball meets a ball, a cushion, a jaw or a pocket."""

    time: float
    kind: EventKind
    ball: int
    other: int  # index of the ball, nose, jaw or pocket, as in the log of events
    place: Floats  # (2,) the point of contact [m]; for a pocket the centre of its fall
    centre: Floats  # (2,) centre of the ball [m]
    velocity: Floats  # (2,) of the ball just before [m/s]
    speed: float  # the same without its direction
    after: float  # of the ball just after [m/s]

    @property
    def cut(self) -> float:
        """Angle [rad] between the direction before and the line of centres; 0 is full."""
        v, line = self.velocity, self.place - self.centre
        return float(np.arctan2(abs(v[0] * line[1] - v[1] * line[0]), v @ line))


def pieces(shot: Shot, ball: int) -> list[Piece]:
    """The path of a ball, empty if it never moves; like pieces without an impact between are joined."""
    rows = shot.segments[shot.segments[:, SEGMENT_BALL] == ball]
    ends = np.append(rows[1:, T0], shot.duration)
    events = shot.events[shot.events["kind"] <= EventKind.POT]
    impacts = set(events["time"][(events["i"] == ball) | (events["j"] == ball)].tolist())
    phases: list[tuple[Kind, list[float]]] = []
    for row, end in zip(rows, ends, strict=True):
        kind = _KINDS.get(int(row[SEGMENT_STATE]))
        start = float(row[T0])
        if kind is None or end <= start or not (row[VX] or row[VY] or row[AX] or row[AY]):
            continue
        times = np.linspace(start, end, 1 + _steps(row, end - start)).tolist()
        if phases and phases[-1][0] == kind and phases[-1][1][-1] == start and start not in impacts:
            phases[-1][1].extend(times[1:])
        else:
            phases.append((kind, times))
    if not phases:
        return []
    at = shot.at(np.concatenate([times for _, times in phases]))[0][:, ball, :2]
    parts = np.split(at, np.cumsum([len(times) for _, times in phases])[:-1])
    return [Piece(kind, np.array(t), points) for (kind, t), points in zip(phases, parts, strict=True)]


def _steps(row, duration):
    """How many chords replace a segment: a parabola is at most a dt^2 / 8 away from one."""
    (vx, vy), (ax, ay) = row[[VX, VY]], row[[AX, AY]]
    speed, pull = np.hypot(vx, vy), np.hypot(ax, ay)
    drags = row[SEGMENT_STATE] == BEND and abs(vx * ay - vy * ax) <= 1e-12 * speed * pull
    if drags or row[SEGMENT_STATE] in (ROLL, FALLING, AIR):  # straight, without a turning point
        return 1
    return int(np.clip(np.ceil(duration * np.sqrt(pull / (8 * STRAY))), 1, 256))


def paths(shot: Shot) -> dict[int, list[Piece]]:
    """The pieces of each ball that moved, by its id."""
    check_path(shot.segments)
    every = {ball: pieces(shot, ball) for ball in range(len(shot.positions))}
    return {ball: parts for ball, parts in every.items() if any(map(_moves, parts))}


def _moves(piece):
    return np.ptp(piece.points, axis=0).max() > STILL


def cue_ball(shot: Shot) -> int | None:
    """The ball that is fastest at the start; None if none moves."""
    v = np.hypot(*shot.at(0.0)[1][:, :2].T)
    return int(v.argmax()) if v.max() > 0 else None


def velocity_before(shot: Shot, ball: int, time: float) -> Floats:
    """Velocity of a ball just before its event at that time: (2,) [m/s]."""
    rows = shot.segments[(shot.segments[:, SEGMENT_BALL] == ball) & (shot.segments[:, T0] < time)]
    if not len(rows):  # it happens at the start
        return shot.at(0.0)[1][ball, :2]
    row = rows[-1]
    return row[[VX, VY]] + row[[AX, AY]] * (time - row[T0])


def contacts(shot: Shot, ball: int) -> Iterator[Meeting]:
    """A ball's meetings in order of time; it is ``Meeting.ball`` even where the other struck it."""
    R = shot.physics.R
    for time, number, i, j, *_ in shot.events[shot.events["kind"] <= EventKind.POT].tolist():
        kind = EventKind(number)
        if ball != i and not (kind == EventKind.BALL_BALL and ball == j):
            continue
        other = int(j if ball == i else i)
        r, v = (part[:, :2] for part in shot.at(time)[:2])
        centre, place = r[ball], r[ball]
        if kind == EventKind.BALL_BALL:
            place = (r[ball] + r[other]) / 2
        elif shot.table is not None and kind == EventKind.CUSHION:
            nose = shot.table.noses[other]
            place = centre.copy()
            place[0 if nose[NOSE_AXIS] == AXIS_X else 1] = nose[NOSE_SIDE] * nose[NOSE_LEVEL]
        elif shot.table is not None and kind == EventKind.JAW:
            towards = shot.table.jaws[other, [JAW_X, JAW_Y]] - centre
            place = centre + R * towards / np.hypot(*towards)
        elif shot.table is not None and kind == EventKind.POT:
            place = shot.table.falls[other, [FALL_X, FALL_Y]]
        before = velocity_before(shot, ball, time)
        speed, after = (float(np.hypot(*u)) for u in (before, v[ball]))
        yield Meeting(time, kind, ball, other, place, centre, before, speed, after)


class Tip(NamedTuple):
    """Where and how a cue strikes: offsets over R (+ right, + up), speed [m/s], elevation [rad]."""

    side: float
    top: float
    speed: float
    elevation: float


def tip_of(velocity: Floats, spin: Floats, physics: Physics) -> Tip:
    """The strike for a velocity and spin: ``physics.cue.struck`` solved; level, if no side or slip is left."""
    v, w = np.asarray(velocity, np.float64), np.asarray(spin, np.float64)
    slip = v + physics.R * np.array([-w[1], w[0]])
    size = float(np.hypot(*slip))
    if size > 1e-9 and w[2]:
        # as before the friction j = mu_s V sin(elevation), whose spin about the path is linear in j
        u = slip / size
        turned = float(w[:2] @ u) + 2.5 / physics.R * float(u[1] * v[0] - u[0] * v[1])
        j = physics.mu_s * float(w[:2] @ v) / (float(w[2]) - physics.mu_s * turned)
        if j > 0.0:
            v, w = v + j * u, w + 2.5 * j / physics.R * np.array([u[1], -u[0], 0.0])
    speed = float(np.hypot(*v))
    c, s = v / speed
    about_path, about_up = float(w[0] * c + w[1] * s), float(w[2])
    elevation = float(np.arctan2(about_path * np.sign(about_up), abs(about_up))) if about_up else 0.0
    elevation = elevation if elevation > 1e-9 else 0.0  # no cue has a negative one
    level = float(np.cos(elevation))
    q = 2.5 * speed / level / physics.R
    return Tip(about_up / level / q, float(w[1] * c - w[0] * s) / q, speed / level, elevation)


def arrow_places(points: Floats, spacing: float) -> list[tuple[Floats, Floats]]:
    """Places of arrowheads on a line (m, 2), one each ``spacing`` [m], and their unit directions."""
    steps = np.diff(points, axis=0)
    lengths = np.hypot(*steps.T)
    total = float(lengths.sum())
    n = max(round(total / spacing), int(total >= spacing / 2))
    ends, heads = np.cumsum(lengths), []
    for far in (np.arange(n) + 0.5) * total / max(n, 1):
        k = int(np.searchsorted(ends, far))
        unit = steps[k] / lengths[k]
        heads.append((points[k + 1] - (ends[k] - far) * unit, unit))
    return heads
