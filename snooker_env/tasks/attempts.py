"""What does the miss rule need to know of a stroke that failed? Its clear paths and, with ``miss="attempt"``,
whether it was an attempt. For that, strokes without a clear path that struck no ball on first are played once
more, uncounted, with the path of the cue ball, before the referee rules."""

from typing import TYPE_CHECKING

import numpy as np

from .._jit import entry
from .._types import Ints
from ..game.attempt import ATTEMPT_GAP, closest_approach
from ..game.balls import CUE, N_BALLS, bits
from ..game.frame_columns import ANYWHERE, BALL_ON, FREE_BALL, IN_HAND, MISSED, Layouts, strikeable
from ..game.paths import best_paths
from ..game.ruling import Before, Facts, ruling
from ..geometry import BALL_RADIUS
from ..physics.engine import EventKind, Status
from .arrays import PlayedArrays, TableArrays
from .stroke import ATTEMPT, CLEAR_PATH, FIRST, FULL_PATH, ShotBuffers, see, with_path

if TYPE_CHECKING:
    from .tables import Tables

_BALL_BALL, _OK = int(EventKind.BALL_BALL), int(Status.OK)


@entry(what="the paths of the miss rule", seconds=2)
def remember(which, tables, saved, shots, noses, jaws):
    """Record the layouts before the strokes, and which paths were clear before those that struck no ball on
    first; of others ``seen`` says that one was. S3 R14(c) speaks of every ball "that is or could be on":
    after a red, all colours."""
    tables, saved, shots = TableArrays(*tables), Layouts(*saved), PlayedArrays(*shots)
    for j in range(which.shape[0]):
        if shots.status[j] != _OK:
            continue
        k = which[j]
        positions, on_table, row = tables.positions[k], tables.on_table[k], tables.game[k]
        mask, seen = bits(on_table), shots.seen[j]
        first, touching, moved, potted = see(j, shots, positions, on_table)
        seen[CLEAR_PATH], seen[FULL_PATH] = True, False
        before = Before(mask, row[BALL_ON], row[FREE_BALL], 0)
        if ruling(before, Facts(first, touching, moved, potted, 0, tables.nominated[k]), 0).fouls & MISSED:
            in_hand, on = row[IN_HAND] + row[ANYWHERE], strikeable(row, mask & ~1)
            clear, full = best_paths(positions, on_table, on, in_hand, noses, jaws, BALL_RADIUS)
            seen[CLEAR_PATH], seen[FULL_PATH] = clear, full
        for i in range(N_BALLS):
            saved.positions[k, i, 0], saved.positions[k, i, 1] = positions[i, 0], positions[i, 1]
            saved.on_table[k, i] = on_table[i]


@entry(what="the strokes of snookered strikers", seconds=1)
def question(which, on_table, game, status, seen, asked):
    """Find the shots whose attempt must be judged: ``asked[j]``; all others count as attempts."""
    for j in range(which.shape[0]):
        k = which[j]
        asked[j] = False
        seen[j, ATTEMPT] = True
        if status[j] == _OK and not (seen[j, CLEAR_PATH] or seen[j, FULL_PATH]):
            asked[j] = seen[j, FIRST] & strikeable(game[k], bits(on_table[k]) & ~1) == 0


@entry(what="the attempts of snookered strikers", seconds=1)
def gap_of(positions, on_table, row, shots, path, j):
    """How near the cue ball came to a ball on in shot j, before it struck another or came to rest [m]."""
    shots, (segments, n_segments) = PlayedArrays(*shots), path
    until, on = shots.duration[j], strikeable(row, bits(on_table) & ~1)
    for e in range(shots.n_events[j]):
        if shots.event_what[j, e, 0] == _BALL_BALL and shots.event_what[j, e, 1] == CUE:
            until = shots.event_time[j, e]
            break
    return closest_approach(segments[j], n_segments[j], until, positions, on_table, on, BALL_RADIUS)


def judge_attempts(which: Ints, b: ShotBuffers, tables: "Tables") -> dict[int, float]:
    """Write into ``b.seen`` which shots were attempts; returns the gaps [m] of those asked by row."""
    positions, on_table, game, *_ = tables.arrays
    asked = np.empty(len(which), np.bool_)
    question(which, on_table, game, b.status, b.seen, asked)
    gaps = {}
    for j in np.flatnonzero(asked).tolist():
        k = which[j]
        one, at = b, j
        if not b.segments.shape[1]:
            one, at = with_path(b, j, positions[k], on_table[k], tables.rules, tables.packed[2]), 0
        gaps[j] = gap_of(positions[k], on_table[k], game[k], one.played, (one.segments, one.n_segments), at)
        b.seen[j, ATTEMPT] = gaps[j] <= ATTEMPT_GAP
    return gaps
