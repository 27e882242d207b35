"""How do two agents play a frame against each other? PettingZoo's AEC interface around a ``FrameTable``."""

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.utils import seeding
from pettingzoo import AECEnv

from .._check import choice, refuse
from ..game.layouts import layout as deal
from ..tasks import observations
from ..tasks.frame import frame_text
from ..tasks.frame_table import MAX_STROKES, FrameTable
from ..tasks.rewards import FRAME_REWARDS
from ..tasks.stroke import shooter_of
from ..tasks.table_fit import fitted
from .pictures import FPS, MODES, Pictures

PLAYERS = ("player_0", "player_1")


class MatchEnv(AECEnv):
    """A frame of snooker between two players, one stroke a step.

    ## Turns
    ``agent_selection`` is who plays next: the same player for as long as he scores, the other after a miss or a foul. After a foul the
    player who comes to the table is selected, and his action says first what he wants.

    ## Action space
    ``Box(-1, 1, (7,), float32)`` for both: cue speed, side, top, aim, the place in the D (2), the decision; with ``elevation=True`` the
    elevation stands before the place. See ``tasks.box_actions.Actions``. The *place* counts only when the cue ball is in hand (a
    place that is taken becomes the nearest free one). The *decision* counts only when the other has just fouled: below -1/3 the offender
    must play again from where the balls lie, above 1/3 the balls are first replaced as they were (if a miss was called), between or without
    that option the player plays himself, with the rest of this same action. The first two play no stroke: the step only turns the table
    over to the offender. ``placement=False``, ``decision=False`` leave them out: the cue ball is then played from where it was put, and
    everybody plays after a foul. The colour after a red, and the free ball, is the one first struck. Nobody concedes or claims.

    ## Observation space
    That of ``Snooker-v0`` with ``task="frame"`` as each player sees it: his own score first, and whether it is his turn.

    ## Rewards
    ``"points"`` (default): what the step added to the player's score less what it added to the other's; the sum of both is zero.
    ``"win"``: +1 and -1 when the frame ends.

    ## Start and end
    Who breaks off is drawn from the seed. Both players terminate when the frame ends by the rules. Both are truncated when they have played
    ``max_strokes`` strokes together (1000 unless told otherwise, None for never): the referee stops a frame that goes nowhere, with no
    winner. No ball leaves the table, the physics is planar.

    ## Infos
    For both players, always the same keys: ``points``, ``penalty`` (of the last stroke), ``fouls`` (bits of
    ``snooker_env.game.ruling.Foul``), ``score``, ``opponent_score``, ``strokes`` (of both so far), ``break``, ``choice`` (a decision is
    open), ``free_ball``, ``winner`` (-1, 0 or 1).

    ## States
    ``get_state`` and ``set_state`` save and restore everything as JSON types; ``reset(options={"state": ...})`` starts from a state. It
    holds the random numbers too, so that playing on from it again repeats the errors of ``noise``. With a seed, ``reset(seed=...,
    options={"state": ...})``, table and frame are those of the state and the random numbers those of the seed. From a state of a frame that
    has ended both players are terminated, or truncated, at once.
    """

    metadata = {"name": "snooker_match_v0", "render_modes": list(MODES), "is_parallelizable": False, "render_fps": FPS}  # noqa: RUF012

    def __init__(
        self, *, layout="break_off", aim="absolute", observation="flat", noise="none", reward="points", elevation=False, placement=True,
        decision=True, miss="off", physics="paper", table="match", fidelity="standard", max_strokes=MAX_STROKES, render_mode=None,
    ):  # fmt: skip
        super().__init__()
        shooter = shooter_of(aim, elevation, placement, decision, noise, physics, table, fidelity)
        self._plan = fitted(layout, shooter.table)
        self.layout, self.observation = layout, observation
        self.reward = FRAME_REWARDS[choice("reward", reward, FRAME_REWARDS)]
        if render_mode is not None:
            choice("render_mode", render_mode, MODES)
        self.render_mode = render_mode
        self.table = FrameTable(shooter, miss=miss, max_strokes=max_strokes)
        self.possible_agents = list(PLAYERS)
        self.agents = []
        self.observation_spaces = {name: observations.space(observation, frame=True) for name in PLAYERS}
        self.action_spaces = {name: spaces.Box(-1.0, 1.0, (shooter.actions.size,), np.float32) for name in PLAYERS}
        self.np_random, _ = seeding.np_random()
        self._last_played = None
        self._pictures = Pictures(shooter.table, render_mode)

    @property
    def strokes(self):
        """How many strokes both players have played."""
        return self.table.strokes

    def observation_space(self, agent):
        """The same object each time."""
        return self.observation_spaces[agent]

    def action_space(self, agent):
        """The same object each time."""
        return self.action_spaces[agent]

    def observe(self, agent):
        """What ``agent`` sees now; a fresh array (or dict of arrays)."""
        return observations.observe_frame(self.observation, self.table, PLAYERS.index(agent))

    def reset(self, seed=None, options=None):
        """A new frame. options: None or {"state": a state of ``get_state``}; other keys are not read, PettingZoo's own test gives some."""
        if options is not None and not isinstance(options, dict):
            raise refuse("options", options, 'must be None or {"state": ...}')
        given = None
        if options and "state" in options:
            given = self.table.checked(options["state"], self.np_random)
        if seed is not None:
            self.np_random, _ = seeding.np_random(seed)
        if given is not None:
            self._take(given, noise=seed is None)
        else:
            self._last_played = None
            breaker = int(self.np_random.integers(2))
            self.table.start(*deal(self._plan, self.np_random), breaker=breaker, in_hand=self._plan.in_hand)
            self._begin()
        if self.render_mode == "human":
            self._show(film=False)

    def _begin(self):
        """PettingZoo's book-keeping for a table as it is."""
        self.agents = list(PLAYERS)
        self.rewards = dict.fromkeys(PLAYERS, 0.0)
        self._cumulative_rewards = dict.fromkeys(PLAYERS, 0.0)
        self._account()

    def _account(self):
        over = self.table.over
        self.terminations = dict.fromkeys(PLAYERS, over)
        self.truncations = dict.fromkeys(PLAYERS, self.table.stopped)
        self.infos = {name: self._info(k) for k, name in enumerate(PLAYERS)}
        self.agent_selection = PLAYERS[self.table.frame.striker]

    def step(self, action):
        """The selected player's action, None once he has terminated. ValueError if it is not finite, of the right shape and in [-1, 1]."""
        if not self.agents:
            raise gymnasium.error.ResetNeeded("the frame is over: call reset() before step()")
        name = self.agent_selection
        if self.terminations[name] or self.truncations[name]:
            self._was_dead_step(action)
            return
        a = self.table.shooter.actions.check(action)
        before = self.table.frame
        self._last_played = self.table.act(a, self.np_random, path=self.render_mode is not None)
        self._cumulative_rewards[name] = 0.0
        self.rewards = {player: self.reward(before, self.table.frame, k) for k, player in enumerate(PLAYERS)}
        self._account()
        self._accumulate_rewards()
        if self.render_mode == "human":
            self._show(film=self._last_played is not None)

    def _info(self, player):
        frame, played = self.table.frame, self._last_played
        return {
            "points": 0.0 if played is None else float(played.verdict.points),
            "penalty": 0 if played is None else int(played.verdict.penalty),
            "fouls": 0 if played is None else int(played.verdict.fouls),
            "score": float(frame.scores[player]), "opponent_score": float(frame.scores[1 - player]),
            "strokes": self.strokes, "break": float(frame.break_points),
            "choice": frame.phase == "choice", "free_ball": frame.free_ball, "winner": -1 if frame.winner is None else frame.winner,
        }  # fmt: skip

    def get_state(self):
        """The whole state as JSON types: table, frame, strokes and random generator."""
        return self.table.get_state() | {"rng": self.np_random.bit_generator.state}

    def set_state(self, state):
        """Take over a state from ``get_state``; the next stroke plays on identically. Rewards not yet collected are zero.

        ValueError if it is not sound, and then nothing has changed.
        """
        self._take(self.table.checked(state, self.np_random), noise=True)

    def _take(self, sound, *, noise):
        self.table.take(sound)
        if noise:
            self.np_random.bit_generator.state = sound.rng
        self._last_played = None
        self._begin()

    def render(self):
        """The table with the cue ball's last path: uint8 (H, W, 3) for "rgb_array", str for "ansi", None otherwise."""
        shot = None if self._last_played is None else self._last_played.shot
        return self._pictures.render(self.table.positions, self.table.on_table, shot, frame_text(self.table.frame))

    def _show(self, *, film):
        shot = None if self._last_played is None else self._last_played.shot
        self._pictures.show(self.table.positions, self.table.on_table, shot, frame_text(self.table.frame), film=film)

    def close(self):
        """Close the window, if there is one."""
        self._pictures.close()
