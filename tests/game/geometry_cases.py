"""Does the code place and see as a case says?"""

import numpy as np

from snooker_env.game.balls import CLEARANCE, CUE, N_BALLS, NAMES, SPOTS, colour, mask_of
from snooker_env.game.snookered import is_snookered
from snooker_env.game.spotting import spot
from snooker_env.geometry import BALL_RADIUS, HALF_LENGTH
from tests.kernels import from_python

ABOUT = "id kind title rule confidence note expect "
_SPOT = from_python(spot)


def lie(places):
    """``positions`` and ``on_table`` of balls at these places, by their ids."""
    positions, on_table = SPOTS.copy(), np.zeros(N_BALLS, bool)
    for ball, place in places.items():
        positions[ball], on_table[ball] = place, True
    return positions, on_table


def spot_colours(positions, on_table, mask):
    """New ``positions`` and ``on_table`` with the colours of ``mask`` spotted."""
    placed, present = positions.copy(), on_table.copy()
    _SPOT(placed, present, mask, BALL_RADIUS)
    return placed, present


def unknown(given, known):
    extra = set(given) - set(known.split())
    return f"not understood: {', '.join(sorted(extra))}" if extra else None


def blockers(occupied, no_room):
    """Centres of balls on the spots named that leave some of them no room towards the top cushion."""
    balls = [SPOTS[colour(name)].copy() for name in occupied]
    for name in no_room:
        x, y = SPOTS[colour(name)]
        while True:
            ys = np.arange(y, HALF_LENGTH - BALL_RADIUS, 1e-4)
            free = ys[~touched(balls, x, ys)]
            if not len(free):
                break
            # As high as it still bars the lowest free place, but not into the next ball above.
            above = min([b[1] for b in balls if b[0] == x and b[1] > free[0]], default=np.inf)
            highest = min(above - 2 * BALL_RADIUS, HALF_LENGTH - BALL_RADIUS)
            balls.append(np.array([x, min(free[0] + 1.9 * BALL_RADIUS, highest)]))
    return balls


def touched(balls, x, ys, gap=0.0):
    """For each y: would a ball at (x, y) be nearer than ``gap`` [m] to one of ``balls``?"""
    if not len(balls):
        return np.zeros(len(ys), dtype=bool)
    bx, by = np.array(balls).T
    return np.any(np.hypot(bx - x, ys[:, None] - by) <= 2 * BALL_RADIUS + gap, axis=1)


def run_spotting(case):
    problem = unknown(case, ABOUT + "to_spot occupied no_room_toward_top")
    if problem:
        return problem
    to_spot = [colour(name) for name in case["to_spot"]]
    spare = [i for i in range(1, N_BALLS) if i not in to_spot]
    standing = blockers(case["occupied"], case.get("no_room_toward_top", []))
    positions, on_table = spot_colours(*lie(dict(zip(spare, standing, strict=False))), mask_of(to_spot))
    if not all(on_table[to_spot]):
        return "a colour was not returned"
    for name, wanted in case["expect"].items():
        ball = colour(name)
        others = [positions[i] for i in range(N_BALLS) if on_table[i] and i != ball]
        problem = misplaced(positions[ball], others, wanted)
        if problem:
            return f"{name} at {positions[ball]}, expected {wanted}: {problem}"
    return None


def misplaced(place, others, wanted):
    """What is wrong with a place, found by trying places 10 um apart on the line; None if nothing is.

    The nearest place is the nearest that leaves ``CLEARANCE`` to every ball: less could be seen as touching.
    """
    if touched(others, place[0], place[1:])[0]:
        return "touches a ball"
    if wanted in NAMES:
        return None if np.array_equal(place, SPOTS[colour(wanted)]) else "not that spot"
    near, name, side = wanted.split(":")
    sign = {"toward_top": 1.0, "toward_baulk_on_centre_line": -1.0}.get(side)
    if near != "near" or sign is None:
        return "not understood"
    x, y = SPOTS[colour(name)]
    if place[0] != x or sign * (place[1] - y) <= 0:
        return "not on the line"
    if place[1] + BALL_RADIUS >= HALF_LENGTH:
        return "touches the cushion"
    step = 1e-5
    if not all(touched(others, x, np.arange(y, place[1] - sign * step, sign * step), CLEARANCE)):
        return "there is a nearer place"
    if sign < 0 and not all(
        touched(others, x, np.arange(y, HALF_LENGTH - BALL_RADIUS - CLEARANCE, step), CLEARANCE)
    ):
        return "there is room above"
    return None


def run_snooker_geometry(case):
    problem = unknown(case, ABOUT + "cue balls_on obstructing")
    if problem:
        return problem
    on = range(1, 1 + len(case["balls_on"]))
    balls = [CUE, *on, *range(N_BALLS - len(case["obstructing"]), N_BALLS)]
    places = np.array([case["cue"], *case["balls_on"], *case["obstructing"]]) / 1000
    positions, on_table = lie(dict(zip(balls, places, strict=True)))
    got = is_snookered(positions, on_table, mask_of(on))[0]
    return None if got == case["expect"] else f"expected {case['expect']}, got {got}"
