"""Which tables can a task start from? Layouts, ``positions`` (22, 2) [m] and ``on_table`` (22,), by geometry
only, from a stream of random numbers: same key and counter, same table. Absent balls lie on spots."""

from dataclasses import dataclass
from functools import cache, lru_cache
from math import atan2, cos, hypot, sin
from pathlib import Path
from typing import Any

import numpy as np

from .._lib.check import refuse
from .._lib.jit import entry, kernel
from .._lib.types import Bools, Floats
from ..geometry import BALL_RADIUS, HALF_LENGTH, HALF_WIDTH, POCKET_PLACES
from .balls import CUE, GREEN, N_BALLS, N_REDS, REDS_MASK, SPOTS, YELLOW
from .philox import normals, pair, stream_of
from .pots import POT_COLUMNS, TOLERANCE, find_pots
from .snookered import NO_JAWS, snookered_from

GAP, CUSHION_GAP, POCKET_GAP = 0.001, 0.05, 0.15
"""Least gaps [m] of a ball placed at random to balls, to cushions, and of its centre to pockets."""
STORED, BREAK_OFF, LINE_UP, COLOURS, RANDOM, SNOOKERED, POT = range(7)  # kinds of layouts, for the kernels

# Banks of tables, which ``python -m benchmarks.make_tables NAME`` makes by simulated play. opened.npz: a break-off and
# further hard strokes until the pack is spread; all 22 balls and some pot on a red. safety.npz: positions of frames in
# which a red is on, but no pot. escape.npz: snookers from which constant choices often fail.
FOLDER = Path(__file__).parent
HELD_OUT = 2048
"""Number of opened tables that only the layout "held_out" deals, for evaluation."""
BANKS = {"opened": HELD_OUT, "safety": 512, "escape": 512}
"""Of each bank the number of its last tables, which are held out."""
NO_BANK = np.zeros((0, N_BALLS, 2))
NO_BANK.setflags(write=False)


@cache
def bank(name: str) -> Floats:
    """The tables of a bank: float64 (k, 22, 2) [m], NaN for a ball that is not on the table; read-only."""
    with np.load(FOLDER / f"{name}.npz") as data:
        tables = data["positions"].astype(np.float64)
    tables.setflags(write=False)
    return tables


def split_bank(name: str) -> tuple[range, range]:
    """Indices of the tables of a bank that are not held out, and of those that are."""
    size = len(bank(name))
    return range(size - BANKS[name]), range(size - BANKS[name], size)


@lru_cache(8)
def bank_without(name: str, unfit: tuple[int, ...]) -> Floats:
    """The bank with each table of ``unfit`` replaced by the next of its part that fits; others stay."""
    if not unfit:
        return bank(name)
    tables = bank(name).copy()
    for part in split_bank(name):
        fit = np.setdiff1d(part, unfit)
        for k in np.intersect1d(part, unfit):
            tables[k] = tables[fit[np.searchsorted(fit, k) % len(fit)]]
    tables.setflags(write=False)
    return tables


@kernel
def clear(positions, on_table, x, y):
    """Whether a place (x, y) [m] is clear of the balls on the table, the cushions and the pockets."""
    room = BALL_RADIUS + CUSHION_GAP
    if abs(x) > HALF_WIDTH - room or abs(y) > HALF_LENGTH - room:
        return False
    for k in range(POCKET_PLACES.shape[0]):
        if hypot(POCKET_PLACES[k, 0] - x, POCKET_PLACES[k, 1] - y) < POCKET_GAP:
            return False
    free, reach = True, 2 * BALL_RADIUS + GAP
    for i in range(N_BALLS):
        free = free and not (on_table[i] and hypot(positions[i, 0] - x, positions[i, 1] - y) < reach)
    return free


@kernel
def _put(positions, on_table, ball, kind, stream):
    """Put a ball at the first random place that is clear; the cue ball within the bounds of its layout."""
    left, bottom, right, top = -HALF_WIDTH, -HALF_LENGTH, HALF_WIDTH, HALF_LENGTH
    if ball == CUE and kind == BREAK_OFF:
        u, _ = pair(stream)
        positions[CUE, 0], on_table[CUE] = SPOTS[CUE, 0] if u < 0.5 else -SPOTS[CUE, 0], True
        return
    if ball == CUE and kind == LINE_UP:
        left, bottom, right, top = -0.6, -0.3, 0.6, 1.5
    while True:
        u, v = pair(stream)
        x, y = left + u * (right - left), bottom + v * (top - bottom)
        far = hypot(x - SPOTS[YELLOW, 0], y - SPOTS[YELLOW, 1])
        if ball == CUE and kind == COLOURS and not 0.25 <= far <= 1.2:
            continue  # too near to the first ball on, or too far from it
        if clear(positions, on_table, x, y):
            positions[ball, 0], positions[ball, 1] = x, y
            on_table[ball] = True
            return


@kernel
def _deal_from_bank(positions, on_table, tables, first, last, stream):
    """One of the tables first to last - 1 of a bank, with probability 1/2 mirrored in the long axis."""
    u, v = pair(stream)
    table = tables[first + int(u * (last - first))]
    for i in range(N_BALLS):
        j = i
        if v < 0.5 and YELLOW <= i <= GREEN:
            j = YELLOW + GREEN - i  # so that each stays on its side of the table
        positions[i, 0], positions[i, 1] = -table[j, 0] if v < 0.5 else table[j, 0], table[j, 1]
        on_table[i] = not np.isnan(table[j, 0])
        if not on_table[i]:
            positions[i, 0], positions[i, 1] = SPOTS[i, 0], SPOTS[i, 1]


@kernel
def _line_up_y(k):
    """The y of red k of 15 [m]: 2 below the blue, 7 below the pink, 4 below the black, 2 above."""
    blue, pink, black = SPOTS[19, 1], SPOTS[20, 1], SPOTS[21, 1]
    low, high = (pink - blue) / 8, (black - pink) / 5
    if k <= 9:
        return blue + low * (k - 3 if k <= 2 else k - 2)
    return pink + high * (k - 9) if k <= 13 else black + high * (k - 13)


SNOOKERED_REDS = 3
BEHIND = (0.08, 0.5)
"""Of the layout "snookered": the most reds; range of the cue ball's distance from the colour before it [m]."""


@kernel
def _hide(positions, on_table, reds, stream):
    """Try to snooker it on every red, 1 to ``reds``, behind a random colour; returns whether it is."""
    u, v = pair(stream)
    far, _ = pair(stream)
    turn, _ = normals(stream)
    red, colour = 1 + int(u * reds), YELLOW + int(v * (N_BALLS - YELLOW))
    dx, dy = positions[colour, 0] - positions[red, 0], positions[colour, 1] - positions[red, 1]
    angle = atan2(dy, dx) + 0.03 * turn
    far = BEHIND[0] + far * (BEHIND[1] - BEHIND[0])
    x, y = positions[colour, 0] + far * cos(angle), positions[colour, 1] + far * sin(angle)
    if not clear(positions, on_table, x, y):
        return False
    positions[CUE, 0], positions[CUE, 1] = x, y
    on_table[CUE] = True
    return snookered_from(positions, on_table, REDS_MASK, x, y, NO_JAWS, BALL_RADIUS)[0]


POT_WINDOWS = {"easy": (4e-3, np.inf), "medium": (1e-3, 4e-3), "hard": (3e-4, 1e-3)}
"""Difficulty -> range of the tolerance of the layout's widest pot [rad], by which the aim may err to either
side. Along the solved line at 2.3 m/s a professional's execution errors pot 94, 80 and 40 % of them, a club
player's 79, 35 and 12 % (``python -m benchmarks.execution --strokes 2000``)."""


@kernel
def _deal(code, tables, stream, positions, on_table, pot):
    """One layout: racked and spotted balls, loose reds, last the cue ball; until its condition holds."""
    kind, reds, low, high = int(code[0]), int(code[1]), code[2], code[3]
    if kind == STORED:
        _deal_from_bank(positions, on_table, tables, int(low), int(high), stream)
        return
    racked = reds if kind == BREAK_OFF or kind == LINE_UP else 0
    loose = reds - racked
    while True:
        if kind == SNOOKERED:
            u, _ = pair(stream)
            loose = 1 + int(u * reds)
        for i in range(N_BALLS):
            positions[i, 0], positions[i, 1] = SPOTS[i, 0], SPOTS[i, 1]
            on_table[i] = 1 <= i <= racked or (i >= YELLOW and kind != POT)
            if kind == LINE_UP and 1 <= i <= racked:
                positions[i, 0], positions[i, 1] = 0.0, _line_up_y(i)
        for ball in range(loose, 0 if kind == SNOOKERED else -1, -1):
            _put(positions, on_table, ball, kind, stream)
        if kind == SNOOKERED:
            if _hide(positions, on_table, loose, stream):
                return
        elif kind == POT:
            many = find_pots(positions, on_table, REDS_MASK, BALL_RADIUS, pot)
            if many and low <= pot[0, TOLERANCE] < high:
                return
        else:
            return


@entry(what="the dealing of tables", seconds=4)
def deal_tables(which, code, tables, streams, positions, on_table):
    """New layouts for the tables ``which``; ``code``, ``tables``: of a ``LayoutPlan``; ``streams`` (n, 2) uint64."""
    pot = np.empty((1, POT_COLUMNS))
    for k in which:
        _deal(code, tables, streams[k], positions[k], on_table[k], pot)


@dataclass(frozen=True, eq=False)
class LayoutPlan:
    """A layout by name, in the form that the kernels read. Pickling and copying make it again: no bank is copied."""

    name: str
    code: Floats  # (4,): kind, number of reds, and the range of tables of the bank or of a pot's tolerance [rad]
    tables: Floats  # (b, 22, 2): the bank of stored tables [m]; b = 0 for a layout without one
    unfit: tuple[int, ...] = ()  # tables of the bank that do not fit the table played on; others replace them

    @property
    def in_hand(self) -> bool:
        """Whether the cue ball is in hand at the start, and may be placed in the D."""
        return self.name.startswith("break_off")

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]:
        return plan_of, (self.name, self.unfit)


STORED_IN = {"opened": ("opened", False), "held_out": ("opened", True)}
for _bank in ("safety", "escape"):
    STORED_IN |= {_bank: (_bank, False), f"held_out_{_bank}": (_bank, True)}
"""Of each layout of stored tables its bank, and whether it deals those that are held out."""
_NAMES = {"break_off": (BREAK_OFF, N_REDS, 0, 0), "line_up": (LINE_UP, N_REDS, 0, 0)}
_NAMES |= {"colours": (COLOURS, 0, 0, 0), "snookered": (SNOOKERED, SNOOKERED_REDS, 0, 0)}
_CODES = _NAMES | {f"pots:{name}": (POT, 1, *window) for name, window in POT_WINDOWS.items()}
for _reds in range(N_REDS + 1):
    _CODES |= {f"random:{_reds}": (RANDOM, _reds, 0, 0), f"break_off:{_reds}": (BREAK_OFF, _reds, 0, 0)}
"""``LayoutPlan.code`` of each layout that is no stored one."""
LAYOUTS = (*STORED_IN, *_NAMES)
"""Names without a number: "opened", "safety", "escape" and what is held out of each; "break_off", "line_up",
"colours", "snookered"."""


def plan_of(name: str, unfit: tuple[int, ...] = ()) -> LayoutPlan:
    """The ``LayoutPlan`` of a layout, see ``layout``, without the tables ``unfit`` of its bank; ValueError for others."""
    if isinstance(name, str) and name in STORED_IN:
        which, held_out = STORED_IN[name]
        part = split_bank(which)[held_out]
        code = np.array((STORED, N_REDS, part.start, part.stop), np.float64)
        return LayoutPlan(name, code, bank_without(which, unfit), unfit)
    if isinstance(name, str) and name in _CODES:
        return LayoutPlan(name, np.array(_CODES[name], np.float64), NO_BANK)
    known = ", ".join(map(repr, LAYOUTS))
    allowed = f'must be one of {known}, "pots:easy", "pots:medium", "pots:hard", "random:N" or "break_off:N" with N from 0 to {N_REDS}'
    raise refuse("layout", name, allowed)


def layout(plan: LayoutPlan | str, rng: np.random.Generator) -> tuple[Floats, Bools]:
    """Deal one table of a layout.

    Parameters
    ----------
    plan : str
        The layout: one of ``LAYOUTS``, ``"random:N"`` or ``"break_off:N"`` with N reds from 0 to 15, or ``"pots:D"``
        with D one of ``POT_WINDOWS``; ValueError for others. Or a ``LayoutPlan`` of one, for repeated use.
    rng : numpy.random.Generator
        One number is drawn from it, the key of the layout's stream.

    Returns
    -------
    positions, on_table : numpy.ndarray
        New arrays, float64 (22, 2), centres of the balls [m], and bool (22,).

    Examples
    --------
    >>> import numpy as np
    >>> from snooker_env.game import layout
    >>> positions, on_table = layout("random:3", np.random.default_rng(1))
    >>> int(on_table[1:16].sum())
    3
    """
    plan = plan if isinstance(plan, LayoutPlan) else plan_of(plan)
    positions, on_table = np.empty((1, N_BALLS, 2)), np.empty((1, N_BALLS), np.bool_)
    deal_tables(np.zeros(1, np.int64), plan.code, plan.tables, stream_of(rng)[None], positions, on_table)
    return positions[0], on_table[0]
