"""What is ``Snooker-v0``? The Gymnasium environment: composes action, noise, strike, engine, referee, observation and reward."""

from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np

from .._check import choice, refuse
from .._types import Action, Bools, Floats, Observation, RenderMode
from ..game.balls import BallOn
from ..game.frame import Frame
from ..game.frame_columns import BALL_ON, IN_HAND, POINTS
from ..physics.parameters import Physics
from ..physics.table import Table
from ..tasks import observations
from ..tasks.discrete_actions import Choices
from ..tasks.frame import Frames
from ..tasks.kinds import TABLES
from ..tasks.noise import Noise
from ..tasks.options import Options, options_of
from ..tasks.stroke import ShotBuffers
from ..tasks.tables import Crew, Tables
from .pictures import FPS, MODES, SIZE, Picture, Pictures
from .record import HasHistory, Record
from .reset_options import ONE, Start, given_of, start_of


class SnookerEnv(HasHistory, gymnasium.Env[Any, Any]):
    """Snooker shot selection: one step is one whole shot.

    ## Description
    A visit to the table: the agent plays the cue ball, the shot is simulated to rest (frictional impacts of Mathavan, Jackson & Parkin
    2014 in an exact event-driven engine, cushions of their 2010 model), the referee judges it, colours are respotted, and the agent
    sees the new layout. The aim is a high break: pot a red, then a colour, then a red ..., finally the colours in order.

    ``task="frame"``: a whole frame against ``opponent``, scores, fouls, free balls and all. One step is one stroke of the agent and all
    that the opponent plays after it. Who breaks is drawn from the seed. ``opponent="none"``: the agent plays alone; what it misses or
    fouls it plays on from itself, penalties go to the other score. ``"random"``: uniform actions. ``"ghost_ball"``: the plain geometric
    player. ``opponent(observation, rng) -> action``: any callable, asked in this environment's spaces from its own side of the table.
    A path to a ``.zip``: a model of Stable-Baselines3 or sb3-contrib, trained on either task with these options. Such a file holds pickled
    Python code, which runs when it is loaded, and so needs ``trust=True``; a model that does not fit is refused before any of it runs.

    ## Action space
    ``Box(-1, 1, (4,), float32)``: cue speed, side spin, top/back spin, aim; see ``tasks.box_actions.Actions`` for every component
    and formula. ``aim="absolute"`` reads the aim as an angle of the full circle, ``aim="target"`` as up to 3 degrees left or right of the
    best potting line. ``elevation=True`` appends the cue's elevation, ``placement=True`` two numbers for the place in the D. After a red,
    the colour first struck is the one nominated; so is the free ball. In a frame ``decision=True`` appends what to do when the opponent has
    fouled: play, have him play again, or (after a miss, ``miss="clear_path"``) have the balls replaced; without it the agent always plays.
    In hand the cue ball stands at its usual place for the break, or near it, until ``placement`` moves it.

    ## Observation space
    ``observation="flat"``: ``Box(-1, 1, (121,), float32)``, the 22 rows of five of the table of balls, then eleven state entries.
    ``observation="balls"``: ``Dict(balls=(22, 5), state=(11,))``, the same numbers (SB3: "MultiInputPolicy").

    | balls, one row a ball (0 cue, 1-15 reds, 16-21 yellow to black) | | state | |
    |---|---|---|---|
    | x, y | / 0.889, / 1.7845 m, 0 when off the table | reds | left / 15 |
    | on_table | 0 or 1 | any_colour, red, yellow .. black | one-hot: what is on |
    | value | points / 7 | in_hand | 1 if the cue ball is played from the D |
    | ball_on | 1 if it may be struck first | break | points of the visit / 155 |

    World frame: origin at the table's centre, +x to the yellow side, +y to the black end. ``task="frame"`` appends nine entries to the
    state (so ``(130,)``, ``(20,)``): ``observations.FRAME_ENTRIES``.

    ## Rewards
    ``reward="points"`` (default): the points of the stroke, 0 for a miss or a foul, in [0, 15]. ``"points_and_fouls"``: less the
    penalty of a foul (4 to 7). ``"pots"``: 1 for a scoring stroke. In a frame: ``"points"`` (default), the agent's points less the
    opponent's in this step, penalties included; ``"win"``, +1 or -1 when the frame ends.

    ## Starting state
    ``layout="opened"`` (default): a table opened by real simulated play, all 22 balls on it, reds on; ``"held_out"``: such tables that
    ``"opened"`` never gives; ``"break_off"`` (default of a frame), ``"line_up"``, ``"colours"`` (the six on their spots), ``"random:N"`` (N
    reds sprinkled), ``"snookered"`` (on every red), ``"pots:easy"``, ``"pots:medium"``, ``"pots:hard"`` (one red alone).

    ## Episode end
    Terminated by the first stroke that pots nothing, by a foul, or by a clearance; in a frame by its end under the rules, nobody concedes.
    A frame that goes nowhere (fouls in turn, "play again") is stopped by the referee: truncated, with no winner, at once after the last of
    ``max_strokes`` strokes of both players together, in the middle of a visit too. A visit is never truncated by itself
    (``gymnasium.make(..., max_episode_steps=N)`` does). No ball leaves the table: the physics is planar.

    ## Arguments
    All are JSON types (but a callable opponent), so that ``EnvSpec.to_json`` round-trips.

    | name | default | what |
    |---|---|---|
    | task | "visit" | build a break until the first miss or foul; "frame": see Description |
    | layout | "default" | see Starting state |
    | opponent | "none" | of a frame only: see Description |
    | miss | "off" | of a frame only; or "clear_path": the rule for a foul and a miss (``snooker_env.game.frame``) |
    | decision | False | of a frame only: see Action space |
    | max_strokes | 1000 | of a frame only: see Episode end; None: it is never stopped |
    | trust | False | of a frame only; may the code in an opponent's ``.zip`` run? |
    | action | "box" | or "discrete": one number means a pot, speed, side and top, the aim solved; ``snooker_env.tasks.discrete_actions`` |
    | aim | "absolute" | or "target" |
    | observation | "flat" | or "balls" |
    | noise | "none" | "professional", "amateur", "club", "robot", "olympiad", or a dict of ``snooker_env.tasks.noise.Noise`` |
    | reward | "points" | see Rewards |
    | elevation, placement | False | longer actions |
    | physics | "paper" | "match", or a dict of overrides of ``snooker_env.Physics`` (not R) |
    | table | "match" | or "tight", or a ``Table`` of your own whose noses are where theirs are |
    | fidelity | "standard" | "fast", "reference", "euler:N" |
    | options | None | an ``Options`` that holds all of the above, in place of them |
    | render_mode | None | "human", "rgb_array", "ansi": see Pictures and films |
    | render_size | (1920, 1080) | width and height of pictures [pixels] |

    ## Info
    Always the same keys: ``points``, ``break``, ``seconds`` (float; the shot's duration), ``foul`` (bool), ``penalty``, ``pots``,
    ``fouls`` (bits of ``snooker_env.game.ruling.Foul``), ``first_ball`` (-1: none), ``ball_on`` (what was on, a ``BallOn``),
    ``events`` (int). In a frame they tell of the agent's own stroke, and there are ``score``, ``opponent_score`` (float),
    ``strokes`` (of both players so far), ``opponent_strokes`` (of this step), ``winner`` (-1, 0 the agent, 1), ``choice``, ``free_ball``,
    ``needs_snookers``.

    ## States
    ``state = env.unwrapped.get_state()`` is everything between two shots as JSON types, ``reset(options={"state": state})`` starts from it.
    It holds the random numbers too: played on again, the same actions meet the same errors of ``noise`` (and of an opponent). With a seed,
    ``reset(seed=..., options={"state": state})``, table and game are those of the state and the random numbers those of the seed: other
    seeds, other errors. A state that is not sound is refused, with nothing changed.

    ``reset(options={"position": position})`` starts from a ``snooker_env.Position``, checked on this environment's table: balls, what is
    on, in hand and points are the position's; the random numbers are the seed's, or go on. In a frame the agent is to play it: a break of
    its points so far, both scores 0.

    ## Pictures and films
    ``render()`` gives the table with the paths of the last stroke and a score bar. ``RecordVideo`` and ``vector.RecordVideo`` of Gymnasium
    and ``VecVideoRecorder`` of Stable-Baselines3, in the same process, get the motion of every stroke of a step at ``render_fps`` (30 a
    second, in real time): ``render()`` knows when a recorder asks. They keep all pictures in memory, 6 MB each at the usual size:
    ``render_size=(960, 540)`` takes a quarter, ``sn.RecordReplay`` none. "human" raises RuntimeError where there is no display.

    ## Version history
    v0: first version. Results of package versions 0.1 and 0.2 do not compare: the pockets, the cushions of "match" and the levels of noise
    moved (CHANGELOG.md).
    ## References
    S. Mathavan, M. R. Jackson, R. M. Parkin: Numerical simulations of the frictional collisions of solid balls on a rough surface, Sports
    Engineering 17 (2014); A theoretical analysis of billiard ball dynamics under cushion impacts, Proc. IMechE C 224 (2010). Rules: WPBSA,
    May 2022.
    """

    metadata: dict[str, Any] = {"render_modes": list(MODES), "render_fps": FPS}  # noqa: RUF012 - Gymnasium's own convention

    def __init__(
        self, options: Options | None = None, *, render_mode: RenderMode | None = None, render_size: Sequence[int] = SIZE, **given: Any
    ):
        self.options: Options = options_of(options, given)
        self.tables: Tables = TABLES[self.options.task](self.options.rules, 1)
        """The one table: ``tasks.tables.Tables``."""
        self.action_space: Any = self.options.rules.actions.space
        self.observation_space: Any = observations.space(self.options.observation, frame=self.options.task == "frame")
        if render_mode is not None:
            choice("render_mode", render_mode, self.metadata["render_modes"])
        self.render_mode = render_mode
        names = (("Agent",), ("Agent", "Opponent"))[self.options.task == "frame"]
        self._pictures = Pictures(self.options.rules.table, render_mode, render_size, names)
        self._record, self._seeded = Record(full=render_mode is not None), False

    # the state of the table ------------------------------------------------------------------------------------------------

    @property
    def positions(self) -> Floats:
        """Where the balls lie: (22, 2) [m]."""
        return self.tables.positions[0].copy()

    @property
    def on_table(self) -> Bools:
        """Which balls are on the table: (22,) bool."""
        return self.tables.on_table[0].copy()

    @property
    def ball_on(self) -> BallOn:
        """What is on, a ``BallOn``."""
        return BallOn(self.tables.game[0, BALL_ON])

    @property
    def in_hand(self) -> bool:
        """Whether the cue ball is in hand."""
        return bool(self.tables.game[0, IN_HAND])

    @property
    def points(self) -> int:
        """Points of the visit so far; in a frame of the striker's."""
        return int(self.tables.game[0, POINTS])

    @property
    def over(self) -> bool:
        """Whether the visit or frame has ended, stopped by the referee too, or not yet begun."""
        return bool(self.tables.ended()[0])

    @property
    def on(self) -> int:
        """Mask of the balls that may be struck first, bit i for ball i."""
        return self.tables.on(0)

    @property
    def frame(self) -> Frame | None:
        """The ``snooker_env.game.frame.Frame`` that is played; None in a visit."""
        return self.tables.frame(0) if isinstance(self.tables, Frames) else None

    @property
    def physics(self) -> Physics:
        """The ``Physics`` it is played by."""
        return self.options.rules.physics

    @property
    def table(self) -> Table:
        """The ``Table`` it is played on."""
        return self.options.rules.table

    @property
    def noise(self) -> Noise:
        """The ``Noise`` of its strokes."""
        return self.options.rules.noise

    def get_state(self) -> dict[str, Any]:
        """The whole state between two shots: table, game and random numbers. ``set_state`` brings it back exactly.

        Returns
        -------
        dict
            Of JSON types. In a visit: "positions" (22, 2) [m], "on_table" (22,), "ball_on", "in_hand", "points", "over", "stream", "rng";
            in a frame: "positions", "on_table", "frame" (``Frame.to_dict``), "strokes", "stream", "rng".

        Examples
        --------
        >>> import snooker_env as sn
        >>> env = sn.SnookerEnv()
        >>> _ = env.reset(seed=1)
        >>> state = env.get_state()
        >>> first = env.step([0.0, 0.0, 0.0, 0.5])[0]
        >>> env.set_state(state)
        >>> bool((env.step([0.0, 0.0, 0.0, 0.5])[0] == first).all())
        True
        """
        return self.tables.get_state(0) | {"rng": self.np_random.bit_generator.state}

    def set_state(self, state: dict[str, Any]) -> None:
        """Take over a state; the next shot plays on identically.

        Parameters
        ----------
        state : dict
            As ``get_state`` gives it.

        Returns
        -------
        None

        Raises
        ------
        ValueError
            If it is not sound; then nothing has changed.
        """
        self._take(Start(state=self.tables.checked(state, self.np_random)), seed=None)
        self._record.begin_episode()

    def _take(self, start: Start, *, seed: int | None) -> None:
        """Begin from there; the random numbers that come with a state are taken over unless there is a seed."""
        rng = start.take(self.tables, 0)
        if rng is not None and seed is None:
            self.np_random.bit_generator.state, self._np_random_seed = rng, -1  # Gymnasium's number for "not from a seed"
            self._seeded = True

    # Gymnasium's interface -------------------------------------------------------------------------------------------------

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Observation, dict[str, Any]]:
        """A new visit or frame.

        Parameters
        ----------
        seed : int, optional
            Of all random numbers to come; None: they go on.
        options : dict, optional
            {"state": a state of ``get_state``} or {"position": a ``snooker_env.Position``, or its ``to_dict()``} starts from there; see
            States.

        Returns
        -------
        observation : float32 (k,) or dict
            See Observation space.
        info : dict
            See Info.

        Raises
        ------
        ValueError
            For other options, or a state or position that is not sound here or has no shot left.

        Examples
        --------
        >>> import snooker_env as sn
        >>> observation, info = sn.SnookerEnv().reset(seed=1)
        >>> observation.shape, info["points"]
        ((121,), 0.0)
        """
        check = lambda state: self.tables.checked(state, self.np_random, to_play=True)  # noqa: E731
        start = start_of(given_of(options, ONE), self.tables, check)
        super().reset(seed=seed)
        if start is not None:
            self._take(start, seed=seed)
        if seed is not None or not self._seeded:
            self.tables.seed(0, self.np_random)
            self._seeded = True
        self._record.begin_episode()
        out = self.tables.output()
        self.tables.reset(np.array([start is None]), out, self._crew())
        if self.render_mode == "human":
            self._show()
        return observations.shaped(self.options.observation, out.observations[0]), self.tables.info(out, 0)

    def step(self, action: Action) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Play one shot; in a frame also all that the opponent plays after it.

        Parameters
        ----------
        action : array_like, float (k,), or int
            Within [-1, 1]; with ``action="discrete"`` a choice.

        Returns
        -------
        observation : float32 (k,) or dict
            See Observation space.
        reward : float
            See Rewards.
        terminated, truncated : bool
            See Episode end.
        info : dict
            See Info.

        Raises
        ------
        ValueError
            If the action is not in the action space; then nothing is played.
        gymnasium.error.ResetNeeded
            If the episode is over or has not begun.
        SimulationError
            If a shot cannot be computed; the balls are left as they lay, but for a cue ball that was placed.

        Examples
        --------
        >>> import snooker_env as sn
        >>> env = sn.SnookerEnv(aim="target")
        >>> _ = env.reset(seed=1)
        >>> observation, reward, terminated, truncated, info = env.step([0.2, 0.0, 0.0, 0.0])
        >>> observation.shape, truncated
        ((121,), False)
        """
        a = self.options.rules.actions.check(action)
        tables = self.tables
        if tables.ended()[0]:
            raise gymnasium.error.ResetNeeded(f"the {self.options.task} is over: call reset() before step()")
        out = tables.output()
        self._record.begin_step()
        try:
            tables.step(np.array([a]), np.zeros(1, np.bool_), out, self._crew())
        except BaseException:
            tables.interrupted()
            raise
        observation = observations.shaped(self.options.observation, out.observations[0])
        return observation, float(out.rewards[0]), bool(out.terminated[0]), bool(out.truncated[0]), tables.info(out, 0)

    def action_masks(self) -> Bools:
        """With ``action="discrete"``: which choices there are, as sb3-contrib's maskable algorithms ask for them.

        Returns
        -------
        bool (n,)

        Raises
        ------
        ValueError
            With ``action="box"``.
        """
        if not isinstance(self.options.rules.actions, Choices):
            raise refuse("action", "box", 'must be "discrete": a Box has no masks')
        return self.tables.action_masks()[0]

    def _crew(self) -> Crew:
        return Crew(self._record.buffers, (self.np_random,), self._watch)

    def _watch(self, k: int, buffers: ShotBuffers, j: int, own: bool) -> None:
        """Called after each stroke of either player."""
        self._record.saw(self.tables, k, buffers, j, own)
        if self.render_mode == "human":
            self._show(played=True)

    def render(self) -> Picture:
        """The table with the paths of the last shot; to a recorder the motion of the strokes, see Pictures and films.

        Returns
        -------
        uint8 (H, W, 3), str or None
            By the render mode: "rgb_array", "ansi", another.
        """
        return self._pictures.render(self.tables, 0, self._record.strokes, self._record.recent())

    def close(self) -> None:
        """Close the window, if there is one."""
        self._pictures.close()

    def _show(self, *, played: bool = False) -> None:
        self._pictures.show(self.tables, self._record.strokes, played=played)
