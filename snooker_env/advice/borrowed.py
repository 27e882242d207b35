"""How does any other player give advice? ``Borrowed`` puts the position on a table, takes the player's action and reads it as a stroke.

A player has ``options``, the keywords of ``Options`` that define its action format, and ``act(tables, observations, going)``, which returns
an action for each table of a ``SnookerVectorEnv`` with flat observations. It may also have ``rank(tables, observations, going)``, which
returns a pair (actions, scores) for each table: the actions that it considered, best first, and its own scores of them.
"""

from typing import Any

import numpy as np

from .._check import refuse_what
from .._types import Bools
from ..planning import Planner, Positions
from .advisor import Advisor, Ranked
from .practice import PHYSICAL_OPTIONS, Practice, starts, stroke_of_row
from .strokes import CueStroke


class Borrowed(Advisor):
    """Gives a player of tables the interface of an ``Advisor``.

    A player whose actions have no place in the D plays a cue ball in hand from the place with the best value by the rule of thumb.
    """

    def __init__(self, player: Any, name: str):
        super().__init__()
        if not isinstance(getattr(player, "options", None), dict) or not callable(getattr(player, "act", None)):
            raise refuse_what("agent", f"a {type(player).__name__}", "must be a player's name, or a player: with options and act(...)")
        self.player, self.name, self.options = player, name, player.options  # type: ignore[misc]
        self._practice: Practice | None = None
        self._tables: Any = None

    def act(self, tables: Any, observations: Any, going: Bools) -> Any:
        """The player's own actions."""
        return self.player.act(tables, observations, going)

    def rank(self, practice: Practice, at: Positions, n: int, seed: int) -> Ranked:
        """The player's own ranking, or its one stroke without a score."""
        tables, start = self._dealt(practice, at, seed)
        observations, going = tables.tables.observe(np.arange(1)), np.ones(1, np.bool_)
        if callable(getattr(self.player, "rank", None)):
            ((actions, scores),) = self.player.rank(tables, observations, going)
            given = [(action, None if scores is None else float(scores[k])) for k, action in enumerate(actions[:n])]
        else:
            given = [(self.player.act(tables, observations, going)[0], None)]
        return [(self._stroke(tables, start, bool(at.in_hand[0]), action), score) for action, score in given]

    def _dealt(self, practice: Practice, at: Positions, seed: int) -> tuple[Any, Positions]:
        """The player's own table, with the position on it."""
        if self._practice is not practice:
            from ..envs.vector import SnookerVectorEnv  # here, because most advice needs no environment

            physical = {name: getattr(practice.options, name) for name in PHYSICAL_OPTIONS}
            self._tables = SnookerVectorEnv(1, threads=1, **{**self.player.options, **physical, "noise": practice.noise})
            self._practice = practice
        if at.in_hand[0] and not self._tables.options.rules.actions.placement:
            at = starts(practice, at, 1)
        self._tables.reset(seed=seed)
        (state,) = self._tables.get_state()
        ball_on, in_hand, points, over, _ = at.game[0].tolist()
        state |= {
            "positions": at.positions[0].tolist(), "on_table": at.on_table[0].tolist(), "ball_on": ball_on, "in_hand": bool(in_hand),
            "points": points, "over": bool(over),
        }  # fmt: skip
        self._tables.reset(seed=seed, options={"state": state})
        return self._tables, at

    def _stroke(self, tables: Any, start: Positions, in_hand: bool, action: Any) -> CueStroke:
        """The stroke that an action of the player means in the position ``start``."""
        planner = Planner(tables.options, noise="none", threads=1)
        chosen = [int(np.asarray(action).item())] if planner.discrete else [action]
        strokes, there = planner.strokes_of(start, [0], chosen)
        return stroke_of_row(strokes[0], there, in_hand)
