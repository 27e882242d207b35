"""What is ``Snooker-v0``? The Gymnasium environment of one table."""

import copy
from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces

from .._lib.types import Action, Bools, Observation, RenderMode
from ..tasks import observations
from ..tasks.options import Options, observation_space_of
from ..tasks.stroke import ShotBuffers
from ..tasks.tables import Crew, StepOutput
from .arguments import ONE, breakers_of, known_options, starts_of
from .one_table import OneTable, Record
from .pictures import MODES, SIZE, Pictures
from .seats import game_of, tables_of


class SnookerEnv(OneTable, gymnasium.Env[Any, Any]):
    """Shot selection in snooker: one step is one whole shot, simulated until all balls rest and then judged.

    docs/environment/specification.md is the specification, with each formula, entry and key. In short:

    * **Task.** "visit" (default): a break until the first stroke that pots nothing, a foul or a clearance; "frame",
      against ``opponent``: a step is a stroke and all of the opponent's after it; "match": the best of ``frames``.
    * **Action.** ``Box(-1, 1, (4,), float32)``: cue speed, side, top and the pot, whose aim is solved. All 0: the widest
      pot, no spin. Longer with ``elevation``, ``placement`` and ``says``. Values up to 1e-6 outside are clipped, as
      rounding; others are refused. ``action="discrete"``: ``Discrete(540)`` or more; ``action_masks()`` are the available.
    * **Observation.** Of a visit ``Box(-1.1, 1.1, (61,), float32)``: the four widest pots, the cue ball, the state. Of a
      frame, or "flat", ``Box(-1.1, 1.1, (121,), float32)``: all balls, the state; a frame appends 19 numbers, a miss rule
      66 more. "balls": the same as ``Dict(balls=(22, 5), state=(11,))``. "masked", of discrete actions:
      ``Dict(observations, action_mask)``.
    * **Reward.** "points" (default): of the stroke, of a frame the growth of the lead; or of a visit
      "points_and_fouls", "pots", "legal", of a frame "win", of a match "frames".
    * **Episode.** A frame is truncated after ``max_strokes`` strokes of both players; ``one_stroke=True``: it ends
      after one step. ``reset(options=...)`` takes "state", "position" or "breaker" (0 the agent, 1 the opponent).

    Parameters
    ----------
    options : Options, optional
        All options as one object. Default None: they are made from the keywords.
    render_mode : {"human", "rgb_array", "ansi"}, optional
        How ``render`` shows the table; default None: not at all.
    render_size : (int, int), optional
        Width and height of pictures [pixels], each in [100, 8192]; default (1920, 1080).
    **keywords
        The options as keywords, in place of ``options``. TypeError for an unknown one, ValueError for a bad
        value.

    Examples
    --------
    >>> import gymnasium, snooker_env
    >>> env = gymnasium.make("Snooker-v0", noise="club")
    >>> observation, info = env.reset(seed=1)
    >>> observation, reward, terminated, truncated, info = env.step([0.2, 0.0, 0.0, 0.0])
    """

    metadata: dict[str, Any] = {"render_modes": list(MODES), "render_fps": 1}  # noqa: RUF012

    def __init__(
        self,
        options: Options | None = None,
        *,
        render_mode: RenderMode | None = None,
        render_size: Sequence[int] = SIZE,
        **keywords: object,
    ):
        self.options, opponent = game_of(options, keywords)
        self.tables = tables_of(self.options, opponent, 1)
        self.action_space: spaces.Space[Any] = copy.deepcopy(
            self.options.rules.actions.space
        )  # with its own generator
        self.observation_space: spaces.Space[Any] = observation_space_of(self.options)
        self.render_mode = render_mode
        names = ("Agent",) if self.options.task == "visit" else ("Agent", "Opponent")
        self._pictures = Pictures(self.options.rules.table, render_mode, render_size, names)
        self._record, self._keyed = Record(full=render_mode is not None), False

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin a new episode, see Episode; without a seed the random stream goes on.

        Returns the observation and the info. ValueError for an unknown key, or a state or position that is
        invalid or has no stroke left."""
        options = known_options(options, ONE)
        starts = starts_of(options, self.tables, self.np_random)
        breakers = breakers_of(options, self.tables)
        super().reset(seed=seed)
        self._begin_at(None if starts is None else starts[0], seeded=seed is not None)
        self._begin()
        out = self.tables.output()
        self.tables.reset(np.array([starts is None]), out, self._crew(), **breakers)
        self._show()
        return self._arrange(out), self.tables.info(out, 0)

    def step(self, action: Action) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Play one shot; in a frame, also all strokes of the opponent after it.

        Returns observation, reward, terminated, truncated, info. ValueError for an action outside the space,
        ResetNeeded if no episode is going on: then nothing is played. SimulationError if a shot cannot be
        computed: the balls lie as before, but for a cue ball that was placed."""
        a = self.options.rules.actions.check(action)
        tables = self.tables
        if tables.are_told_over()[0]:
            what = f"the {self.options.task} {tables.unplayable}"
            raise gymnasium.error.ResetNeeded(f"{what}: call reset() before step()")
        self._pictures.require_display()
        out = tables.output()
        try:
            tables.step(np.array([a]), np.zeros(1, np.bool_), out, self._crew())
        except BaseException:
            tables.interrupt()
            raise
        ended = bool(out.terminated[0]), bool(out.truncated[0])
        return self._arrange(out), float(out.rewards[0]), *ended, tables.info(out, 0)

    def action_masks(self) -> Bools:
        """Return the choices, bool (540,) or longer, for maskable algorithms; ValueError with "box"."""
        return self.tables.action_masks()[0]

    def _arrange(self, out: StepOutput) -> Observation:
        masks = out.masks[0] if len(out.masks) else None
        return observations.arrange(self.options.rules.observation, out.observations[0], masks)

    def _watch(self, k: int, buffers: ShotBuffers, j: int, mine: bool) -> None:
        super()._watch(k, buffers, j, mine)
        self._show(played=True)

    def _crew(self) -> Crew:
        return Crew(self._record.buffers, self._watch)
