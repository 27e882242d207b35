"""Who sits at the table? Persons, and agents by name: some of the package, and those named at the start.

An agent is asked for one stroke at a time, on a copy of the frame, without execution errors.
"""

from collections.abc import Mapping

from .._check import choice, refuse, refuse_what
from ..advice.ask import AGENT
from ..game.frame_columns import STROKES
from ..players import Player, Strokes, player
from .session import Session

PERSON = "person"
OFFERED = (AGENT, "search_2000", "ghost_ball", "random")
"""The agents that can always be chosen."""


class Seats:
    """The two seats, and the players that may take them: ``OFFERED``, and ``agents`` by name."""

    who: list[str]
    """``PERSON`` or the name of an agent, for each seat."""

    def __init__(self, agents: Mapping[str, Player]):
        self.players: dict[str, Player] = dict(agents)
        for name in OFFERED:
            self.players.setdefault(name, player(name))
        self.who = [PERSON, PERSON]

    @property
    def names(self) -> list[str]:
        """The players that may sit down: "person" and the agents."""
        return [PERSON, *self.players]

    @property
    def agents(self) -> list[str]:
        """The agents' names."""
        return list(self.players)

    def sit(self, who: list[str]) -> None:
        """Assign both seats; ValueError for an unknown name."""
        if not isinstance(who, list) or len(who) != 2:
            raise refuse("players", who, "must be two names")
        self.who = [choice(f"players[{k}]", name, self.names) for k, name in enumerate(who)]

    def is_agent(self, seat: int) -> bool:
        """Whether an agent has this seat."""
        return self.who[seat] != PERSON

    def label(self, seat: int) -> str:
        """The player's name on the page."""
        if self.is_agent(seat):
            name = self.who[seat].replace("_", " ")  # as the page lists it
            return name if self.who[0] != self.who[1] else f"{name} {seat + 1}"
        return "You" if self.is_agent(1 - seat) else f"Player {seat + 1}"

    @property
    def labels(self) -> tuple[str, str]:
        """The names of both."""
        return self.label(0), self.label(1)

    def decided(self, name: str, session: Session) -> Strokes:
        """What an agent does in the frame: a decision, a declaration or a stroke, without changing it."""
        options = session.options_with(session.noise[session.frame.striker])
        decided = self.players[name].at(options).play(session.position, session.tables.game[:, STROKES])
        if not isinstance(decided, Strokes) or len(decided) != 1:
            raise refuse_what("strokes", f"a {type(decided).__name__}", "must be Strokes of one stroke")
        return decided
