"""Who sits at the table? Persons, and agents by name: those in the package, and those named when the page was started.

An agent is asked for one stroke at a time, on a copy of the table, without execution errors, which are drawn when the stroke is played.
After a foul of the opponent every agent plays the table as it lies. Agents nominate no colour and do not use a free ball.
"""

from collections.abc import Mapping
from typing import Any

from .._check import choice, refuse
from ..advice import CueStroke, names, player_of, stroke_of
from ..advice.players import BUILT_IN
from .session import Session

PERSON = "person"
TRAINED = "ppo_foresight"
"""The pre-trained agent that is offered if the repository has it. It is loaded at its first stroke."""


class Seats:
    """The two seats, and the players that may take them.

    Parameters
    ----------
    agents : mapping of str to a player of ``snooker_env.advice``
        Agents that may be chosen besides the built-in ones, by name.
    """

    who: list[str]
    """``PERSON`` or the name of an agent, for each seat."""

    def __init__(self, agents: Mapping[str, Any]):
        offered = [*BUILT_IN, *(name for name in names() if name == TRAINED)]
        self._players: dict[str, Any] = {**agents, **{name: None for name in offered if name not in agents}}
        self.who = [PERSON, PERSON]

    @property
    def names(self) -> list[str]:
        """The players that may sit down: "person" and the agents."""
        return [PERSON, *self._players]

    @property
    def agents(self) -> list[str]:
        """The agents' names."""
        return list(self._players)

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

    def player(self, name: str) -> Any:
        """The player of ``snooker_env.advice`` with this name."""
        choice("agent", name, self.agents)
        if self._players[name] is None:
            self._players[name] = player_of(name)
        return self._players[name]

    def stroke(self, name: str, session: Session) -> CueStroke:
        """The stroke that an agent plays on the current table, with a place for a cue ball in hand. ``session`` is not changed."""
        noise, seed = session.noise[session.frame.striker], len(session.acts)
        return stroke_of(self.player(name), session.planned(), noise=noise, seed=seed)
