"""What is ``Snooker-v0``? The Gymnasium environment of one table, and what that of two players shares with it."""

import copy
from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces

from .._lib.check import truth
from .._lib.types import Action, Bools, Floats, Observation, RenderMode
from ..game.balls import BallOn
from ..game.frame import Frame
from ..game.frame_columns import BALL_ON, IN_HAND, POINTS
from ..physics.parameters import Physics
from ..simulation.shot import Shot
from ..tasks import observations
from ..tasks.frames import Frames
from ..tasks.options import Options
from ..tasks.played import Played
from ..tasks.stroke import ShotBuffers
from ..tasks.tables import Crew, StepOutput, Tables
from .arguments import ONE, Start, begin_at, breakers_of, game_of, known_options, starts_of, tables_of
from .pictures import MODES, SIZE, Picture, Pictures


class OneTable:
    """An environment with one table: ``SnookerEnv``, and ``MatchEnv`` with two players."""

    options: Options
    tables: Tables  # the one table: ``tasks.tables.Tables``
    np_random: np.random.Generator
    render_mode: str | None
    _np_random_seed: int | None
    _pictures: Pictures
    _full: bool  # whether a history is kept
    _buffers: ShotBuffers  # work space in which the strokes are played
    _strokes: list[Played]  # of both players since the reset; empty unless a history is kept
    _last_shot: Shot | None = None
    _keyed = False  # has the table's stream a key?

    @property
    def positions(self) -> Floats:
        """Centres of the balls [m], float64 (22, 2), a copy: the cue ball, 15 reds, yellow to black."""
        return self.tables.positions[0].copy()

    @property
    def on_table(self) -> Bools:
        """Which balls are on the table, bool (22,); a copy."""
        return self.tables.on_table[0].copy()

    @property
    def ball_on(self) -> BallOn:
        """What must be struck first, a ``BallOn``."""
        return BallOn(self.tables.game[0, BALL_ON])

    @property
    def in_hand(self) -> bool:
        """Whether the cue ball is in hand, a bool."""
        return bool(self.tables.game[0, IN_HAND])

    @property
    def points(self) -> int:
        """Points of the visit so far, an int; in a frame those of the striker's break."""
        return int(self.tables.game[0, POINTS])

    @property
    def over(self) -> bool:
        """Whether there is no stroke to play: the episode has ended, was stopped, or has not begun."""
        return bool(self.tables.are_over()[0])

    @property
    def frame(self) -> Frame | None:
        """The current ``snooker_env.game.frame.Frame``; None in a visit."""
        return self.tables.frame(0) if isinstance(self.tables, Frames) else None

    @property
    def physics(self) -> Physics:
        """The physical constants of this episode's table, a ``Physics``."""
        return self.tables.physics_of(0)

    # strokes

    @property
    def last_shot(self) -> Shot | None:
        """The agent's last ``Shot``, None before the first; with a history that of either player."""
        return self._last_shot

    @property
    def history(self) -> list[Played]:
        """Both players' ``Played`` strokes since the last reset, a list; empty unless ``keep_history``."""
        return list(self._strokes)

    @property
    def keep_history(self) -> bool:
        """Whether ``history`` is kept, with all paths; always with a render mode. False forgets it."""
        return self._full

    @keep_history.setter
    def keep_history(self, value: bool) -> None:
        full = truth("keep_history", value) or self.render_mode is not None
        if full != self._full:
            self._keep(full)

    def _keep(self, full: bool) -> None:
        """Keep a ``full`` history from now on, with all paths, or the last ``Shot`` alone."""
        self._full, self._buffers, self._strokes = full, ShotBuffers(1, path=full), []

    def _watch(self, k: int, buffers: ShotBuffers, j: int, mine: bool) -> None:
        """Record shot j of the buffers, just played on table k; ``mine``: by the agent."""
        if self._full:
            self._strokes.append(self.tables.record(k, buffers, j))
            self._last_shot = self._strokes[-1].shot
        elif mine:
            self._last_shot = self.tables.shot(k, buffers, j)

    def render(self) -> Picture:
        """Return a ``Picture``, with the paths of the last shot."""
        return self._pictures.render(self.tables, 0, self._strokes)

    def _show(self, *, played: bool = False) -> None:
        self._pictures.show(self.tables, self._strokes, played=played)

    def close(self) -> None:
        """Close the window, if there is one."""
        self._pictures.close()

    # states

    def get_state(self) -> dict[str, Any]:
        """Return everything between two shots as JSON types, see docs/environment/specification.md."""
        return self.tables.get_state(0) | {"rng": self.np_random.bit_generator.state}

    def set_state(self, state: dict[str, Any]) -> None:
        """Restore a result of ``get_state``; ValueError if it is invalid: then nothing has changed."""
        self._begin_at(self.tables.check_state(state, self.np_random), seeded=False)
        self._begin()

    def _begin(self) -> None:
        """A new episode begins on the table."""
        self._strokes, self._last_shot = [], None

    def _begin_at(self, start: Start | None, *, seeded: bool) -> None:
        if begin_at(start, self.tables, 0, self.np_random, seeded=seeded, keyed=self._keyed):
            self._np_random_seed = -1  # Gymnasium's number for "not from a seed"
        self._keyed = True


class SnookerEnv(OneTable, gymnasium.Env[Any, Any]):
    """Shot selection in snooker: one step is one whole shot, simulated until all balls rest and then judged.

    ``Options`` says what can be chosen, docs/environment/specification.md each formula, entry and key. By default:

    * **Task.** A visit: a break until the first stroke that pots nothing, a foul or a clearance. In a frame a step is a
      stroke and all of the opponent's after it.
    * **Action.** ``Box(-1, 1, (4,), float32)``: cue speed, side, top and the pot, whose aim is solved. All 0: the widest
      pot, no spin. Values up to 1e-6 outside are clipped, as rounding; others are refused.
    * **Observation.** ``Box(-1.1, 1.1, (61,), float32)``: the four widest pots, the cue ball, the state. Of a frame, or
      "flat", (121,): all balls, the state; a frame appends 19 numbers, a miss rule 66 more.
    * **Reward.** The points of the stroke, in a frame the growth of the lead.
    * **Episode.** ``reset(options=...)`` takes "state", "position" or "breaker" (0 the agent, 1 the opponent).

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
        own = copy.deepcopy(self.options.rules.actions.space)  # with its own generator
        self.action_space: spaces.Space[Any] = own
        self.observation_space: spaces.Space[Any] = self.tables.observation_space()
        self.render_mode = render_mode
        names = ("Agent",) if self.options.task == "visit" else ("Agent", "Opponent")
        self._pictures = Pictures(self.options.rules.table, render_mode, render_size, names)
        self._keep(render_mode is not None)

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
            tables.step(a[None], np.zeros(1, np.bool_), out, self._crew())
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
        return Crew(self._buffers, self._watch)
