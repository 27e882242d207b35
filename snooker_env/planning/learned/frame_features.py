"""What does a learned worth of frames see of a position? All that a learned value sees of the visit, and what safety is about:
which balls on can be struck at all, how near the nearest reds lie and how much of each is seen."""

from math import log, sqrt

import numpy as np

from ..._lib.jit import entry
from ..._lib.types import Floats
from ...game import frame_columns as columns
from ...game.balls import N_BALLS, available, bits, touching_balls
from ...geometry import BALL_RADIUS, HALF_LENGTH, HALF_WIDTH
from ...tasks.noise import Spread
from ...tasks.windows import HIGH, LOW, MOST_EDGES, half_width, open_part, open_windows
from ..positions import Positions
from ..pot_geometry import in_parts
from ..worth import NARROWEST, SPREAD, WIDEST
from .value_features import SHARED as SHARED_OF_VISITS
from .value_features import SIZE as VISIT_SIZE
from .value_features import value_features

NEAREST = 3  # reds that are described one by one
RED_ENTRIES, SHARED = 5, 18
SIZE = VISIT_SIZE + NEAREST * RED_ENTRIES + 6 + SHARED
LIKELY = VISIT_SIZE - SHARED_OF_VISITS + 10  # the entry that holds the chance of the likeliest direct pot
HIDDEN = VISIT_SIZE + NEAREST * RED_ENTRIES + 6 + 6  # the entry that is 1 where the striker is snookered


@entry(what="the features of frames", seconds=4)
def _features(positions, on_table, game, spread, out):
    windows, seen, near = np.empty((MOST_EDGES, 3)), np.empty(N_BALLS), np.empty(NEAREST, np.int64)
    for k in range(len(out)):
        p, here, game_row, row = positions[k], on_table[k], game[k], out[k, VISIT_SIZE:]
        row[:] = 0.0
        mask = bits(here) & ~1
        on, touching = columns.strikeable(game_row, mask), touching_balls(p, here)
        many, total, widest = open_windows(p, here, on, touching, windows), 0.0, 0.0
        for w in range(many):
            wide = windows[w, HIGH] - windows[w, LOW]
            total += wide
            widest = max(widest, wide)
        cx, cy = p[0, 0], p[0, 1]
        side = -1.0 if cx < 0.0 else 1.0
        strikeable = closest = 0.0
        nearest, nearest_seen, low = 1e9, 0.0, 1e9
        for j in range(NEAREST):
            near[j] = 0
        for b in range(1, N_BALLS):
            seen[b] = 0.0
            if not here[b]:
                continue
            dx, dy = p[b, 0] - cx, p[b, 1] - cy
            away = sqrt(dx * dx + dy * dy)
            low = min(low, away)
            if (on >> b) & 1:
                _, half = open_part(p, b, windows, many)
                seen[b] = half / half_width(p, b)
                strikeable += seen[b] > 0.0
                if away < nearest:
                    nearest, nearest_seen = away, seen[b]
            if b <= 15:
                at = NEAREST
                while at > 0:
                    other = near[at - 1]
                    if other:
                        ox, oy = p[other, 0] - cx, p[other, 1] - cy
                        if ox * ox + oy * oy <= away * away:
                            break
                    at -= 1
                if at < NEAREST:
                    for j in range(NEAREST - 1, at, -1):
                        near[j] = near[j - 1]
                    near[at] = b
                closest += away < 8.0 * BALL_RADIUS
        for j in range(NEAREST):
            b, o = near[j], j * RED_ENTRIES
            if b:
                dx, dy = side * (p[b, 0] - cx), p[b, 1] - cy
                row[o], row[o + 1], row[o + 2] = 1.0, dx, dy
                row[o + 3], row[o + 4] = seen[b], sqrt(dx * dx + dy * dy)
        o = NEAREST * RED_ENTRIES
        for c in range(6):
            row[o + c] = seen[16 + c]
        o += 6
        row[o] = game_row[columns.IN_HAND] != 0
        row[o + 1], row[o + 2] = game_row[columns.FREE_BALL] != 0, game_row[columns.RESPOTTED_BLACK] != 0
        row[o + 3], row[o + 4], row[o + 5] = min(many, 4) / 4.0, min(total, 1.0), min(widest, 1.0)
        row[o + 6], row[o + 7] = total == 0.0, total < 0.02
        row[o + 8], row[o + 9] = strikeable / 8.0, (touching & on) != 0
        row[o + 10], row[o + 11] = min(nearest, 4.0), nearest_seen
        row[o + 12], row[o + 13] = min(low, 1.0), closest / 4.0
        row[o + 14] = min(HALF_WIDTH - side * cx, 0.1) * 10.0
        row[o + 15] = min(HALF_LENGTH - abs(cy), 0.1) * 10.0
        left = available(mask, game_row[columns.BALL_ON], game_row[columns.FREE_BALL])
        row[o + 16] = sqrt(max(0.0, left)) / 12.0
        row[o + 17] = log(min(max(spread.core, NARROWEST), WIDEST) / SPREAD)


def read_errors(seen: np.ndarray) -> Floats:
    """The errors of direction [rad] under which features (n, ``SIZE`` or more) were seen: float64 (n,)."""
    return SPREAD * np.exp(seen[:, SIZE - 1].astype(np.float64))


def frame_features(at: Positions, spread: Spread, threads: int = 1) -> np.ndarray:
    """Features of n ``Positions`` as their strikers see them, the cue ball on the table: float32 (n, SIZE)."""
    out = np.empty((len(at), SIZE), np.float32)
    out[:, :VISIT_SIZE] = value_features(at.as_visits(), spread, threads)
    balls = at.positions, at.on_table, at.game
    in_parts(len(at), threads, lambda rows: _features(*(each[rows] for each in balls), spread, out[rows]))
    return out
