"""What costs a player most, and what should be practised? ``coach``: errors, pots made and expected, costs, drills.

Costs are those of ``costs``, with the 95 % interval of a bootstrap over strokes (docs/play/coach.md)."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from math import degrees, sqrt
from typing import Any

import numpy as np

from .._lib.check import choice
from .._lib.types import Floats
from ..planning import clear_paths, pots
from ..tasks.noise import LEVELS, NoiseLike
from .costs import PARTS, count_costs
from .errors import (
    BASE,
    SCALES,
    CalledPots,
    Estimate,
    Fit,
    PlayerErrors,
    fit_errors,
    list_chances,
    list_strokes,
)
from .practice import Practice, practice_of
from .recorded import Recorded, agree_options

WIDE, NARROW = 0.23, 0.06  # tolerances [deg] above which a pot is easy, below which hard, as of ``pots:D``
RESAMPLES = 2000
WORDS = {
    "easy": "pots of which the aim may err by more than 0.23 degrees",
    "medium": "pots of which the aim may err by 0.06 to 0.23 degrees",
    "hard": "pots of which the aim may err by less than 0.06 degrees",
}


@dataclass(frozen=True, kw_only=True)
class Drill:
    """What to practise, and why."""

    layout: str  # as of an environment, and ``--layout`` of the page
    reason: str  # in one sentence


@dataclass(frozen=True, kw_only=True)
class Coaching:
    """What ``coach`` found.

    Attributes
    ----------
    errors : PlayerErrors
        The player's errors of execution.
    strokes, visits, called, made : int
        Numbers of strokes and of visits; of the strokes with a called pot whose outcome is known, and of those made.
    expected : Estimate or None
        How many of these a player with such errors makes, and the 95 % interval of that number: the errors' own interval
        and the luck of the pots. Where the errors were estimated from these very pots it must agree.
    likely : Estimate or None
        The same of a player of the target level, whose errors are known.
    target : str or dict
        The level that costs are counted against.
    costs : dict of str to Estimate
        "potting", "position", "safety": points lost in a visit against the target; without one of which no stroke is known.
    most : str or None
        Which of these costs most; None where none is known, or none is positive.
    sure : float
        The share of the bootstrap's samples in which it does.
    drills : tuple of Drill
        What to practise, first what costs most: each a ``layout`` of this package, and the ``reason`` in one sentence.

    Examples
    --------
    >>> import snooker_env as sn
    >>> from snooker_env.advice import Recorded, coach
    >>> at = sn.Position(cue=(0.0, 0.9), black=(0.4, 1.3))
    >>> over = sn.Position(over=True)
    >>> made = Recorded(position=at, ball=21, pocket=3, potted=True, points=7, after=over)
    >>> report = coach([made] * 3, options={"cue": "real", "physics": "match", "table": "match"})
    >>> report.called, report.made, sorted(report.costs)
    (3, 3, ['position', 'potting'])
    """

    errors: PlayerErrors
    strokes: int
    visits: int
    called: int
    made: int
    expected: Estimate | None
    likely: Estimate | None
    target: str | dict[str, float]
    costs: dict[str, Estimate]
    most: str | None
    sure: float
    drills: tuple[Drill, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return all attributes by name as JSON types."""
        return asdict(self) | {"drills": [asdict(one) for one in self.drills]}

    def __str__(self) -> str:
        errors, lines = self.errors, [f"{self.strokes} strokes in {self.visits} visits"]
        at = f"{errors.at:.3g} m/s"
        base = LEVELS[BASE]
        for name, one, unit, scale, usual in (
            (f"direction, at {at}", errors.direction, "deg", 1.0, base.direction_deg(speed=errors.at)),
            ("speed", errors.speed, "%", 100.0, base.speed_rel),
        ):
            if one is None:
                lines.append(f"error of {name}: no stroke tells it")
                continue
            value, low, high = scale * one.value, scale * one.low, scale * one.high
            often = f"{one.value / usual:.1f} times a professional's, from {one.strokes} strokes"
            lines.append(f"error of {name}: {value:.3g} {unit} [{low:.3g}, {high:.3g}], {often}")
        if errors.direction is not None:
            one, law = errors.growth, "with the cue speed V it grows as sqrt(1 + (g V)^2)"
            lines.append(
                f"{law}, g = {one} s/m"
                if one
                else f"strokes of about {at} do not tell how it grows with the speed"
            )
        for name, one, unit, scale, words in (
            ("aims", errors.aside, "deg", 1.0, ("left", "right")),
            ("strikes", errors.faster, "%", 100.0, ("too hard", "too softly")),
        ):
            if one is not None and one.low * one.high > 0.0:
                way = words[one.value < 0.0]
                lines.append(f"on average {name} {scale * abs(one.value):.2g} {unit} {way}")
        if self.expected is not None and self.likely is not None:
            one = self.expected
            such = f"such errors make {one.value:.0f} [{one.low:.0f}, {one.high:.0f}]"
            made = f"pots: {self.made} of {self.called} made; {such}, the target {self.likely.value:.0f}"
            lines.append(made)
        for name, one in self.costs.items():
            what, sign = ("gains", -1.0) if one.value < 0.0 else ("costs", 1.0)
            low, high = sorted((sign * one.low, sign * one.high))
            words = f"{abs(one.value):.2f} [{low:.2f}, {high:.2f}] points a visit, {one.strokes} strokes"
            lines.append(f"{name} {what} {words}")
        if self.most is not None:
            lines.append(f"{self.most} costs most: so it is in {100 * self.sure:.0f} % of the resamples")
        drills = [f"practise {one.layout}: {one.reason}" for one in self.drills]
        lines += drills or ["nothing to practise: no part costs points beside the target"] * bool(self.costs)
        return "\n".join(lines)


def coach(
    strokes: Sequence[Recorded], *, target: NoiseLike = "professional", options: object = None, seed: int = 0
) -> Coaching:
    """Say what recorded strokes tell of a player: errors, pots expected and made, what costs most, and drills.

    Parameters
    ----------
    strokes : sequence of Recorded
        The strokes of one player, in order.
    target : str, dict or Noise
        Errors of the player that costs are counted against.
    options : dict or Options, optional
        Where they were played, as in ``advise``: what the strokes do not say of "cue", "physics" and "table"; in a frame
        also "miss" and "game".
    seed : int
        Seed of the simulated strokes, in [0, 2**63].

    Returns
    -------
    Coaching
        ValueError if an argument is invalid, no stroke says anything of an error, or nothing says where they were played.

    Examples
    --------
    >>> import snooker_env as sn
    >>> from snooker_env.advice import Recorded, coach
    >>> at = sn.Position(cue=(0.1, 0.2), black=(-0.3, 1.0))
    >>> pot = {"position": at, "ball": 21, "pocket": 4, "speed": 2.0}
    >>> after = sn.Position(over=True)
    >>> table = {"cue": "real", "physics": "match", "table": "match"}
    >>> report = coach([Recorded(**pot, potted=True, points=7, after=after) for _ in range(3)], options=table)
    >>> report.made, report.errors.speed is None
    (3, True)
    """
    kept = list_strokes(strokes)
    options = agree_options(kept, options)
    if isinstance(target, str):
        choice("target", target, LEVELS)
    bench = practice_of(target, options, of_frames=True)
    physical = {name: getattr(bench.options, name) for name in ("physics", "table", "fidelity", "cue")}
    base = practice_of(BASE, physical)
    found = fit_errors(kept, base, seed)
    kept = found.strokes
    points, counts = count_costs(kept, bench, seed)
    visits = count_visits(kept)
    rng = np.random.default_rng((seed, RESAMPLES))
    drawn = points[rng.integers(0, len(kept), (RESAMPLES, len(kept)))].sum(axis=1) / max(1, visits)
    ends, sums = np.quantile(drawn, (0.025, 0.975), axis=0), points.sum(axis=0) / max(1, visits)
    parts: dict[str, Estimate] = {}
    for name, (value, low, high), many in zip(PARTS, np.vstack([sums, ends]).T.tolist(), counts, strict=True):
        if many:
            parts[name] = Estimate(value=value, low=low, high=high, strokes=int(many))
    ranked = sorted((name for name in parts if parts[name].value > 0.0), key=lambda name: -parts[name].value)
    most = ranked[0] if ranked else None
    drill = {"potting": _potting, "position": _position, "safety": _safety}
    by_part: dict[str, Floats] = {name: points[:, k] for k, name in enumerate(PARTS)}
    largest = (drawn.argmax(axis=1) == PARTS.index(most)) & (drawn.max(axis=1) > 0.0) if most else np.zeros(1)
    return Coaching(
        errors=found.errors,
        strokes=len(kept),
        visits=visits,
        called=len(found.pots.rows),
        made=int(found.pots.made.sum()),
        expected=_expect(found),
        likely=_expect_of_target(found.pots, bench),
        target=target if isinstance(target, str) else asdict(bench.noise),
        costs=parts,
        most=most,
        sure=float(largest.mean()),
        drills=tuple(drill[name](kept, parts[name], by_part[name], found.errors) for name in ranked),
    )


def count_visits(strokes: Sequence[Recorded]) -> int:
    """The number of visits in strokes of one player, in order; the last may go on."""
    return sum(not one.goes_on for one in strokes) + strokes[-1].goes_on


def _expect_of_target(pots: CalledPots, bench: Practice) -> Estimate | None:
    """How many called pots a player of the target level makes, whose errors are known; the normal interval."""
    physics, noise, base = bench.options.rules.physics, bench.noise, LEVELS[BASE]
    times = [
        noise.direction_deg(physics, speed=v) / base.direction_deg(physics, speed=v)
        for v in pots.paces.tolist()
    ]
    at = np.log(np.maximum(times, SCALES[0]))
    p = np.array([np.interp(x, np.log(SCALES), row) for x, row in zip(at, pots.chances, strict=True)])
    return _interval(float(p.sum()), float((p * (1.0 - p)).sum()), len(p)) if len(p) else None


def _expect(found: Fit) -> Estimate | None:
    """How many called pots are made: the mean over the errors' posterior, the normal interval of the count."""
    if found.direction is None or not len(found.pots.rows):
        return None
    mean = square = 0.0
    for chances, weights in zip(list_chances(found.pots, found.errors.at), found.direction, strict=True):
        counts, spread = chances.sum(axis=0), (chances * (1.0 - chances)).sum(axis=0)
        mean, square = mean + float(counts @ weights), square + float((spread + counts**2) @ weights)
    return _interval(mean, square - mean * mean, len(found.pots.rows))


def _interval(mean: float, variance: float, n: int) -> Estimate:
    half = 1.96 * sqrt(max(0.0, variance))
    return Estimate(value=mean, low=max(0.0, mean - half), high=min(float(n), mean + half), strokes=n)


def _potting(strokes: list[Recorded], cost: Estimate, lost: Floats, errors: PlayerErrors) -> Drill:
    """Pots as wide as those that cost most."""
    sums = dict.fromkeys(WORDS, 0.0)
    for one, points in zip(strokes, lost.tolist(), strict=True):
        if points and (wide := measure_width(one)) is not None:
            sums["easy" if wide > WIDE else "medium" if wide > NARROW else "hard"] += points
    worst = max(sums, key=lambda name: sums[name])
    share = f"of {cost.value:.1f} points a visit lost by missed pots most were lost at {WORDS[worst]}"
    return Drill(layout=f"pots:{worst}", reason=share)


def measure_width(one: Recorded) -> float | None:
    """The tolerance of the called pot [deg], if it is direct."""
    direct = pots(one.position, 16)
    which = np.flatnonzero((direct.ball[0] == one.ball) & (direct.pocket[0] == one.pocket))
    return degrees(float(direct.tolerance[0, which[0]])) if len(which) else None


def _position(strokes: list[Recorded], cost: Estimate, lost: Floats, errors: PlayerErrors) -> Drill:
    """The line-up: pots are easy there, and the speed decides."""
    reason = f"the positions left after pots are {cost.value:.1f} points a visit worse than the target's"
    if errors.speed is not None and errors.direction is not None:
        base = LEVELS[BASE]
        usual = base.direction_deg(speed=errors.at)
        fast, aside = errors.speed.value / base.speed_rel, errors.direction.value / usual
        if fast > 1.25 * aside:
            reason += f", and the error of speed is {fast:.1f} times a professional's, that of direction {aside:.1f}"
    return Drill(layout="line_up", reason=reason)


def _safety(strokes: list[Recorded], cost: Estimate, lost: Floats, errors: PlayerErrors) -> Drill:
    """Escapes, if most was lost where no straight path led to a ball on; else safeties."""
    hidden = ~clear_paths([one.position for one in strokes]).any_part
    if lost[hidden].sum() > 0.5 * lost.sum():
        reason = f"of {cost.value:.1f} points a visit lost in safety most were lost when snookered"
        return Drill(layout="escape", reason=reason)
    missed = np.array([one.ball is not None for one in strokes])
    if lost[missed].sum() > 0.5 * lost.sum():
        reason = f"of {cost.value:.1f} points a visit lost in safety most were left on by missed pots"
    else:
        reason = f"strokes that leave the table to the other cost {cost.value:.1f} points a visit"
    return Drill(layout="safety", reason=reason)
