"""What is ``Snooker-v0``? The Gymnasium environment: composes action, noise, strike, engine, referee, observation and reward."""

from typing import Any

import gymnasium
import numpy as np

from .._check import choice, refuse, truth
from ..game.balls import REDS_MASK, BallOn, balls_on
from ..tasks import observations
from ..tasks.discrete_actions import Choices
from ..tasks.frame import AGENT, FrameTask
from ..tasks.frame_table import MAX_STROKES
from ..tasks.rewards import REWARDS
from ..tasks.states import checked
from ..tasks.stroke import mask, shooter_of
from ..tasks.table_fit import fitted
from ..tasks.visit import BALL_ON, IN_HAND, OVER, POINTS, Returned, Rules, Visits, Work
from .pictures import FPS, MODES, Pictures

TASKS = ("visit", "frame")
FRAME_ONLY = {"opponent": "none", "trust": False, "miss": "off", "decision": False, "max_strokes": MAX_STROKES}
"""Arguments that mean something in the frame task only, and the values that they must have in a visit."""
LAYOUTS = {"visit": "opened", "frame": "break_off"}
"""What layout="default" is in each task."""


def visit_only(reward, **frame_only):
    """Raise ValueError unless these arguments make sense in a visit; ``frame_only``: those that ``FRAME_ONLY`` names."""
    choice("reward", reward, REWARDS)
    for name, value in frame_only.items():
        usual = FRAME_ONLY[name]
        if not isinstance(value, (type(usual), np.bool_)) or value != usual:
            raise refuse(name, value, f'must be {usual!r} with task="visit"; it belongs to task="frame"')


class SnookerEnv(gymnasium.Env):
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
    | opponent, miss, decision | "none", "off", False | of a frame only; miss: "off" or "clear_path" (``snooker_env.game.frame``) |
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
    | render_mode | None | "human", "rgb_array", "ansi" |

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

    ## Version history
    v0: first version. Results of package versions 0.1 and 0.2 do not compare: the pockets, the cushions of "match" and the levels of noise
    moved (CHANGELOG.md).

    ## References
    S. Mathavan, M. R. Jackson, R. M. Parkin: Numerical simulations of the frictional collisions of solid balls on a rough surface, Sports
    Engineering 17 (2014); A theoretical analysis of billiard ball dynamics under cushion impacts, Proc. IMechE C 224 (2010). Rules: WPBSA,
    May 2022.
    """

    metadata = {"render_modes": list(MODES), "render_fps": FPS}  # noqa: RUF012 - Gymnasium's own convention

    def __init__(
        self, *, task="visit", layout="default", action="box", aim="absolute", observation="flat", noise="none", reward="points",
        elevation=False, placement=False, physics="paper", table="match", fidelity="standard", render_mode=None, opponent="none",
        miss="off", decision=False, max_strokes=MAX_STROKES, trust=False,
    ):  # fmt: skip
        whole = choice("task", task, TASKS) == "frame"
        layout = LAYOUTS[task] if isinstance(layout, str) and layout == "default" else layout
        self.layout, self.observation, self.reward = layout, observation, reward
        self.shooter = shooter_of(aim, elevation, placement, decision, noise, physics, table, fidelity, action)
        self._plan = fitted(layout, self.shooter.table)
        self.actions, self.noise, self.physics = self.shooter.actions, self.shooter.noise, self.shooter.physics
        self.table, self.fidelity = self.shooter.table, self.shooter.fidelity
        self.action_space = self.actions.space
        self.observation_space = observations.space(observation, frame=whole)
        self.frames: Any = None
        """The ``FrameTask``; None in a visit."""
        self.visits: Any = None
        """The ``Visits`` of one table; None in a frame."""
        self._unbegun = True
        if whole and action == "discrete":
            raise refuse("action", action, 'must be "box" with task="frame"')
        if whole:
            self.frames = FrameTask(
                self.shooter, opponent=opponent, trust=trust, miss=miss, reward=reward, observation=observation, max_strokes=max_strokes
            )
        else:
            visit_only(reward, opponent=opponent, trust=truth("trust", trust), miss=miss, decision=decision, max_strokes=max_strokes)
            self.visits = Visits(Rules(self.shooter, self._plan, reward), 1)
            self._work, self._seeded = Work(1, path=render_mode is not None), False
        if render_mode is not None:
            choice("render_mode", render_mode, self.metadata["render_modes"])
        self.render_mode = render_mode
        self._pictures = Pictures(self.table, render_mode)
        self.last_shot = None
        """The ``Shot`` of the last step, with its path when a render mode is set; None before the first."""

    # the state of the table ------------------------------------------------------------------------------------------------

    @property
    def positions(self):
        """Where the balls lie: (22, 2) [m]."""
        return self.frames.table.positions if self.visits is None else self.visits.positions[0].copy()

    @property
    def on_table(self):
        """Which balls are on the table: (22,) bool."""
        return self.frames.table.on_table if self.visits is None else self.visits.on_table[0].copy()

    @property
    def ball_on(self):
        """What is on, a ``BallOn``."""
        return self.frames.table.frame.ball_on if self.visits is None else BallOn(self.visits.game[0, BALL_ON])

    @property
    def in_hand(self):
        """Whether the cue ball is in hand."""
        return self.frames.table.frame.in_hand if self.visits is None else bool(self.visits.game[0, IN_HAND])

    @property
    def points(self):
        """Points of the visit so far."""
        return self.frames.table.frame.break_points if self.visits is None else int(self.visits.game[0, POINTS])

    @property
    def over(self):
        """Whether the visit or frame has ended, stopped by the referee too, or not yet begun."""
        return self._unbegun or self.frames.table.ended if self.visits is None else bool(self.visits.game[0, OVER])

    @property
    def on(self):
        """Mask of the balls on, bit i for ball i."""
        return balls_on(self.ball_on, mask(self.on_table)) if self.frames is None else self.frames.table.on

    def get_state(self):
        """The whole state as JSON types: table, game and random numbers. ``set_state`` brings it back exactly."""
        table = self.frames.table.get_state() if self.visits is None else self.visits.get_state(0)
        return table | {"rng": self.np_random.bit_generator.state}

    def set_state(self, state):
        """Take over a state from ``get_state``; the next shot plays on identically. ValueError if it is not sound, with nothing changed."""
        self._take(self._checked(state), seed=None)

    def _checked(self, state, *, to_play=False):
        """The ``State`` or ``FrameState`` that it is; ValueError if it is not sound, or if it is ``to_play`` and there is no shot left."""
        if self.visits is None:
            return self.frames.checked(state, self.np_random, to_play=to_play)
        return checked(state, self.table, self.physics.R, self.np_random, to_play=to_play)

    def _take(self, sound, *, seed):
        """Take over a sound state; with a seed the random numbers are not the state's but those of ``np_random``."""
        if seed is None:
            self.np_random.bit_generator.state, self._np_random_seed = sound.rng, -1  # Gymnasium's number for "not from a seed"
        if self.visits is None:
            self.frames.take(sound)
            self._unbegun = False
            return
        self.visits.set_state(0, sound)
        if seed is not None:
            self.visits.seed(0, self.np_random)
        self._seeded = True

    # Gymnasium's interface -------------------------------------------------------------------------------------------------

    def reset(self, *, seed=None, options=None):
        """A new visit or frame. options: None or {"state": a state of ``get_state``}; with a seed too, see States."""
        if options is not None and not isinstance(options, dict):
            raise refuse("options", options, 'must be None or {"state": ...}')
        for key in options or {}:
            choice("options", key, ("state",))
        sound = self._checked(options["state"], to_play=True) if options else None
        super().reset(seed=seed)
        if sound is not None:
            self._take(sound, seed=seed)
        self.last_shot = None
        if self.visits is None:
            observation, info = self._reset_frame(sound is None)
        else:
            observation, info = self._reset_visit(sound is None, seed)
        if self.render_mode == "human":
            self._show()
        return observation, info

    def _reset_visit(self, fresh, seed):
        if fresh and (seed is not None or not self._seeded):
            self.visits.seed(0, self.np_random)
            self._seeded = True
        out = Returned(1)
        self.visits.begin(np.array([fresh]), out, others=True)
        return observations.shaped(self.observation, out.observations[0]), out.info(0)

    def _reset_frame(self, fresh):
        if fresh:
            self._unbegun = True  # until the opponent has played, if it is he who breaks
            self.frames.start(self._plan, self.np_random, self._watch if self.render_mode is not None else None)
            self._unbegun = False
        return self.frames.observe(), self._frame_info(None)

    def step(self, action):
        """Play one shot. ValueError if the action is not finite and within [-1, 1]."""
        a = self.actions.check(action)
        if self.over:
            raise gymnasium.error.ResetNeeded(f"the {'visit' if self.frames is None else 'frame'} is over: call reset() before step()")
        return self._visit_step(a) if self.frames is None else self._frame_step(a)

    def action_masks(self):
        """With ``action="discrete"``: which choices there are, bool (n,), as sb3-contrib's maskable algorithms ask for them."""
        if self.frames is not None or not isinstance(self.actions, Choices):
            raise refuse("action", "box", 'must be "discrete": a Box has no masks')
        return self.visits.action_masks()[0]

    def _visit_step(self, a):
        out = Returned(1)
        self.visits.play(np.array([a]), np.zeros(1, np.bool_), out, self._work)
        self.last_shot = (self._work.enlarged or self._work).shot(0, self.physics)
        if self.render_mode == "human":
            self._show(film=True)
        observation = observations.shaped(self.observation, out.observations[0])
        return observation, float(out.rewards[0]), bool(out.terminated[0]), False, out.info(0)

    def _frame_step(self, a):
        try:
            reward, played = self.frames.step(a, self.np_random, self._watch if self.render_mode is not None else None)
        except BaseException:
            self._unbegun = self.frames.table.frame.striker != AGENT  # the next action would be played for the opponent
            raise
        if played is not None and self.render_mode is None:
            self.last_shot = played.shot
        table = self.frames.table
        return self.frames.observe(), reward, table.over, table.stopped, self._frame_info(played)

    def _watch(self, shot):
        """Called after each stroke of a frame, of either player, when there is something to see."""
        self.last_shot = shot
        if self.render_mode == "human":
            self._show(film=True)

    def render(self):
        """The table with the cue ball's last path: uint8 (H, W, 3) for "rgb_array", str for "ansi", None otherwise."""
        return self._pictures.render(self.positions, self.on_table, self.last_shot, self._text())

    def close(self):
        """Close the window, if there is one."""
        self._pictures.close()

    def _frame_info(self, played):
        """What a step of a frame tells: of the agent's own stroke, if there was one, and of the frame; always the same keys."""
        info = {
            "points": 0.0, "break": float(self.points), "foul": False, "penalty": 0, "pots": 0, "fouls": 0, "ball_on": int(self.ball_on),
            "first_ball": -1, "events": 0, "seconds": 0.0,
        }  # fmt: skip
        if played is not None:
            stroke, verdict, shot = played.stroke, played.verdict, played.shot
            info |= {
                "points": float(verdict.points), "foul": bool(verdict.fouls), "penalty": int(verdict.penalty),
                "pots": (stroke.potted & ~1).bit_count(), "fouls": int(verdict.fouls), "ball_on": int(played.ball_on),
                "first_ball": (stroke.first & -stroke.first).bit_length() - 1, "events": len(shot.events), "seconds": shot.duration,
            }  # fmt: skip
        return info | self.frames.info()

    # pictures --------------------------------------------------------------------------------------------------------------

    def _text(self):
        if self.frames is not None:
            return self.frames.text()
        reds = (mask(self.on_table) & REDS_MASK).bit_count()
        return f"break {self.points}   on: {self.ball_on.name.lower().replace('_', ' ')}   reds: {reds}"

    def _show(self, *, film=False):
        self._pictures.show(self.positions, self.on_table, self.last_shot, self._text(), film=film)
