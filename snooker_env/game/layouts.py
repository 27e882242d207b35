"""How can a table stand at the start of a task? Layouts from a random generator: geometry only, no shot is simulated.

Each function returns ``positions`` (22, 2) [m] and ``on_table`` (22,) bool and draws only from the generator it is given: the same
generator state, the same table. A ball off the table keeps its row of ``balls.SPOTS``. Balls that are not racked or on a spot stand
at least ``GAP`` from any other.
"""

import numpy as np

from .._check import integer, refuse
from .balls import BALL_RADIUS, BAULK_Y, BLACK, CUE, D_RADIUS, HALF_LENGTH, HALF_WIDTH, N_BALLS, N_REDS, POCKETS, REDS_MASK, SPOTS, YELLOW
from .opened import held_out, opened
from .pots import pots
from .snookered import is_snookered

GAP = 0.001
"""Least gap [m] between a ball placed at random and any other."""
CUSHION_GAP = 0.05
"""... and any cushion [m]: about a ball's width, so that it can be struck normally."""
POCKET_GAP = 0.15
"""Least distance [m] of such a ball's centre from a pocket's nominal place: clear of the jaws."""


def _generator(rng):
    if not isinstance(rng, np.random.Generator):
        raise refuse("rng", rng, "must be a numpy.random.Generator")
    return rng


def _table(reds):
    """Fresh arrays: the first ``reds`` reds and all colours on the table, every ball on its spot, no cue ball yet."""
    on_table = np.zeros(N_BALLS, dtype=np.bool_)
    on_table[1 : 1 + reds] = True
    on_table[YELLOW:] = True
    return SPOTS.copy(), on_table


def _clear(positions, on_table, place):
    """Is a place clear of the balls on the table, cushions and pockets?"""
    return (
        np.all(np.hypot(*(positions[on_table] - place).T) >= 2 * BALL_RADIUS + GAP)
        and np.all(np.abs(place) <= np.array([HALF_WIDTH, HALF_LENGTH]) - BALL_RADIUS - CUSHION_GAP)
        and np.all(np.hypot(*(POCKETS - place).T) >= POCKET_GAP)
    )


def _put(positions, on_table, ball, draw):
    """Put a ball at the first place from ``draw()`` that is clear of other balls, cushions and pockets."""
    while True:
        place = draw()
        if _clear(positions, on_table, place):
            positions[ball] = place
            on_table[ball] = True
            return


def _box(rng, low, high):
    """A draw, uniform in a box."""
    return lambda: rng.uniform(low, high)


def _in_d(rng):
    """A draw, uniform in the D."""

    def draw():
        while True:
            x, y = rng.uniform([-D_RADIUS, -D_RADIUS], [D_RADIUS, 0.0])
            if x * x + y * y <= D_RADIUS * D_RADIUS:
                return np.array([x, BAULK_Y + y])

    return draw


def break_off(rng):
    """The start of a frame: reds racked, colours on their spots, the cue ball at a random place in the D."""
    positions, on_table = _table(N_REDS)
    _put(positions, on_table, CUE, _in_d(_generator(rng)))
    return positions, on_table


def line_up(rng):
    """The practice line-up: 15 reds on the centre line, two below the blue, seven from blue to pink, four on to the black, two above it.

    They stand about 112 mm apart, so that a ball just passes between two. The cue ball is placed at random beside the line.
    """
    positions, on_table = _table(N_REDS)
    blue, pink, black = SPOTS[19, 1], SPOTS[20, 1], SPOTS[21, 1]
    low, high = (pink - blue) / 8, (black - pink) / 5
    ys = [blue - 2 * low, blue - low, *(blue + low * np.arange(1, 8)), *(pink + high * np.arange(1, 5)), black + high, black + 2 * high]
    positions[1 : 1 + N_REDS] = np.column_stack([np.zeros(N_REDS), ys])
    _put(positions, on_table, CUE, _box(_generator(rng), [-0.6, -0.3], [0.6, 1.5]))
    return positions, on_table


def colours(rng):
    """Only the six colours, on their spots; the cue ball at a random place 0.25 m to 1.2 m from the yellow, the first ball on."""
    positions, on_table = _table(0)
    box = _box(_generator(rng), [-HALF_WIDTH, -HALF_LENGTH], [HALF_WIDTH, HALF_LENGTH])

    def draw():
        while True:
            place = box()
            if 0.25 <= np.hypot(*(place - SPOTS[YELLOW])) <= 1.2:
                return place

    _put(positions, on_table, CUE, draw)
    return positions, on_table


def random(rng, n):
    """``n`` reds (0 to 15) and the cue ball sprinkled over the whole table, all colours on their spots."""
    positions, on_table = _table(0)
    draw = _box(_generator(rng), [-HALF_WIDTH, -HALF_LENGTH], [HALF_WIDTH, HALF_LENGTH])
    for red in range(1, 1 + integer("n", n, 0, N_REDS)):
        _put(positions, on_table, red, draw)
    _put(positions, on_table, CUE, draw)
    return positions, on_table


SNOOKERED_REDS = 3
"""At most so many reds are on the table in ``snookered``."""
BEHIND = (0.08, 0.5)
"""How far from the snookering colour its cue ball lies [m]: from about a ball's width to a third of the table's width."""


def snookered(rng):
    """The cue ball snookered on every red: one to three reds sprinkled, all colours on their spots, red on.

    By construction and trial: behind a colour as seen from a red, then kept only if the rule's tangent test (``snookered.is_snookered``)
    finds no red that can be struck at both edges. A way out needs a cushion, swerve, or a touch on a red's one open edge.
    """
    rng = _generator(rng)
    while True:
        positions, on_table = random(rng, int(rng.integers(1, SNOOKERED_REDS + 1)))
        red, colour = 1 + rng.integers(np.count_nonzero(on_table[1:YELLOW])), rng.integers(YELLOW, BLACK + 1)
        away = positions[colour] - positions[red]
        angle = np.arctan2(away[1], away[0]) + rng.normal(0.0, 0.03)
        place = positions[colour] + rng.uniform(*BEHIND) * np.array([np.cos(angle), np.sin(angle)])
        on_table[CUE] = False
        if _clear(positions, on_table, place):
            positions[CUE], on_table[CUE] = place, True
            if is_snookered(positions, on_table, REDS_MASK)[0]:
                return positions, on_table


POT_WINDOWS = {"easy": (4e-3, np.inf), "medium": (1e-3, 4e-3), "hard": (3e-4, 1e-3)}
"""How far the aim of the layout's widest pot may err to either side [rad], by ``game.pots``. Struck at 2.4 m/s along its line, so with
no allowance for throw, 300 of each went in 69, 61 and 45 % of the time with an aim of 0.025 deg, and 68, 52 and 22 % with 0.1 deg."""


def single_pot(rng, difficulty):
    """One red and the cue ball alone on the table, anywhere, with a direct pot; its widest is of that ``difficulty`` (``POT_WINDOWS``)."""
    rng = _generator(rng)
    if difficulty not in POT_WINDOWS:
        raise refuse("difficulty", difficulty, "must be one of " + ", ".join(map(repr, POT_WINDOWS)))
    low, high = POT_WINDOWS[difficulty]
    draw = _box(rng, [-HALF_WIDTH, -HALF_LENGTH], [HALF_WIDTH, HALF_LENGTH])
    while True:
        positions, on_table = SPOTS.copy(), np.zeros(N_BALLS, dtype=np.bool_)
        _put(positions, on_table, 1, draw)
        _put(positions, on_table, CUE, draw)
        found = pots(positions, on_table, REDS_MASK, most=1)
        if len(found) and low <= found[0, 5] < high:
            return positions, on_table


_COUNTS = [str(n) for n in range(N_REDS + 1)]
LAYOUTS = {"opened": opened, "held_out": held_out, "break_off": break_off, "line_up": line_up, "colours": colours, "snookered": snookered}


def layout(name, rng):
    """The layout of that name: one of ``LAYOUTS``, ``"random:N"`` with N reds, or ``"pots:D"`` with D one of ``POT_WINDOWS``."""
    if isinstance(name, str):
        if name in LAYOUTS:
            return LAYOUTS[name](rng)
        head, _, which = name.partition(":")
        if head == "random" and which in _COUNTS:
            return random(rng, int(which))
        if head == "pots" and which in POT_WINDOWS:
            return single_pot(rng, which)
    known = ", ".join(map(repr, LAYOUTS))
    raise refuse("layout", name, f'must be one of {known}, "pots:easy", "pots:medium", "pots:hard" or "random:N" with N from 0 to {N_REDS}')
