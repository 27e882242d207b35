"""Was there a clear path to a ball on? The two tests of the rule of the foul and a miss, as kernels.

*Any part*: in some direction the cue ball, rolling straight, meets a ball on before any ball not on; other balls
on never obstruct. *Full ball* (S3 R14): it can roll straight onto the centre of some ball on, through a strip as
wide as a ball. Other reds do not obstruct the strip to a red; any ball obstructs the strip to a colour, as the
striker nominates one.

A path ends at a cushion, nose or jaw (only the test for a snooker leaves cushions out). In hand a path counts if it is
clear from some place of ``in_hand`` (R14(a), and S2 R17 for a snooker); an opening between these favours the striker."""

import numpy as np

from .._lib.jit import entry, kernel
from ..geometry import BALL_RADIUS
from .balls import N_BALLS, REDS_MASK, REFEREE_TOUCH
from .in_hand import PLACES_IN_D, PLACES_ON_BED
from .snookered import SLACK, segment_distance
from .spotting import touches

WINDOW = 1e-9  # a narrower opening does not count [rad]: it is rounding
# columns of ``noses`` and ``jaws``, as of ``physics.Table``
AXIS, SIDE, LEVEL, LOW, HIGH = range(5)
ARC_X, ARC_Y, ARC_RADIUS, ARC_UX, ARC_UY, ARC_COS = range(6)


@kernel
def meets(bx, by, ux, uy, radius):
    """How far it rolls from the origin along the unit vector u until it meets a ball at b [m], or inf."""
    along, across = bx * ux + by * uy, bx * uy - by * ux
    if along <= 0.0 or abs(across) >= 2.0 * radius:
        return np.inf
    return along - np.sqrt(4.0 * radius * radius - across * across)


@kernel
def find_first_ball(positions, on_table, x, y, ux, uy, far):
    """The ball met first from (x, y) along the unit vector u, up to the distance ``far`` [m]; 0 if none."""
    ball = 0
    for i in range(1, N_BALLS):
        if on_table[i]:
            run = meets(positions[i, 0] - x, positions[i, 1] - y, ux, uy, BALL_RADIUS)
            if run < far:
                far, ball = run, i
    return ball


@kernel
def to_cushion(cx, cy, ux, uy, noses, jaws, radius):
    """How far [m] the cue ball rolls from c along the unit vector u until it meets a cushion, or inf."""
    run = np.inf
    for k in range(noses.shape[0]):
        c, u, other, slide = (cx, ux, cy, uy) if noses[k, AXIS] == 0.0 else (cy, uy, cx, ux)
        towards = noses[k, SIDE] * u
        if towards > 0.0:
            s = (noses[k, LEVEL] - radius - noses[k, SIDE] * c) / towards
            if s >= -SLACK and noses[k, LOW] <= other + s * slide <= noses[k, HIGH]:
                run = min(run, max(0.0, s))
    for k in range(jaws.shape[0]):
        bx, by, reach = jaws[k, ARC_X] - cx, jaws[k, ARC_Y] - cy, jaws[k, ARC_RADIUS] + radius
        along, across = bx * ux + by * uy, bx * uy - by * ux
        if along <= 0.0 or abs(across) >= reach:
            continue
        s = along - np.sqrt(reach * reach - across * across)
        px, py = s * ux - bx, s * uy - by
        if s >= -SLACK and px * jaws[k, ARC_UX] + py * jaws[k, ARC_UY] >= jaws[k, ARC_COS] * reach - SLACK:
            run = min(run, max(0.0, s))
    return run


@kernel
def full_ball_path(positions, on_table, on, noses, jaws, radius):
    """Whether a ball on (mask ``on``) can be struck full from the place of the cue ball."""
    cx, cy = positions[0, 0], positions[0, 1]
    for target in range(1, N_BALLS):
        if on_table[target] and (on >> target) & 1:
            tx, ty = positions[target, 0], positions[target, 1]
            harmless = on & REDS_MASK if (REDS_MASK >> target) & 1 else 1 << target
            # The path ends at contact, 2 R before the target's centre.
            d = np.hypot(tx - cx, ty - cy)
            run = max(0.0, 1.0 - 2.0 * radius / d)
            clear = to_cushion(cx, cy, (tx - cx) / d, (ty - cy) / d, noses, jaws, radius) >= run * d - SLACK
            for i in range(1, N_BALLS):
                if on_table[i] and not (harmless >> i) & 1:
                    x, y = positions[i, 0], positions[i, 1]
                    ex, ey = cx + run * (tx - cx), cy + run * (ty - cy)
                    clear = clear and segment_distance(x, y, cx, cy, ex, ey) >= 2.0 * radius - SLACK
            if clear:
                return True
    return False


@kernel
def _open_direction(positions, on_table, on, target, angle, noses, jaws, radius):
    """Whether the cue ball, rolling at ``angle`` [rad], meets ``target`` before balls not on and cushions."""
    ux, uy = np.cos(angle), np.sin(angle)
    cx, cy = positions[0, 0], positions[0, 1]
    run = meets(positions[target, 0] - cx, positions[target, 1] - cy, ux, uy, radius)
    if run == np.inf:
        return False
    for i in range(1, N_BALLS):
        x, y = positions[i, 0] - cx, positions[i, 1] - cy
        if on_table[i] and not (on >> i) & 1 and meets(x, y, ux, uy, radius) < run:
            return False
    return to_cushion(cx, cy, ux, uy, noses, jaws, radius) >= run - SLACK


@kernel
def _cushion_edges(edges, n, c, t, towards, noses, jaws, radius):
    """Append directions at which a cushion may open or close the path from c to t; returns the number."""
    (cx, cy), (tx, ty) = c, t
    for k in range(noses.shape[0]):
        level, vertical = noses[k, SIDE] * (noses[k, LEVEL] - radius), noses[k, AXIS] == 0.0
        away, middle = level - (tx if vertical else ty), ty if vertical else tx
        half2 = 4.0 * radius * radius - away * away
        for end in range(4):
            if end < 2 and half2 < 0.0:
                continue
            at = noses[k, LOW + end - 2] if end >= 2 else middle + (2 * end - 1) * np.sqrt(half2)
            turn = np.arctan2(at - cy, level - cx) if vertical else np.arctan2(level - cy, at - cx)
            edges[n] = turn - towards
            n += 1
    for k in range(jaws.shape[0]):
        bx, by, reach = jaws[k, ARC_X] - cx, jaws[k, ARC_Y] - cy, jaws[k, ARC_RADIUS] + radius
        turn, graze = np.arctan2(by, bx) - towards, np.arcsin(min(1.0, reach / np.hypot(bx, by)))
        edges[n], edges[n + 1] = turn - graze, turn + graze
        # The ends of the arc, and where both circles are met at the same time.
        side = np.sqrt(max(0.0, 1.0 - jaws[k, ARC_COS] * jaws[k, ARC_COS]))
        for sign in (-1.0, 1.0):
            ex = jaws[k, ARC_COS] * jaws[k, ARC_UX] - sign * side * jaws[k, ARC_UY]
            ey = jaws[k, ARC_COS] * jaws[k, ARC_UY] + sign * side * jaws[k, ARC_UX]
            edges[n + 2 + (sign > 0.0)] = np.arctan2(by + reach * ey, bx + reach * ex) - towards
        n += 4
        sx, sy = bx + cx - tx, by + cy - ty
        apart = np.hypot(sx, sy)
        if abs(reach - 2.0 * radius) < apart < reach + 2.0 * radius:
            along = 0.5 * (apart + (4.0 * radius * radius - reach * reach) / apart)
            height = np.sqrt(max(0.0, 4.0 * radius * radius - along * along))
            for sign in (-1.0, 1.0):
                mx = tx + (along * sx - sign * height * sy) / apart
                my = ty + (along * sy + sign * height * sx) / apart
                edges[n] = np.arctan2(my - cy, mx - cx) - towards
                n += 1
    return n


@entry  # it makes an array, which an inner kernel may not
def clear_path(positions, on_table, on, noses, jaws, radius):
    """Whether a straight path leads to any part of a ball on (mask ``on``). A path opens or closes only at tangents to balls
    and jaws, at ends of cushions, and where two are met at once: the midpoints between these are tested."""
    cx, cy = positions[0, 0], positions[0, 1]
    edges = np.empty(4 * N_BALLS + 4 * noses.shape[0] + 6 * jaws.shape[0])
    for target in range(1, N_BALLS):
        if not (on_table[target] and (on >> target) & 1):
            continue
        tx, ty = positions[target, 0] - cx, positions[target, 1] - cy
        d = np.hypot(tx, ty)
        towards = np.arctan2(ty, tx)
        half = np.arcsin(min(1.0, 2.0 * radius / d))
        edges[0], edges[1] = -half, half
        n = 2
        for i in range(1, N_BALLS):
            if not on_table[i] or (on >> i) & 1:
                continue
            bx, by = positions[i, 0] - cx, positions[i, 1] - cy
            b = np.hypot(bx, by)
            turn = np.arctan2(by, bx) - towards
            reach = np.arcsin(min(1.0, 2.0 * radius / b))
            edges[n], edges[n + 1] = turn - reach, turn + reach
            n += 2
            # Touching both: on the perpendicular bisector of b-t, 2 R from each.
            sx, sy = bx - tx, by - ty
            apart = np.hypot(sx, sy)
            if 0.0 < apart < 4.0 * radius:
                height = np.sqrt(4.0 * radius * radius - apart * apart / 4.0) / apart
                for sign in (-1.0, 1.0):
                    mx = 0.5 * (bx + tx) - sign * height * sy
                    my = 0.5 * (by + ty) + sign * height * sx
                    edges[n] = np.arctan2(my, mx) - towards
                    n += 1
        n = _cushion_edges(edges, n, (cx, cy), (tx + cx, ty + cy), towards, noses, jaws, radius)
        inside = 0
        for k in range(n):  # into (-pi, pi]: the target's window is one interval; the edges in it, in order
            edge = edges[k] - 2.0 * np.pi * np.round(edges[k] / (2.0 * np.pi))
            if -half <= edge <= half:
                j = inside
                while j > 0 and edges[j - 1] > edge:
                    edges[j] = edges[j - 1]
                    j -= 1
                edges[j] = edge
                inside += 1
        for k in range(inside - 1):
            low, high = edges[k], edges[k + 1]
            angle = towards + 0.5 * (low + high)
            wide = high - low > WINDOW
            if wide and _open_direction(positions, on_table, on, target, angle, noses, jaws, radius):
                return True
    return False


@entry(what="the paths of the miss rule", seconds=2)
def best_paths(positions, on_table, on, in_hand, noses, jaws, radius):
    """Both tests: (any part, full ball). ``in_hand``: 0 from where the cue ball lies, 1 from the D, 2 from anywhere on the bed;
    its place in ``positions`` is tried first, then others until one has a full-ball path."""
    if on_table[0]:
        full = full_ball_path(positions, on_table, on, noses, jaws, radius)
        clear = full or clear_path(positions, on_table, on, noses, jaws, radius)
        if full or in_hand == 0:
            return clear, full
    else:
        clear = False
    at, others = positions.copy(), on_table.copy()
    others[0] = False
    places = PLACES_IN_D if in_hand == 1 else PLACES_ON_BED
    for k in range(places.shape[0]):
        if touches(at, others, places[k, 0], places[k, 1], 2.0 * radius + REFEREE_TOUCH):
            continue
        at[0, 0], at[0, 1] = places[k, 0], places[k, 1]
        if full_ball_path(at, on_table, on, noses, jaws, radius):
            return True, True
        clear = clear or clear_path(at, on_table, on, noses, jaws, radius)
    return clear, False
