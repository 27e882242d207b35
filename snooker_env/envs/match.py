"""How do two agents play a frame against each other? PettingZoo's AEC interface around one table of ``tasks.frame``."""

import copy
from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium.utils import seeding
from numpy.typing import NDArray
from pettingzoo import AECEnv

from .._check import choice, refuse
from .._types import Action, Bools, Floats, Observation, RenderMode
from ..game.frame import Frame
from ..game.frame_columns import POINTS, STROKES
from ..simulation import Shot
from ..tasks import observations
from ..tasks.discrete_actions import Choices
from ..tasks.frame import Frames
from ..tasks.options import Options, options_of
from ..tasks.rewards import frame_reward
from ..tasks.tables import I_FOULS, I_PENALTY, I_POINTS, Crew
from .pictures import FPS, MODES, SIZE, Picture, Pictures
from .record import HasHistory, Record
from .reset_options import Start, start_of

PLAYERS = ("player_0", "player_1")


class MatchEnv(HasHistory, AECEnv[str, Any, Any]):
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

    ``action="discrete"``: ``Discrete(n)`` as in ``Snooker-v0``, without place and decision; the choices that there are for the player whose
    turn it is are ``action_mask(agent)`` and, as PettingZoo's own games have it, ``infos[agent]["action_mask"]``.

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

    ``reset(options={"position": position})`` begins a frame with a ``snooker_env.Position``, checked on this environment's table: player_0
    is to play it, a break of its points so far, both scores 0. The random numbers are those of the seed, or go on.
    """

    metadata: dict[str, Any] = {"name": "snooker_match_v0", "render_modes": list(MODES), "is_parallelizable": False, "render_fps": FPS}  # noqa: RUF012

    options: Options
    tables: Frames
    """The one table: ``tasks.frame.Frames``."""
    possible_agents: list[str]
    agents: list[str]
    observation_spaces: dict[str, Any]
    action_spaces: dict[str, Any]
    rewards: dict[str, float]
    terminations: dict[str, bool]
    truncations: dict[str, bool]
    infos: dict[str, dict[str, Any]]
    np_random: np.random.Generator

    def __init__(
        self, options: Options | None = None, *, render_mode: RenderMode | None = None, render_size: Sequence[int] = SIZE, **given: Any
    ):
        super().__init__()
        if options is None:
            box = given.get("action", "box") == "box"
            given = {"task": "frame", "placement": box, "decision": box, **given}
        self.options = options_of(options, given)
        if self.options.task != "frame" or self.options.opponent != "none" or self.options.trust:
            what = f"task={self.options.task!r}, opponent={self.options.opponent!r}, trust={self.options.trust!r}"
            raise ValueError(f'options = {what}: must be task="frame", opponent="none" and trust=False: a match has two players')
        if render_mode is not None:
            choice("render_mode", render_mode, MODES)
        self.render_mode = render_mode
        self.tables = Frames(self.options.rules, 1)
        self.possible_agents = list(PLAYERS)
        self.agents = []
        self.observation_spaces = {name: observations.space(self.options.observation, frame=True) for name in PLAYERS}
        self.action_spaces = {name: copy.deepcopy(self.options.rules.actions.space) for name in PLAYERS}  # each with its own generator
        self.np_random, _ = seeding.np_random()
        self._seeded = False
        self._record, self._last = Record(full=render_mode is not None), None
        self._pictures = Pictures(self.options.rules.table, render_mode, render_size, ("Player 1", "Player 2"))

    @property
    def positions(self) -> Floats:
        """Where the balls lie: (22, 2) [m]."""
        return self.tables.positions[0].copy()

    @property
    def on_table(self) -> Bools:
        """Which balls are on the table: (22,) bool."""
        return self.tables.on_table[0].copy()

    @property
    def frame(self) -> Frame:
        """The ``snooker_env.game.frame.Frame`` that is played."""
        return self.tables.frame(0)

    @property
    def last_shot(self) -> Shot | None:
        """The ``Shot`` of the last turn, with its path where a history is kept; None where none was played."""
        return self._record.last_shot if self._last is not None else None

    @property
    def strokes(self) -> int:
        """How many strokes both players have played."""
        return int(self.tables.game[0, STROKES])

    def observation_space(self, agent: str) -> gymnasium.Space[Any]:
        """What a player observes is in it; the same object each time.

        Parameters
        ----------
        agent : str
            "player_0" or "player_1".

        Returns
        -------
        gymnasium.Space
        """
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> gymnasium.Space[Any]:
        """What a player may do is in it; the same object each time.

        Parameters
        ----------
        agent : str
            "player_0" or "player_1".

        Returns
        -------
        gymnasium.Space
        """
        return self.action_spaces[agent]

    def observe(self, agent: str) -> Observation:
        """What a player sees now.

        Parameters
        ----------
        agent : str
            "player_0" or "player_1".

        Returns
        -------
        float32 (k,) or dict of arrays
            Fresh.
        """
        rows = self.tables.observe(np.zeros(1, np.int64), PLAYERS.index(agent))
        return observations.shaped(self.options.observation, rows[0])

    def action_mask(self, agent: str) -> NDArray[np.int8]:
        """With ``action="discrete"``: which choices a player has; none unless it is his turn.

        Parameters
        ----------
        agent : str

        Returns
        -------
        int8 (n,)

        Raises
        ------
        ValueError
            With ``action="box"``.
        """
        if not isinstance(self.options.rules.actions, Choices):
            raise refuse("action", "box", 'must be "discrete": a Box has no masks')
        there = agent == self.agent_selection and not self.tables.ended()[0]
        return (self.tables.action_masks()[0] & there).astype(np.int8)

    def reset(self, seed: int | None = None, options: dict[str, Any] | None = None) -> None:
        """A new frame.

        Parameters
        ----------
        seed : int, optional
            Of all random numbers to come; None: they go on.
        options : dict, optional
            {"state": a state of ``get_state``} or {"position": a ``snooker_env.Position``, or its ``to_dict()``} starts from there. Other
            keys are not read: PettingZoo's own test gives some.

        Returns
        -------
        None

        Raises
        ------
        ValueError
            For a state or position that is not sound.
        """
        if options is not None and not isinstance(options, dict):
            raise refuse("options", options, 'must be None or a dict, of which "state" or "position" is read')
        start = start_of(options or {}, self.tables, lambda state: self.tables.checked(state, self.np_random, either=True))
        if seed is not None:
            self.np_random, _ = seeding.np_random(seed)
        if start is not None:
            self._take(start, seeded=seed is not None)
        if seed is not None or not self._seeded:
            self.tables.seed(0, self.np_random)
            self._seeded = True
        if start is None:
            self.tables.deal(np.zeros(1, np.int64), drawn=True)
        self._begin()
        if self.render_mode == "human":
            self._show()

    def _begin(self):
        """PettingZoo's book-keeping for a table as it is."""
        self._last = None
        self._record.begin_episode()
        self.agents = list(PLAYERS)
        self.rewards = dict.fromkeys(PLAYERS, 0.0)
        self._cumulative_rewards = dict.fromkeys(PLAYERS, 0.0)
        self._account()

    def _account(self):
        frame = self.frame
        over = frame.phase == "over"
        self.terminations = dict.fromkeys(PLAYERS, over)
        self.truncations = dict.fromkeys(PLAYERS, bool(self.tables.stopped()[0]) and not over)
        self.agent_selection = PLAYERS[frame.striker]
        self.infos = {name: self._info(frame, k) for k, name in enumerate(PLAYERS)}

    def step(self, action: Action) -> None:
        """Play the selected player's action.

        Parameters
        ----------
        action : array_like, float (k,), int or None
            Within [-1, 1], or a choice; None once the player has terminated or is truncated.

        Returns
        -------
        None

        Raises
        ------
        ValueError
            If the action is not in the action space; then nothing is played.
        gymnasium.error.ResetNeeded
            If no player is left.
        """
        if not self.agents:
            raise gymnasium.error.ResetNeeded("the frame is over: call reset() before step()")
        name = self.agent_selection
        if self.terminations[name] or self.truncations[name]:
            self._was_dead_step(action)
            return
        a = self.options.rules.actions.check(action)
        before = self.tables.lead()[0]
        out = self.tables.output()
        crew = Crew(self._record.buffers, (), self._watch)
        self._record.begin_step()
        played = self.tables.turn(lambda which, buffers: self.tables.prepare(which, np.array([a]), buffers), out, crew)[0]
        self._last = out if played else None
        self._cumulative_rewards[name] = 0.0
        gained, winner = int(self.tables.lead()[0] - before), self.frame.winner
        self.rewards = {player: frame_reward(self.options.reward, gained, winner, k) for k, player in enumerate(PLAYERS)}
        self._account()
        self._accumulate_rewards()
        if self.render_mode == "human":
            self._show(played=bool(played))

    def _watch(self, k, buffers, j, own):
        self._record.saw(self.tables, k, buffers, j, own)

    def _info(self, frame, player):
        last, row = self._last, self.tables.game[0]
        info = {
            "points": 0.0 if last is None else float(last.reals[0, I_POINTS]),
            "penalty": 0 if last is None else int(last.counts[0, I_PENALTY]),
            "fouls": 0 if last is None else int(last.counts[0, I_FOULS]),
            "score": float(frame.scores[player]), "opponent_score": float(frame.scores[1 - player]),
            "strokes": int(row[STROKES]), "break": float(row[POINTS]),
            "choice": frame.phase == "choice", "free_ball": frame.free_ball, "winner": -1 if frame.winner is None else frame.winner,
        }  # fmt: skip
        if isinstance(self.options.rules.actions, Choices):
            info["action_mask"] = self.action_mask(PLAYERS[player])
        return info

    def get_state(self) -> dict[str, Any]:
        """The whole state: table, frame, strokes and random numbers.

        Returns
        -------
        dict
            Of JSON types.
        """
        return self.tables.get_state(0) | {"rng": self.np_random.bit_generator.state}

    def set_state(self, state: dict[str, Any]) -> None:
        """Take over a state; the next stroke plays on identically. Rewards not yet collected are zero.

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
        self._take(Start(state=self.tables.checked(state, self.np_random, either=True)), seeded=False)
        self._begin()

    def _take(self, start, *, seeded):
        rng = start.take(self.tables, 0)
        if rng is not None and not seeded:
            self.np_random.bit_generator.state = rng
            self._seeded = True

    def render(self) -> Picture:
        """The table with the cue ball's last path.

        Returns
        -------
        uint8 (H, W, 3), str or None
            By the render mode: "rgb_array", "ansi", another.
        """
        return self._pictures.render(self.tables, 0, self._record.strokes, self._record.recent())

    def _show(self, *, played=False):
        self._pictures.show(self.tables, self._record.strokes, played=played)

    def close(self) -> None:
        """Close the window, if there is one."""
        self._pictures.close()
