"""Which agent is judged? A player for each training seed, and what is declared of it."""

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias

from .._lib.check import integer, number, refuse
from ..players import Player
from ..players import player as player_named
from ..players.degenerate import is_degenerate
from ..players.program import ProgramPlayer
from ..players.resolver import PROGRAM, is_name
from ..players.saved_models import LEFT_OUT, check_model_options
from ..players.seen import SeenPlayer
from ..players.weights import levels
from .schema import LABEL
from .tasks import Task

Source: TypeAlias = str | Player | object
"""What ``sn.player`` makes a player of: a text, a player, or a model of Stable-Baselines3."""


@dataclass(frozen=True, kw_only=True)
class Agent:
    """An agent to judge; ``Agent.of`` makes one from a text or a player.

    Attributes
    ----------
    label, sources : str, tuple of str or player
        The name in tables: 1 to 20 letters, digits or . + - _; for each training seed, an argument that
        ``sn.player`` accepts.
    options, trust : dict, bool
        As for ``sn.player``: how to read the actions of models of Stable-Baselines3; whether pickled code in
        models may run.
    timeout : float
        The longest time that a program may take for one stroke [s].
    training_shots, shots_declared : int, optional
        Shots simulated in training, None if unknown; shots simulated for a decision if this process cannot
        count them, None to declare nothing.

    Examples
    --------
    >>> from snooker_env.benchmark import Agent
    >>> agent = Agent.of("random")
    >>> agent.label, agent.sources, agent.training_shots
    ('random', ('random',), 0)
    """

    label: str
    sources: tuple[Source, ...]
    options: dict[str, Any] = field(default_factory=dict)
    trust: bool = False
    timeout: float = 60.0
    training_shots: int | None = None
    shots_declared: int | None = None

    @classmethod
    def of(
        cls, agent: Source | Path, *, label: str | None = None, training_shots: int | None = None, **more: Any
    ) -> "Agent":
        """Make an agent from an argument of ``sn.player``, or from LABEL=SOURCE,SOURCE,... (one for each training seed).

        A label or number of training shots that is None follows from the name or class. ``**more``: other
        attributes. No code of a class or file runs. ValueError if nothing has that name."""
        agent = str(agent) if isinstance(agent, Path) else agent
        sources: list[Source] = [agent]
        if isinstance(agent, str) and not agent.startswith(PROGRAM) and not Path(agent).exists():
            name, equals, text = agent.rpartition("=")
            label, sources = label or name if equals else label, [*text.split(",")]
        if len(sources) > 1 and len(set(sources)) < len(sources):
            raise refuse("agent", agent, "must be different players or models, one for each training seed")
        for source in sources:
            if isinstance(source, str) and not is_name(source) and not (source and Path(source).exists()):
                player_named(source)  # says what is allowed
            if len(sources) > 1 and str(source).startswith(PROGRAM):
                raise refuse("agent", agent, "must be one program")
        label = label or _label(sources[0])
        if not LABEL.fullmatch(label):
            raise refuse("label", label, "must be 1 to 20 letters, digits or . + - _: give --label")
        made = cls(label=label, sources=tuple(sources), training_shots=training_shots, **more)
        if claims_player_name(label, made.texts):
            raise refuse("label", label, "must not be the name of another player: give --label")
        for name, shots in (("training_shots", training_shots), ("simulated_shots", made.shots_declared)):
            if shots is not None:
                integer(name, shots, 0, 2**53)
        number("timeout", made.timeout, 0.0, 1e6, open_low=True)
        if check_model_options(made.options) and any(is_name(text) for text in made.texts):
            raise refuse("options", made.options, LEFT_OUT)
        if training_shots is None and all(map(is_player_name, made.texts)):
            shots = getattr(player_named(sources[0]), "training_shots", None)
            object.__setattr__(made, "training_shots", shots)
        return made

    @property
    def texts(self) -> list[str]:
        """The sources, as a result file names them."""
        texts = [text_of(source) for source in self.sources]
        return [text if texts.count(text) == 1 else f"{text} {k}" for k, text in enumerate(texts)]

    @property
    def program(self) -> bool:
        """Whether this is an external program."""
        return self.texts[0].startswith(PROGRAM)

    def player(self, task: Task, run: int = 0) -> Player:
        """Return the player of training seed ``run``, not yet bound; its code runs. ValueError if it cannot play the task."""
        source = self.sources[run]
        if self.program and isinstance(source, str):
            return ProgramPlayer(source.removeprefix(PROGRAM), timeout=self.timeout)
        made = player_named(source, trust=self.trust, options=self.options)
        bound = made.at(task.judged_options())
        if isinstance(bound, SeenPlayer) and bound.frames and not task.frame:
            raise refuse("player", source, "must see visits to play them: it sees frames")
        return made


@contextmanager
def seat(agent: Agent, task: Task, run: int) -> Iterator[Player]:
    """Yield the player of one training seed; end a program afterwards."""
    player = agent.player(task, run)
    try:
        yield player
    finally:
        if isinstance(player, ProgramPlayer):
            player.close()


def text_of(source: Source) -> str:
    """A source as a file names it: an object by its class."""
    if isinstance(source, str):
        return source
    name = getattr(source, "name", None)
    if isinstance(name, str) and name.startswith(PROGRAM):
        return name
    return f"{type(source).__module__}:{type(source).__qualname__}"


def is_player_name(text: str) -> bool:
    """Whether a text names a player of this package or of an installed one, and so its weights."""
    name, at, model = text.partition("@")
    named = ":" not in name and is_name(name) and (not at or model in levels())
    return named or is_degenerate(text)


def claims_player_name(label: str, sources: Sequence[str]) -> bool:
    """Whether the label is, or looks like, the name of a known player that these sources are not."""
    alike = re.sub("[.+_-]+", "_", label.lower()).strip("_")  # what a reader would take for it
    return (is_player_name(label) or is_player_name(alike)) and list(sources) != [label]


def _label(source: Source) -> str:
    text = text_of(source)
    if text.startswith(PROGRAM):
        path = Path((text.removeprefix(PROGRAM).split() or ["program"])[-1])
    else:
        path = Path(text if is_player_name(text) else text.rpartition(":")[2])
    stem = path.parent.stem if path.name == "model.zip" and path.parent.name else path.stem
    return re.sub(r"[^\w.+-]", "_", stem)[:20]
