"""How do strokes turn out under execution errors? Chances, points, and in frames the chance to win, on common errors.

The visits that strokes leave, the player's or the other's, are played on by a fast search, with errors, many at once."""

from dataclasses import asdict, dataclass, fields
from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from .._lib.check import integer
from .._lib.types import Bools, Floats, Ints, Place
from ..game.balls import CUE
from ..planning import Outcomes, Positions, clear_paths
from ..planning.positions import PositionsLike
from ..planning.worth import lead_of
from ..players.cue_stroke import CueStroke, StrokeLike
from ..tasks.noise import NoiseLike
from . import stroke_words as say
from .intentions import Intention
from .practice import (
    GOING_ON,
    JUDGING,
    Practice,
    Room,
    arrive,
    find_arrivals,
    join,
    keys,
    one_position,
    practice_of,
    start_from,
)

Z = 1.959964  # standard deviations of a 95 % interval
OFTEN = 0.05  # share of misses from which is said what a missed pot leaves


@dataclass(frozen=True, kw_only=True)
class Suggestion(CueStroke):
    """A stroke, what it does when played as intended, and its outcomes under execution errors.

    Attributes
    ----------
    speed, aim, side, top, elevation, place
        As in ``CueStroke``.
    room : Room
        How the cue finds room over rails and balls: ``elevation`` [rad], ``side`` and ``top`` as they are then played; whether
        the cue is ``raised``, its tip ``moved``, because a cue of 45 degrees does not reach it, or the stroke ``unplayable``;
        what it is ``over`` ("rail" or a ball), so far ``behind`` the cue ball's centre [m]; and ``words``.
    kind : {"pot", "contact", "safety", "escape", "in-off", "foul"}
        What the stroke does without errors. "pot": it scores. "contact": it hits a ball on fairly and scores nothing; in a
        frame "safety"; "escape" if no straight path leads to a ball on. "in-off": it loses the cue ball; "foul": any other.
    ball, pocket, first : int
        Id of the ball that the stroke pots without errors (if none, of the ball that it strikes first or plays away from);
        the pocket, an index into ``snooker_env.POCKETS``; id of the ball that it strikes first. -1 if none.
    chance, chance_interval : float, (float, float)
        Of a pot, the share of samples in which that ball went into that pocket without a foul; of another stroke, the share
        without a foul. Wilson's 95 % interval of the chance; without noise, the chance itself twice.
    points, points_interval : float, (float, float)
        Expected points of the visit from this stroke on, continued by a fast search, with the 95 % interval.
    foul, in_off : float
        Shares of the samples with a foul, and with the cue ball potted.
    stops, spread : (float, float), float or None
        Mean stopping point of the cue ball [m] in the samples in which it stayed on the table, and the root mean square
        distance from that point [m]; None if it never stayed.
    win, win_interval, against, replies, leaves, snookers : float, (float, float), float, float, float, float or None
        Only of a frame: the chance to win with its 95 % interval; that of the first stroke's rival; how often the opponent
        pots next, their mean points, and how often they are snookered. None if not known.
    words : str
        All of this in one line of text.

    Examples
    --------
    >>> import snooker_env as sn
    >>> position = sn.Position(cue=(0.3, 1.1), black=(0.0, 1.4605))
    >>> suggestion = sn.advise(position, agent="search", noise="none", n=1)[0]
    >>> suggestion.kind, suggestion.chance
    ('pot', 1.0)
    """

    room: Room
    kind: str
    ball: int
    pocket: int
    first: int
    chance: float
    chance_interval: tuple[float, float]
    points: float
    points_interval: tuple[float, float]
    foul: float
    in_off: float
    stops: Place | None
    spread: float | None
    words: str
    win: float | None = None
    win_interval: tuple[float, float] | None = None
    against: float | None = None
    replies: float | None = None
    leaves: float | None = None
    snookers: float | None = None

    @property
    def figure(self) -> float:
        """The figure that orders strokes: in a frame the chance to win, else the points of a pot, or the share without a foul."""
        return self.win if self.win is not None else self.points if self.kind == "pot" else self.chance

    @property
    def stroke(self) -> CueStroke:
        """The stroke alone, a ``CueStroke``."""
        return CueStroke.of({field.name: getattr(self, field.name) for field in fields(CueStroke)})

    def to_dict(self) -> dict[str, Any]:
        """Return all attributes by name as JSON types; pairs as lists."""
        kept = {name: list(x) if isinstance(x, tuple) else x for name, x in asdict(self).items()}
        return kept | {"room": self.room.to_dict()}

    def __str__(self) -> str:
        return self.words


class Trials(NamedTuple):
    samples: int
    visits: int
    seed: int


def judge_strokes(practice: Practice, strokes: list[Intention], trials: Trials) -> list[Suggestion]:
    """Strokes with their outcomes under execution errors, in their order."""
    n, sure = len(strokes), practice.sure
    tries = 1 if sure else trials.samples
    trials = trials._replace(visits=min(1, trials.visits) if sure else trials.visits)
    rows, starts = [one.stroke.numbers() for one in strokes], join([one.start for one in strokes])
    each, noise = np.repeat(np.arange(n), tries), np.tile(keys(trials.seed, JUDGING, tries), n)
    stops = practice.play(starts, each, np.repeat(rows, tries, 0), noise)
    groups = [k * tries + np.flatnonzero(stops.goes_on[k * tries : (k + 1) * tries]) for k in range(n)]
    rests = _play_on_groups(practice, stops.afterstates, groups, trials)
    looks = _look_ahead(practice, starts, each, stops, trials, n) if starts.of_frames else [{}] * n
    out = []
    for k, (one, rest, look) in enumerate(zip(strokes, rests, looks, strict=True)):
        mine = slice(k * tries, (k + 1) * tries)
        no_foul = stops.penalty[mine] == 0
        made = no_foul & (stops.potted[mine, one.ball] == one.pocket) if one.kind == "pot" else no_foul
        chance, stayed = float(made.mean()), stops.potted[mine, CUE] < 0
        points, interval = expect_points(stops.points[mine], stops.goes_on[mine], rest)
        middle, spread = None, None
        if len(places := stops.places[mine, CUE][stayed]):
            x, y = places.mean(axis=0).tolist()
            middle, spread = (x, y), float(np.sqrt(((places - (x, y)) ** 2).sum(axis=1).mean()))
        foul = float((~no_foul).mean())
        figures = say.figures_words(one.kind, chance, points, foul if look else None)
        out.append(
            Suggestion(
                **vars(one.stroke),
                **{name: getattr(one, name) for name in ("room", "kind", "ball", "pocket", "first")},
                **look,
                chance=chance,
                chance_interval=(chance, chance) if sure else wilson(int(made.sum()), tries),
                points=points,
                points_interval=interval,
                foul=foul,
                in_off=float((~stayed).mean()),
                stops=middle,
                spread=spread,
                words=f"{one.words}, {figures}{_say_why(one.kind, chance, look) if look else ''}",
            )
        )
    return out


def _look_ahead(
    practice: Practice, starts: Positions, each: Ints, stops: Outcomes, trials: Trials, n: int
) -> list[dict[str, Any]]:
    """What n strokes of a frame lead to, ``each`` (n * tries,) says which: fields of ``Suggestion``."""
    after = stops.afterstates
    wins = practice.judge.value_of(lead_of(starts)[each], after)[:, 0].reshape(n, -1)
    comes = np.flatnonzero(find_arrivals(after))
    theirs = arrive(after[comes])
    hidden = ~clear_paths(theirs)
    groups = [np.flatnonzero(each[comes] == k) for k in range(n)]
    rests, out = _play_on_groups(practice, theirs, groups, trials), []
    for mine, group, rest in zip(wins, groups, rests, strict=True):
        half = Z * sqrt(float(mine.var(ddof=1)) / len(mine)) if len(mine) > 1 else 0.0
        win = float(mine.mean())
        look = {"win": win, "win_interval": (max(0.0, win - half), min(1.0, win + half))}
        look["replies"] = float((rest > 0.0).mean()) if len(rest) else None
        look["leaves"] = float(rest.mean()) if len(rest) else None
        look["snookers"] = float(hidden[group].mean()) if len(group) else None
        out.append(look)
    return out


def _play_on_groups(practice: Practice, left: Positions, groups: list[Ints], trials: Trials) -> list[Floats]:
    """For each group of rows of ``left``: the points of the visits from its first ``trials.visits`` rows."""
    rows = [group[: trials.visits] for group in groups]
    numbers = np.concatenate([np.arange(len(some)) for some in rows]).astype(np.int64)
    rest = play_on(practice, left[np.concatenate(rows).astype(np.int64)].as_visits(), numbers, trials.seed)
    return np.split(rest, np.cumsum([len(some) for some in rows])[:-1])


def play_on(practice: Practice, left: Positions, visits: Ints, seed: int) -> Floats:
    """Points (n,) of the rest of n visits from ``left``; equal numbers ``visits`` (n,) meet equal errors."""
    total, going, number = np.zeros(len(left)), np.arange(len(left)), 0
    most = int(visits.max()) + 1 if len(visits) else 0
    while len(going):
        ranked = practice.quick.rank(left, visits[going])
        strokes = np.array([one.strokes.values[0] for one in ranked])
        samples = keys(seed, GOING_ON, most, number)[visits[going]]
        stops = practice.play(left, np.arange(len(left)), strokes, samples)
        total[going] += stops.points
        left, going, number = stops.afterstates[stops.goes_on], going[stops.goes_on], number + 1
    return total


def wilson(made: int, tries: int) -> tuple[float, float]:
    """The 95 % interval of a probability with ``made`` successes in ``tries`` samples (Wilson 1927)."""
    share, z2 = made / tries, Z * Z / tries
    middle = (share + 0.5 * z2) / (1.0 + z2)
    half = Z * sqrt(share * (1.0 - share) / tries + 0.25 * z2 / tries) / (1.0 + z2)
    return max(0.0, min(share, middle - half)), min(1.0, max(share, middle + half))


def expect_points(points: Floats, goes_on: Bools, rest: Floats) -> tuple[float, tuple[float, float]]:
    """Mean points of a visit and its 95 % interval: first strokes (samples,), and the ``rest`` (visits,)."""
    n, follows = len(points), float(rest.mean()) if len(rest) else 0.0
    share, each = float(goes_on.mean()), points + goes_on * follows
    mean = float(each.mean())
    # delta method: the samples' part, then that of the rest
    variance = float(each.var(ddof=1)) / n if n > 1 else 0.0
    variance += share * share * float(rest.var(ddof=1)) / len(rest) if len(rest) > 1 else 0.0
    half = Z * sqrt(variance)
    return mean, (max(0.0, mean - half), mean + half)


def _say_why(kind: str, chance: float, look: dict[str, Any]) -> str:
    seldom = kind == "pot" and 1.0 - chance < OFTEN
    reply = "" if seldom else say.reply_words(kind, look["replies"], look["leaves"], look["snookers"])
    return f"{reply and f', {reply}'}; win chance {say.percent(look['win'])}"


class Destinations(NamedTuple):
    """The fields are described by ``destinations``."""

    samples: int
    cue: Floats
    ball: Floats
    potted: float
    in_off: float
    foul: float
    scored: float
    points: float


def destinations(
    position: PositionsLike,
    stroke: StrokeLike,
    *,
    noise: NoiseLike = "professional",
    samples: int = 500,
    seed: int = 0,
    options: object = None,
) -> Destinations:
    """Simulate a stroke with execution errors: where the balls stop, and how often it pots and fouls.

    Parameters
    ----------
    position, stroke, noise
        As in ``advise``; the intended stroke is a ``CueStroke``, a ``Suggestion`` or a dict with fields of ``CueStroke``.
    samples : int
        Number of simulations, in [1, 1000000]; without noise there is one.
    seed : int
        Seed of the execution errors, in [0, 2**63]. With one seed all strokes meet the same errors, so the places change
        smoothly with the stroke.
    options
        As in ``advise``.

    Returns
    -------
    Destinations
        ``samples``, how often the stroke was played; ``cue`` and ``ball``, float64 (m, 2), where the cue ball and the ball
        that the stroke hits first without errors stopped [m] in the samples in which they stayed on the table, before
        respotting; the shares ``potted`` (that ball), ``in_off``, ``foul`` and ``scored``; the mean ``points``. ValueError
        if an argument is invalid, or there is no stroke to play.

    Examples
    --------
    >>> import snooker_env as sn
    >>> from snooker_env.advice import destinations
    >>> position = sn.Position(cue=(0.0, 0.9), black=(0.4, 1.3))
    >>> destinations(position, {"speed": 1.8, "aim": 0.8}, noise="none").cue.shape
    (1, 2)
    """
    integer("samples", samples, 1, 1_000_000)
    integer("seed", seed, 0, 2**63)
    practice, struck = practice_of(noise, options, position), CueStroke.of(stroke)
    start, row = start_from(one_position(position).as_visits(), struck), struck.numbers()[None]
    tries = 1 if practice.sure else samples
    rows = np.zeros(tries, np.int64)
    ball = int(practice.play(start, rows[:1], row).first[0])
    stops = practice.play(start, rows, np.repeat(row, tries, 0), keys(seed, JUDGING, tries))
    stayed = stops.potted[:, CUE] < 0
    here = stops.potted[:, ball] < 0 if ball > 0 else np.zeros(tries, np.bool_)
    return Destinations(
        samples=tries,
        cue=stops.places[stayed, CUE],
        ball=stops.places[here, max(0, ball)],
        potted=float(1.0 - here.mean()) if ball > 0 else 0.0,
        in_off=float(1.0 - stayed.mean()),
        foul=float((stops.penalty > 0).mean()),
        scored=float((stops.points > 0).mean()),
        points=float(stops.points.mean()),
    )
