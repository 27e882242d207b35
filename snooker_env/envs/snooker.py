"""What is ``Snooker-v0``? The Gymnasium environment: composes action, noise, strike, engine, referee,
observation and reward."""

from collections.abc import Sequence
from inspect import cleandoc
from typing import Any

import gymnasium
import numpy as np

from .._check import choice, refuse
from .._types import Action, Bools, Observation, RenderMode
from ..tasks import observations
from ..tasks.discrete_actions import Choices
from ..tasks.options import Options, observation_space_of, options_table
from ..tasks.stroke import ShotBuffers
from ..tasks.tables import Crew, StepOutput, Tables
from .one_table import OneTable
from .opponents import game_of, tables_of
from .pictures import FPS, MODES, SIZE, Picture, Pictures
from .record import HasHistory, Record
from .reset_options import ONE, breakers_of, given_of, start_of


class SnookerEnv(OneTable, HasHistory, gymnasium.Env[Any, Any]):
    """Shot selection in snooker: one step is one whole shot.

    ## Description The agent plays a visit to the table. In each step it strikes the cue ball once. The shot
    is simulated until all balls rest, the referee judges it, colours are respotted, and the agent observes
    the new table. The goal is a high break: a red, then a colour, and so on, finally the colours in order.
    The physics is an exact event-driven engine with frictional impacts (see References).

    With ``task="frame"`` the agent plays a whole frame against ``opponent``, with scores, fouls and free
    balls. One step is one stroke of the agent and all strokes of the opponent after it. The seed determines
    who breaks off. ``task="match"`` is the best of ``frames`` frames, in which they break in turn; what is
    said of a frame holds for it, too.

    | opponent | plays |
    |---|---|
    | "none" | nobody: the agent plays on from its own misses and fouls; penalties go to the other score |
    | "random" | uniformly random actions of this environment's own action space, as an untrained agent |
    | "ghost_ball" | the geometric player: the widest direct pot, as softly as possible |
    | another name | what ``snooker_env.player`` takes: "search", "planner_500", "MODULE:CLASS", "program:COMMAND", a run's folder |
    | a path to a ``.zip`` | a model of Stable-Baselines3 or sb3-contrib. Its pickled code runs when it is loaded: it needs ``trust=True`` |
    | a player | an object with ``at(rules)`` and ``play(positions, seeds)``, or with ``act(observations, masks, seeds)`` |
    | a callable | ``opponent(observation, rng) -> action``, in this environment's spaces, from its own side of the table |
    | a ``tasks.OpponentPool`` | one of several, drawn for each frame. More about all of them: docs/environment/opponents.md |

    ## Action space ``action="box"`` (default): ``Box(-1, 1, (4,), float32)``, or longer with the options in
    the last column. All components are linear.

    | component | -1 | +1 | present with |
    |---|---|---|---|
    | cue speed | 0.2 m/s | 7.0 m/s | always |
    | side: tip offset over R | 0.5 to the left | 0.5 to the right | always |
    | top: tip offset over R | 0.5 below the middle | 0.5 above the middle | always |
    | aim, ``aim="absolute"`` | -180 deg from +x | +180 deg, anticlockwise | always |
    | aim, ``aim="target"`` | 3 deg right of the target line | 3 deg left of it | always |
    | elevation of the cue | 0 deg | 30 deg | ``elevation=True`` |
    | place: across the D | 0.292 m to the left (-x) | 0.292 m to the right (+x) | ``placement=True`` |
    | place: back in the D | on the baulk line | on the edge of the D | ``placement=True`` |
    | nomination | yellow | black | ``nominate=True`` |
    | decision after a foul | the offender plays again | the balls are replaced, he plays again | ``decision=True`` |
    | declaration | concedes | claims the frame | ``concede``, ``claim``, ``lot`` |

    A tip offset outside the disc of radius 0.5 R (the miscue limit) is moved to its edge. The aim is the
    direction in which the cue ball leaves without noise: squirt is compensated. The target line is that of
    the widest direct pot or, without one, of what is seen of a ball on, or of an escape over cushions. The
    place counts only when the cue ball is in hand; without it, the cue ball stands at its usual place, 0.18 m
    beside the brown, or near it. The decision counts only in a frame when the opponent has just fouled.
    Between -1/3 and 1/3 the agent plays, with this same action; above 1/3 it does so, too, unless a miss was
    called (``miss``).

    ``action="discrete"``: ``Discrete(540)``. A choice is one of 4 pots, 9 speeds, 3 sides and 5 tops, and the
    aim is solved for it (``snooker_env.tasks.choice_of``). ``action_masks()`` returns the available choices.
    ``nominate=True`` makes them 7 x 540, 540 n + the choice: n = 0 nominates nothing, 1 to 6 yellow to black.
    ``concede``, ``claim`` and ``lot`` each add one choice at the end.

    The nomination counts after a red (the range cut in six) and with a free ball (in seven: first the ball on
    itself); the aim and the pots are then those of the ball nominated. Without ``nominate``, the colour first
    struck is the one nominated; so is the free ball. The declaration concedes below -2/3 and claims above 2/3
    (only the black left, more than 7 ahead); the winner of the lot for a re-spotted black lets the other
    player begin below 0.

    ## Observation space ``observation="flat"`` (default): ``Box(-1.1, 1.1, (121,), float32)``, the 22 rows of
    5 numbers of the table of balls, then the 11 of the state. "balls": ``Dict(balls=(22, 5), state=(11,))``,
    the same numbers. "masked", with ``action="discrete"``: ``Dict(observations=(121,), action_mask=(540,))``,
    the flat ones and ``action_masks()`` as int8 (for RLlib and TorchRL).

    | column of balls | value | entry of state | value |
    |---|---|---|---|
    | x, y | x / 0.889 m, y / 1.7845 m, 0 when off the table; over 1 in a pocket's mouth | reds | reds left / 15 |
    | on_table | 0 or 1 | any_colour, red, yellow .. black | one-hot: the ball on |
    | value | points of the ball / 7 | in_hand | 1 if the cue ball is in hand |
    | ball_on | 1 if it may be struck first | break | points of the visit / 155 |

    Rows: 0 the cue ball, 1 to 15 the reds, 16 to 21 yellow, green, brown, blue, pink, black. Table frame: the
    origin is the table's centre, +x points to the yellow side and +y to the black end.

    ``task="frame"`` appends 19 numbers to the state, so that the shapes are ``(140,)`` and ``(30,)``. With a
    miss rule, the layout that "replace" restores follows: 66 more numbers, or "replaced" (22, 3), the x, y
    and on_table of each ball; 0 unless a miss was called.

    | entry | value |
    |---|---|
    | score, opponent_score | s / (s + 147) |
    | lead | d / (abs(d) + 147) |
    | available | points on the table / 155 |
    | to_play, free_ball | 1 if it is the observer's turn; 1 if the striker has a free ball: "ball_on" is then 1 for every colour too |
    | choice, miss_called | 1 if the other player has just fouled: a decision is open; 1 if that foul was called a miss |
    | respotted_black, broke | 1 if the black was re-spotted; 1 if the observer broke off in this frame |
    | failures, warned | failures in succession from one position / 2; 1 if the next one loses the frame |
    | in_lot | 1 if the winner of the lot has to say who begins |
    | frames_won, opponent_frames, frames_needed | f / (f + 1), of a match: frames won by each, and those that win it |
    | clock, misses, anywhere | 0 in snooker |

    ## Rewards
    | task | reward | value of a step |
    |---|---|---|
    | "visit" | "points" (default) | the points of the stroke, in [0, 15]; 0 for a miss or a foul |
    | "visit" | "points_and_fouls" | the same minus the penalty of a foul (4 to 7), in [-7, 15] |
    | "visit" | "pots" | 1 for a scoring stroke, else 0 |
    | "visit" | "legal" | 1 for a stroke without a foul, else 0 |
    | "frame", "match" | "points" (default) | the agent's points minus the opponent's since the last reward, penalties included |
    | "frame", "match" | "win" | +1 or -1 when the frame or match ends, else 0 |
    | "match" | "frames" | frames won minus frames lost since the last reward: the first one includes the opponent's opening visit |

    ## Starting state
    | layout | table |
    |---|---|
    | "opened" (default of a visit), "held_out" | after simulated play: all 22 balls, reds spread; such that "opened" never deals |
    | "break_off" (default of a frame) | the rack, cue ball in hand |
    | "line_up", "colours" | the line-up exercise; the six colours on their spots |
    | "random:N", "snookered" | N reds at random places; no straight path to any red |
    | "pots:easy", "pots:medium", "pots:hard" | one red alone, by difficulty |

    ## Episode end A visit is terminated by the first stroke that pots nothing, by a foul, or by a clearance;
    with ``one_stroke=True``, by any stroke. It is never truncated by itself (``gymnasium.make(...,
    max_episode_steps=N)`` does that).

    A frame is terminated by its end under the rules. It is truncated, without a winner, after the last of
    ``max_strokes`` strokes of both players together; so is its match. A frame that ends in the opponent's
    opening visit is not dealt again: reset's info shows its end, and the next step plays nothing and reports
    it.

    ## Arguments All but an opponent that is an object are JSON types, so that ``EnvSpec.to_json``
    round-trips. ``Options`` describes each option. ``decision=True`` and the like are another spelling of
    ``says=("decision",)``.

    {options}
    | options | None | an ``Options`` in place of all of the above |
    | render_mode, render_size | None, (1920, 1080) | "human", "rgb_array", "ansi"; width and height [pixels]: see Pictures and films |

    ## Info
    The same keys after every reset and step.

    | key | type | value |
    |---|---|---|
    | points | float | points of the stroke |
    | break | float | points of the visit so far |
    | seconds | float | duration of the shot |
    | foul, fouls | bool, int | whether it was a foul; bits of ``snooker_env.game.ruling.Foul`` |
    | penalty, pots | int | penalty points of a foul; number of balls potted |
    | first_ball | int | id of the ball struck first, -1 for none |
    | ball_on | int | what was on, a ``BallOn`` |
    | events | int | number of events in the shot |

    In a frame these are about the agent's own stroke, and there are more keys: ``score``, ``opponent_score``,
    ``clock`` (float; the last: time played by a clock [s]), ``strokes`` (of both players so far),
    ``opponent_strokes`` (in this step), ``winner`` (-1 for none, 0 the agent, 1 the opponent), ``misses``,
    ``failures`` (int), ``choice``, ``free_ball``, ``needs_snookers``, ``anywhere``, ``warned`` (bool). They
    are of the frame in progress; a match adds ``frames_won``, ``opponent_frames`` and ``frame`` (from 0).

    ## States ``env.unwrapped.get_state()`` returns everything between two shots as JSON types, and
    ``reset(options={"state": state})`` starts from it. A state holds the random stream: the same actions then
    meet the same execution errors (and the same opponent). With a seed as well, table and game are those of
    the state, the random numbers those of the seed. An invalid state is refused; nothing changes.

    ``reset(options={"position": position})`` starts from a ``snooker_env.Position``, validated on this
    environment's table. Balls, ball on, in hand and points are the position's; the random stream goes on, or
    is that of the seed. In a frame it is the agent's turn, with a break of the position's points so far; both
    scores are 0.

    ## Pictures and films ``render()`` returns the table with the paths of the last stroke and a score bar.
    ``RecordVideo`` and ``vector.RecordVideo`` of Gymnasium and ``VecVideoRecorder`` of Stable-Baselines3, in
    the same process, get the motion of every stroke of a step, at ``render_fps`` (30 a second, in real time).
    They keep all pictures in memory, 6 MB each at the default size: ``render_size=(960, 540)`` takes a
    quarter, ``sn.RecordReplay`` none. "human" raises RuntimeError at the first stroke without a display.

    ## Version history
    v0: first version. Results of package versions 0.1 and 0.2 are not comparable (CHANGELOG.md).

    ## References
    * S. Mathavan, M. R. Jackson, R. M. Parkin: Numerical simulations of the frictional collisions of solid
      balls on a rough surface (2014).
    * S. Mathavan, M. R. Jackson, R. M. Parkin: A theoretical analysis of billiard ball dynamics under cushion
      impacts (2010).
    * WPBSA: Official Rules of the Games of Snooker and English Billiards, May 2022.

    Parameters
    ----------
    options : Options, optional
        All options as one object. Default None: they are made from the keywords.
    render_mode : {"human", "rgb_array", "ansi"}, optional
        How ``render`` shows the table; default None: not at all.
    render_size : (int, int), optional
        Width and height of pictures [pixels], each in [100, 8192]; default (1920, 1080).
    **given
        The options as keywords, in place of ``options``, see Arguments.

    Raises
    ------
    ValueError
        If an argument is invalid.
    TypeError
        For an unknown keyword.

    Examples
    --------
    >>> import gymnasium
    >>> import snooker_env
    >>> env = gymnasium.make("Snooker-v0", aim="target", noise="club")
    >>> observation, info = env.reset(seed=1)
    >>> observation, reward, terminated, truncated, info = env.step([0.2, 0.0, 0.0, 0.0])
    >>> observation.shape, sorted(info)[:3]
    ((121,), ['ball_on', 'break', 'events'])
    """

    metadata: dict[str, Any] = {"render_modes": list(MODES), "render_fps": FPS}  # noqa: RUF012 - Gymnasium's own convention

    def __init__(
        self,
        options: Options | None = None,
        *,
        render_mode: RenderMode | None = None,
        render_size: Sequence[int] = SIZE,
        **given: Any,
    ):
        game, opponent = game_of(options, given)
        self._set_up(game, tables_of(game, opponent, 1), render_mode, render_size)

    def _set_up(
        self, game: Options, tables: Tables, render_mode: RenderMode | None, render_size: Sequence[int]
    ) -> None:
        self.options: Options = game
        self.tables: Tables = tables
        """The one table: ``tasks.tables.Tables``."""
        self.action_space: Any = self.options.rules.actions.space
        self.observation_space: Any = observation_space_of(self.options)
        if render_mode is not None:
            choice("render_mode", render_mode, self.metadata["render_modes"])
        self.render_mode = render_mode
        names = (("Agent",), ("Agent", "Opponent"))[self.options.task != "visit"]
        self._pictures = Pictures(self.options.rules.table, render_mode, render_size, names)
        self._record, self._seeded = Record(full=render_mode is not None), False

    @classmethod
    def _of(
        cls, game: Options, tables: Tables, render_mode: RenderMode | None, render_size: Sequence[int]
    ) -> "SnookerEnv":
        """An environment of a table that exists."""
        one = cls.__new__(cls)
        one._set_up(game, tables, render_mode, render_size)
        return one

    # Gymnasium's interface
    # --------------------------------------------------------------------------------------------------------

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin a new visit or frame.

        ``seed``: seed of all random numbers from now on; default None: the stream goes on. ``options``:
        "state" or "position": starts from there, see States. "breaker": 0 or 1, the agent or the opponent
        breaks. Returns ``observation``, float32 (k,), or a dict of such arrays, see Observation space and
        ``info``, see Info. ValueError if an option is unknown, or a state or position is invalid or has no
        shot left.
        """
        check = lambda state: self.tables.checked(state, self.np_random, to_play=True)  # noqa: E731
        options = given_of(options, ONE)
        start, breakers = start_of(options, self.tables, check), breakers_of(options, 1, self.options)
        super().reset(seed=seed)
        if start is not None:
            self._take(start, seed=seed)
        if seed is not None or not self._seeded:
            self.tables.seed(0, self.np_random)
            self._seeded = True
        self._record.begin_episode()
        out = self.tables.output()
        self.tables.reset(np.array([start is None]), out, self._crew(), **breakers)
        self._show()
        return self._shaped(out), self.tables.info(out, 0)

    def step(self, action: Action) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Play one shot; in a frame, also all strokes of the opponent after it.

        ``action``: float (k,) within [-1, 1]; with ``action="discrete"`` a choice. Returns ``observation``,
        float32 (k,), or a dict of such arrays, see Observation space and ``reward``, see Rewards and
        ``terminated, truncated``, see Episode end and ``info``, see Info. ValueError if the action is not in
        the action space; then nothing is played. gymnasium.error.ResetNeeded if the episode is over or has
        not begun. SimulationError if a shot cannot be computed. The balls are then left as they lay, except
        for a cue ball that was placed.
        """
        a = self.options.rules.actions.check(action)
        tables = self.tables
        if tables.finished()[0]:
            raise gymnasium.error.ResetNeeded(
                f"the {self.options.task} {tables.unplayable}: call reset() before step()"
            )
        self._pictures.require_display()
        out = tables.output()
        self._record.begin_step()
        try:
            tables.step(np.array([a]), np.zeros(1, np.bool_), out, self._crew())
        except BaseException:
            tables.interrupted()
            raise
        return (
            self._shaped(out),
            float(out.rewards[0]),
            bool(out.terminated[0]),
            bool(out.truncated[0]),
            tables.info(out, 0),
        )

    def action_masks(self) -> Bools:
        """Return the available choices of ``action="discrete"``; sb3-contrib calls this method.

        Returns bool (540,). ValueError with ``action="box"``.
        """
        if not isinstance(self.options.rules.actions, Choices):
            raise refuse("action", "box", 'must be "discrete": a Box has no masks')
        return self.tables.action_masks()[0]

    def _shaped(self, out: StepOutput) -> Observation:
        return observations.shaped(
            self.options.observation, out.observations[0], out.masks[0] if len(out.masks) else None
        )

    def _crew(self) -> Crew:
        return Crew(self._record.buffers, (self.np_random,), self._watch)

    def _watch(self, k: int, buffers: ShotBuffers, j: int, own: bool) -> None:
        """Called after each stroke of either player."""
        self._record.saw(self.tables, k, buffers, j, own)
        self._show(played=True)

    def render(self) -> Picture:
        """Return the table with the paths of the last shot; a recorder gets the motion.

        Returns uint8 (H, W, 3) with "rgb_array", str with "ansi", None otherwise.
        """
        return self._pictures.render(self.tables, 0, self._record.strokes, self._record.recent())

    def close(self) -> None:
        """Close the window, if there is one."""
        self._pictures.close()

    def _show(self, *, played: bool = False) -> None:
        self._pictures.show(self.tables, self._record.strokes, played=played)


SnookerEnv.__doc__ = cleandoc(SnookerEnv.__doc__ or "").replace("{options}", options_table().rstrip())
