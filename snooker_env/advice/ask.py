"""What would a player do here, and how would it turn out? ``advise``."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from .._lib.check import integer, refuse
from ..planning import Position
from ..planning.positions import Positions, PositionsLike
from ..players import Player
from ..players import player as player_of
from ..players.cue_stroke import cue_strokes
from ..replays.referee_words import errors_words
from ..tasks.noise import NoiseLike
from .intentions import FOULS, Intention, drop_alike, intend
from .outcomes import Suggestion, Trials, judge_strokes
from .practice import Practice, one_position, practice_of
from .stroke_words import percent

AGENT, OF_FRAMES = "planner_500", "tactician_1000"
"""Who is asked if nobody is named: in a visit, and in a frame."""
INSTEAD = "random"  # whose strokes are judged where none of an agent's is fair: many discrete choices
RIVALS = 4  # strokes of the other kind, pots or not, that the best of a frame is compared with
SELDOM = 0.05  # chance of a pot below which it is no suggestion
ALIKE = 0.005  # strokes whose chances to win differ by no more are as good,
FEW = 0.05  # or, where the chance is small, by no more than this share of it
FAR = 1.25  # how many times as often a pot must win that takes a ball to lay snookers on
CONSIDERED = 20  # ranked strokes that are examined for each stroke requested, so that enough of them differ
WAYS = 3  # ways of playing the same stroke that are judged: the best one is kept
FEWEST = 40  # strokes that are examined at least


@dataclass(frozen=True, kw_only=True)
class Advice:
    """A sequence of ``Suggestion``; ``advise`` describes the fields."""

    suggestions: tuple[Suggestion, ...]
    position: Position
    scores: tuple[int, int] | None
    agent: str
    own: bool
    noise: str | dict[str, float]
    samples: int
    visits: int
    seed: int

    def __len__(self) -> int:
        return len(self.suggestions)

    def __iter__(self) -> Iterator[Suggestion]:
        return iter(self.suggestions)

    def __getitem__(self, index: int) -> Suggestion:
        return self.suggestions[index]

    @property
    def order(self) -> str:
        """In words, what orders the strokes, with whose errors, and whether they are not the agent's own."""
        whose = "" if self.own else f"{self.agent} has no fair stroke here; these strokes are not its own. "
        errors = errors_words(self.noise)
        if self.scores is not None:
            return f"{whose}By chance to win, {errors}:"
        by = {True: "pots by points expected", False: "strokes without a pot by how often they are fair"}
        parts = ", then ".join(by[pot] for pot in dict.fromkeys(one.kind == "pot" for one in self))
        return f"{whose}{parts.capitalize()}, {errors}:"

    def to_dict(self) -> dict[str, Any]:
        """Return all attributes by name as JSON types; the position and the suggestions as dicts."""
        kept = {"position": self.position.to_dict(), "scores": self.scores and list(self.scores)}
        return vars(self) | kept | {"order": self.order, "suggestions": [one.to_dict() for one in self]}

    def __str__(self) -> str:
        return "\n".join([self.order, *(f"{k}. {one.words}" for k, one in enumerate(self, 1))])


def advise(
    position: PositionsLike,
    *,
    agent: Any = None,
    scores: tuple[int, int] | None = None,
    noise: NoiseLike = "professional",
    n: int = 5,
    samples: int = 2000,
    visits: int = 40,
    seed: int = 0,
    options: Any = None,
) -> Advice:
    """Return the strokes that a player would play in a position, best first, and their outcomes.

    docs/play/advice.md explains how strokes are judged and ordered. Their errors come from ``seed`` alone, not from the
    random stream of a saved state, so advice never reveals the errors of the next stroke.

    Parameters
    ----------
    position : Position, dict, Positions or environment
        One position, as ``Positions.of`` takes it, or a ``Position.to_dict()``. With the cue ball in hand each stroke has
        its ``place``. Points of the break so far do not count.
    agent : str, Path or player, optional
        The player, as ``snooker_env.player`` takes it; in a frame one that knows frames ("tactician", "stroke_value", your
        own). A player without ``rank`` has one stroke. Default None: "planner_500", in a frame "tactician_1000".
    scores : (int, int), optional
        Scores of the striker and of the opponent, in [0, 1000], which turn a position of a visit into one of a frame.
    noise : str, dict or Noise
        Execution errors with which strokes are chosen and judged.
    n : int
        Largest number of strokes, in [1, 100].
    samples : int
        Number of simulations of each stroke, in [1, 100000]; without noise there is one.
    visits : int
        How many visits are continued after each stroke, in [0, 100000]; with 0, ``points`` are those of the stroke alone.
    seed : int
        Seed of the execution errors, in [0, 2**63].
    options : dict or Options, optional
        An ``Options``, or a dict with "physics", "table", "fidelity", "cue" and, in a frame, "miss" and "game". Default None:
        those of ``position`` if it is an environment, else the defaults.

    Returns
    -------
    Advice
        A sequence of ``Suggestion``, in words with ``str``. Its ``order`` says in words what orders them. ``own``: whether the
        strokes are the agent's own; False if none of those is fair, so that others were judged, too. Its other fields are the
        arguments, ``agent`` as a name. ValueError if an argument is invalid or there is no stroke to play.

    Examples
    --------
    >>> import snooker_env as sn
    >>> position = sn.Position(cue=(0.3, 1.1), black=(0.0, 1.4605))
    >>> advice = sn.advise(position, agent="search", noise="none", n=1)
    >>> advice[0].ball, sn.POCKETS[advice[0].pocket]
    (21, 'top left')
    >>> print(advice)  # doctest: +ELLIPSIS
    Pots by points expected, without errors:
    1. black, top left, ... m/s, ..., pot 100 %, 7 points expected
    """
    integer("n", n, 1, 100)
    trials = Trials(
        integer("samples", samples, 1, 100_000),
        integer("visits", visits, 0, 100_000),
        integer("seed", seed, 0, 2**63),
    )
    at = one_position(position, scores)
    practice = practice_of(noise, options, position, of_frames=at.of_frames)
    name, asked = name_player(agent, at)
    chosen, own = choose_strokes(practice, asked, at, n, trials)
    return Advice(
        suggestions=tuple(chosen),
        position=at[0],
        scores=tuple(at.scores[0].tolist()) if at.of_frames else None,
        agent=name,
        own=own,
        noise=noise if isinstance(noise, str) else asdict(practice.noise),
        **trials._asdict(),
    )


def choose_strokes(
    practice: Practice, asked: Player, at: Positions, n: int, trials: Trials, rivals: int = RIVALS
) -> tuple[list[Suggestion], bool]:
    """The player's strokes, best first, the first of a frame compared with so many ``rivals``; whether all are its own."""
    strokes = _ask(asked, practice, at, n, trials.seed)
    chosen, of_agent = _choose_fair(practice, strokes, n, trials, rivals), {one.stroke for one in strokes}
    if not chosen:
        strokes += _ask(player_of(INSTEAD), practice, at, n, trials.seed)
        fair = _choose_fair(practice, strokes, n, trials, rivals)
        chosen = fair or [_choose_least_bad(practice, strokes, trials)]
    return chosen, all(one.stroke in of_agent for one in chosen)


def name_player(agent: object, at: Positions) -> tuple[str, Player]:
    """The player and its name; ValueError for one that knows visits alone in a frame."""
    agent = (OF_FRAMES if at.of_frames else AGENT) if agent is None else agent
    asked = player_of(agent)
    name = str(agent) if isinstance(agent, str | Path) else getattr(asked, "name", "") or type(asked).__name__
    if at.of_frames and not getattr(asked, "frames", True):
        allowed = f'must know frames, as "{OF_FRAMES}" or "stroke_value" do: this player only knows visits'
        raise refuse("agent", name, allowed)
    return name, asked


def _ask(player: Player, practice: Practice, at: Positions, n: int, seed: int) -> list[Intention]:
    """The strokes that a player would play, the first of those that are alike."""
    bound = player.at(practice.options)
    rank = getattr(bound, "rank", None)
    played = bound.play(at, [seed]) if rank is None else rank(at, [seed])[0].strokes
    return drop_alike(intend(practice, at, cue_strokes(played, at)[: max(FEWEST, CONSIDERED * n)]))


def _choose_fair(
    practice: Practice, strokes: list[Intention], n: int, trials: Trials, rivals: int
) -> list[Suggestion]:
    """The first n ideas that are fair without errors and in most samples, best first; no pot that hardly ever goes."""
    fair = [one for one in strokes if one.kind not in FOULS]
    out, waiting = _judge_fair(practice, [one for one in fair if not one.spends], n, trials)
    if practice.options.task != "frame":
        return sorted(out, key=lambda one: ((one.kind == "pot") != (out[0].kind == "pot"), -one.figure))[:n]
    spent, rest = _judge_fair(practice, [one for one in fair if one.spends], n, trials)
    out = _lay_first(_sort_by_win(out), _sort_by_win(spent))
    if not (out and rivals):
        return out[:n]
    others = [one for one in waiting + rest if (one.kind == "pot") != (out[0].kind == "pot")][:rivals]
    judged = judge_strokes(practice, others, trials._replace(visits=0)) if others else []
    return [_compare(out, [one for one in out[1:] + judged if _is_sensible(one)]), *out[1:n]]


def _judge_fair(
    practice: Practice, fair: list[Intention], n: int, trials: Trials
) -> tuple[list[Suggestion], list[Intention]]:
    """The best way of each of n ideas that is fair in most samples, and the strokes that were not judged."""
    # the chance to win tells ways apart by what they leave; points need the visits that follow
    first = trials._replace(visits=0) if practice.options.task == "frame" else trials
    ways: Counter[object] = Counter()
    waiting, best = [], dict[object, tuple[Suggestion, Intention]]()
    for one in fair:
        ways[one.idea] += 1
        if ways[one.idea] <= WAYS:
            waiting.append(one)
    some = n + (WAYS - 1) * (n - 1)
    while waiting and len(best) < n:
        for one, judged in zip(waiting, judge_strokes(practice, waiting[:some], first), strict=False):
            known = best.get(one.idea)
            if _is_sensible(judged) and (known is None or judged.figure > known[0].figure):
                best[one.idea] = judged, one
        waiting, some = waiting[some:], n - len(best)
    if first == trials or not best:
        return [judged for judged, _ in best.values()], waiting
    return judge_strokes(practice, [one for _, one in best.values()], trials), waiting


def _lay_first(others: list[Suggestion], spent: list[Suggestion]) -> list[Suggestion]:
    """Strokes, best first: pots ``spent`` on a ball needed for a snooker stand last, unless they win far more often."""
    far = bool(others and spent) and spent[0].figure > FAR * others[0].figure
    return spent + others if far else others + spent


def _is_sensible(one: Suggestion) -> bool:
    return one.foul <= 0.5 and (one.kind != "pot" or one.chance >= SELDOM)


def _sort_by_win(strokes: list[Suggestion]) -> list[Suggestion]:
    """Strokes of a frame, best first; of those that win as often as the best of them, the one with the most points first."""

    def net_points(one: Suggestion) -> float:
        """Expected points of the visit, less those left to the other."""
        return one.points - (1.0 - one.chance if one.kind == "pot" else 1.0) * (one.leaves or 0.0)

    waiting, out = sorted(strokes, key=lambda one: -one.figure), []
    while waiting:
        best = waiting[0].figure
        alike = [one for one in waiting if one.figure >= best - min(ALIKE, FEW * best)]
        out += sorted(alike, key=net_points, reverse=True)
        waiting = waiting[len(alike) :]
    return out


def _compare(best: list[Suggestion], others: list[Suggestion]) -> Suggestion:
    """The best stroke of a frame, compared with the best of the other kind, a pot or none, or the next best."""
    one = best[0]
    rivals = [other for other in others if (other.kind == "pot") != (one.kind == "pot")]
    if not (rivals or best[1:]):
        return one
    rival = max(rivals or best[1:], key=lambda other: other.figure)
    which = f"best {rival.kind}" if rivals else "next best"
    words = f"{one.words} against {percent(rival.figure)} for the {which}"
    return replace(one, against=rival.win, words=words)


def _choose_least_bad(practice: Practice, strokes: list[Intention], trials: Trials) -> Suggestion:
    """Where no stroke is sensible, the one that is fair, in a frame wins, most often; a hopeless pot only if all are."""
    judged = judge_strokes(practice, strokes, trials)
    worst = [one.foul if one.win is None else -one.win for one in judged]
    seldom = [one.kind == "pot" and one.chance < SELDOM for one in judged]
    best = judged[min(range(len(judged)), key=lambda k: (seldom[k], worst[k]))]
    return replace(best, words=f"no fair stroke found: {best.words}")
