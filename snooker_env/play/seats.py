"""Who sits at the table? Persons, and agents by name: those that came with the package, and those named when the page was started.

An agent is asked for one stroke at a time, on a copy of the table, without errors of execution: those are drawn when the stroke is
played. After a foul of the other every agent plays the table as it lies; it names no colour and takes no free ball for another ball.
"""

from collections.abc import Mapping
from math import atan2
from typing import Any

import numpy as np

from .._check import choice, refuse
from ..game.balls import CUE
from ..tasks.frame import Frames
from ..tasks.opponents import GhostBallOpponent
from ..tasks.stroke import CUE_SPEED, VX, VY, ShotBuffers
from .session import Session
from .wishes import Wish

PERSON = "person"
GHOST_BALL = "ghost_ball"


class Seats:
    """The two seats, and the players that may take them.

    Parameters
    ----------
    agents : mapping of str to a player of ``snooker_env.advice``, or None
        By name; None: it is made when it is asked for the first time.
    """

    who: list[str]
    """``PERSON`` or an agent's name, of each seat."""

    def __init__(self, agents: Mapping[str, Any]):
        self._players = {GHOST_BALL: None, **agents}
        self.who = [PERSON, PERSON]

    @property
    def names(self) -> list[str]:
        """Who may sit down: persons and agents."""
        return [PERSON, *self._players]

    @property
    def agents(self) -> list[str]:
        """The agents' names."""
        return list(self._players)

    def sit(self, who: list[str]) -> None:
        """Give both seats away; ValueError for an unknown name."""
        if not isinstance(who, list) or len(who) != 2:
            raise refuse("players", who, "must be two names")
        self.who = [choice(f"players[{k}]", name, self.names) for k, name in enumerate(who)]

    def is_agent(self, seat: int) -> bool:
        """Does an agent sit there?"""
        return self.who[seat] != PERSON

    def label(self, seat: int) -> str:
        """How a player is called."""
        if self.is_agent(seat):
            return self.who[seat] if self.who[0] != self.who[1] else f"{self.who[seat]} {seat + 1}"
        return "You" if self.is_agent(1 - seat) else f"Player {seat + 1}"

    def player(self, name: str) -> Any:
        """The player of ``snooker_env.advice`` of that name."""
        from ..advice import player_of

        choice("agent", name, self.agents)
        if self._players[name] is None:
            self._players[name] = player_of(name)
        return self._players[name]

    def stroke(self, name: str, session: Session) -> tuple[Wish, tuple[float, float] | None]:
        """What an agent plays at a table of its own, and where it puts a cue ball in hand. ``session`` is left as it is."""
        if name == GHOST_BALL:
            return _of_ghost_ball(session)
        from ..advice import stroke_of

        stroke = stroke_of(self.player(name), session.planned(), noise=session.noise[session.frame.striker], seed=len(session.acts))
        place = None if stroke.place is None else (float(stroke.place[0]), float(stroke.place[1]))
        return Wish(speed=stroke.speed, aim=stroke.aim, side=stroke.side, top=stroke.top, elevation=stroke.elevation), place


def _of_ghost_ball(session: Session) -> tuple[Wish, tuple[float, float] | None]:
    """The stroke of the frame's own geometric opponent, which plays on when there is no pot, too."""
    tables, buffers, one = Frames(session.rules_with("none"), 1), ShotBuffers(1), np.zeros(1, np.int64)
    session.copy_to(tables)
    GhostBallOpponent().prepare(tables, one, None, buffers)
    struck = buffers.shots[0]
    place = tuple(tables.positions[0, CUE].tolist()) if session.frame.in_hand else None
    return Wish(speed=float(struck[CUE_SPEED]), aim=atan2(struck[VY], struck[VX])), place  # it knows neither side nor top
