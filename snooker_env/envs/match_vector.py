"""How do two players meet on thousands of tables? ``match_env`` on many tables, as kernels."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode

from .._lib.check import refuse
from .._lib.types import Bools, Floats, Ints, Observation
from ..game.frame_columns import STRIKER
from ..tasks.frames import Frames
from ..tasks.options import Options
from ..tasks.tables import Tables
from .arguments import match_options, match_tables
from .vector import SnookerVectorEnv


class MatchVectorEnv(SnookerVectorEnv):
    """Many frames or matches of two players: ``match_env``, bit for bit, on n tables; for self-play.

    A step is one turn on each table, of the player whose turn it is there: ``strikers``, whose observations are
    returned. Infos are as player 0 sees them; rewards float64 (n, 2), one for each player. A table whose match has ended
    stands still until ``reset(options={"reset_mask": ...})``.

    Parameters
    ----------
    num_envs, options, **keywords
        As in ``SnookerVectorEnv``, with ``task="frame"`` or "match" and no opponent, and without
        ``autoreset_mode`` and ``max_episode_steps``. As in ``match_env`` box actions hold placement and
        decision by default, and with ``frames`` the task is "match".
    seats : (dict, dict), optional
        What differs for each player: options of its actions, and "noise", its execution errors.

    Examples
    --------
    >>> import numpy as np
    >>> import snooker_env as sn
    >>> tables = sn.MatchVectorEnv(4, noise="club", threads=1)
    >>> observations, infos = tables.reset(seed=1)
    >>> observations, rewards, terminations, truncations, infos = tables.step(np.zeros((4, 7)))
    >>> observations.shape, rewards.shape, tables.strikers.shape
    ((4, 140), (4, 2), (4,))
    """

    tables: Frames

    def __init__(
        self,
        num_envs: int = 1,
        options: Options | None = None,
        *,
        seats: Sequence[Mapping[str, Any]] | None = None,
        **keywords: Any,
    ):
        for name in ("autoreset_mode", "max_episode_steps"):
            if name in keywords:
                words = "must be left out: tables whose match has ended stand still until they are reset"
                raise refuse(name, keywords[name], words)
        self._differences = seats
        super().__init__(num_envs, options, autoreset_mode=AutoresetMode.DISABLED, **keywords)
        one, other = (actions.space for actions in self.tables.actions)
        if one != other:
            raise refuse("seats", seats, "must give both players the same actions; match_env takes others")

    def _game_of(self, given: Options | None, keywords: Any, limit: int) -> tuple[Options, Tables]:
        options = match_options(given, keywords)
        return options, match_tables(options, self._differences, self.num_envs)

    @property
    def strikers(self) -> Ints:
        """Whose turn it is, or was at the end, on each table: int64 (num_envs,), 0 or 1."""
        return self.tables.game[:, STRIKER].copy()

    def reset(self, *, seed: Any = None, options: Any = None) -> tuple[Observation, dict[str, Any]]:
        """Begin new frames or matches, see ``SnookerVectorEnv.reset``."""
        observations, infos = super().reset(seed=seed, options=options)
        return observations, infos | {"striker": self.strikers}

    def step(self, actions: Any) -> tuple[Observation, Floats, Bools, Bools, dict[str, Any]]:
        """Play one turn on each table, see ``SnookerVectorEnv.step``.

        ``actions`` are the strikers'; observations are of the players whose turn it is now; rewards float64 (num_envs, 2)."""
        tables = self.tables
        told = tables.actions[0].check(actions, self.num_envs)
        self._require_begun()
        written = tables.output()
        with self._playing():
            tables.turns([told, told], written, self._crew)
        infos = tables.infos(written.reals, written.counts) | {"striker": self.strikers}
        rewards = np.stack([written.rewards, -written.rewards], axis=1) + 0.0  # no negative zero
        return self._arrange(written), rewards, written.terminated, written.truncated, infos

    def observe(self, player: int) -> Observation:
        """Return the observations of player 0 or 1: float32 (num_envs, k), or a dict of such arrays."""
        if player not in (0, 1):
            raise refuse("player", player, "must be 0 or 1")
        written = self.tables.output()
        written.observations[:] = self.tables.observe(np.arange(self.num_envs), player)
        if len(written.masks):
            written.masks[:] = self.action_masks()
            written.masks[(self.strikers != player) | self.tables.are_over()] = False
        return super()._arrange(written)

    def _arrange(self, written: Any) -> Any:
        """The strikers' observations, without a choice where the frame or match has ended."""
        theirs = np.flatnonzero(self.tables.game[:, STRIKER])
        written.observations[theirs] = self.tables.observe(theirs, 1)
        if len(written.masks):
            written.masks[self.tables.are_over()] = False
        return super()._arrange(written)
