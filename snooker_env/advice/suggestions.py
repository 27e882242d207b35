"""What does ``advise`` return? ``Advice``: strokes with their outcomes, each a ``Suggestion``."""

from collections.abc import Iterator
from dataclasses import asdict, dataclass, fields
from typing import Any

from .._lib.types import Place
from ..planning import Position
from ..players.cue_stroke import CueStroke
from ..replays.referee_words import errors_words
from .room import Room


@dataclass(frozen=True, kw_only=True)
class Suggestion(CueStroke):
    """A stroke, what it does when played as intended, and its outcomes under execution errors.

    Attributes
    ----------
    speed, aim, side, top, elevation, place
        As in ``CueStroke``.
    room : Room
        How the cue finds room for the stroke: a real cue may be raised and its tip moved.
    kind : {"pot", "contact", "safety", "escape", "in-off", "foul"}
        What the stroke does without errors. "pot": it scores. "contact": it hits a ball on fairly and scores nothing; in a
        frame, where this is judged, "safety"; "escape" if no straight path leads to a ball on. "in-off": it loses the cue
        ball. "foul": any other foul.
    ball, pocket, first : int
        Id of the ball that the stroke pots without errors (if none, of the ball that it strikes first or plays away from);
        the pocket, an index into ``snooker_env.POCKETS``; id of the ball that it strikes first. -1 if none.
    chance, chance_interval : float, (float, float)
        Of a pot, the share of samples in which that ball went into that pocket without a foul; of another stroke, the share
        without a foul. Wilson's 95 % interval of the chance; without noise, the chance itself twice.
    points, points_interval : float, (float, float)
        Expected points of the visit from this stroke on, continued by a fast search, with the 95 % interval of the
        sampling error.
    foul, in_off : float
        Shares of the samples with a foul, and with the cue ball potted.
    stops, spread : (float, float), float or None
        Mean stopping point of the cue ball [m] in the samples in which it stayed on the table, and the root mean square
        distance from that point [m]; None if it never stayed.
    win, win_interval, against, replies, leaves, snookers : float, (float, float), float, float, float, float or None
        Only of a frame (docs/play/advice.md). ``win``: the chance to win, with the 95 % interval of the sampling error.
        ``against``: of the first stroke, the chance to win of the best stroke of the other kind. ``replies``, ``leaves``,
        ``snookers``: how often the opponent pots next, their mean points, and how often they are snookered; None if the
        opponent never comes to the table.
    words : str
        All of this in one line of text.

    Examples
    --------
    >>> import snooker_env as sn
    >>> position = sn.Position(cue=(0.3, 1.1), black=(0.0, 1.4605))
    >>> suggestion = sn.advise(position, agent="search", noise="none", n=1)[0]
    >>> suggestion.kind, suggestion.chance
    ('pot', 1.0)
    >>> print(suggestion)  # doctest: +ELLIPSIS
    black, top left, ... m/s, ..., pot 100 %, 7 points expected
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


@dataclass(frozen=True, kw_only=True)
class Advice:
    """The strokes that an agent would play in a position, best first; a sequence of ``Suggestion``.

    Attributes
    ----------
    suggestions : tuple of Suggestion
        The strokes.
    position : Position
        The position.
    scores : (int, int) or None
        In a frame, the scores of the striker and of the opponent.
    agent : str
        Name of the agent.
    own : bool
        Whether the strokes are the agent's own; False if none of those is fair, so that others were judged, too.
    noise : str or dict
        Execution errors: the name of a level, or the fields of ``Noise``.
    samples, visits, seed : int
        As in ``advise``.

    Examples
    --------
    >>> import snooker_env as sn
    >>> position = sn.Position(cue=(0.3, 1.1), black=(0.0, 1.4605))
    >>> advice = sn.advise(position, agent="search", noise="none", n=1)
    >>> len(advice), advice.agent
    (1, 'search')
    >>> print(advice)  # doctest: +ELLIPSIS
    Pots by points expected, without errors:
    1. black, top left, ... m/s, ..., pot 100 %, 7 points expected
    """

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
        names = ("agent", "own", "order", "noise", "samples", "visits", "seed")
        kept = {"position": self.position.to_dict(), **{name: getattr(self, name) for name in names}}
        kept["scores"] = self.scores and list(self.scores)
        return {**kept, "suggestions": [one.to_dict() for one in self]}

    def __str__(self) -> str:
        return "\n".join([self.order, *(f"{k}. {one.words}" for k, one in enumerate(self, 1))])
