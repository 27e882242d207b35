"""How large are a player's errors of direction and speed? ``estimate_errors``: estimates with 95 % intervals.

The model is that of ``snooker_env.tasks.noise``; two multiples s of a professional's errors are estimated, by the
likelihoods of docs/play/coach.md, "How errors are estimated"."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from math import erf, hypot, pi, remainder, sqrt
from statistics import NormalDist
from typing import Any, NamedTuple

import numpy as np

from .._check import integer, refuse_what
from .._types import Floats
from ..geometry import AIM_X, AIM_Y, POCKET_AIMS
from ..planning import Positions
from ..planning.sobol import sobol_points
from ..tasks.noise import LEVELS, POT_SPEED, TWICE, Noise
from .practice import Practice, practice_of
from .recorded import CALLED, Recorded, direction_of

BASE = "professional"  # whose errors the estimates are multiples of
LEAST, MOST = 0.02, 50.0  # smallest and largest error that is thought of, over a professional's
SCALES = np.geomspace(LEAST, MOST, 600)
SHARES = np.linspace(0.005, 0.9, 40)  # shares of safeties among guessed pots that are thought of, each alike
RADII = np.geomspace(0.12, 60.0, 27)  # sizes of errors that are tried [a professional's standard deviations]
WAYS = 32  # errors of each radius that are tried


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """A number with its 95 % interval, and the number of strokes that it was learned from."""

    value: float
    low: float
    high: float
    strokes: int

    def __str__(self) -> str:
        return f"{self.value:.3g} [{self.low:.3g}, {self.high:.3g}]"


@dataclass(frozen=True, kw_only=True)
class PlayerErrors:
    """A player's errors of execution, as returned by ``estimate_errors``. An ``Estimate`` has ``value``, the ends ``low``
    and ``high`` of its 95 % interval, and the number of ``strokes`` that it was learned from.

    Attributes
    ----------
    direction : Estimate or None
        Standard deviation of the cue ball's direction at 1.5 m/s [deg]; None if no stroke tells it.
    speed : Estimate or None
        That of the speed, as a share of the speed.
    aside, faster : Estimate or None
        Mean errors: of the direction, anticlockwise (to the left as the player sees it) [deg at 1.5 m/s], and of the
        speed, as a share. Only of strokes that were measured.

    Examples
    --------
    >>> import snooker_env as sn
    >>> from snooker_env.advice import Recorded, estimate_errors
    >>> at = sn.Position(cue=(0.0, 0.9), black=(0.4, 1.3))
    >>> meant = {"speed": 2.0, "aim": 0.8}
    >>> strokes = [Recorded(position=at, intended=meant, played={"speed": 2.0, "aim": 0.8 + e}) for e in (-0.002, 0.002)]
    >>> found = estimate_errors(strokes)
    >>> round(found.direction.value, 2), found.direction.strokes
    (0.11, 2)
    """

    direction: Estimate | None
    speed: Estimate | None
    aside: Estimate | None
    faster: Estimate | None

    @property
    def noise(self) -> Noise:
        """Execution errors like the player's, a ``Noise``, with a professional's proportions; of an error that is not known,
        as many times a professional's as the other."""
        base = LEVELS[BASE]
        turned = self.direction and self.direction.value / base.direction_deg()
        hurried = self.speed and self.speed.value / base.speed_rel
        many, fast = turned or hurried or 1.0, hurried or turned or 1.0
        same = {"aim_deg": base.aim_deg, "offset_mm": base.offset_mm, "elevation_deg": base.elevation_deg}
        errors: Any = {name: value * many for name, value in same.items()}
        return Noise(**errors, speed_rel=base.speed_rel * fast, growth=base.growth)

    def to_dict(self) -> dict[str, Any]:
        """Return all attributes by name as JSON types."""
        return asdict(self)


class Pots(NamedTuple):
    """The strokes with a called pot: their rows, and the chances of the pots for each of ``SCALES``."""

    rows: list[int]
    chances: Floats  # (n, scales)
    made: Any  # bool (n,)


class Fitted(NamedTuple):
    """The errors of a player, and what was found on the way."""

    errors: PlayerErrors
    direction: Floats | None  # the posterior of its error over ``SCALES``
    pots: Pots  # those that were called
    strokes: list[Recorded]  # without the guessed pots that were likelier to be safeties


def estimate_errors(strokes: Sequence[Recorded], *, options: Any = None, seed: int = 0) -> PlayerErrors:
    """Estimate a player's errors of direction and speed from recorded strokes.

    Parameters
    ----------
    strokes : sequence of Recorded
        The strokes of one player. Those that say nothing of an error are left out.
    options : dict or Options, optional
        Where they were played, as in ``advise``.
    seed : int
        Seed of the simulated strokes, in [0, 2**63].

    Returns
    -------
    PlayerErrors
        ValueError if no stroke says anything, or an argument is invalid.

    Examples
    --------
    >>> import snooker_env as sn
    >>> from snooker_env.advice import Recorded, estimate_errors
    >>> at = sn.Position(cue=(0.1, 0.2), black=(-0.3, 1.0))
    >>> pot = {"position": at, "ball": 21, "pocket": 4, "speed": 2.0}
    >>> found = estimate_errors([Recorded(**pot, potted=k > 0) for k in range(6)])
    >>> found.direction.low < found.direction.value < found.direction.high
    True
    """
    return fitted(checked(strokes), practice_of(BASE, options), seed).errors


def checked(strokes: Any) -> list[Recorded]:
    """Strokes as a list; ValueError unless there is one, and all are ``Recorded``."""
    kept = list(strokes)
    for k, one in enumerate(kept):
        if not isinstance(one, Recorded):
            raise refuse_what(f"strokes[{k}]", f"a {type(one).__name__}", "must be a Recorded")
    if not kept:
        raise refuse_what("strokes", "none", "must hold at least one stroke")
    return kept


def fitted(strokes: list[Recorded], practice: Practice, seed: int) -> Fitted:
    """``estimate_errors`` with what was found on the way; ``practice``: with the errors ``BASE``."""
    integer("seed", seed, 0, 2**63)
    directions, speeds, widths = measured(strokes, practice)
    guessed = np.array([one.guessed for one in strokes]) & ~np.isnan(directions)
    mixed, meant = guesses(directions[guessed], widths[guessed])
    strokes = list(strokes)
    for k in np.flatnonzero(guessed)[~meant].tolist():
        strokes[k] = replace(strokes[k], ball=None, pocket=None, potted=None, guessed=False)
        directions[k] = np.nan
    pots = tolerances(strokes, practice, seed)
    told = [k for k, row in enumerate(pots.rows) if np.isnan(directions[row])]
    e = directions[~np.isnan(directions)]
    base, direction, weights = LEVELS[BASE], None, None
    unit = base.direction_deg(practice.options.rules.physics)
    if len(e) + len(told):
        sure = directions[~np.isnan(directions) & ~guessed]
        log_l = direct(sure) + mixed + outcome(pots.chances[told], pots.made[told]).sum(axis=0)
        weights = posterior(log_l)
        direction = estimate(weights, unit, len(e) + len(told))
    v = speeds[~np.isnan(speeds)]
    speed = estimate(posterior(direct(v)), base.speed_rel, len(v)) if len(v) else None
    if direction is None and speed is None:
        allowed = "with intended and played, with a pot and played, or with a pot and potted"
        raise refuse_what("strokes", "none that tells an error", f"must hold strokes {allowed}")
    aside, faster = mean_of(e, unit), mean_of(v, base.speed_rel)
    errors = PlayerErrors(direction=direction, speed=speed, aside=aside, faster=faster)
    return Fitted(errors, weights, pots, strokes)


def direct(e: Floats) -> Floats:
    """Log-likelihood (scales,) of errors (n,) in a professional's standard deviations."""
    return -len(e) * np.log(SCALES) - 0.5 * float(np.sum(e * e)) / SCALES**2


def guesses(e: Floats, widths: Floats) -> tuple[Floats, Any]:
    """Log-likelihood (scales,) of guessed pots (n,), or safeties evenly within ``widths``; which are pots."""
    if not len(e):
        return np.zeros(len(SCALES)), np.zeros(0, np.bool_)
    pot = np.exp(-0.5 * (e / SCALES[:, None]) ** 2) / (SCALES[:, None] * sqrt(2.0 * pi))
    safety = 0.5 / widths
    log_l = np.array([np.log((1.0 - share) * pot + share * safety).sum(axis=1) for share in SHARES])
    both = np.exp(log_l - log_l.max())
    both /= both.sum()
    likely = [(1.0 - share) * pot / ((1.0 - share) * pot + share * safety) for share in SHARES]
    meant = sum(weights @ each for weights, each in zip(both, likely, strict=True))
    return np.log(np.maximum(both.sum(axis=0), 1e-300)), meant > 0.5


def outcome(chances: Floats, made: Any) -> Floats:
    """Log-likelihoods (n, scales) of pots made or missed, whose chances are (n, scales)."""
    p = np.clip(chances, 1e-3, 1.0 - 1e-3)  # a fluke or a slip is never impossible
    return np.where(np.asarray(made)[:, None], np.log(p), np.log1p(-p))


def posterior(log_likelihood: Floats) -> Floats:
    """Weights (scales,) that sum to 1, for a prior flat in the logarithm: ``SCALES`` are evenly spaced in it."""
    weights = np.exp(log_likelihood - log_likelihood.max())
    return weights / weights.sum()


def quantiles(weights: Floats, shares: Sequence[float]) -> Floats:
    """Quantiles of a posterior over ``SCALES``."""
    return np.exp(np.interp(shares, np.cumsum(weights) - 0.5 * weights, np.log(SCALES)))


def estimate(weights: Floats, unit: float, strokes: int) -> Estimate:
    """Median and 95 % interval of a posterior, in units of a professional's error."""
    value, low, high = (unit * quantiles(weights, (0.5, 0.025, 0.975))).tolist()
    return Estimate(value=value, low=low, high=high, strokes=strokes)


def mean_of(e: Floats, unit: float) -> Estimate | None:
    """The mean of errors (n,), its 95 % interval by Student's law (Hill's expansion); None if n < 3."""
    n = len(e)
    if n < 3:
        return None
    z, f = 1.959964, n - 1
    t = z + (z**3 + z) / (4 * f) + (5 * z**5 + 16 * z**3 + 3 * z) / (96 * f * f)
    middle, half = float(e.mean()), t * float(e.std(ddof=1)) / sqrt(n)
    return Estimate(value=middle * unit, low=(middle - half) * unit, high=(middle + half) * unit, strokes=n)


def measured(strokes: list[Recorded], practice: Practice) -> tuple[Floats, Floats, Floats]:
    """Errors of direction and speed (n,) over a professional's, NaN if unknown; and ``CALLED`` over it."""
    directions, speeds, widths = np.full((3, len(strokes)), np.nan)
    base, physics = LEVELS[BASE], practice.options.rules.physics
    unit = np.radians(base.direction_deg(physics, speed=0.0))
    for k, one in enumerate(strokes):
        tipped = 1.0
        if one.played is None:
            continue
        if one.intended is not None:
            aim, speed = one.intended.aim, one.intended.speed
            speeds[k] = (one.played["speed"] - speed) / (base.speed_rel * speed)
        elif one.ball is not None:
            speed, aim, tipped = one.played["speed"], *line_of(one, practice)
        else:
            continue
        raised = one.played["elevation"] / TWICE if practice.options.cue == "real" else 0.0
        more = sqrt(1.0 + (base.growth * speed) ** 2) * (1.0 + raised) * tipped
        aside = remainder(direction_of(one.played, physics) - aim, 2.0 * pi)
        directions[k], widths[k] = aside / (unit * more), CALLED / (unit * more)
    return directions, speeds, widths


def line_of(one: Recorded, practice: Practice) -> tuple[float, float]:
    """The line that a stroke at a pot should have had [rad]; by how much more the direction differs than it errs."""
    physics, base = practice.options.rules.physics, LEVELS[BASE]
    assert one.played is not None
    step = 0.02
    moved = [
        replace(one, played=one.played | {name: one.played[name] + by * step})
        for name, by in (("side", 0.0), ("side", 1.0), ("side", -1.0), ("top", 1.0), ("top", -1.0))
    ]
    aim, right, left, up, down = solved(moved, practice)[:, 3].tolist()
    tip = base.offset_mm * 1e-3 / physics.R  # its error moves the line, too, by the throw of its spin
    squirted = direction_of({"aim": 0.0, "side": step}, physics) / step
    parts = (
        np.radians(base.aim_deg),
        tip * (squirted - remainder(right - left, 2.0 * pi) / (2.0 * step)),
        tip * remainder(up - down, 2.0 * pi) / (2.0 * step),
    )
    whole = float(np.linalg.norm(parts))
    return aim, whole / float(np.radians(base.direction_deg(physics, speed=0.0)))


def solved(strokes: list[Recorded], practice: Practice) -> Floats:
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
    rows = [k for k, one in enumerate(strokes) if one.intended is None]
    if rows:
        at = Positions.of([strokes[k].position for k in rows])
        balls = np.array([strokes[k].ball for k in rows])
        pockets = np.array([strokes[k].pocket for k in rows])
        targets = POCKET_AIMS[pockets][:, [AIM_X, AIM_Y]]
        out[rows, 3] = practice.exact.pot_aim(at, np.arange(len(rows)), balls, targets, out[rows])
    return out


def tolerances(strokes: list[Recorded], practice: Practice, seed: int) -> Pots:
    """The called pots whose outcome is known, with their chances for each of ``SCALES``."""
    rows = [k for k, one in enumerate(strokes) if one.ball is not None and one.potted is not None]
    if not rows:
        return Pots([], np.empty((0, len(SCALES))), np.empty(0, np.bool_))
    called = [strokes[k] for k in rows]
    meant, many = solved(called, practice), len(RADII) * WAYS
    # each stroke has errors of its own, so that equal strokes tell more together
    ways = np.stack([normal_points(WAYS, seed + k) for k in range(len(called))])
    ways /= np.linalg.norm(ways, axis=2)[..., None]
    errors = (RADII[:, None, None] * ways[:, None]).reshape(-1, 5)
    at = Positions.of([one.position for one in called])
    each = np.repeat(np.arange(len(called)), many)
    stops = practice.noisy.stops(at, each, strokes=meant[each], errors=errors)
    balls, pockets = np.array([(one.ball, one.pocket) for one in called]).T
    went = (stops.potted[np.arange(len(each)), balls[each]] == pockets[each]) & (stops.penalty == 0)
    shares = went.reshape(len(called), len(RADII), WAYS).mean(axis=2)
    return Pots(rows, shares @ radius_weights(), np.array([one.potted for one in called]))


def radius_weights() -> Floats:
    """How likely an error of each size in ``SCALES`` is to have each of ``RADII``: (radii, scales), columns sum to 1."""
    edges = np.sqrt(RADII[1:] * RADII[:-1])[:, None] / SCALES
    below = np.vstack([np.zeros(len(SCALES)), chi5(edges), np.ones(len(SCALES))])
    return np.diff(below, axis=0)


def chi5(x: Floats) -> Floats:
    """The distribution function of the length of five standard normal numbers."""
    half = np.vectorize(erf)(x / sqrt(2.0))
    return half - sqrt(2.0 / pi) * np.exp(-0.5 * x * x) * (x + x**3 / 3.0)


def normal_points(n: int, seed: int) -> Floats:
    """n evenly spread standard normal points (n, 5)."""
    return np.vectorize(NormalDist().inv_cdf)(sobol_points(n, 5, seed))
