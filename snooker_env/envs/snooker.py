"""What is ``Snooker-v0``? The Gymnasium environment: composes action, noise, strike, engine, referee, observation and reward."""

import gymnasium
import numpy as np
from gymnasium import spaces

from .._check import choice, refuse
from ..game.balls import BALL_RADIUS, CUE, N_BALLS, REDS_MASK, TOUCH, BallOn, balls_on, mask_of, next_on
from ..game.in_hand import place_cue
from ..game.layouts import layout as make_layout
from ..game.referee import Situation, Stroke
from ..game.ruling import VisitEnd
from ..game.settle import settle_table
from ..physics import cue
from ..physics.contact import parse_fidelity
from ..physics.engine import EventKind
from ..physics.parameters import Physics
from ..physics.table import Table
from ..simulation import play
from . import observations
from .actions import Actions
from .noise import Noise
from .rewards import REWARDS
from .state import checked

TASKS = ("visit",)

_AT_ONCE = 1e-9  # s; contacts nearer than this are simultaneous


_BITS = 1 << np.arange(N_BALLS)


def _mask(balls):
    """The mask of a bool array (22,)."""
    return int(balls @ _BITS)


class SnookerEnv(gymnasium.Env):
    """Snooker shot selection: one step is one whole shot.

    ## Description
    A visit to the table: the agent plays the cue ball, the shot is simulated to rest (frictional impacts of Mathavan, Jackson & Parkin
    2014 in an exact event-driven engine, cushions of their 2010 model), the referee judges it, colours are respotted, and the agent
    sees the new layout. The aim is a high break: pot a red, then a colour, then a red ..., finally the colours in order.

    ## Action space
    ``Box(-1, 1, (4,), float32)``: cue speed, side spin, top/back spin, aim; see ``snooker_env.envs.actions.Actions`` for every component
    and formula. ``aim="absolute"`` reads the aim as an angle of the full circle, ``aim="target"`` as up to 3 degrees left or right of the
    best potting line. ``elevation=True`` appends the cue's elevation, ``placement=True`` two numbers for the place in the D. After a red,
    the colour first struck is the one nominated.

    ## Observation space
    ``observation="flat"``: ``Box(-1, 1, (121,), float32)``, the 22 rows of five of the table of balls, then eleven state entries.
    ``observation="balls"``: ``Dict(balls=(22, 5), state=(11,))``, the same numbers (SB3: "MultiInputPolicy").

    | balls, one row a ball (0 cue, 1-15 reds, 16-21 yellow to black) | | state | |
    |---|---|---|---|
    | x, y | / 0.889, / 1.7845 m, 0 when off the table | reds | left / 15 |
    | on_table | 0 or 1 | any_colour, red, yellow .. black | one-hot: what is on |
    | value | points / 7 | in_hand | 1 if the cue ball is played from the D |
    | ball_on | 1 if it may be struck first | break | points of the visit / 155 |

    World frame: origin at the table's centre, +x to the yellow side, +y to the black end.

    ## Rewards
    ``reward="points"`` (default): the points of the stroke, 0 for a miss or a foul, in [0, 15]. ``"points_and_fouls"``: less the
    penalty of a foul (4 to 7). ``"pots"``: 1 for a scoring stroke.

    ## Starting state
    ``layout="opened"`` (default): a table opened by real simulated play, all 22 balls on it, reds on; ``"held_out"``: such tables that
    ``"opened"`` never gives; ``"break_off"``, ``"line_up"``, ``"colours"`` (the six on their spots), ``"random:N"`` (N reds sprinkled).

    ## Episode end
    Terminated by the first stroke that pots nothing, by a foul, or by a clearance. Never truncated by itself.

    ## Arguments
    All are JSON types, so that ``EnvSpec.to_json`` round-trips.

    | name | default | what |
    |---|---|---|
    | task | "visit" | build a break until the first miss or foul |
    | layout | "opened" | see Starting state |
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
    ``events`` (int).
    ``reset(options={"state": env.unwrapped.get_state()})`` starts from a saved state.

    ## Version history
    v0: first version.

    ## References
    S. Mathavan, M. R. Jackson, R. M. Parkin: Numerical simulations of the frictional collisions of solid balls on a rough surface, Sports
    Engineering 17 (2014); A theoretical analysis of billiard ball dynamics under cushion impacts, Proc. IMechE C 224 (2010). Rules: WPBSA,
    May 2022.
    """

    metadata = {"render_modes": ["human", "rgb_array", "ansi"], "render_fps": 30}  # noqa: RUF012 - Gymnasium's own convention

    def __init__(
        self, *, task="visit", layout="opened", aim="absolute", observation="flat", noise="none", reward="points", elevation=False,
        placement=False, physics="paper", table="match", fidelity="standard", render_mode=None,
    ):  # fmt: skip
        choice("task", task, TASKS)
        make_layout(layout, np.random.default_rng(0))  # an unknown name fails here and not in reset
        self.layout, self.observation, self.reward = layout, observation, reward
        self.physics, self.table = Physics.of(physics), Table.of(table)
        if self.physics.R != BALL_RADIUS:
            raise refuse("physics.R", self.physics.R, f"must be {BALL_RADIUS} in Snooker-v0: spots, rack and pockets are made for it")
        self.physics.check_stopping()
        if self.table.name == "unbounded":
            raise refuse("table", table, 'must be "match", "tight" or a Table')
        self.fidelity = parse_fidelity(fidelity)
        self.noise = Noise.of(noise)
        self.actions = Actions(aim, elevation, placement, self.physics)
        choice("reward", reward, REWARDS)
        self.action_space = spaces.Box(-1.0, 1.0, (self.actions.size,), np.float32)
        self.observation_space = observations.space(observation)
        if render_mode is not None:
            choice("render_mode", render_mode, self.metadata["render_modes"])
        self.render_mode = render_mode
        self._window = None
        self.last_shot = None
        """The ``Shot`` of the last step, with its path when a render mode is set; None before the first."""
        self.positions = np.zeros((N_BALLS, 2))
        self.on_table = np.zeros(N_BALLS, bool)
        self.ball_on, self.in_hand, self.points, self.over = BallOn.NOTHING, False, 0, True

    # the state of the table ------------------------------------------------------------------------------------------------

    @property
    def on(self):
        """Mask of the balls on, bit i for ball i."""
        return balls_on(self.ball_on, _mask(self.on_table))

    def get_state(self):
        """The whole state as JSON types: table, game and random generator. ``set_state`` brings it back exactly."""
        return {
            "positions": self.positions.tolist(), "on_table": self.on_table.tolist(), "ball_on": int(self.ball_on),
            "in_hand": self.in_hand, "points": self.points, "over": self.over, "rng": self.np_random.bit_generator.state,
        }  # fmt: skip

    def set_state(self, state):
        """Take over a state from ``get_state``; the next shot plays on identically. ValueError if it is not sound."""
        sound = checked(state, self.table, self.physics.R, self.np_random)
        self.positions, self.on_table, self.ball_on, self.in_hand, self.points, self.over, rng = sound
        self.np_random.bit_generator.state = rng

    def __getstate__(self):
        return self.__dict__ | {"_window": None}  # a window belongs to one process

    # Gymnasium's interface -------------------------------------------------------------------------------------------------

    def reset(self, *, seed=None, options=None):
        """A new visit. options: None or {"state": a state of ``get_state``}."""
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
        else:
            self.positions, self.on_table = make_layout(self.layout, self.np_random)
            self.ball_on = BallOn(next_on(_mask(self.on_table)))
            self.in_hand, self.points, self.over = self.layout == "break_off", 0, False
        if self.render_mode == "human":
            self._show()
        return self._observe(), self._no_info()

    def step(self, action):
        """Play one shot. ValueError if the action is not finite and within [-1, 1]."""
        a = self.actions.check(action)
        if self.over:
            raise gymnasium.error.ResetNeeded("the visit is over: call reset() before step()")
        if self.in_hand and self.actions.placement:
            self._place(a)
        intended = self.actions.shot(a, self.positions, self.on_table, self.on)
        speed, side, top, aim, elevation = self.noise.draw(self.np_random, *intended, self.physics.R)
        v, w = cue.strike(speed, aim, *self.actions.tip(side, top), elevation, self.physics)
        shot = self._play(v, w)
        ball_on = self.ball_on
        stroke = self._stroke(shot, speed)
        situation = Situation(on_table=_mask(self.on_table), ball_on=ball_on, lead=self.points)
        verdict, self.positions, self.on_table = settle_table(shot.positions, self.on_table, situation, stroke, jaws=self.table.jaws[:, :3])
        self.ball_on, self.in_hand = verdict.ball_on, verdict.in_hand
        self.points += verdict.points
        self.over = verdict.visit_end != VisitEnd.CONTINUES
        if self.render_mode == "human":
            self._show(shot)
        return self._observe(), REWARDS[self.reward](verdict), bool(self.over), False, self._info(shot, stroke, ball_on, verdict)

    def render(self):
        """The table with the cue ball's last path: uint8 (H, W, 3) for "rgb_array", str for "ansi", None otherwise."""
        if self.render_mode is None:
            gymnasium.logger.warn('render() without render_mode; make the environment with render_mode="rgb_array", "ansi" or "human"')
        if self.render_mode == "rgb_array":
            from ..render.pygame_view import rgb_array

            return rgb_array(self._scene())
        if self.render_mode == "ansi":
            from ..render.ascii_view import ansi

            return ansi(self._scene())
        return None

    def close(self):
        """Close the window, if there is one."""
        if self._window is not None:
            self._window.close()
            self._window = None

    # one shot --------------------------------------------------------------------------------------------------------------

    def _place(self, a):
        """Put the cue ball in hand where the action says; if a ball is in the way, at the nearest free place of the D."""
        self.on_table[CUE] = False
        self.positions[CUE] = place_cue(self.positions, self.on_table, *self.actions.place(a))
        self.on_table[CUE] = True

    def _play(self, v, w):
        velocities, spins = np.zeros((N_BALLS, 2)), np.zeros((N_BALLS, 3))
        velocities[CUE], spins[CUE] = v[:2], w
        path = self.render_mode is not None
        self.last_shot = play(self.positions, velocities, spins, self.on_table, self.physics, self.table, self.fidelity, path=path)
        return self.last_shot

    def _stroke(self, shot, speed):
        """What the referee sees of a shot: first contact, touching balls, pots."""
        gaps = np.hypot(*(self.positions - self.positions[CUE]).T) - 2 * BALL_RADIUS
        touching = _mask(self.on_table & (gaps < TOUCH)) & ~1
        events = shot.events
        hits = events[(events["kind"] == EventKind.BALL_BALL) & (events["i"] == CUE)]
        first = moved = 0
        if len(hits):
            start = hits["time"][0]
            first = mask_of(hits["j"][hits["time"] <= start + _AT_ONCE].tolist())
            # A touching ball that the cue ball is played away from is not struck; one it is played into is struck before the cue ball
            # has gone ten times the gap that still counts as touching.
            moved = touching & first if start * speed <= 10 * TOUCH else 0
        return Stroke(first=first, potted=_mask(shot.potted >= 0), touching=touching, moved=moved)

    def _observe(self):
        return observations.observe(self.observation, self.positions, self.on_table, self.ball_on, self.on, self.in_hand, self.points)

    def _info(self, shot, stroke, ball_on, verdict):
        return {
            "points": float(verdict.points), "break": float(self.points), "foul": bool(verdict.fouls), "penalty": int(verdict.penalty),
            "pots": (stroke.potted & ~1).bit_count(), "fouls": int(verdict.fouls), "ball_on": int(ball_on),
            "first_ball": (stroke.first & -stroke.first).bit_length() - 1, "events": len(shot.events), "seconds": shot.duration,
        }  # fmt: skip

    def _no_info(self):
        """The same keys before any shot."""
        return {
            "points": 0.0, "break": float(self.points), "foul": False, "penalty": 0, "pots": 0, "fouls": 0, "ball_on": int(self.ball_on),
            "first_ball": -1, "events": 0, "seconds": 0.0,
        }  # fmt: skip

    # pictures --------------------------------------------------------------------------------------------------------------

    def _text(self):
        reds = (_mask(self.on_table) & REDS_MASK).bit_count()
        return f"break {self.points}   on: {self.ball_on.name.lower().replace('_', ' ')}   reds: {reds}"

    def _scene(self):
        from ..render.scene import ball_paths, scene

        shot = self.last_shot  # the paths of the cue ball and of what it potted
        paths = None if shot is None else ball_paths(shot, (CUE, *np.flatnonzero(shot.potted[1:] >= 0) + 1))
        return scene(self.table, self.positions, self.on_table, paths=paths, text=self._text())

    def _show(self, shot=None):
        from ..render.pygame_view import Window
        from ..render.scene import shot_scenes

        if self._window is None:
            self._window = Window()
        if shot is not None:
            fps = self.metadata["render_fps"]
            self._window.play(shot_scenes(self.table, shot, fps=fps, speed=2.0, text=self._text()), fps)
        self._window.draw(self._scene())
