"""How large are a player's errors of direction and speed? ``fit_errors``: estimates with 95 % intervals.

The model is that of ``snooker_env.tasks.noise``. Estimated are the errors of direction and of speed, as multiples s of a
professional's, and how the first grow with the cue speed, by the likelihoods of docs/play/coach.md, "How errors are
estimated"."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import erf, hypot, pi, radians, remainder, sqrt
from statistics import NormalDist
from typing import Any, NamedTuple

import numpy as np

from .._lib.check import integer, refuse_what
from .._lib.types import Bools, Floats
from ..geometry import AIM_X, AIM_Y, POCKET_AIMS
from ..physics.cue import MAX_ELEVATION as STEEPEST_CUE
from ..planning import Positions
from ..planning.sobol import sobol_points
from ..tasks.noise import LEVELS, POT_SPEED, TWICE
from .practice import Practice, room_for
from .recorded import CALLED, Recorded, direction_of, squirt

BASE = "professional"  # whose errors the estimates are multiples of
LEAST, MOST = 0.02, 50.0  # smallest and largest error that is thought of, over a professional's
SCALES = np.geomspace(LEAST, MOST, 600)
STEP = float(np.log(SCALES[1] / SCALES[0]))
# Growths g [s/m] that are thought of, errors being as sqrt(1 + (g V)^2): one in five that they do not grow, as of robots;
# else each angle whose tangent is g V at the speed of a pot is as likely as any other
_ANGLES = np.linspace(0.0, 0.97, 31) * 0.5 * pi
GROWTHS = np.tan(_ANGLES) / POT_SPEED
# The growths halfway between them: each stands for those between two of these
ENDS = np.concatenate([[0.0], np.tan(0.5 * (_ANGLES[1:] + _ANGLES[:-1])) / POT_SPEED, GROWTHS[-1:]])
UNGROWN = 0.2
PRIOR = np.where(GROWTHS == 0.0, UNGROWN, (1.0 - UNGROWN) / (len(GROWTHS) - 1))
SEVERAL = 1.5  # highest over lowest speed from which the strokes tell a growth
AS_NEEDED = radians(2.0)  # a cue so little above what rails and balls need was meant as low as they allow
SHARES = np.linspace(0.005, 0.9, 12)  # shares of safeties among guessed pots that are thought of, each alike
RADII = np.geomspace(0.12, 60.0, 27)  # sizes of errors that are tried [a professional's standard deviations]
WAYS = 32  # errors of each radius that are tried
# The density that every error has at least: beyond three or four deviations of a lapse its size tells nothing, for a line
# was solved for a tip that was not meant, or a stroke was recorded wrongly
FLOOR = 1e-5
OUTER = 0.05  # share of pots played softest, and of those played hardest, whose speed may be a lapse's


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """A number with its 95 % interval, and the number of strokes that it was learned from."""

    value: float
    low: float
    high: float
    strokes: int

    @property
    def source(self) -> str:
        return f"from {self.strokes} stroke{'s' * (self.strokes != 1)}"


@dataclass(frozen=True, kw_only=True)
class PlayerErrors:
    """A player's errors of execution, with 95 % intervals, as ``coach`` describes them; None where the strokes do not tell."""

    direction: Estimate | None
    at: float
    growth: Estimate | None
    speed: Estimate | None


class CalledPots(NamedTuple):
    """The strokes with a called pot: their rows, and the chances of the pots for each of ``SCALES`` at their own speeds."""

    rows: list[int]
    chances: Floats  # (n, scales)
    made: Bools  # (n,)
    paces: Floats  # (n,) cue speeds [m/s]


def fit_errors(
    strokes: list[Recorded], practice: Practice, seed: int
) -> tuple[PlayerErrors, Floats | None, CalledPots, list[Recorded]]:
    """A player's errors; the posterior (growths, scales) of the direction's; the called pots; the strokes, without the guessed
    pots that were likelier to be safeties. ``practice``: with the errors ``BASE``."""
    integer("seed", seed, 0, 2**63)
    directions, widths, speeds, paces = measure_errors(strokes, practice)
    known = ~np.isnan(directions)
    guessed = np.array([one.guessed for one in strokes]) & known
    tells = known | np.array([one.potted is not None for one in strokes])
    at = choose_speed(paces[tells])
    more = grow_with_speed(paces, at)
    mixed, meant = weigh_guesses(directions[guessed], widths[guessed], more[:, guessed])
    strokes = list(strokes)
    for k in np.flatnonzero(guessed)[~meant].tolist():
        strokes[k] = replace(strokes[k], ball=None, pocket=None, potted=None, guessed=False)
        directions[k] = np.nan
    known = ~np.isnan(directions)
    pots = simulate_pots(strokes, practice, seed)
    told = [k for k, row in enumerate(pots.rows) if not known[row]]
    base, direction, growth, weights, speed = LEVELS[BASE], None, None, None, None
    unit, n = base.direction_deg(practice.options.rules.physics, speed=at), int(known.sum()) + len(told)
    if n:
        sure = known & ~guessed
        rest = CalledPots([], pots.chances[told], pots.made[told], pots.paces[told])
        log_l = weigh_errors(directions[sure], more[:, sure]) + mixed + weigh_outcomes(rest, at)
        weights = normalise(log_l + np.log(PRIOR)[:, None])
        direction = estimate(weights.sum(axis=0), unit, n)
        tried = np.concatenate([paces[known], rest.paces])
        if tried.max() >= SEVERAL * tried.min():
            growth = estimate_growth(weights.sum(axis=1), n)
    v = speeds[~np.isnan(speeds)]
    if len(v):
        speed = estimate(normalise(weigh_errors(v, np.ones((1, len(v))))[0]), base.speed_rel, len(v))
    if direction is None and speed is None:
        allowed = "with intended and played, with a pot and played, or with a pot and potted"
        raise refuse_what("strokes", "none that shows an error", f"must hold strokes {allowed}")
    return PlayerErrors(direction=direction, at=at, growth=growth, speed=speed), weights, pots, strokes


def choose_speed(paces: Floats) -> float:
    """The cue speed at which an error is stated [m/s]: ``POT_SPEED``, or the nearest between the quartiles of ``paces``."""
    if not len(paces):
        return POT_SPEED
    low, high = np.quantile(paces, (0.25, 0.75)).tolist()
    return min(max(POT_SPEED, low), high)


def grow_with_speed(paces: Floats, at: float) -> Floats:
    """Standard deviations of the direction at cue speeds (n,), in those of a professional at rest, for each of ``GROWTHS``
    where it is a professional's at the speed ``at``: (growths, n)."""
    g = GROWTHS[:, None]
    return np.hypot(1.0, g * paces) / np.hypot(1.0, g * at) * hypot(1.0, LEVELS[BASE].growth * at)


def weigh_errors(e: Floats, more: Floats) -> Floats:
    """Log-likelihood (growths, scales) of errors (n,) whose deviations are ``more`` (growths, n) times each scale."""
    return np.array([np.log(density(e, SCALES[:, None] * row)).sum(axis=1) for row in more])


def density(e: Floats, sigma: Floats) -> Floats:
    """The density of errors under the law of ``BASE``, of which all but the lapses have the deviations ``sigma``."""
    base, out = LEVELS[BASE], np.full(np.broadcast_shapes(e.shape, sigma.shape), FLOOR)
    for share, times in ((1.0 - base.lapse, 1.0), (base.lapse, base.lapse_factor)):
        wide = times * sigma
        out += share / (wide * sqrt(2.0 * pi)) * np.exp(-0.5 * (e / wide) ** 2)
    return out


def weigh_guesses(e: Floats, widths: Floats, more: Floats) -> tuple[Floats, Any]:
    """Log-likelihood (growths, scales) of guessed pots (n,), as of ``weigh_errors``, or safeties evenly within ``widths``; which
    are pots at the likeliest growth, scale and share of safeties."""
    if not len(e):
        return np.zeros((len(more), len(SCALES))), np.zeros(0, np.bool_)
    safety, log_l = 0.5 / widths, np.empty((len(more), len(SHARES), len(SCALES)))
    for row, out in zip(more, log_l, strict=True):
        pot = density(e, SCALES[:, None] * row)
        for k, share in enumerate(SHARES.tolist()):
            out[k] = np.log((1.0 - share) * pot + share * safety).sum(axis=1)
    g, k, s = np.unravel_index(log_l.argmax(), log_l.shape)
    meant = (1.0 - SHARES[k]) * density(e, SCALES[s] * more[g]) > SHARES[k] * safety
    return np.logaddexp.reduce(log_l, axis=1), meant


def weigh_outcomes(pots: CalledPots, at: float) -> Floats:
    """Log-likelihood (growths, scales) of pots made or missed; the scales are of errors at the cue speed ``at``."""
    out = []
    for chances in list_chances(pots, at):
        p = np.clip(chances, 1e-3, 1.0 - 1e-3)  # a fluke or a slip is never impossible
        out.append(np.where(pots.made[:, None], np.log(p), np.log1p(-p)).sum(axis=0))
    return np.array(out)


def list_chances(pots: CalledPots, at: float) -> Iterator[Floats]:
    """The chances (n, scales) of pots for each of ``GROWTHS``; the scales are of errors at the cue speed ``at``."""
    own = np.hypot(1.0, LEVELS[BASE].growth * pots.paces)
    for row in grow_with_speed(pots.paces, at):  # those of scales that are row / own times as large
        x = np.clip(np.arange(len(SCALES)) + np.log(row / own)[:, None] / STEP, 0.0, len(SCALES) - 1.0)
        left = np.minimum(x.astype(np.int64), len(SCALES) - 2)
        low, high = (np.take_along_axis(pots.chances, left + k, axis=1) for k in (0, 1))
        yield low + (x - left) * (high - low)


def normalise(log_likelihood: Floats) -> Floats:
    """Weights that sum to 1, for a prior flat in the logarithm of the scale: ``SCALES`` are evenly spaced in it."""
    weights = np.exp(log_likelihood - log_likelihood.max())
    return weights / weights.sum()


def estimate_growth(weights: Floats, strokes: int) -> Estimate:
    """Median and 95 % interval of a posterior over ``GROWTHS``."""
    below = np.cumsum(weights)
    low, high = np.searchsorted(below, (0.025, 0.975)).tolist()
    value = float(np.interp(0.5, below - 0.5 * weights, GROWTHS))
    return Estimate(value=value, low=float(ENDS[low]), high=float(ENDS[high + 1]), strokes=strokes)


def estimate(weights: Floats, unit: float, strokes: int) -> Estimate:
    """Median and 95 % interval of a posterior, in units of a professional's error."""
    middles = np.cumsum(weights) - 0.5 * weights
    value, low, high = (unit * np.exp(np.interp((0.5, 0.025, 0.975), middles, np.log(SCALES)))).tolist()
    return Estimate(value=value, low=low, high=high, strokes=strokes)


def measure_errors(strokes: list[Recorded], practice: Practice) -> tuple[Floats, Floats, Floats, Floats]:
    """What n strokes tell, NaN where they do not: errors of direction, in a professional's standard deviations for a level cue at
    rest; ``CALLED`` in this unit; errors of speed in those of speed; cue speeds [m/s], ``POT_SPEED`` where nothing is known."""
    directions, widths, speeds = np.full((3, len(strokes)), np.nan)
    paces = np.full(len(strokes), POT_SPEED)
    base, physics = LEVELS[BASE], practice.options.rules.physics
    unit = np.radians(base.direction_deg(physics, speed=0.0))
    rows = [k for k, one in enumerate(strokes) if one.played and one.ball and not one.intended]
    at_pots = {k: lower_cue(strokes[k], practice) for k in rows}
    lines = dict(zip(at_pots, zip(*solve_lines(list(at_pots.values()), practice), strict=True), strict=True))
    for k, one in enumerate(strokes):
        if one.intended is not None:
            paces[k] = one.intended.speed
        elif one.played is not None or one.speed is not None:
            paces[k] = one.played["speed"] if one.played is not None else one.speed
        if one.played is None or (one.intended is None and one.ball is None):
            continue
        if one.intended is not None:
            speeds[k] = (one.played["speed"] - paces[k]) / (base.speed_rel * paces[k])
            elevation, side = fit_to_room(one, one.intended.numbers(), practice)
            cue = one.intended.aim - squirt(one.intended.side, physics)
            # as of a stroke without side: the squirt of a tip far off the middle changes less with it
            aside, more = one.played["aim"] - cue + squirt(one.played["side"] - side, physics), 1.0
        else:
            line, more = lines[k]
            elevation = (at_pots[k].played or {})["elevation"]
            aside = direction_of(one.played, physics) - line
        if practice.options.cue == "real":
            more *= 1.0 + elevation / TWICE
        directions[k], widths[k] = remainder(aside, 2.0 * pi) / (unit * more), CALLED / (unit * more)
    if at_pots:
        own = paces[list(at_pots)]
        ends = np.quantile(own, OUTER, method="lower"), np.quantile(own, 1.0 - OUTER, method="higher")
        paces[list(at_pots)] = np.clip(own, *ends)
    return directions, widths, speeds, paces


def fit_to_room(one: Recorded, stroke: Floats, practice: Practice) -> tuple[float, float]:
    """Elevation and side of a stroke as rails and balls allow them, before errors take the room and raise the cue once more."""
    if practice.options.cue == "free":
        return float(stroke[4]), float(stroke[1])
    room = room_for(stroke, Positions.of(one.position), practice.options.rules)
    return room.elevation, room.side


def lower_cue(one: Recorded, practice: Practice) -> Recorded:
    """A stroke at a pot with the elevation that was likely meant: as low as the cue could be, if it was nearly that."""
    played: dict[str, float] = one.played or {}
    way = direction_of(played, practice.options.rules.physics)
    stroke = np.array([played["speed"], played["side"], played["top"], way, 0.0])
    needed, _ = fit_to_room(one, stroke, practice)
    own = played["elevation"]
    return replace(one, played=played | {"elevation": needed if own < needed + AS_NEEDED else own})


def solve_lines(strokes: list[Recorded], practice: Practice) -> tuple[Floats, Floats]:
    """The lines that strokes at pots should have had [rad]; by how much more their directions differ than they err."""
    physics, base, step = practice.options.rules.physics, LEVELS[BASE], 0.02
    if not strokes:
        return np.empty(0), np.empty(0)
    played: list[dict[str, float]] = [one.played or {} for one in strokes]
    moved = [
        replace(one, played=its | {name: its[name] + by * step})
        for name, by in (("side", 0.0), ("side", 1.0), ("side", -1.0), ("top", 1.0), ("top", -1.0))
        for one, its in zip(strokes, played, strict=True)
    ]
    aims, right, left, up, down = solve_strokes(moved, practice)[:, 3].reshape(5, -1)
    turn = lambda a, b: np.array([remainder(x, 2.0 * pi) for x in (a - b).tolist()]) / (2.0 * step)  # noqa: E731
    squirts = [[squirt(its["side"] + by, physics) for its in played] for by in (step, -step)]
    tip = base.offset_mm * 1e-3 / physics.R  # its error moves the line, too, by the throw of its spin
    parts = (
        np.full(len(strokes), radians(base.aim_deg)),
        tip * (np.subtract(squirts[0], squirts[1]) / (2.0 * step) - turn(right, left)),
        tip * turn(up, down),
    )
    return aims, np.linalg.norm(parts, axis=0) / np.radians(base.direction_deg(physics, speed=0.0))


def solve_strokes(strokes: list[Recorded], practice: Practice) -> Floats:
    """The strokes (n, 5) that were meant: as recorded, else at the middle of the pocket."""
    out, most = np.zeros((len(strokes), 5)), practice.options.rules.physics.max_offset
    for k, one in enumerate(strokes):
        if one.intended is not None:
            out[k] = one.intended.numbers()
            continue
        cue = one.played or {"speed": one.speed or POT_SPEED, "side": 0.0, "top": 0.0}
        tip = hypot(cue["side"], cue["top"])
        inside = min(1.0, most / tip) if tip > 0.0 else 1.0
        out[k, :3] = min(max(cue["speed"], 0.2), 7.0), inside * cue["side"], inside * cue["top"]
        out[k, 4] = min(cue.get("elevation", 0.0), STEEPEST_CUE)
    rows = [k for k, one in enumerate(strokes) if one.intended is None]
    if rows:
        at = Positions.of([strokes[k].position for k in rows])
        balls = np.array([strokes[k].ball for k in rows])
        pockets = np.array([strokes[k].pocket for k in rows])
        targets = POCKET_AIMS[pockets][:, [AIM_X, AIM_Y]]
        out[rows, 3] = practice.exact.pot_aim(at, np.arange(len(rows)), balls, targets, out[rows])
    return out


def simulate_pots(strokes: list[Recorded], practice: Practice, seed: int) -> CalledPots:
    """The called pots whose outcome is known, with their chances for each of ``SCALES``."""
    rows = [k for k, one in enumerate(strokes) if one.ball is not None and one.potted is not None]
    if not rows:
        return CalledPots([], np.empty((0, len(SCALES))), np.empty(0, np.bool_), np.empty(0))
    called = [strokes[k] for k in rows]
    meant, many = solve_strokes(called, practice), len(RADII) * WAYS
    # each stroke has errors of its own, so that equal strokes tell more together
    normal = np.vectorize(NormalDist().inv_cdf)
    ways = np.stack([normal(sobol_points(WAYS, 5, seed + k)) for k in range(len(called))])
    ways /= np.linalg.norm(ways, axis=2)[..., None]
    errors = (RADII[:, None, None] * ways[:, None]).reshape(-1, 5)
    at = Positions.of([one.position for one in called])
    each = np.repeat(np.arange(len(called)), many)
    stops = practice.noisy.play_strokes(at, each, meant[each], errors=errors)
    balls, pockets = np.array([(one.ball, one.pocket) for one in called]).T
    went = (stops.potted[np.arange(len(each)), balls[each]] == pockets[each]) & (stops.penalty == 0)
    shares = went.reshape(len(called), len(RADII), WAYS).mean(axis=2)
    return CalledPots(rows, shares @ weigh_radii(), np.array([one.potted for one in called]), meant[:, 0])


def weigh_radii() -> Floats:
    """How likely an error of each size in ``SCALES`` is to have each of ``RADII``: (radii, scales), columns sum to 1."""
    base, edges = LEVELS[BASE], np.sqrt(RADII[1:] * RADII[:-1])[:, None] / SCALES
    inside = (1.0 - base.lapse) * chi5(edges) + base.lapse * chi5(edges / base.lapse_factor)
    below = np.vstack([np.zeros(len(SCALES)), inside, np.ones(len(SCALES))])
    return np.diff(below, axis=0)


def chi5(x: Floats) -> Floats:
    """The distribution function of the length of five standard normal numbers."""
    half = np.vectorize(erf)(x / sqrt(2.0))
    return half - sqrt(2.0 / pi) * np.exp(-0.5 * x * x) * (x + x**3 / 3.0)
