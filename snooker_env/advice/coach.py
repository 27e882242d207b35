"""What costs a player most, and what should be practised? ``coach``: errors, pots made and expected, costs, drills.

Costs are points of a frame lost by potting, position and safety, with the 95 % interval of a bootstrap over strokes
(docs/play/coach.md)."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from math import degrees, sqrt
from typing import Any

import numpy as np

from .._lib.check import choice, refuse_what
from .._lib.types import Floats, Ints
from ..planning import Position, Positions, Search, clear_paths, pots
from ..planning.proposals import Asking, Proposals, strokes_at
from ..planning.sobol import sobol_points
from ..planning.worth import lead_of, pass_after_miss
from ..tasks.noise import LEVELS, NoiseLike
from .errors import BASE, CalledPots, Estimate, PlayerErrors, fit_errors, list_chances
from .practice import JUDGING, Practice, keys, one_position, practice_of
from .recorded import Recorded, agree_options

WIDE, NARROW = 0.23, 0.06  # tolerances [deg] above which a pot is easy, below which hard, as of ``pots:D``
RESAMPLES = 2000
PARTS = ("potting", "position", "safety")
SAMPLES = 24  # simulations of the best stroke at a called pot
SLOW, FAST, TIP = 0.8, 4.5, 0.35
"""Range of the strokes tried there: cue speeds [m/s], and the largest height of the tip over R."""
WORDS = {"easy": "more than 0.23", "medium": "0.06 to 0.23", "hard": "less than 0.06"}  # [deg]


@dataclass(frozen=True, kw_only=True)
class Drill:
    """What to practise: the ``layout`` of an environment or of the page, and the ``reason`` in one sentence."""

    layout: str
    reason: str


@dataclass(frozen=True, kw_only=True)
class Coaching:
    """The fields are described by ``coach``."""

    errors: PlayerErrors
    strokes: int
    visits: int
    called: int
    made: int
    expected: Estimate | None
    target: str | dict[str, float]
    costs: dict[str, Estimate]
    most: str | None
    sure: float
    drills: tuple[Drill, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return all attributes by name as JSON types."""
        return asdict(self)

    def __str__(self) -> str:
        errors, lines = self.errors, [f"{self.strokes} strokes in {self.visits} visits"]
        at, base, unknown = f"{errors.at:.3g} m/s", LEVELS[BASE], "cannot be estimated from these strokes"
        for name, one, unit, scale, usual in (
            (f"direction, at {at}", errors.direction, "deg", 1.0, base.direction_deg(speed=errors.at)),
            ("speed", errors.speed, "%", 100.0, base.speed_rel),
        ):
            said = unknown
            if one is not None:
                value, low, high = (f"{scale * x:.3g}" for x in (one.value, one.low, one.high))
                often = f"{one.value / usual:.1f} times a professional's"
                said = f"{value} {unit} [{low}, {high}], {often}, {one.source}"
            lines.append(f"error of {name}: {said}")
        if (g := errors.growth) is not None:
            law = f"sqrt(1 + (g V)^2), g = {g.value:.3g} [{g.low:.3g}, {g.high:.3g}] s/m"
            lines.append(f"the error of direction grows with the cue speed V as {law}")
        elif errors.direction is not None:
            lines.append(f"the error of direction at other speeds {unknown}")
        if (one := self.expected) is not None:
            expected = f"{one.value:.0f} [{one.low:.0f}, {one.high:.0f}] expected with these errors"
            lines.append(f"pots: {self.made} of {self.called} made, {expected}")
        for name, one in self.costs.items():
            what, sign = ("gains", -1.0) if one.value < 0.0 else ("costs", 1.0)
            low, high = sorted((sign * one.low, sign * one.high))
            words = f"{abs(one.value):.2f} [{low:.2f}, {high:.2f}] points a visit, {one.source}"
            lines.append(f"{name} {what} {words}")
        if self.most is not None:
            lines.append(f"{self.most} costs most ({100 * self.sure:.0f} % sure)")
        drills = [f"practise {one.layout}: {one.reason}" for one in self.drills]
        if self.costs and not drills:
            drills = ["nothing to practise: no part costs more than at the target level"]
        return "\n".join([*lines, *drills])


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
        Where the strokes were played, as in ``advise``: "cue", "physics" and "table" if the strokes do not say them; in a
        frame also "miss" and "game".
    seed : int
        Seed of the simulated strokes, in [0, 2**63].

    Returns
    -------
    Coaching
        Each estimate has a ``value``, the ends ``low`` and ``high`` of its 95 % interval, and the number of ``strokes`` that it
        is based on; one that is not known is None.

        * ``errors``: the standard deviations outside lapses of the ``direction`` [deg], at the cue speed ``at`` [m/s], and of
          the ``speed``, as a share of it; the ``growth`` of the first with the speed [s/m], see ``Noise``.
        * ``strokes``, ``visits``; ``called``, ``made`` and ``expected``: the pots whose outcome is known, those that went in, and
          how many go in with these errors.
        * ``costs``: points lost in each visit against the target by "potting", "position" and "safety"; ``most``: which of
          them costs most, the more so the nearer ``sure``, a share of bootstrap samples, is to 1.
        * ``drills``, the costliest part first: each has the ``layout`` to play and the ``reason`` in one sentence.

        ValueError if an argument is invalid, no error can be estimated, or it is not known where the strokes were played.

    Examples
    --------
    >>> import snooker_env as sn
    >>> from snooker_env.advice import Recorded, coach
    >>> at, over = sn.Position(cue=(0.1, 0.2), black=(-0.3, 1.0)), sn.Position(over=True)
    >>> made = Recorded(position=at, ball=21, pocket=4, potted=True, points=7, after=over)
    >>> report = coach([made] * 3, options={"cue": "real", "physics": "match", "table": "match"})
    >>> report.made, sorted(report.costs), report.errors.speed
    (3, ['position', 'potting'], None)
    """
    kept = list(strokes)
    for k, one in enumerate(kept):
        if not isinstance(one, Recorded):
            raise refuse_what(f"strokes[{k}]", f"a {type(one).__name__}", "must be a Recorded")
    if not kept:
        raise refuse_what("strokes", "none", "must hold at least one stroke")
    options = agree_options(kept, options)
    if isinstance(target, str):
        choice("target", target, LEVELS)
    bench = practice_of(target, options, of_frames=True)
    physical = {name: getattr(bench.options, name) for name in ("physics", "table", "fidelity", "cue")}
    base = practice_of(BASE, physical)
    errors, posterior, called, kept = fit_errors(kept, base, seed)
    points, counts = count_costs(kept, bench, seed)
    visits = sum(not one.goes_on for one in kept) + kept[-1].goes_on  # the last may go on
    rng = np.random.default_rng((seed, RESAMPLES))
    drawn = points[rng.integers(0, len(kept), (RESAMPLES, len(kept)))].sum(axis=1) / visits
    ends, sums = np.quantile(drawn, (0.025, 0.975), axis=0), points.sum(axis=0) / visits
    parts: dict[str, Estimate] = {}
    for name, (value, low, high), many in zip(PARTS, np.vstack([sums, ends]).T.tolist(), counts, strict=True):
        if many:
            parts[name] = Estimate(value=value, low=low, high=high, strokes=int(many))
    ranked = sorted((name for name in parts if parts[name].value > 0.0), key=lambda name: -parts[name].value)
    most = ranked[0] if ranked else None
    largest = (drawn.argmax(axis=1) == PARTS.index(most)) & (drawn.max(axis=1) > 0.0) if most else np.zeros(1)
    return Coaching(
        errors=errors,
        strokes=len(kept),
        visits=visits,
        called=len(called.rows),
        made=int(called.made.sum()),
        expected=_expect(called, posterior, errors.at),
        target=target if isinstance(target, str) else asdict(bench.noise),
        costs=parts,
        most=most,
        sure=float(largest.mean()),
        drills=tuple(_choose_drill(name, kept, parts[name], points[:, PARTS.index(name)]) for name in ranked),
    )


def count_costs(strokes: list[Recorded], bench: Practice, seed: int) -> tuple[Floats, Ints]:
    """Points lost against the errors of ``bench``, (n, 3) by ``PARTS``; how many strokes tell each, (3,)."""
    parts, counts = np.zeros((len(strokes), 3)), np.zeros(3, np.int64)
    known = [k for k, one in enumerate(strokes) if one.after is not None]
    at = {k: one_position(strokes[k].position, strokes[k].scores) for k in known}
    worths = bench.worth([at[k] for k in known])
    left = value_strokes(bench, [strokes[k] for k in known])
    for k, worth, value in zip(known, worths, left, strict=True):
        one = strokes[k]
        if one.ball is None:
            parts[k, 2] = worth - value
            counts[2] += 1
            continue
        if one.potted is None or (best := play_best_pot(bench, at[k], one, seed)) is None:
            continue
        p, made, missed = best
        parts[k, 0] = (p - bool(one.potted)) * (made - missed)
        parts[k, 1 if one.potted else 2] = (made if one.potted else missed) - value
        counts += [1, bool(one.potted), not one.potted]
    return parts, counts


def value_strokes(bench: Practice, strokes: list[Recorded]) -> Floats:
    """What strokes were worth as they came (n,): points, and the worth of what they left."""
    out = np.array([float(one.points - one.penalty) for one in strokes])
    going = [k for k, one in enumerate(strokes) if one.after is not None and not one.after.over]
    after = []
    for one in (strokes[k] for k in going):
        scores = one.scores[0] + one.points, one.scores[1] + one.penalty
        scores = tuple(min(score, 1000) for score in (scores if one.goes_on else scores[::-1]))
        after.append(one_position(one.after, scores))
    signs = np.array([1.0 if strokes[k].goes_on else -1.0 for k in going])
    out[going] += signs * bench.worth(after)
    return out


def play_best_pot(
    bench: Practice, at: Positions, one: Recorded, seed: int
) -> tuple[float, float, float] | None:
    """The target's best stroke at the called pot: chance, worth if made and if missed; None if not direct."""
    judge, found = bench.judge, find_pot(at, one)
    if found is None:
        return None

    def at_the_pot(asking: Asking, at: Positions, m: int, seeds: Ints) -> Proposals:
        u = sobol_points(m, 2, seed)
        tips = np.column_stack([SLOW * (FAST / SLOW) ** u[:, 0], np.zeros(m), TIP * (2.0 * u[:, 1] - 1.0)])
        return strokes_at(at, np.full((1, m), found[0]), tips[None], asking.spread, asking.dynamics)

    (ranked,) = Search(judge, propose=at_the_pot).rank(at, [seed])
    best = ranked.strokes[ranked.kinds == 0][:1].values
    if not len(best):
        return None
    many = 1 if bench.sure else SAMPLES
    stops = bench.play(at, np.zeros(many, np.int64), np.repeat(best, many, 0), keys(seed, JUDGING, many))
    went = (stops.potted[:, one.ball] == one.pocket) & (stops.penalty == 0)
    if not went.any():
        return None
    worth = judge.value_of(np.repeat(lead_of(at), many), stops.afterstates)[:, 1]
    # where it is never missed: a miss would leave the balls about as they lie
    left = float(worth[~went].mean()) if not went.all() else -float(judge.worth(pass_after_miss(at))[0])
    return float(went.mean()), float(worth[went].mean()), left


def _expect(called: CalledPots, posterior: Floats | None, at: float) -> Estimate | None:
    """How many called pots are made: the mean over the errors' posterior, the normal interval of the count."""
    n = len(called.rows)
    if posterior is None or not n:
        return None
    mean = square = 0.0
    for chances, weights in zip(list_chances(called, at), posterior, strict=True):
        counts, spread = chances.sum(axis=0), (chances * (1.0 - chances)).sum(axis=0)
        mean, square = mean + float(counts @ weights), square + float((spread + counts**2) @ weights)
    half = 1.96 * sqrt(max(0.0, square - mean * mean))
    return Estimate(value=mean, low=max(0.0, mean - half), high=min(float(n), mean + half), strokes=n)


def find_pot(at: Position | Positions, one: Recorded) -> tuple[int, float] | None:
    """The row of the called pot among the direct ones, and its tolerance [rad]; None if it is not direct."""
    direct = pots(at, 16)
    which = np.flatnonzero((direct.ball[0] == one.ball) & (direct.pocket[0] == one.pocket))
    return (int(which[0]), float(direct.tolerance[0, which[0]])) if len(which) else None


def _choose_drill(part: str, strokes: list[Recorded], cost: Estimate, lost: Floats) -> Drill:
    """What to practise against a cost: pots as wide as those that cost most; the line-up, where the cue ball decides; escapes
    if most was lost when snookered, else safeties."""
    points = f"{cost.value:.1f} points a visit"
    if part == "position":
        return Drill(layout="line_up", reason=f"the positions left after pots cost {points}")
    if part == "safety":
        hidden = ~clear_paths([one.position for one in strokes])
        if lost[hidden].sum() > 0.5 * lost.sum():
            return Drill(layout="escape", reason=f"most of {points} lost in safety were lost when snookered")
        return Drill(layout="safety", reason=f"strokes that end the visit cost {points}")
    sums = dict.fromkeys(WORDS, 0.0)
    for one, own in zip(strokes, lost.tolist(), strict=True):
        if own and (found := find_pot(one.position, one)) is not None:
            wide = degrees(found[1])
            sums["easy" if wide > WIDE else "medium" if wide > NARROW else "hard"] += own
    worst = max(sums, key=lambda name: sums[name])
    where = f"at pots with a tolerance of {WORDS[worst]} degrees"
    return Drill(layout=f"pots:{worst}", reason=f"most of {points} lost by missed pots were lost {where}")
