"""Which strokes are worth a look? Generators: each makes m continuous strokes for each of n positions, of n seeds. At pots their
numbers go with (chance x nearness)^4 x worth; their speeds, heights and sides are Sobol points (docs/agents/planner.md)."""

from collections.abc import Callable
from math import atan2, exp, hypot, log, pi
from typing import NamedTuple, Protocol, TypeAlias

import numpy as np

from .._lib.jit import entry, kernel
from .._lib.types import Floats, Integers, Ints
from ..game.balls import VALUES, balls_on_kernel, bits, touching_balls
from ..game.frame_columns import BALL_ON
from ..game.pots import GHOST_X, GHOST_Y, POT_BALL, POT_COLUMNS, POT_POCKET, find_pots
from ..geometry import AIM_X, AIM_Y, BALL_RADIUS, POCKET_AIMS
from ..physics.cue import squirt
from ..tasks.box_actions import MAX_SPEED
from ..tasks.escapes import LINE_AIM, LINE_ROOM, LINE_SPEED, ROLLING, escape_aim, find_escapes
from ..tasks.kernel_arrays import CueLaw
from ..tasks.lines import EASY, aim_at_ball, break_off, end_red_of_rack, new_work
from ..tasks.noise import POT_SPEED, Spread, widen
from ..tasks.pot_aim import solved_aim
from ..tasks.pot_chance import DISTANT, FOLLOWS, chance_of, length_of, raised_spread
from ..tasks.stroke import row_of
from ..tasks.windows import HIGH, LOW, MOST_EDGES, open_windows, wrap_angle
from .aims import Dynamics, law_of
from .positions import Positions
from .sobol import sobol
from .stroke_columns import AIM, COLUMNS, SIDE, SPEED, TOP

SLOWEST, FASTEST, SOFTEST = 0.8, 6.5, 0.5  # cue speeds at pots [m/s]; the smallest of strokes without a pot
HIGHEST, WIDEST, RIM = 0.45, 0.35, 0.49
"""Largest tip offsets over R, up or down and to a side; radius of the disc that a corner is drawn in to."""
PLAIN, POWER = 0.5, 4.0  # share of the strokes without side; power of the chance in a pot's share of them
GENTLEST, HARDEST, SAFE_TIP = 0.45, 6.0, 0.4  # of safeties: cue speeds [m/s], largest tip offset over R
EDGE = 0.1  # how far from an edge of what is seen thin safeties are aimed, at most [rad]
ESCAPES, ANYWHERE, MOST_POTS = 8, 8, 16
"""Escapes that share strokes, every which over cushions goes anywhere; pots that share strokes."""


class Asking(Protocol):
    """What a generator may ask of the judge that calls it."""

    spread: Spread
    dynamics: Dynamics


class Proposals(NamedTuple):
    """Strokes (n, m, 5) in SI, and the chance (n, m) of each one's pot by its width: 1 without a pot, 0 for no stroke."""

    strokes: Floats
    chances: Floats


Propose: TypeAlias = Callable[[Asking, Positions, int, Ints], Proposals]
"""A generator: proposals of m strokes for each position, for the judge, the n positions, m and seeds (n,)."""


@kernel
def _tip_on_rim(stroke):
    far = hypot(stroke[TOP], stroke[SIDE])
    if far > RIM:
        stroke[TOP] *= RIM / far
        stroke[SIDE] *= RIM / far


@kernel
def _spread_stroke(i, seed, stroke):
    """Stroke i of a pot: speed, side and top from a Sobol point."""
    stroke[SPEED] = SLOWEST * exp(log(FASTEST / SLOWEST) * sobol(i, 0, seed))
    stroke[TOP] = HIGHEST * (2.0 * sobol(i, 1, seed) - 1.0)
    u = (sobol(i, 2, seed) - PLAIN) / (1.0 - PLAIN)
    stroke[SIDE] = 0.0 if u < 0.0 else WIDEST * (2.0 * u - 1.0)
    _tip_on_rim(stroke)


@kernel
def _aim(stroke, positions, on_table, pot, law, work):
    """Solve the aim of a stroke at a pot."""
    pocket, ghost = int(pot[POT_POCKET]), (pot[GHOST_X], pot[GHOST_Y])
    target, level = (POCKET_AIMS[pocket, AIM_X], POCKET_AIMS[pocket, AIM_Y]), 0.0
    played = stroke[SPEED], stroke[SIDE], stroke[TOP], level
    stroke[AIM] = solved_aim(positions, on_table, int(pot[POT_BALL]), target, ghost, played, law, work)


@entry(what="the proposals of strokes", seconds=17)
def _propose(balls, seeds, which, spread, growth, law, strokes, chances):
    """Fill strokes (n, m, 5) at the pots ``which`` (n, m), without rows spread, and chances; ``spread``: at ``POT_SPEED``."""
    lines, weights = np.empty((MOST_POTS, POT_COLUMNS)), np.empty(MOST_POTS)
    (positions, on_table, game), work = balls, new_work()
    phys, ratios, fidelity, n_steps, most, rails = law
    m = strokes.shape[1]
    for k in range(len(strokes)):
        p, here, seed, own = positions[k], on_table[k], seeds[k], row_of(k, phys)
        its = CueLaw(phys[own], ratios[own], fidelity, n_steps, most, rails)
        on = balls_on_kernel(game[k, BALL_ON], bits(here))
        many = find_pots(p, here, on, BALL_RADIUS, lines)
        if many == 0:
            chances[k, :] = 0.0
            continue
        total = 0.0
        for j in range(many):
            worth = VALUES[int(lines[j, POT_BALL])] + FOLLOWS
            aim = atan2(lines[j, GHOST_Y] - p[0, 1], lines[j, GHOST_X] - p[0, 0])
            wide = raised_spread(spread, 0.0, 0.0, aim, p, here, rails)
            near = exp(-DISTANT * length_of(p, lines[j]))
            weights[j] = (chance_of(p, lines[j], wide) * near) ** POWER * worth + 1e-12
            total += weights[j]
        j, reached = 0, weights[0] / total
        for i in range(m):
            if which.shape[0]:
                j = min(which[k, i], many - 1)
                _tip_on_rim(strokes[k, i])
            else:
                while j < many - 1 and i >= int(m * reached + 0.5):
                    j += 1
                    reached += weights[j] / total
                _spread_stroke(i, seed, strokes[k, i])
            _aim(strokes[k, i], p, here, lines[j], its, work)
            side, top = strokes[k, i, SIDE], strokes[k, i, TOP]
            aim = strokes[k, i, AIM] - squirt(side, its.end_mass_ratio)
            faster = hypot(1.0, growth * strokes[k, i, SPEED]) / hypot(1.0, growth * POT_SPEED)
            wide = raised_spread(widen(spread, faster), side, top, aim, p, here, rails)
            chances[k, i] = chance_of(p, lines[j], wide)


@kernel
def _plain_stroke(i, seed, hard, stroke):
    """Speed and tip of stroke i without a pot; ``hard``: few balls go in by chance unless it is."""
    _spread_stroke(i, seed, stroke)
    u = sobol(i, 0, seed)
    soft = SOFTEST * exp(log(FASTEST / SOFTEST) * u)
    stroke[SPEED] = max(SLOWEST, MAX_SPEED * u ** (1.0 / 3.0)) if hard else soft


@kernel
def _safe_stroke(i, seed, stroke):
    """Speed and tip of safety i, of all speeds."""
    stroke[SPEED] = GENTLEST * exp(log(HARDEST / GENTLEST) * sobol(i, 0, seed))
    stroke[TOP] = SAFE_TIP * (2.0 * sobol(i, 1, seed) - 1.0)
    u = (sobol(i, 2, seed) - PLAIN) / (1.0 - PLAIN)
    aside = 0.0 if u < 0.0 else SAFE_TIP * (2.0 * u - 1.0)
    stroke[SIDE] = aside * (1.0 - 0.5 * abs(stroke[TOP]) / SAFE_TIP)


@kernel
def _along(windows, many, far):
    """The direction ``far`` [rad] along the windows, one behind the other."""
    w = 0
    while w < many - 1 and far > windows[w, HIGH] - windows[w, LOW]:
        far -= windows[w, HIGH] - windows[w, LOW]
        w += 1
    return windows[w, LOW] + far


@kernel
def _near_edge(windows, many, which, far):
    """A direction within a window by the share ``far``^2 of ``EDGE``: all edges alike, the nearer the more."""
    e = min(2 * many - 1, int(2 * many * which))
    low, high = windows[e // 2, LOW], windows[e // 2, HIGH]
    inside = min(EDGE, 0.5 * (high - low)) * far * far
    return low + inside if e % 2 else high - inside


@entry(what="the contacts of positions", seconds=2)
def _contacts(balls, seeds, law, safe, strokes, chances):
    """Fill strokes (n, m, 5) and chances (n, m) with strokes at the balls on that are seen; ``safe``: safeties. Every
    other one is hard, or thin: of two sequences, as every other point of one would fill a part of the cube only."""
    (positions, on_table, game), windows, work = balls, np.empty((MOST_EDGES, 3)), new_work()
    for k in range(len(strokes)):
        p, here, own = positions[k], on_table[k], row_of(k, law[0])
        seed = seeds[k] ^ 0x3C3C if safe else seeds[k]
        its = CueLaw(law[0][own], law[1][own], 0, 0, law[4], law[5])
        on = balls_on_kernel(game[k, BALL_ON], bits(here))
        chances[k, :] = 0.0
        many, total = open_windows(p, here, on, touching_balls(p, here), windows), 0.0
        for w in range(many):
            total += windows[w, HIGH] - windows[w, LOW]
        if total == 0.0:
            continue
        for i in range(strokes.shape[1]):
            stroke, j, other = strokes[k, i], i // 2, i % 2 == 1
            scramble = seed + i % 2 if safe else seed ^ 0xA5A5 if other else seed
            if safe:
                _safe_stroke(j, scramble, stroke)
            else:
                _plain_stroke(j, scramble, other, stroke)
            far = sobol(j, 4, scramble)
            aim = _along(windows, many, total * far)
            if safe and other:
                aim = _near_edge(windows, many, sobol(j, 3, scramble), far)
            played = stroke[SPEED], stroke[SIDE], stroke[TOP], 0.0
            stroke[AIM] = wrap_angle(aim_at_ball(aim, played, p, here, its, work))
            chances[k, i] = 1.0
        end_red = end_red_of_rack(p, here) if safe else 0
        if end_red:  # the one stroke that is known to be good
            stroke = strokes[k, 0]
            stroke[SPEED], stroke[SIDE], stroke[TOP], stroke[AIM] = break_off(p, end_red)


@entry(what="the escapes of positions", seconds=15)
def _escapes(balls, seeds, law, strokes, chances):
    """Fill strokes (n, m, 5) and chances (n, m) with strokes over cushions, where hardly anything is seen."""
    (positions, on_table, game), windows = balls, np.empty((MOST_EDGES, 3))
    lines = np.empty((ESCAPES, POT_COLUMNS))
    work, aims = new_work(), np.empty(ESCAPES)
    for k in range(len(strokes)):
        p, here, seed, own = positions[k], on_table[k], seeds[k], row_of(k, law[0])
        its = CueLaw(law[0][own], law[1][own], 0, 0, law[4], law[5])
        on, touching = balls_on_kernel(game[k, BALL_ON], bits(here)), touching_balls(p, here)
        chances[k, :] = 0.0
        if open_windows(p, here, on, touching, windows) and windows[0, HIGH] - windows[0, LOW] >= 2.0 * EASY:
            continue
        many = find_escapes(p, here, on & ~touching, lines, 0)
        for i in range(strokes.shape[1]):
            stroke, anywhere = strokes[k, i], many == 0 or i % ANYWHERE == ANYWHERE - 1
            chances[k, i] = 1.0
            if anywhere:
                _plain_stroke(i, seed ^ 0x5A5A, True, stroke)
                stroke[AIM] = pi * (2.0 * sobol(i, 4, seed ^ 0x5A5A) - 1.0)
                continue
            j = i - i // ANYWHERE
            line, again = lines[j % many], j // many
            faster, aside, scramble = 0.0, 0.0, seed + j % many
            if again:
                faster = sobol(again - 1, 0, scramble)
                aside = line[LINE_ROOM] * (2.0 * sobol(again - 1, 4, scramble) - 1.0)
            stroke[SPEED], stroke[SIDE], stroke[TOP] = line[LINE_SPEED] * exp(0.5 * faster), 0.0, ROLLING
            if again == 0:
                level = stroke[SPEED], 0.0, ROLLING, 0.0
                aims[j] = escape_aim(line[LINE_AIM], level, p, here, on, its, work)
            stroke[AIM] = wrap_angle(aims[j % many] + aside)


_SPREAD = np.empty((0, 0), np.int64)


def at_pots(judge: Asking, at: Positions, m: int, seeds: Integers) -> Proposals:
    """Generate strokes spread over all direct pots, speeds and tips, for a ``Search``.

    Parameters
    ----------
    judge, at, m, seeds
        The judge, whose ``spread`` and ``dynamics`` count; n ``Positions``; the number of strokes for each; int64 (n,).

    Returns
    -------
    Proposals
        ``strokes``, float64 (n, m, 5), in SI, see ``Planner``; ``chances``, float64 (n, m), of each one's pot by its width; 0,
        for no stroke, where there is no direct pot.

    Examples
    --------
    >>> from snooker_env.planning import Position, Positions, VisitJudge, at_pots
    >>> at = Positions.of(Position(cue=(0.0, 0.9), black=(0.4, 1.3)))
    >>> at_pots(VisitJudge({}), at, 5, [7]).strokes.shape
    (1, 5, 5)
    """
    return _propose_each(at, np.zeros((len(at), m, COLUMNS)), seeds, _SPREAD, judge.spread, judge.dynamics)


def strokes_at(
    at: Positions, which: Ints, speeds_and_tips: Floats, spread: Spread, dynamics: Dynamics
) -> Proposals:
    """Strokes at chosen pots (n, m), indices of ``pots``, with speeds and tips (n, m, 3); their aims are solved."""
    n, m = which.shape
    strokes = np.zeros((n, m, COLUMNS))
    strokes[..., :AIM] = speeds_and_tips
    return _propose_each(at, strokes, np.zeros(n), np.ascontiguousarray(which, np.int64), spread, dynamics)


def _propose_each(at, strokes, seeds, which, spread, dynamics):
    chances = np.empty(strokes.shape[:2])
    law, scrambles = law_of(dynamics, at), np.asarray(seeds, np.int64)
    _propose(_balls(at), scrambles, which, spread, dynamics.growth, law, strokes, chances)
    return Proposals(strokes, chances)


def _balls(at):
    """The arrays of visits that the kernels read."""
    at = at.as_visits()
    return at.positions, at.on_table, at.game


def at_balls(judge: Asking, at: Positions, m: int, seeds: Integers) -> Proposals:
    """Strokes at the balls on that the cue ball can strike; none where no ball on is seen."""
    return _of_visits(_contacts, judge, at, m, seeds, False)


def safeties(judge: Asking, at: Positions, m: int, seeds: Integers) -> Proposals:
    """Such strokes of all speeds, every other one thin; before a break-off the first one is the built-in break-off."""
    return _of_visits(_contacts, judge, at, m, seeds, True)


def over_cushions(judge: Asking, at: Positions, m: int, seeds: Integers) -> Proposals:
    """Escapes over cushions, where hardly anything of a ball on is seen; none in other positions."""
    return _of_visits(_escapes, judge, at, m, seeds)


def _of_visits(kernel, judge, at, m, seeds, *more):
    made = Proposals(np.zeros((len(at), m, COLUMNS)), np.zeros((len(at), m)))
    kernel(_balls(at), np.asarray(seeds, np.int64), law_of(judge.dynamics, at), *more, *made)
    return made
