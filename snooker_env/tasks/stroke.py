"""How is one stroke played, on one table or on thousands? ``address`` (placement, action, error, strike), then
``engine.run_batch``; each task has its own referee. Row j of the ``ShotBuffers`` is the shot on table which[j]."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._lib.jit import entry, kernel
from .._lib.types import Bools, Floats, Ints
from ..game.balls import CUE, N_BALLS, TOUCH, bits, touching_balls
from ..game.fouls import AUTO
from ..game.frame_columns import ANYWHERE, IN_HAND
from ..game.in_hand import nearest_place
from ..geometry import BALL_RADIUS
from ..physics import cloth, cue, engine
from ..physics.cue_room import in_room, raise_cue
from ..physics.engine import EventKind
from ..physics.events import OFF_TABLE
from ..physics.parameters import Physics
from ..physics.table import Table
from ..simulation import EVENT, MAX_EVENTS, Shot, count
from . import discrete_actions
from .box_actions import place_of, shot_of, tip_on_disc
from .declarations import A_DISCRETE, A_PLACEMENT, A_SPEEDS, playable
from .kernel_arrays import (
    C_E_T,
    C_END_MASS,
    C_MAX_OFFSET,
    C_MU_S,
    C_RAILS,
    CueLaw,
    PlayedArrays,
    StruckArrays,
)
from .lines import new_work
from .noise import execute_stroke, kick_of
from .options import Rules
from .stroke_menu import solve_menu_stroke

AT_ONCE = 1e-9  # contacts within this time [s] are simultaneous
# Columns of a strike: the cue ball's velocity and spin after it, intended speed, the strike with errors; what its
# room did to it (``cue_room.in_room``), and what was meant before.
(VX, VY, UZ, WX, WY, WZ, SPEED, CUE_SPEED, SIDE, TOP, AIM, ELEVATION, ROOM) = range(13)
MEANT = 13
STRIKE_COLUMNS = MEANT + 5
# Columns of the referee's facts: masks of balls, clear paths before a stroke that failed (where misses are
# called), whether it was an attempt (``miss="attempt"``); and of the ruling (``BREAK``: with this stroke).
FIRST, DOWN, JUMPED, CLEAR_PATH, FULL_PATH, ATTEMPT = range(6)
PLAYER, WAS_ON, FREE, BREAK, SCORED, COST, FOULS = range(6, 13)
SEEN_COLUMNS = 13
_BALL_BALL, _CUSHION, _JAW = int(EventKind.BALL_BALL), int(EventKind.CUSHION), int(EventKind.JAW)


@kernel
def _played_into(positions, ball, vx, vy, time):
    """Whether the cue ball, struck with (vx, vy) [m/s], was played into the touching ``ball`` that it met at ``time`` [s]: its
    line leads into it, or they met at once, also along the tangent."""
    dx, dy = positions[ball, 0] - positions[CUE, 0], positions[ball, 1] - positions[CUE, 1]
    speed = np.hypot(vx, vy)
    into = abs(vx * dy - vy * dx) < 2.0 * BALL_RADIUS * speed or time * speed <= 10.0 * TOUCH
    return vx * dx + vy * dy > 0.0 and into


@kernel
def find_first_contact(event_time, event_what, n_events, touching, positions, vx, vy):
    """Masks, from a shot's log, of the balls struck first, and of the ``touching`` ones that it was played into, a push stroke;
    one that it meets later off a cushion is struck but not moved in leaving."""
    first, moved, start = 0, 0, np.inf
    for e in range(n_events):
        kind, time = event_what[e, 0], event_time[e]
        if time > start + AT_ONCE and not touching:
            break
        if event_what[e, 1] == CUE and (kind == _CUSHION or kind == _JAW):
            touching = 0  # what it meets from here on, it does not meet in leaving
        elif event_what[e, 1] == CUE and kind == _BALL_BALL:
            ball = event_what[e, 2]
            if time <= start + AT_ONCE:
                start = min(start, time)
                first |= 1 << ball
            if (touching >> ball) & 1 and _played_into(positions, ball, vx, vy, time):
                moved |= 1 << ball
    return first, moved


@kernel
def place(positions, on_table, x, y, anywhere):
    """Put a cue ball in hand on the free place of the D, or bed, nearest to (x, y); it stays if none is."""
    on_table[CUE] = False
    x, y, free = nearest_place(positions, on_table, x, y, BALL_RADIUS, anywhere != 0)  # one type, one compile
    on_table[CUE] = True
    if free:
        positions[CUE, 0], positions[CUE, 1] = x, y


@kernel
def reached_cushion(event_what, n_events):
    """From the log of a shot: whether any ball met a nose or a jaw."""
    reached = False
    for e in range(n_events):
        reached = reached or event_what[e, 0] == _CUSHION or event_what[e, 0] == _JAW
    return reached


@kernel
def played_in(intended, positions, on_table, cue_row, shot):
    """The stroke that is ``intended``, its aim the cue's, as the cue has room for it; ``shot`` records what was done."""
    rails, most = cue_row[C_RAILS:], cue_row[C_MAX_OFFSET]
    played, shot[ROOM] = in_room(intended, positions, on_table, rails, BALL_RADIUS, most)
    for c in range(5):
        shot[MEANT + c] = intended[c]
    return played


@kernel
def strike_with(intended, struck, positions, on_table, cue_row, j, shots):
    """Shot j: the cue ball ``struck`` with errors in place of ``intended``; where these took the cue's room, it is raised once more."""
    speed, side, top, aim, elevation = struck
    side, top = tip_on_disc(side, top, cue_row[C_MAX_OFFSET])
    if side != intended[1] or top != intended[2] or aim != intended[3] or elevation != intended[4]:
        cue_at, rails = (side, top, aim, elevation), cue_row[C_RAILS:]
        elevation = raise_cue(cue_at, positions, on_table, rails, BALL_RADIUS)
    shot, r, v, w, aloft, here = shots.shots[j], shots.r, shots.v, shots.w, shots.aloft, shots.here
    mu_s, m = cue_row[C_MU_S], cue_row[C_END_MASS]
    after = cue.strike_ball(speed, aim, side, top, elevation, BALL_RADIUS, mu_s, m, cue_row[C_E_T])
    (shot[VX], shot[VY], shot[UZ]), (shot[WX], shot[WY], shot[WZ]) = after
    shot[SPEED] = intended[0]
    shot[CUE_SPEED], shot[SIDE], shot[TOP], shot[AIM], shot[ELEVATION] = speed, side, top, aim, elevation
    for i in range(N_BALLS):
        r[j, i, 0], r[j, i, 1], here[j, i] = positions[i, 0], positions[i, 1], on_table[i]
        v[j, i, 0] = v[j, i, 1] = w[j, i, 0] = w[j, i, 1] = w[j, i, 2] = aloft[j, i, 0] = aloft[j, i, 1] = 0.0
    v[j, CUE, 0], v[j, CUE, 1], aloft[j, CUE, 1] = shot[VX], shot[VY], shot[UZ]
    w[j, CUE, 0], w[j, CUE, 1], w[j, CUE, 2] = shot[WX], shot[WY], shot[WZ]


@kernel
def strike(intended, positions, on_table, stream, cue_row, noise, j, shots):
    """Shot j: the table as it lies, the cue ball struck as ``intended``, as far as the cue has room, with errors."""
    meant = played_in(intended, positions, on_table, cue_row, shots.shots[j])
    strike_with(meant, execute_stroke(*meant, noise, stream), positions, on_table, cue_row, j, shots)
    shots.kicks[j] = kick_of(noise, stream)


@kernel
def _same_table(positions, on_table, other, other_on):
    """Whether the balls lie at the same places on two tables."""
    differ = 0
    for i in range(N_BALLS):
        moved = positions[i, 0] != other[i, 0] or positions[i, 1] != other[i, 1]
        differ += on_table[i] != other_on[i] or moved
    return differ == 0


@kernel
def row_of(k, rows):
    """Table k's row of what all tables share, in one row, or have for themselves."""
    return min(k, rows.shape[0] - 1)


@entry(what="the strokes of the environment", seconds=23)
def address(which, actions, tables, shots, packed, fidelity):
    """Carry the actions (n, k) of the tables ``which`` out up to the strike; ``packed``: of ``Tables``."""
    positions, on_table, game, streams, nominated = tables
    shots, (options, cues, noise, phys), work = StruckArrays(*shots), packed, new_work()
    choice, mask_before, intended = -1.0, 0, (0.0, 0.0, 0.0, 0.0, 0.0)
    for j in range(which.shape[0]):
        k = which[j]
        a, p, on, cue_row = actions[k], positions[k], on_table[k], cues[row_of(k, cues)]
        most, rails = cue_row[C_MAX_OFFSET], cue_row[C_RAILS:]
        law = CueLaw(phys[row_of(k, phys)], cue_row[C_END_MASS], fidelity[0], fidelity[1], most, rails)
        if game[k, IN_HAND] and options[A_PLACEMENT]:
            anywhere = game.shape[1] > ANYWHERE and game[k, ANYWHERE] != 0
            x, y = place_of(a, options, anywhere)
            place(p, on, x, y, anywhere)
        mask = playable(game[k], bits(on), nominated[k] if nominated.shape[0] else AUTO)
        if options[A_DISCRETE]:
            # a planner plays a choice under several errors in succession: its aim is solved once
            before, new = which[max(0, j - 1)], a[0] != choice or mask != mask_before
            if new or phys.shape[0] > 1 or not _same_table(p, on, positions[before], on_table[before]):
                choice, mask_before, speeds = a[0], mask, int(options[A_SPEEDS])
                if speeds:
                    intended = solve_menu_stroke(int(choice), speeds, p, on, mask, law, work)
                else:
                    intended = discrete_actions.solve_choice(int(choice), p, on, mask, law, work)
        else:
            intended = shot_of(a, p, on, mask, options, law, work)
        strike(intended, p, on, streams[k], cue_row, noise, j, shots)


@kernel
def see(j, shots, positions, on_table):
    """The facts (first, touching, moved, potted, off the table) of shot j, from the table before it; ``seen`` has some, and jumps."""
    shot, seen = shots.shots[j], shots.seen[j]
    touching = touching_balls(positions, on_table)
    log = shots.event_time[j], shots.event_what[j], shots.n_events[j]
    first, moved = find_first_contact(*log, touching, positions, shot[VX], shot[VY])
    down = off = 0
    for i in range(N_BALLS):
        if shots.potted[j, i] >= 0:
            down |= 1 << i
        elif shots.potted[j, i] == OFF_TABLE:
            off |= 1 << i
    seen[FIRST], seen[DOWN], seen[JUMPED] = first, down, shots.aloft[j, CUE, 0] != 0.0
    return first, touching, moved, down, off


@kernel
def write_ruling(seen, player, ball_on, free_ball, before, result):
    """Record a ``Ruling`` in the shot's row of ``seen``; ``before``: the break until then."""
    seen[PLAYER], seen[WAS_ON], seen[FREE], seen[BREAK] = player, ball_on, free_ball, before + result.points
    seen[SCORED], seen[COST], seen[FOULS] = result.points, result.penalty, result.fouls


class ShotBuffers:
    """Work space for up to m shots at once, each with a log of ``log`` events and optionally its path."""

    def __init__(self, m: int, log: int = 512, *, path: bool = False):
        self.log: int = log
        # the balls before the shots, then after: [m], [m/s], [rad/s]; the pocket of each, or -1
        self.r: Floats = np.zeros((m, N_BALLS, 2))
        self.v: Floats = np.zeros((m, N_BALLS, 2))
        self.w: Floats = np.zeros((m, N_BALLS, 3))
        self.aloft: Floats = np.zeros((m, N_BALLS, 2))
        self.here: Bools = np.zeros((m, N_BALLS), np.bool_)
        self.potted: Ints = np.zeros((m, N_BALLS), np.int64)
        self.kicks: Floats = np.zeros(m)  # the friction of the first contact in a kick, else 0
        # each strike, columns ``VX`` to ``MEANT + 4``; facts for the referee and the ruling, ``FIRST`` to ``FOULS``
        self.shots: Floats = np.zeros((m, STRIKE_COLUMNS))
        self.seen: Ints = np.zeros((m, SEEN_COLUMNS), np.int64)
        # time [s]; kind, i, j of each event; the paths, if they are recorded
        self.event_time: Floats = np.zeros((m, log))
        self.event_what: NDArray[np.int32] = np.zeros((m, log, 3), np.int32)
        self.segments: Floats = np.zeros((m, 2 * log + N_BALLS + 2 if path else 0, cloth.COLUMNS + 2))
        # how each shot ended, and how long it took [s]
        self.status: Ints = np.zeros(m, np.int64)
        self.n_events: Ints = np.zeros(m, np.int64)
        self.n_segments: Ints = np.zeros(m, np.int64)
        self.duration: Floats = np.zeros(m)
        # for kernels: the parts of ``StruckArrays`` and ``PlayedArrays``, in plain tuples
        self.struck: tuple[Any, ...] = tuple(getattr(self, name) for name in StruckArrays._fields)
        self.played: tuple[Any, ...] = tuple(getattr(self, name) for name in PlayedArrays._fields)
        self.enlarged: dict[int, ShotBuffers] = {}  # shots of the last run with a longer log of their own

    def __len__(self) -> int:
        return len(self.duration)

    def shot(self, j: int, table: Table, physics: Physics) -> Shot:
        """Shot j as a ``Shot``."""
        n = self.n_events[j]
        events = np.zeros(n, EVENT)
        events["time"] = self.event_time[j, :n]
        for c, name in enumerate(("kind", "i", "j")):
            events[name] = self.event_what[j, :n, c]
        segments = self.segments[j, : self.n_segments[j]].copy()
        ends = self.r[j].copy(), self.potted[j].copy(), self.here[j].copy(), float(self.duration[j])
        return Shot(*ends, events, segments, physics, table)


def run(buffers: ShotBuffers, m: int, rules: Rules, phys: Floats, *, again: bool = False) -> None:
    """Play the first m shots until all balls are at rest; ``phys``: packed constants, a row for all or each; ``again``: uncounted."""
    count(0 if again else m)
    table = rules.table
    buffers.enlarged = {}
    balls = buffers.r, buffers.v, buffers.w, buffers.here, buffers.potted
    aloft = buffers.aloft if rules.physics.flight else None
    reach = table._reach(rules.physics.R)
    setup = phys, buffers.kicks, table.noses, table.jaws, table.falls, reach, *rules.fidelity, False
    log = buffers.event_time, buffers.event_what, buffers.segments
    ends = buffers.status, buffers.n_events, buffers.n_segments, buffers.duration
    engine.run_batch(balls, aloft, setup, MAX_EVENTS, log, ends, 0, m)
