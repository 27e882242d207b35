"""How does a player of visits see a frame? On tables of his own that show the stroke to come as one of a visit.

A player has ``options``, the keywords that say how its actions are read, and ``act(tables, observations, going)``, which returns an action
for each table of a ``SnookerVectorEnv`` with flat observations. Planning players simulate on those tables, which have the physics, table,
noise and fidelity of the frames. A player whose attribute ``frames`` is True gets tables of frames instead, from his own side.

With a free ball, the tables of a visit show that any colour is on. It is right in all but one thing: what it scores. A cue ball in
hand that may stand anywhere is placed for the player where "ghost_ball" would place it.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from .._types import Bools, Ints
from ..game.frame_columns import ANYWHERE, IN_HAND, STEPS, VISIT_COLUMNS
from ..game.sides import as_visits, swapped
from ..geometry import HALF_LENGTH, HALF_WIDTH
from ..tasks.frame import Frames
from ..tasks.ghost_ball import put_in_hand
from .vector import SnookerVectorEnv

PHYSICAL = ("noise", "physics", "table", "fidelity")
"""The options of frames that hold for visits, too."""


class Seat:
    """The tables on which a player sees frames.

    Parameters
    ----------
    player : object
        With ``options``, and optionally ``frames``.
    n : int
        Number of tables.
    game : mapping
        Options of the frames: at least those of ``PHYSICAL``.
    threads : int, optional
        As in ``SnookerVectorEnv``.

    Attributes
    ----------
    tables : SnookerVectorEnv
        The player's own tables.
    """

    def __init__(self, player: Any, n: int, game: Mapping[str, Any], threads: int | None = None):
        self._frames = getattr(player, "frames", False) is True
        same, own = dict(game), dict(player.options)
        if not self._frames:
            same = {name: game[name] for name in PHYSICAL}
            own.pop("decision", None)  # there is none in a visit
        self.tables = SnookerVectorEnv(n, threads=threads, **own | same)
        self.tables.reset(seed=0)  # whose tables are replaced by those of the frames

    def show(self, frames: Frames, which: Ints, rows: Ints | None = None, side: int = 0) -> None:
        """Show the tables ``which`` of frames on ``rows`` (by default the same) as player ``side`` sees them."""
        own: Any = self.tables.tables
        rows = which if rows is None else rows
        own.positions[rows], own.on_table[rows] = frames.positions[which], frames.on_table[which]
        game = frames.game[which]
        if self._frames:
            own.saved.positions[rows], own.saved.on_table[rows] = frames.saved.positions[which], frames.saved.on_table[which]
            own.game[rows] = swapped(game) if side else game
            return
        game = as_visits(game)
        game[:, STEPS] = 0
        own.game[rows] = game[:, :VISIT_COLUMNS]

    def act(self, player: Any, going: Bools) -> Any:
        """The player's actions on these tables."""
        return player.act(self.tables, self.tables.tables.observe(np.arange(self.tables.num_envs)), going)


class AtFrames:
    """A player of visits as the agent at tables of frames: it sees the stroke to come as one of a visit, and plays on after every foul.

    Parameters
    ----------
    player : object
        With ``options`` and ``act``.

    Examples
    --------
    >>> import numpy as np
    >>> import snooker_env as sn
    >>> from snooker_env.benchmark import AtFrames
    >>> class Soft:
    ...     options = {}
    ...     def act(self, tables, observations, going):
    ...         return np.full((len(going), 4), -1.0)
    >>> frames = sn.SnookerVectorEnv(2, task="frame", threads=1)
    >>> observations, _ = frames.reset(seed=0)
    >>> AtFrames(Soft()).act(frames, observations, np.ones(2, bool)).shape
    (2, 4)
    """

    def __init__(self, player: Any):
        self.player, self.options = player, player.options
        self._frames: Any = None
        self._seat: Any = None

    def act(self, frames: Any, observations: Any, going: Bools) -> Any:
        """The player's actions, which mean the same in a frame.

        Parameters
        ----------
        frames : SnookerVectorEnv
            The n tables, with ``task="frame"`` or "match".
        observations : numpy.ndarray
            Theirs; the player gets those of a visit instead.
        going : numpy.ndarray
            bool (n,): tables on which the player is to play.

        Returns
        -------
        numpy.ndarray
            An action for each table.
        """
        if self._frames is not frames:
            same = {name: getattr(frames.options, name) for name in PHYSICAL}
            self._seat, self._frames = Seat(self.player, frames.num_envs, same, frames.threads), frames
        which = np.flatnonzero(going)
        self._seat.show(frames.tables, which)
        own, game, said = self._seat.tables.tables, frames.tables.game, frames.options.rules.actions
        anywhere = which[(game[which, ANYWHERE] != 0) & (game[which, IN_HAND] != 0)]
        if not len(anywhere) or not said.placement:
            return self._seat.act(self.player, going)
        put, on_table = own.positions[anywhere], own.on_table[anywhere]
        put_in_hand(put, on_table, game[anywhere], frames.tables.streams[anywhere])
        own.positions[anywhere] = put
        actions = np.array(self._seat.act(self.player, going), np.float64)
        at = 5 if said.elevation else 4  # the place means another one where the cue ball may stand anywhere
        actions[anywhere, at : at + 2] = own.positions[anywhere, 0] / (HALF_WIDTH, HALF_LENGTH)
        return actions
