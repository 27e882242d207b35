"""Which strokes are safe? A generator of strokes at the balls on without a pot: anywhere where one is met first,
every other one near an edge of what is seen, where the cue ball goes on past the ball."""

from math import exp, log

import numpy as np

from .._jit import entry
from .._types import Integers
from ..game.balls import balls_on_kernel, bits, touching_balls
from ..game.frame_columns import BALL_ON
from ..tasks.arrays import CueLaw
from ..tasks.ghost_ball import break_off
from ..tasks.lines import aim_at_met, new_work, racked
from ..tasks.stroke import row_of
from ..tasks.windows import HIGH, LOW, MOST_EDGES, open_windows, turned
from .positions import Positions
from .proposals import PLAIN, Proposals, Search, visits_of
from .sobol import sobol
from .strokes import AIM, COLUMNS, SIDE, SPEED, TOP, law_of

SLOWEST, FASTEST = 0.45, 6.0
"""Cue speeds [m/s]."""
TIP = 0.4
"""Largest tip offset over R to each side."""
EDGE = 0.1
"""How far from an edge of a window the thin strokes are aimed, at most [rad]."""


@entry(what="the safeties of positions", seconds=2)
def _safeties(balls, seeds, law, strokes, chances):
    """Fill strokes (n, m, 5) and chances (n, m) with strokes at the balls on that are seen."""
    (positions, on_table, game), windows, work = balls, np.empty((MOST_EDGES, 3)), new_work()
    for k in range(len(strokes)):
        p, here, seed, own = positions[k], on_table[k], seeds[k] ^ 0x3C3C, row_of(k, law[0])
        its = CueLaw(law[0][own], law[1][own], 0, 0, law[4], law[5])
        on = balls_on_kernel(game[k, BALL_ON], bits(here))
        chances[k, :] = 0.0
        many, total = open_windows(p, here, on, touching_balls(p, here), windows), 0.0
        for w in range(many):
            total += windows[w, HIGH] - windows[w, LOW]
        if total == 0.0:
            continue
        for i in range(strokes.shape[1]):
            stroke, j, scramble = strokes[k, i], i // 2, seed + i % 2
            stroke[SPEED] = SLOWEST * exp(log(FASTEST / SLOWEST) * sobol(j, 0, scramble))
            stroke[TOP] = TIP * (2.0 * sobol(j, 1, scramble) - 1.0)
            u = (sobol(j, 2, scramble) - PLAIN) / (1.0 - PLAIN)
            stroke[SIDE] = 0.0 if u < 0.0 else TIP * (2.0 * u - 1.0) * (1.0 - 0.5 * abs(stroke[TOP]) / TIP)
            along = sobol(j, 4, scramble)
            if i % 2 == 0:  # anywhere: windows by their widths
                w, along = 0, total * along
                while w < many - 1 and along > windows[w, HIGH] - windows[w, LOW]:
                    along -= windows[w, HIGH] - windows[w, LOW]
                    w += 1
                aim = windows[w, LOW] + along
            else:  # near an edge: all edges alike, the nearer the more
                e = min(2 * many - 1, int(2 * many * sobol(j, 3, scramble)))
                width = windows[e // 2, HIGH] - windows[e // 2, LOW]
                inside = min(EDGE, 0.5 * width) * along * along
                aim = windows[e // 2, LOW] + inside if e % 2 else windows[e // 2, HIGH] - inside
            played = stroke[SPEED], stroke[SIDE], stroke[TOP], 0.0
            stroke[AIM] = turned(aim_at_met(aim, played, p, here, its, work))
            chances[k, i] = 1.0
        end_red = racked(p, here)
        if end_red:  # the one stroke that is known to be good
            strokes[k, 0, SPEED], strokes[k, 0, SIDE], strokes[k, 0, TOP], strokes[k, 0, AIM] = break_off(
                p, end_red
            )


def safeties(search: Search, at: Positions, m: int, seeds: Integers) -> Proposals:
    """Generate strokes at the balls on that the cue ball can strike, of all speeds, many of them thin.

    Parameters
    ----------
    search, at, m, seeds
        As for ``at_pots``.

    Returns
    -------
    Proposals
        The strokes; none where no ball on is seen.

    Examples
    --------
    >>> from snooker_env.planning import Position, Positions, StrokeSearch
    >>> from snooker_env.planning.safeties import safeties
    >>> at = Positions.of(Position(cue=(0.3, 1.0), reds=[(0.3, 1.758), (0.36, 1.758)], black=(0.0, -1.0)))
    >>> safeties(StrokeSearch({}), at, 4, [7]).chances.tolist()
    [[1.0, 1.0, 1.0, 1.0]]
    """
    made = Proposals(np.zeros((len(at), m, COLUMNS)), np.zeros((len(at), m)))
    _safeties(visits_of(at), np.asarray(seeds, np.int64), law_of(search.dynamics, at), *made)
    return made
