"""What does a file of tracked shots hold? This reads and checks the shots, and finds cue balls, contacts and wild samples.

The format: {"shots": [{"id": 0, "balls": {"1": {"t": [...], "x": [...], "y": [...]}, "2": ..., "3": ...}}, ...]},
in metres and seconds, with the origin in the middle of a carom table (noses at x +-0.71 and y +-1.42) and three balls.
"""

from dataclasses import dataclass, field

import numpy as np

from snooker_env._lib.files import read_json

R = 0.03075
HALF = (0.71, 1.42)
"""Radius of the balls, and the noses' distances from the middle [m]."""

MOVED = 0.005  # m from its first sample: the ball moves (noise 0.001)
_OVERLAP = 5e-7  # m; the engine takes balls that overlap by 1e-6
_CUSHIONS = ("right", "left", "far", "near")
"""Names of the cushions at x +, x -, y +, y -."""


@dataclass
class Track:
    """The samples of one ball without wild ones: t [s], xy [m]."""

    t: np.ndarray
    xy: np.ndarray
    wild: int = 0


@dataclass
class Tracked:
    """One shot; the cue ball is ``balls[0]``.

    ``moved``: time of the first sample away from its place; ``still``: the last sample before. ``contacts``: contacts of the
    cue ball in order, each (time, what), with "ball 1", "ball 2" or a cushion's name.
    """

    id: int
    balls: list
    names: list
    still: float
    moved: float
    contacts: list = field(default_factory=list)

    @property
    def places(self):
        """Places of the balls before the strike; a ball that overlaps a nose or a ball is moved off it."""
        return self._places

    def __post_init__(self):
        self._places = _apart(np.array([b.xy[0] for b in self.balls]))


def _apart(p):
    """Places for the engine, without overlaps of noses and balls."""
    p = p.copy()
    for _ in range(20):
        for a in range(2):
            p[:, a] = np.clip(p[:, a], R - HALF[a], HALF[a] - R)
        for i in range(len(p)):
            for j in range(i):
                gap = p[i] - p[j]
                d = np.hypot(*gap)
                if d < 2 * R - _OVERLAP:
                    push = 0.5 * (2 * R - d) * gap / d
                    p[i] += push
                    p[j] -= push
    return p


def _numbers(where, ball, key):
    if not isinstance(ball, dict) or key not in ball:
        raise ValueError(f"{where}.{key} is missing")
    try:
        found = np.array(ball[key], dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"{where}.{key} must be a list of numbers") from None
    if found.ndim != 1 or len(found) == 0 or not np.isfinite(found).all():
        raise ValueError(f"{where}.{key} must be a list of finite numbers, with one at least")
    return found


def _wild(t, xy):
    """Which samples lie where no ball of this track can have been, because the way there and back would take 1.5 times
    the speeds around the sample."""
    wild = np.zeros(len(t), bool)
    if len(t) < 5:
        return wild
    step = np.hypot(*np.diff(xy, axis=0).T)
    speed = step / np.diff(t)
    for k in range(1, len(t) - 1):
        if t[k + 1] - t[k - 1] > 0.3 or wild[k - 1]:
            continue
        beside = max(speed[k - 2] if k > 1 else 0.0, speed[k + 1] if k + 1 < len(speed) else 0.0)
        wild[k] = step[k - 1] + step[k] > 1.5 * beside * (t[k + 1] - t[k - 1]) + 0.06
        wild[k] &= step[k - 1] + step[k] > 2.0 * np.hypot(*(xy[k + 1] - xy[k - 1])) + 0.04
    wild[1] = False  # the strike itself: the ball is at rest before
    return wild


def _track(where, ball):
    t, x, y = (_numbers(where, ball, key) for key in "txy")
    if not len(t) == len(x) == len(y):
        raise ValueError(
            f"{where}: t, x and y have {len(t)}, {len(x)} and {len(y)} samples, must have as many"
        )
    if (np.diff(t) <= 0).any():
        raise ValueError(f"{where}.t must rise from sample to sample")
    for name, along, half in (("x", x, HALF[0]), ("y", y, HALF[1])):
        if np.abs(along).max() > half:
            raise ValueError(f"{where}.{name} reaches {np.abs(along).max():.4g} m, the nose lies at {half} m")
    xy = np.stack([x, y], axis=1)
    wild = _wild(t, xy)
    return Track(t[~wild], xy[~wild], int(wild.sum()))


def _first_moves(track):
    away = np.hypot(*(track.xy - track.xy[0]).T) > MOVED
    return int(np.argmax(away)) if away.any() else -1


def read(file):
    """Read the shots of a file, [Tracked]. The ValueError names an invalid field."""
    try:
        data = read_json(file, "file", "must be JSON of tracked shots")
    except OSError as error:
        raise ValueError(f"{file}: {error.strerror or error}") from None
    if not isinstance(data, dict) or not isinstance(data.get("shots"), list) or not data["shots"]:
        raise ValueError(f"{file}: shots is missing, it must be a list of shots")
    return [_shot(f"shots[{k}]", shot) for k, shot in enumerate(data["shots"])]


def _shot(where, shot):
    if not isinstance(shot, dict) or not isinstance(shot.get("balls"), dict):
        raise ValueError(f"{where}.balls is missing")
    balls = shot["balls"]
    if len(balls) != 3:
        raise ValueError(f"{where}.balls has {len(balls)} balls, must have 3")
    if not isinstance(shot.get("id"), int):
        raise ValueError(f"{where}.id is missing, it must be a whole number")
    names = sorted(balls)
    tracks = [_track(f"{where}.balls.{name}", balls[name]) for name in names]
    first = [_first_moves(track) for track in tracks]
    if max(first) < 0:
        raise ValueError(f"{where}.balls: no ball moves")
    cue = min((k for k in range(3) if first[k] >= 0), key=lambda k: tracks[k].t[first[k]])
    order = [cue, *(k for k in range(3) if k != cue)]
    at = first[cue]
    found = Tracked(
        shot["id"],
        [tracks[k] for k in order],
        [names[k] for k in order],
        float(tracks[cue].t[max(at - 1, 0)]),
        float(tracks[cue].t[at]),
    )
    found.contacts = contacts(found)
    return found


def contacts(shot):
    """The contacts of the measured cue ball, [(time, what)], see ``Tracked``."""
    found = _cushions(shot.balls[0]) + _hits(shot)
    return sorted(found)


def _cushions(track):
    """Contacts with cushions: the track turns near a nose, and the straight lines before and after meet at it."""
    found = []
    for axis in range(2):
        edge = HALF[axis] - R
        for sign, name in ((1, _CUSHIONS[2 * axis]), (-1, _CUSHIONS[2 * axis + 1])):
            gap = edge - sign * track.xy[:, axis]
            found += [(time, name) for time in _turns(track.t, gap)]
    return found


def _turns(t, gap, near=0.25, touch=0.012, least=0.006):
    """Times at which the distance from a cushion turns at 0, having been larger by ``least`` before and after."""
    found, k, n = [], 0, len(gap)
    high = gap[0]  # the largest since the last turn
    while k < n - 1:
        high = max(high, gap[k])
        if not (gap[k + 1] > gap[k] and gap[k] < near):
            k += 1
            continue
        last = k
        while last + 1 < n and gap[last + 1] >= gap[last]:
            last += 1
        away = gap[k:].max() if gap[k] < touch else gap[last]
        if high - gap[k] > least and away - gap[k] > least:
            time, reached = _crossing(t, gap, k)
            unseen = t[min(k + 1, n - 1)] - t[k - 1] if k else 0.0
            if min(gap[k], reached) < max(
                touch, 0.08 * unseen
            ):  # in a pause of the track the lines meet less precisely
                found.append(time)
                high = gap[k]
        k = last
    return found


def _crossing(t, gap, k):
    """Time and gap where the lines through the two samples before and after the turn meet; k is the deepest sample."""
    best = (float(t[k]), float(gap[k]))
    for a in (k, k - 1):  # the turn lies after sample a
        if a < 1 or a + 2 >= len(t):
            continue
        v0 = (gap[a] - gap[a - 1]) / (t[a] - t[a - 1])
        v1 = (gap[a + 2] - gap[a + 1]) / (t[a + 2] - t[a + 1])
        if v0 >= 0 or v1 <= 0:
            continue
        time = (gap[a + 1] - gap[a] + v0 * t[a] - v1 * t[a + 1]) / (v0 - v1)
        if t[a] - 1e-9 <= time <= t[a + 1] + 1e-9:
            reached = gap[a] + v0 * (time - t[a])
            if reached < best[1]:
                best = (float(time), float(reached))
    return best


def _hits(shot):
    """The first contact of the cue ball with each other ball: when that ball begins to move next to the cue ball."""
    found = []
    for k in (1, 2):
        track, at = shot.balls[k], _first_moves(shot.balls[k])
        if at < 0:
            continue
        when = _start(track, at)
        reach = []
        for time in np.linspace(max(track.t[at - 1], when - 0.03), track.t[at], 12):
            reach.append(np.hypot(*(place(shot.balls[0], time) - track.xy[0])))
        if min(reach) < 2 * R + 0.03:
            found.append((when, f"ball {k}"))
    return found


def _start(track, at):
    """When a ball begins to move: its first two moving samples extrapolated back to its place, within the samples' gap."""
    low, high = max(track.t[at - 1], track.t[at] - 0.1), track.t[at]
    if at + 1 < len(track.t):
        step = np.hypot(*(track.xy[at + 1] - track.xy[at])) / (track.t[at + 1] - track.t[at])
        if step > 0:
            return float(np.clip(high - np.hypot(*(track.xy[at] - track.xy[0])) / step, low, high))
    return float(high)


def place(track, time):
    """The place on the track at a time, by linear interpolation."""
    return np.array([np.interp(time, track.t, track.xy[:, axis]) for axis in range(2)])
