"""What does advice hold? ``Suggestion``, one stroke with what it leads to, and ``Advice``, a sequence of them, as data and in words."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any, overload

from .._types import Place
from ..planning import Position
from .strokes import CueStroke


@dataclass(frozen=True, kw_only=True)
class Suggestion(CueStroke):
    """A stroke, what it does when it comes out as intended, and what comes of it under errors of execution.

    Attributes
    ----------
    speed, aim, side, top, elevation, place
        The stroke, see ``CueStroke``.
    kind : {"pot", "safety", "escape", "in-off", "foul"}
        What the stroke does without errors: it scores; it hits a ball on fairly and scores nothing, an "escape" where no straight path
        leads to a ball on; it loses the cue ball; or it is another foul.
    ball : int
        The ball that it pots without errors or, if none, the ball that it strikes first; -1 if it strikes nothing.
    pocket : int
        Where that ball goes, an index of ``snooker_env.POCKETS``; -1 if it is not potted.
    first : int
        The ball that it strikes first without errors, -1 if none.
    chance : float
        Of a pot: the share of the samples in which that ball went into that pocket without a foul. Else: without a foul.
    chance_interval : (float, float)
        The 95 % interval of the chance, after Wilson; without noise the chance itself.
    points : float
        Points expected of the visit from this stroke on, played on by the quick player of ``advice.visits``.
    points_interval : (float, float)
        The 95 % interval of that mean: the errors of the samples and of the visits; not what a better player would make of it.
    foul : float
        Share of the samples in which the stroke was a foul.
    in_off : float
        Share of the samples in which the cue ball was potted.
    stops : (float, float) or None
        Where the cue ball stops: the mean over the samples in which it stayed on the table [m]; None if there are none.
    spread : float or None
        Root of the mean square of its distance from there [m].
    score : float or None
        What the agent itself says of the stroke, in its own measure: the built-in lookahead points, a policy a probability.
    words : str
        All this in a line.
    """

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
    score: float | None
    words: str

    @property
    def stroke(self) -> CueStroke:
        """The stroke alone."""
        return CueStroke.of({name: getattr(self, name) for name in ("speed", "aim", "side", "top", "elevation", "place")})

    def to_dict(self) -> dict[str, Any]:
        """The suggestion as JSON types.

        Returns
        -------
        dict
            All attributes by name; pairs as lists.
        """
        return {name: list(value) if isinstance(value, tuple) else value for name, value in asdict(self).items()}

    def __str__(self) -> str:
        return self.words


@dataclass(frozen=True, kw_only=True)
class Advice(Sequence[Suggestion]):
    """What an agent would play at a position: its strokes in its own order, best first; a sequence of ``Suggestion``.

    Attributes
    ----------
    suggestions : tuple of Suggestion
    position : Position
        What was asked about.
    agent : str
        Who was asked.
    noise : str or dict
        Under which errors of execution.
    samples, visits, seed : int
        How the figures were found, see ``advise``.
    """

    suggestions: tuple[Suggestion, ...]
    position: Position
    agent: str
    noise: str | dict[str, float]
    samples: int
    visits: int
    seed: int

    def __len__(self) -> int:
        return len(self.suggestions)

    @overload
    def __getitem__(self, index: int) -> Suggestion: ...

    @overload
    def __getitem__(self, index: slice) -> tuple[Suggestion, ...]: ...

    def __getitem__(self, index: int | slice) -> Suggestion | tuple[Suggestion, ...]:
        return self.suggestions[index]

    def __iter__(self) -> Iterator[Suggestion]:
        return iter(self.suggestions)

    def to_dict(self) -> dict[str, Any]:
        """The advice as JSON types.

        Returns
        -------
        dict
        """
        kept = {"agent": self.agent, "noise": self.noise, "samples": self.samples, "visits": self.visits, "seed": self.seed}
        return {"position": self.position.to_dict(), **kept, "suggestions": [one.to_dict() for one in self]}

    def __str__(self) -> str:
        return "\n".join(f"{k}. {one.words}" for k, one in enumerate(self, 1))
