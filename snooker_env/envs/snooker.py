"""What is ``Snooker-v0``? The Gymnasium environment: composes action, noise, strike, engine, referee, observation and reward."""

import gymnasium
import numpy as np
from gymnasium import spaces

from .._check import choice, refuse
from ..game.balls import CUE, N_BALLS, REDS_MASK, BallOn, balls_on, next_on
from ..game.in_hand import place_cue
from ..game.layouts import layout as make_layout
from ..game.referee import Situation
from ..game.ruling import VisitEnd
from ..game.settle import settle_table
from . import observations
from .frame_task import FrameTask
from .pictures import FPS, MODES, Pictures
from .rewards import REWARDS
from .shooting import mask, shooter_of, stroke_of
from .state import KEYS, check_keys, check_rng, checked

TASKS = ("visit", "frame")
FRAME_ONLY = {"opponent": "none", "miss": "off", "decision": False}
"""Arguments that mean something in the frame task only, and the values that they must have in a visit."""
LAYOUTS = {"visit": "opened", "frame": "break_off"}
"""What layout="default" is in each task."""


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
    A path to a ``.zip``: a model of Stable-Baselines3 or sb3-contrib, trained on either task with these options.

    ## Action space
    ``Box(-1, 1, (4,), float32)``: cue speed, side spin, top/back spin, aim; see ``snooker_env.envs.actions.Actions`` for every component
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
    Never truncated by itself (``gymnasium.make(..., max_episode_steps=N)`` does). No ball leaves the table: the physics is planar.

    ## Arguments
    All are JSON types (but a callable opponent), so that ``EnvSpec.to_json`` round-trips.

    | name | default | what |
    |---|---|---|
    | task | "visit" | build a break until the first miss or foul; "frame": see Description |
    | layout | "default" | see Starting state |
    | opponent, miss, decision | "none", "off", False | of a frame only; miss: "off" or "clear_path" (``snooker_env.game.frame``) |
    | aim | "absolute" | or "target" |
    | observation | "flat" | or "balls" |
    | noise | "none" | "professional", "amateur", "club", "olympiad", or a dict of ``snooker_env.envs.noise.Noise`` |
    | reward | "points" | see Rewards |
    | elevation, placement | False | longer actions |
    | physics | "paper" | "match", or a dict of overrides of ``snooker_env.Physics`` (not R) |
    | table | "match" | or "tight" |
    | fidelity | "standard" | "fast", "reference", "euler:N" |
    | render_mode | None | "human", "rgb_array", "ansi" |

    ## Info
    Always the same keys: ``points``, ``break``, ``seconds`` (float; the shot's duration), ``foul`` (bool), ``penalty``, ``pots``,
    ``fouls`` (bits of ``snooker_env.game.ruling.Foul``), ``first_ball`` (-1: none), ``ball_on`` (what was on, a ``BallOn``),
    ``events`` (int). In a frame they tell of the agent's own stroke, and there are ``score``, ``opponent_score`` (float),
    ``opponent_strokes``, ``winner`` (-1, 0 the agent, 1), ``choice``, ``free_ball``, ``needs_snookers``.
    ``reset(options={"state": env.unwrapped.get_state()})`` starts from a saved state.

    ## Version history
    v0: first version.

    ## References
    S. Mathavan, M. R. Jackson, R. M. Parkin: Numerical simulations of the frictional collisions of solid balls on a rough surface, Sports
    Engineering 17 (2014); A theoretical analysis of billiard ball dynamics under cushion impacts, Proc. IMechE C 224 (2010). Rules: WPBSA,
    May 2022.
    """

    metadata = {"render_modes": list(MODES), "render_fps": FPS}  # noqa: RUF012 - Gymnasium's own convention

    def __init__(
        self, *, task="visit", layout="default", aim="absolute", observation="flat", noise="none", reward="points", elevation=False,
        placement=False, physics="paper", table="match", fidelity="standard", render_mode=None, opponent="none", miss="off",
        decision=False,
    ):  # fmt: skip
        whole = choice("task", task, TASKS) == "frame"
        layout = LAYOUTS[task] if isinstance(layout, str) and layout == "default" else layout
        make_layout(layout, np.random.default_rng(0))  # an unknown name fails here and not in reset
        self.layout, self.observation, self.reward = layout, observation, reward
        self.shooter = shooter_of(aim, elevation, placement, decision, noise, physics, table, fidelity)
        self.actions, self.noise, self.physics = self.shooter.actions, self.shooter.noise, self.shooter.physics
        self.table, self.fidelity = self.shooter.table, self.shooter.fidelity
        self.action_space = spaces.Box(-1.0, 1.0, (self.actions.size,), np.float32)
        self.observation_space = observations.space(observation, frame=whole)
        self.frames = None
        """The ``FrameTask``; None in a visit."""
        if whole:
            self.frames = FrameTask(self.shooter, opponent=opponent, miss=miss, reward=reward, observation=observation)
        else:
            choice("reward", reward, REWARDS)
            for name, value in (("opponent", opponent), ("miss", miss), ("decision", decision)):
                if value != FRAME_ONLY[name]:
                    raise refuse(name, value, f'must be {FRAME_ONLY[name]!r} with task="visit"; it belongs to task="frame"')
        if render_mode is not None:
            choice("render_mode", render_mode, self.metadata["render_modes"])
        self.render_mode = render_mode
        self._pictures = Pictures(self.table, render_mode)
        self.last_shot = None
        """The ``Shot`` of the last step, with its path when a render mode is set; None before the first."""
        self.positions = np.zeros((N_BALLS, 2))
        self.on_table = np.zeros(N_BALLS, bool)
        self.ball_on, self.in_hand, self.points, self.over = BallOn.NOTHING, False, 0, True

    # the state of the table ------------------------------------------------------------------------------------------------

    @property
    def on(self):
        """Mask of the balls on, bit i for ball i."""
        return balls_on(self.ball_on, mask(self.on_table)) if self.frames is None else self.frames.table.on

    def get_state(self):
        """The whole state as JSON types: table, game and random generator. ``set_state`` brings it back exactly."""
        state = {
            "positions": self.positions.tolist(), "on_table": self.on_table.tolist(), "ball_on": int(self.ball_on),
            "in_hand": self.in_hand, "points": self.points, "over": self.over, "rng": self.np_random.bit_generator.state,
        }  # fmt: skip
        return state if self.frames is None else state | {"frame": self.frames.table.frame.to_dict()}

    def set_state(self, state):
        """Take over a state from ``get_state``; the next shot plays on identically. ValueError if it is not sound."""
        if self.frames is not None:
            check_keys(state, (*KEYS, "frame"))
            check_rng(state["rng"], self.np_random)
            self.frames.table.set_state(state)
            self._take_frame()
            self.np_random.bit_generator.state = state["rng"]
            return
        sound = checked(state, self.table, self.physics.R, self.np_random)
        self.positions, self.on_table, self.ball_on, self.in_hand, self.points, self.over, rng = sound
        self.np_random.bit_generator.state = rng

    def _take_frame(self):
        """Take over from the frame what a visit keeps by itself."""
        assert self.frames is not None
        table = self.frames.table
        self.positions, self.on_table, self.over = table.positions, table.on_table, table.over
        self.ball_on, self.in_hand, self.points = table.frame.ball_on, table.frame.in_hand, table.frame.break_points

    # Gymnasium's interface -------------------------------------------------------------------------------------------------

    def reset(self, *, seed=None, options=None):
        """A new visit or frame. options: None or {"state": a state of ``get_state``}."""
        super().reset(seed=seed)
        if options is not None and not isinstance(options, dict):
            raise refuse("options", options, 'must be None or {"state": ...}')
        for key in options or {}:
            choice("options", key, ("state",))
        self.last_shot = None
        if options and "state" in options:
            self.set_state(options["state"])
            if self.over:
                raise refuse("state.over", True, "must be False: there is no shot to play from this state")
        elif self.frames is not None:
            self.frames.start(self.layout, self.np_random, self._watch if self.render_mode is not None else None)
            self._take_frame()
        else:
            self.positions, self.on_table = make_layout(self.layout, self.np_random)
            self.ball_on = BallOn(next_on(mask(self.on_table)))
            self.in_hand, self.points, self.over = self.layout == "break_off", 0, False
        if self.render_mode == "human":
            self._show()
        return self._observe(), self._no_info()

    def step(self, action):
        """Play one shot. ValueError if the action is not finite and within [-1, 1]."""
        a = self.actions.check(action)
        if self.over:
            raise gymnasium.error.ResetNeeded(f"the {'visit' if self.frames is None else 'frame'} is over: call reset() before step()")
        return self._visit_step(a) if self.frames is None else self._frame_step(a)

    def _visit_step(self, a):
        if self.in_hand and self.actions.placement:
            self._place(a)
        intended = self.actions.shot(a, self.positions, self.on_table, self.on)
        shot = self.shooter.shoot(intended, self.positions, self.on_table, self.np_random, path=self.render_mode is not None)
        self.last_shot = shot
        ball_on = self.ball_on
        stroke = stroke_of(shot, self.positions, self.on_table, intended[0])
        situation = Situation(on_table=mask(self.on_table), ball_on=ball_on, lead=self.points)
        verdict, self.positions, self.on_table = settle_table(shot.positions, self.on_table, situation, stroke, jaws=self.table.jaws[:, :3])
        self.ball_on, self.in_hand = verdict.ball_on, verdict.in_hand
        self.points += verdict.points
        self.over = verdict.visit_end != VisitEnd.CONTINUES
        if self.render_mode == "human":
            self._show(film=True)
        return self._observe(), REWARDS[self.reward](verdict), bool(self.over), False, self._info(shot, stroke, ball_on, verdict)

    def _frame_step(self, a):
        assert self.frames is not None
        reward, played = self.frames.step(a, self.np_random, self._watch if self.render_mode is not None else None)
        self._take_frame()
        if played is None:
            info = self._no_info()
        else:
            self.last_shot = played.shot if self.render_mode is None else self.last_shot
            info = self._info(played.shot, played.stroke, played.ball_on, played.verdict)
        return self._observe(), reward, self.over, False, info

    def _watch(self, shot):
        """Called after each stroke of a frame, of either player, when there is something to see."""
        self.last_shot = shot
        self._take_frame()
        if self.render_mode == "human":
            self._show(film=True)

    def render(self):
        """The table with the cue ball's last path: uint8 (H, W, 3) for "rgb_array", str for "ansi", None otherwise."""
        return self._pictures.render(self.positions, self.on_table, self.last_shot, self._text())

    def close(self):
        """Close the window, if there is one."""
        self._pictures.close()

    # one shot --------------------------------------------------------------------------------------------------------------

    def _place(self, a):
        """Put the cue ball in hand where the action says; if a ball is in the way, at the nearest free place of the D."""
        self.on_table[CUE] = False
        self.positions[CUE] = place_cue(self.positions, self.on_table, *self.actions.place(a))
        self.on_table[CUE] = True

    def _observe(self):
        if self.frames is not None:
            return self.frames.observe()
        return observations.observe(self.observation, self.positions, self.on_table, self.ball_on, self.on, self.in_hand, self.points)

    def _info(self, shot, stroke, ball_on, verdict):
        info = {
            "points": float(verdict.points), "break": float(self.points), "foul": bool(verdict.fouls), "penalty": int(verdict.penalty),
            "pots": (stroke.potted & ~1).bit_count(), "fouls": int(verdict.fouls), "ball_on": int(ball_on),
            "first_ball": (stroke.first & -stroke.first).bit_length() - 1, "events": len(shot.events), "seconds": shot.duration,
        }  # fmt: skip
        return info if self.frames is None else info | self.frames.info()

    def _no_info(self):
        """The same keys before any shot."""
        info = {
            "points": 0.0, "break": float(self.points), "foul": False, "penalty": 0, "pots": 0, "fouls": 0, "ball_on": int(self.ball_on),
            "first_ball": -1, "events": 0, "seconds": 0.0,
        }  # fmt: skip
        return info if self.frames is None else info | self.frames.info()

    # pictures --------------------------------------------------------------------------------------------------------------

    def _text(self):
        if self.frames is not None:
            return self.frames.text()
        reds = (mask(self.on_table) & REDS_MASK).bit_count()
        return f"break {self.points}   on: {self.ball_on.name.lower().replace('_', ' ')}   reds: {reds}"

    def _show(self, *, film=False):
        self._pictures.show(self.positions, self.on_table, self.last_shot, self._text(), film=film)
