"""How do two agents play a frame or match? PettingZoo's AEC interface around one table of ``tasks.frames``."""

import copy
from collections.abc import Mapping, Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium.utils import seeding
from numpy.typing import NDArray
from pettingzoo import AECEnv

from .._lib.types import Action, Observation, RenderMode
from ..game.frame_columns import STRIKER
from ..simulation.shot import Shot
from ..tasks import observations
from ..tasks.discrete_actions import Choices
from ..tasks.frames import Frames
from ..tasks.options import Options
from ..tasks.tables import Crew
from .arguments import ONE, breakers_of, known_options, match_options, match_tables, starts_of
from .pictures import MODES, SIZE, Pictures
from .snooker import OneTable

PLAYERS: tuple[str, ...] = ("player_0", "player_1")


class MatchEnv(OneTable, AECEnv[str, Any, Any]):
    """A frame of snooker between two players, one stroke a step; with ``task="match"`` the best of ``frames``
    frames. docs/environment/two_players.md is the specification.

    ``agent_selection`` stays as long as the player scores. Actions: ``Box(-1, 1, (7,), float32)``, speed, side, top,
    aim, place in the D (two numbers), decision after a foul, or more or fewer with the options; or ``Discrete(540)``,
    with ``action_mask(agent)``. Observations and infos are those of a frame of ``SnookerEnv`` as each player sees it;
    the rewards of both sum to zero. ``reset(options=...)`` takes "state", "position" or "breaker" (0 or 1)."""

    metadata: dict[str, Any] = {"render_modes": list(MODES), "render_fps": 1}  # noqa: RUF012
    metadata |= {"name": "snooker_match_v0", "is_parallelizable": False}
    tables: Frames

    def __init__(
        self,
        options: Options | None = None,
        *,
        seats: Sequence[Mapping[str, Any]] | None = None,
        render_mode: RenderMode | None = None,
        render_size: Sequence[int] = SIZE,
        **keywords: object,
    ):
        super().__init__()
        self.options = match_options(options, keywords)
        self.render_mode = render_mode
        self.tables = match_tables(self.options, seats, 1)
        self.possible_agents, self.agents = list(PLAYERS), []
        self.observation_spaces = {name: self.tables.observation_space(k) for k, name in enumerate(PLAYERS)}
        acts = zip(PLAYERS, self.tables.actions, strict=True)
        self.action_spaces = {name: copy.deepcopy(its.space) for name, its in acts}  # each with its generator
        self.np_random, _ = seeding.np_random()
        self._selected: str | None = None
        self._last = None
        self._keep(render_mode is not None)
        names = ("Player 1", "Player 2")
        self._pictures = Pictures(self.options.rules.table, render_mode, render_size, names)

    @property
    def agent_selection(self) -> str:
        """The agent whose turn it is. AttributeError before ``reset``, as in PettingZoo's environments."""
        if self._selected is None:
            words = "call reset(), then observe(), last() or action_mask()"
            raise AttributeError(f"agent_selection cannot be read before reset(): {words}")
        return self._selected

    @agent_selection.setter
    def agent_selection(self, agent: str) -> None:
        self._selected = agent

    @property
    def last_shot(self) -> Shot | None:
        """The ``Shot`` of the last turn, with its path if a history is kept; None if it had no stroke."""
        return self._last_shot if self._last is not None else None

    def observation_space(self, agent: str) -> gymnasium.Space[Any]:
        """Return the observation space of a player; the same object each time."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> gymnasium.Space[Any]:
        """Return the action space of a player; the same object each time."""
        return self.action_spaces[agent]

    def observe(self, agent: str) -> Observation:
        """Return the current observation of a player, in new arrays."""
        _, side = self.agent_selection, PLAYERS.index(agent)  # an error before reset()
        rows = self.tables.observe(np.zeros(1, np.int64), side)
        masks = self.action_mask(agent) if self.options.rules.observation == "masked" else None
        return observations.arrange(self.options.rules.observation, rows[0], masks)

    def action_mask(self, agent: str) -> NDArray[np.int8]:
        """Return a player's available choices, int8 (choices,), 0 out of turn; ValueError without choices."""
        available = self.tables.action_masks(side=PLAYERS.index(agent))[0]
        turn = agent == self.agent_selection and not self.tables.are_over()[0]
        return (available & turn).astype(np.int8)

    def reset(self, seed: int | None = None, options: dict[str, Any] | None = None) -> None:
        """Begin a new frame; without a seed the random stream goes on.

        ``options``: see the class, else ValueError; other keys are ignored: PettingZoo's tests pass some."""
        if isinstance(options, dict):
            options = {key: options[key] for key in ONE if key in options}
        options = known_options(options, ONE)
        starts = starts_of(options, self.tables, self.np_random, to_play=False)
        breakers = breakers_of(options, self.tables)
        if seed is not None:
            self.np_random, _ = seeding.np_random(seed)
        self._begin_at(None if starts is None else starts[0], seeded=seed is not None)
        if starts is None:
            self.tables.deal(np.zeros(1, np.int64), drawn=True, **breakers)
        self._begin()
        self._show()

    def _begin(self):
        """Initialise PettingZoo's attributes for the current table; rewards not yet collected become zero."""
        super()._begin()
        self._last, self.agents = None, list(PLAYERS)
        self.rewards, self._cumulative_rewards = (dict.fromkeys(PLAYERS, 0.0) for _ in range(2))
        self._account()

    def _account(self, striker=None):
        """Whose turn it is, and the infos; ``striker``: who has just had one."""
        frame = self.tables.frame(0)
        over = frame.phase == "over"
        self.terminations = dict.fromkeys(PLAYERS, over)
        self.truncations = dict.fromkeys(PLAYERS, bool(self.tables.are_stopped_short()[0]) and not over)
        self.agent_selection = PLAYERS[frame.striker]
        self.infos = {name: self._info(striker, k) for k, name in enumerate(PLAYERS)}

    def step(self, action: Action) -> None:
        """Play the action of the selected player, None once it has terminated or is truncated.

        ValueError for an action outside the space, ResetNeeded if no player is left: then nothing is played.
        SimulationError if the shot cannot be computed."""
        if not self.agents:
            what = f"the frame {self.tables.unplayable}"
            raise gymnasium.error.ResetNeeded(f"{what}: call reset() before step()")
        name = self.agent_selection  # of PettingZoo's own type
        if self.terminations[name] or self.truncations[name]:
            self._was_dead_step(action)
            return
        striker, out = int(self.tables.game[0, STRIKER]), self.tables.output()
        a = self.tables.actions[striker].check(action)
        self._pictures.require_display()
        crew = Crew(self._buffers, self._watch)
        played = bool(self.tables.turns([a[None]] * 2, out, crew)[0])
        self._last = out if played else None
        self._cumulative_rewards[name], gained = 0.0, float(out.rewards[0])
        self.rewards = dict(zip(PLAYERS, (gained, 0.0 - gained), strict=True))
        self._account(striker)
        self._accumulate_rewards()
        self._show(played=played)

    def _info(self, striker, player):
        """The keys of ``SnookerEnv``'s info: of the last stroke, and of the frame as the player sees it."""
        info = self.tables.info_of(player, self._last)
        info["opponent_strokes"] = int(self._last is not None and striker is not None and striker != player)
        if isinstance(self.tables.actions[player], Choices):
            info["action_mask"] = self.action_mask(PLAYERS[player])
        return info
