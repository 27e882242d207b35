"""What does a referee see on a table at rest? Snookers, clear paths, spots and places in the D, for the
oracle of frames.

Written from the rules of snooker (Section 2 Rules 17 and 18, Section 3 Rules 5, 7, 12 and 14) and from the
table's drawing, in metres, with no use of ``snooker_env.game``. Every function that decides takes ``slack``:
all balls that may obstruct are larger by it. ``decided`` asks with a slack of both signs; where the answers
differ, rounding decides, and the answer is None.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable

import numpy as np
from scipy import ndimage

R = 0.02625
D2 = 2 * R
HALF_WIDTH, HALF_LENGTH = 0.889, 1.7845
BAULK, D_RADIUS = -1.0475, 0.292
SPOTS = {
    16: (0.292, BAULK),
    17: (-0.292, BAULK),
    18: (0.0, BAULK),
    19: (0.0, 0.0),
    20: (0.0, 0.89225),
    21: (0.0, 1.4605),
}
TOUCH, CLEARANCE = 50e-6, 1e-4
"""A referee sees no gap below the first [m]; a ball that is put down beside another, so that it does not
touch, is this far off it [m]."""
NEAR = 1e-9
"""Two lengths that differ by less are equal to rounding [m]."""

_SIGNS = [(a, b) for a in (-1, 1) for b in (-1, 1)]
JAWS = np.array(
    [(a * (HALF_WIDTH - 0.0976346), b * (HALF_LENGTH + 0.0889), 0.0889) for a, b in _SIGNS]
    + [(a * (HALF_WIDTH + 0.0889), b * (HALF_LENGTH - 0.0976346), 0.0889) for a, b in _SIGNS]
    + [(a * (HALF_WIDTH + 0.0669), b * 0.109185, 0.0669) for a, b in _SIGNS]
)
"""Curved faces of the cushions: centre x, y and radius of each arc [m]; the rest of each circle lies inside
its cushion."""


def decided(question: Callable[[float], bool], slack: float = NEAR) -> bool | None:
    """The answer to ``question(slack)``, or None where it hangs on less than ``slack``."""
    generous, strict = question(-slack), question(slack)
    return generous if generous == strict else None


def enter(origin, direction, centre, radius):
    """Distance along a ray at which it enters a circle; inf if it never does, 0 from the inside if it goes
    further in."""
    to = np.asarray(centre) - origin
    along = float(to @ direction)
    square = along * along - float(to @ to) + radius * radius
    if square <= 0 or along <= 0:
        return math.inf
    return max(0.0, along - math.sqrt(square))


def edges(cue, ball):
    """The two straight strokes that just touch a ball: direction and length of each. None where the cue ball
    touches it already."""
    to = np.asarray(ball) - cue
    far = float(np.hypot(*to))
    if far <= D2:
        return []
    length = math.sqrt(far * far - D2 * D2)
    sine, cosine = D2 / far, length / far
    u = to / far
    return [
        (np.array([cosine * u[0] - s * sine * u[1], s * sine * u[0] + cosine * u[1]]), length)
        for s in (1, -1)
    ]


def blockers(cue, ball, others, slack=0.0):
    """Indices of the balls in ``others`` (k, 2) that stop the stroke at either extreme edge of ``ball``
    (Section 2 Rule 17).

    None of them if the curved face of a cushion stops one of the two strokes and is nearer than any of the
    balls (17(e)).
    """
    found, nearest, curved = set(), math.inf, math.inf
    for direction, length in edges(cue, ball):
        for jaw in JAWS:
            if enter(cue, direction, jaw[:2], jaw[2] + R) < length:
                curved = min(curved, float(np.hypot(*(jaw[:2] - cue))) - jaw[2])
        for k, other in enumerate(others):
            if enter(cue, direction, other, D2 + slack) < length:
                found.add(k)
                nearest = min(nearest, float(np.hypot(*(np.asarray(other) - cue))) - R - slack)
    return set() if curved < nearest else found


def snookered_on(cue, ball, others, slack=0.0):
    """Whether an extreme edge of one ball on is hidden by a ball not on.

    A ball on that the cue ball touches is hit by playing away from it (Section 3 Rule 8), so nothing can hide
    it.
    """
    if np.hypot(*(np.asarray(ball) - cue)) <= D2 + 50e-6:
        return False
    to = np.asarray(others).reshape(-1, 2)
    for direction, length in edges(cue, ball):
        along = np.clip((to - cue) @ direction, 0.0, length)
        if (np.hypot(*(to - cue - along[:, None] * direction).T) < D2 + slack).any():
            return bool(blockers(cue, ball, to, slack))
    return False


def snookered(cue, balls_on, others, slack=0.0):
    """Whether every ball on is hidden at an edge at least."""
    return all(snookered_on(cue, ball, others, slack) for ball in balls_on)


def effective_snookering_balls(cue, balls_on, others, slack=0.0):
    """Indices of the effective snookering balls: those nearest of what hides each ball on, if it is the same
    for all of them."""
    nearest = []
    for ball in balls_on:
        found = blockers(cue, ball, others, slack)
        if not found:
            return set()
        far = {k: float(np.hypot(*(np.asarray(others[k]) - cue))) for k in found}
        least = min(far.values())
        nearest.append({k for k in found if far[k] <= least + NEAR})
    return set.intersection(*nearest) if nearest else set()


def _margins(places, ball, others):
    """How far (m,) the worse of a ball's two edges is from being hidden at each place [m]; not positive:
    hidden. Jaws are left out."""
    to = ball - places
    far = np.maximum(np.hypot(*to.T), D2)
    length = np.sqrt(far**2 - D2**2)
    u = to / far[:, None]
    worst = np.full(len(places), np.inf)
    for s in (1, -1):
        sine, cosine = s * D2 / far, length / far
        direction = np.stack([cosine * u[:, 0] - sine * u[:, 1], sine * u[:, 0] + cosine * u[:, 1]], axis=1)
        off = others[None] - places[:, None]
        along = np.clip((off * direction[:, None]).sum(-1), 0.0, length[:, None])
        gap = np.hypot(*np.moveaxis(off - along[..., None] * direction[:, None], -1, 0)) - D2
        worst = np.minimum(worst, gap.min(axis=1))
    return worst


def _d_grid(step):
    x, y = np.meshgrid(np.arange(-D_RADIUS, D_RADIUS + step, step), np.arange(0.0, D_RADIUS + step, step))
    inside = x**2 + y**2 <= D_RADIUS**2
    rim = np.linspace(0, math.pi, 181)
    x = np.concatenate([x[inside], D_RADIUS * np.cos(rim)])
    y = np.concatenate([y[inside], D_RADIUS * np.sin(rim)])
    return np.stack([x, BAULK - y], axis=1)


def _bed_grid(step):
    x, y = np.meshgrid(np.arange(-0.86, 0.87, step), np.arange(-1.75, 1.76, step))
    places = np.stack([x.ravel(), y.ravel()], axis=1)
    return places[[free_anywhere(place, []) for place in places]]


GRID = _d_grid(0.008)


def snookered_in_hand(balls_on, others, everything):
    """Whether the cue ball is snookered wherever it may stand in the D, with the best margin found [m].

    A search, not a formula: a grid over the D, then steps that halve around its best places. Places where the
    cue ball would touch another ball are no places. Returns (snookered, margin); a margin near 0 says that
    the answer is not certain.
    """
    balls_on, others, everything = (
        np.asarray(a, float).reshape(-1, 2) for a in (balls_on, others, everything)
    )
    if not len(others):
        return False, math.inf

    def value(places):
        room = np.hypot(*np.moveaxis(places[:, None] - everything[None], -1, 0)).min(axis=1) - D2
        sight = np.max([_margins(places, ball, others) for ball in balls_on], axis=0)
        return np.minimum(sight, room)

    best = float(value(GRID[::29]).max())  # most often some places out of all show that there is no snooker
    if best > 1e-5:
        return False, best
    at = value(GRID)
    best = float(at.max())
    if best > NEAR:
        return False, best
    step, centres = 0.008, GRID[np.argsort(-at)[:40]]
    turns = np.linspace(0, 2 * math.pi, 12, endpoint=False)
    ring = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    while step > 1e-8:
        near = (centres[:, None] + step * np.concatenate([ring, 0.5 * ring, [[0, 0]]])[None]).reshape(-1, 2)
        near[:, 1] = np.minimum(near[:, 1], BAULK)
        off = near - [0, BAULK]
        far = np.hypot(*off.T)
        near = np.where(
            (far > D_RADIUS)[:, None], [0, BAULK] + off * (D_RADIUS / np.maximum(far, 1e-12))[:, None], near
        )
        at = value(near)
        best = max(best, float(at.max()))
        if best > NEAR:
            return False, best
        centres, step = near[np.argsort(-at)[:12]], 0.6 * step
    for ball in balls_on:  # a curved face may be nearer than what hides the ball: then it is not snookered
        if np.hypot(*(JAWS[:, :2] - ball).T).min() < 0.2:
            room = np.hypot(*np.moveaxis(GRID[:, None] - everything[None], -1, 0)).min(axis=1) >= D2
            if any(not snookered_on(place, ball, others) for place in GRID[room][::4]):
                return False, math.inf
    return True, best


def _stops(cue, direction, ball, others, slack):
    """How far a straight stroke goes until it hits ``ball``, if nothing stops it before; else None."""
    hit = enter(cue, direction, ball, D2)
    if not math.isfinite(hit):
        return None
    if any(enter(cue, direction, other, D2 + slack) < hit for other in others):
        return None
    if any(enter(cue, direction, jaw[:2], jaw[2] + R) < hit for jaw in JAWS):
        return None
    x, y = cue + hit * direction
    outside = (abs(x) > HALF_WIDTH - R and 0.109185 < abs(y) < HALF_LENGTH - 0.0976346) or (
        abs(y) > HALF_LENGTH - R and abs(x) < HALF_WIDTH - 0.0976346
    )
    return None if outside else hit


def shut_in(cue, balls_on, others, h=0.004):
    """Whether no way over the bed, however it turns, leads the cue ball to a ball on: by flooding a grid. None if a
    passage as narrow as the grid decides."""
    far = np.array([HALF_WIDTH, HALF_LENGTH]) - R
    x, y = np.meshgrid(*(np.arange(-a, a, h) for a in far), indexing="ij")

    def away(at):
        return np.hypot(x - at[0], y - at[1])

    def reached(reach):
        free = np.all([away(ball) >= reach for ball in others], axis=0) | (away(cue) < h)  # it lies there
        rooms, _ = ndimage.label(free)
        mine = rooms.ravel()[away(cue).argmin()]
        return any((free & (rooms == mine) & (away(ball) < D2 + 2 * h)).any() for ball in balls_on)

    thin, thick = reached(D2 - h), reached(D2 + h / 2)
    return not thin if thin == thick else None


def clear_path(cue, balls_on, others, slack=0.0):
    """Whether the cue ball can go straight to some part of a ball on, past all balls not on and all cushions.

    Between two neighbouring critical directions (tangents, and those that hit two balls at once) nothing
    changes, so one direction between each two of them decides.
    """
    cue = np.asarray(cue, float)
    for ball in balls_on:
        to = np.asarray(ball) - cue
        far = float(np.hypot(*to))
        if far <= D2 + 50e-6:
            return True  # it touches a ball on
        middle, half = math.atan2(to[1], to[0]), math.asin(D2 / far)
        marks = {-half, half}

        def mark(x, y, marks=marks, middle=middle):
            marks.add((math.atan2(y, x) - middle + math.pi) % (2 * math.pi) - math.pi)

        obstacles = [(np.asarray(o, float), D2 + slack) for o in others] + [
            (jaw[:2], jaw[2] + R) for jaw in JAWS
        ]
        for centre, radius in obstacles:
            off = centre - cue
            distance = float(np.hypot(*off))
            if distance > radius:
                turn, at = math.asin(radius / distance), math.atan2(off[1], off[0])
                for angle in (at - turn, at + turn):
                    mark(math.cos(angle), math.sin(angle))
            else:  # the cue ball is against it: it can go along it, or away
                for s in (1, -1):
                    mark(-s * off[1], s * off[0])
            between = np.asarray(ball) - centre
            d = float(np.hypot(*between))
            if 0 < d < D2 + radius and d > abs(radius - D2):  # places that touch both at once
                a = (d * d + radius * radius - D2 * D2) / (2 * d)
                h = math.sqrt(max(0.0, radius * radius - a * a))
                foot = centre + a * between / d - cue
                for s in (1, -1):
                    mark(foot[0] - s * h * between[1] / d, foot[1] + s * h * between[0] / d)
        for axis, limit in ((0, HALF_WIDTH - R), (1, HALF_LENGTH - R)):
            for side in (-limit, limit):
                gap = side - ball[axis]
                if abs(gap) < D2:
                    other = math.sqrt(D2 * D2 - gap * gap)
                    for s in (1, -1):
                        point = np.array(ball, float)
                        point[axis], point[1 - axis] = side, point[1 - axis] + s * other
                        mark(*(point - cue))
        order = sorted(m for m in marks if -half <= m <= half)
        for low, high in itertools.pairwise(order):
            if (high - low) * far < 1e-12:
                continue
            angle = middle + 0.5 * (low + high)
            if _stops(cue, np.array([math.cos(angle), math.sin(angle)]), ball, others, slack) is not None:
                return True
    return False


def full_ball(cue, balls_on, others, slack=0.0):
    """Whether a ball on can be hit full in the middle: the stroke along the line of centres meets no ball not
    on and no cushion."""
    cue = np.asarray(cue, float)
    for ball in balls_on:
        to = np.asarray(ball) - cue
        far = float(np.hypot(*to))
        if far <= D2 + 50e-6 or _stops(cue, to / far, ball, others, slack) is not None:
            return True
    return False


def free(place, others, slack=0.0):
    """Whether a ball at ``place`` would touch none of ``others``."""
    others = np.asarray(others, float).reshape(-1, 2)
    return not len(others) or bool(np.hypot(*(others - place).T).min() >= D2 + slack)


def free_anywhere(place, others, slack=0.0):
    """Whether the cue ball in hand anywhere may stand at ``place``: on the bed, 0.15 m from the pockets and
    0.1 mm from the balls."""
    x, y = np.abs(place)
    corner, middle = np.hypot(x - HALF_WIDTH, y - HALF_LENGTH), np.hypot(x - HALF_WIDTH, y)
    bed = x <= HALF_WIDTH - R - slack and y <= HALF_LENGTH - R - slack and min(corner, middle) >= 0.15 + slack
    return bool(bed and free(place, others, 1e-4 + slack))


def spotted_place(ball, others, slack=0.0):
    """Where a colour is spotted among ``others`` (Section 3 Rule 7)."""
    for k in [ball, *range(21, 15, -1)]:
        if free(SPOTS[k], others, TOUCH + slack):
            return SPOTS[k]
    x, y = SPOTS[ball]
    others = np.asarray(others, float).reshape(-1, 2)
    for sense in (1, -1):
        beside = others[np.abs(others[:, 0] - x) < D2 + CLEARANCE]
        reach = np.sqrt((D2 + CLEARANCE) ** 2 - (beside[:, 0] - x) ** 2)
        limits = sorted(t for t in np.concatenate([sense * (beside[:, 1] - y) + reach]) if t > 0)
        for t in limits:
            at = (x, y + sense * t)
            if abs(at[1]) <= HALF_LENGTH - R - CLEARANCE and free(at, others, CLEARANCE - NEAR):
                return at
    raise AssertionError(f"no room for ball {ball}")


def nearest_in_d(wish, others):
    """The nearest place to ``wish`` where the cue ball may stand in the D without touching a ball: one of
    finitely many candidates."""
    wish, others = np.asarray(wish, float), np.asarray(others, float).reshape(-1, 2)
    if free(wish, others, TOUCH):
        return wish
    centre = np.array([0.0, BAULK])
    circles = [(o, D2 + CLEARANCE) for o in others if np.hypot(*(o - centre)) < D_RADIUS + D2]
    points = [centre + np.array([s * D_RADIUS, 0.0]) for s in (1, -1)]
    for o, r in circles:
        off = wish - o
        far = np.hypot(*off)
        points.append(o + r * (off / far if far > 0 else np.array([1.0, 0.0])))
        if abs(BAULK - o[1]) < r:
            points += [np.array([o[0] + s * math.sqrt(r * r - (BAULK - o[1]) ** 2), BAULK]) for s in (1, -1)]
    every = [*circles, (centre, D_RADIUS)]
    for i, (a, ra) in enumerate(every):
        for b, rb in every[:i]:
            d = float(np.hypot(*(b - a)))
            if 0 < d < ra + rb and d > abs(ra - rb):
                along = (d * d + ra * ra - rb * rb) / (2 * d)
                h = math.sqrt(max(0.0, ra * ra - along * along))
                u = (b - a) / d
                points += [a + along * u + s * h * np.array([-u[1], u[0]]) for s in (1, -1)]
    allowed = [
        p
        for p in points
        if p[1] <= BAULK + NEAR and np.hypot(*(p - centre)) <= D_RADIUS + NEAR and free(p, others, -NEAR)
    ]
    return min(allowed, key=lambda p: float(np.hypot(*(p - wish))))


BED = _bed_grid(0.07)
"""Places all over the bed where the cue ball may stand anywhere."""
