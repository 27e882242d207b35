"""How do two agents play a frame or match against each other? PettingZoo's AEC interface around one table of
``tasks.frame``."""

import copy
from collections.abc import Mapping, Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium.utils import seeding
from numpy.typing import NDArray
from pettingzoo import AECEnv

from .._check import choice, refuse
from .._types import Action, Observation, RenderMode
from ..game.frame import Frame
from ..game.frame_columns import STRIKER, STROKES
from ..simulation import Shot
from ..tasks import observations
from ..tasks.discrete_actions import Choices
from ..tasks.frame import Frames
from ..tasks.matches import Matches
from ..tasks.options import Options, observation_space_of
from ..tasks.rewards import frame_reward
from ..tasks.tables import Crew
from .one_table import ShowsBalls, TakesTurns
from .opponents import match_options, two_seats
from .pictures import FPS, MODES, SIZE, Picture, Pictures
from .record import HasHistory, Record
from .reset_options import Start, breakers_of, start_of

PLAYERS = ("player_0", "player_1")


class MatchEnv(ShowsBalls, TakesTurns, HasHistory, AECEnv[str, Any, Any]):
    """A frame of snooker between two players, one stroke a step; with ``task="match"`` a match.

    ## Turns ``agent_selection`` is the player whose turn it is: the same player as long as he scores, the
    other one after a miss or a foul. After a foul the player who comes to the table is selected, and the last
    component of his action is his decision.

    ## Action space ``Box(-1, 1, (7,), float32)`` for both players: cue speed, side, top, aim, the place in
    the D (two numbers), the decision. With ``elevation=True`` the elevation comes before the place. The
    components have the meaning that they have in ``SnookerEnv``.

    * The *place* counts only when the cue ball is in hand. A place that is taken becomes the nearest free
      one.
    * The *decision* counts only when the other player has just fouled. Below -1/3, the offender must play
      again from where the balls lie. Above 1/3, if a miss was called, the balls are first replaced as they
      were. These two play no stroke: the step only passes the turn to the offender. In between, or without a
      miss, the player plays himself, with the rest of this same action.
    * ``placement=False`` and ``decision=False`` leave these components out: the cue ball is then played from
      where it was put, and the player always plays after a foul.
    * ``nominate=True`` adds the nomination before the decision; ``concede``, ``claim`` and ``lot`` add a
      declaration at the end: see ``SnookerEnv``. Without them the colour after a red, and the free ball, is
      the one first struck, and nobody concedes or claims.

    ``action="discrete"``: ``Discrete(540)`` or longer as in ``Snooker-v0``, without place and decision. The
    available choices of the player whose turn it is are ``action_mask(agent)`` and, as in PettingZoo's own
    games, ``infos[agent]["action_mask"]``.

    ## Observation space That of ``Snooker-v0`` with the same task, from each player's point of view: his own
    score first, and whether it is his turn.

    ## Rewards ``"points"`` (default): the points that the step added to the player's score minus those added
    to the other's; both rewards sum to zero. ``"win"``: +1 and -1 when the frame or match ends, else 0.
    ``"frames"``, of a match: +1 and -1 when a frame ends.

    ## Start and end The seed determines who breaks off, or ``reset(options={"breaker": 0 or 1})``. In a match
    the players break in turn, and the next rack follows in the step that ends a frame. Both players terminate
    when the frame or match ends by the rules. Both are truncated when they have played ``max_strokes``
    strokes together (default 1000, None for never): the referee stops the frame, without a winner. No ball
    leaves the table, because the physics is planar.

    ## Infos The keys of ``SnookerEnv``, for both players: ``points`` to ``events`` are of the last stroke,
    whoever played it, ``opponent_strokes`` is 1 for the one who did not, ``winner`` is -1, 0 or 1 for both.
    All that is of the frame is as the player sees it.

    ## States ``get_state`` and ``set_state`` save and restore everything as JSON types, the random stream
    included: playing on from a state again repeats the execution errors. ``reset(options={"state": ...})``
    starts from a state. With a seed as well, table and frame are those of the state and the random numbers
    those of the seed. From a state of a finished frame, both players are terminated or truncated at once.

    ``reset(options={"position": position})`` begins a frame with a ``snooker_env.Position``, validated on
    this environment's table. It is the turn of player_0, with a break of the position's points so far; both
    scores are 0.

    Parameters
    ----------
    options : Options, optional
        The options, with ``task="frame"`` or "match" and no opponent. Default None: they are made from the
        keywords.
    seats : (dict, dict), optional
        What differs for each player: options of its actions, and "noise", its execution errors. Default None:
        nothing.
    render_mode : {"human", "rgb_array", "ansi"}, optional
        How ``render`` shows the table; default None: not at all.
    render_size : (int, int), optional
        Width and height of pictures [pixels], each in [100, 8192]; default (1920, 1080).
    **given
        The keywords of ``Options``, in place of ``options``. Box actions hold placement and decision by
        default, and with ``frames`` the task is "match".

    Raises
    ------
    ValueError
        If an argument is invalid.
    TypeError
        For an unknown keyword.

    Examples
    --------
    >>> import snooker_env as sn
    >>> env = sn.match_env(noise="club", action="discrete")
    >>> env.reset(seed=1)
    >>> for agent in env.agent_iter(max_iter=3):
    ...     observation, reward, terminated, truncated, info = env.last()
    ...     env.step(None if terminated or truncated else int(info["action_mask"].argmax()))
    >>> env.strokes
    3
    """

    metadata: dict[str, Any] = {  # noqa: RUF012
        "name": "snooker_match_v0",
        "render_modes": list(MODES),
        "is_parallelizable": False,
        "render_fps": FPS,
    }

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
        self,
        options: Options | None = None,
        *,
        seats: Sequence[Mapping[str, Any]] | None = None,
        render_mode: RenderMode | None = None,
        render_size: Sequence[int] = SIZE,
        **given: Any,
    ):
        super().__init__()
        self.options = match_options(options, given)
        if render_mode is not None:
            choice("render_mode", render_mode, MODES)
        self.render_mode = render_mode
        self.tables = (Matches if self.options.task == "match" else Frames)(
            self.options, seats=two_seats(self.options, seats)
        )
        self.possible_agents = list(PLAYERS)
        self.agents = []
        self.observation_spaces = {name: observation_space_of(self.options) for name in PLAYERS}
        # each with its own generator
        spaces = [copy.deepcopy(seat.actions.space) for seat in self.tables.seats]
        self.action_spaces = dict(zip(PLAYERS, spaces, strict=True))
        self.np_random, _ = seeding.np_random()
        self._seeded = False
        self._record, self._last = Record(full=render_mode is not None), None
        self._pictures = Pictures(
            self.options.rules.table, render_mode, render_size, ("Player 1", "Player 2")
        )

    @property
    def frame(self) -> Frame:
        """The current ``snooker_env.game.frame.Frame``."""
        return self.tables.frame(0)

    @property
    def last_shot(self) -> Shot | None:
        """The ``Shot`` of the last turn, with its path if a history is kept; None if no stroke was played in
        it."""
        return self._record.last_shot if self._last is not None else None

    @property
    def strokes(self) -> int:
        """Number of strokes that both players have played in this frame, an int."""
        return int(self.tables.game[0, STROKES])

    def observation_space(self, agent: str) -> gymnasium.Space[Any]:
        """Return the observation space of a player; the same object each time.

        ``agent``: "player_0" or "player_1". Returns the space.
        """
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> gymnasium.Space[Any]:
        """Return the action space of a player; the same object each time.

        ``agent``: "player_0" or "player_1". Returns the space.
        """
        return self.action_spaces[agent]

    def observe(self, agent: str) -> Observation:
        """Return the current observation of a player.

        ``agent``: "player_0" or "player_1". Returns as in the observation space; new arrays.
        """
        turn = agent == self.agent_selection  # an error before reset()
        side = PLAYERS.index(agent)
        rows = self.tables.observe(np.zeros(1, np.int64), side)
        masks = self._mask(side, turn) if self.options.observation == "masked" else None
        return observations.shaped(self.options.observation, rows[0], masks)

    def action_mask(self, agent: str) -> NDArray[np.int8]:
        """Return the available choices of a player, with ``action="discrete"``.

        ``agent``: "player_0" or "player_1". Returns int8 (n,), n the number of choices. 1 for each available
        choice; all 0 unless it is the player's turn. ValueError with ``action="box"``.
        """
        side = PLAYERS.index(agent)
        if not isinstance(self.tables.seats[side].actions, Choices):
            raise refuse("action", "box", 'must be "discrete": a Box has no masks')
        return self._mask(side, agent == self.agent_selection)

    def _mask(self, side, turn):
        return (self.tables.action_masks(side=side)[0] & (turn and not self.tables.ended()[0])).astype(
            np.int8
        )

    def reset(self, seed: int | None = None, options: dict[str, Any] | None = None) -> None:
        """Begin a new frame.

        ``seed``: seed of all random numbers from now on; default None: the stream goes on. ``options``:
        {"state": a state from ``get_state``} or {"position": a ``snooker_env.Position`` or its ``to_dict()``}
        starts from there. {"breaker": 0 or 1} says who breaks. Other keys are ignored, because PettingZoo's
        own tests pass some. ValueError if the options, the state or the position are invalid.
        """
        if options is not None and not isinstance(options, dict):
            raise refuse(
                "options",
                options,
                'must be None or a dict, of which "state", "position" or "breaker" is read',
            )
        start = start_of(
            options or {}, self.tables, lambda state: self.tables.checked(state, self.np_random, either=True)
        )
        breakers = breakers_of(options or {}, 1, self.options, two_players=True)
        if seed is not None:
            self.np_random, _ = seeding.np_random(seed)
        if start is not None:
            self._take(start, seeded=seed is not None)
        if seed is not None or not self._seeded:
            self.tables.seed(0, self.np_random)
            self._seeded = True
        if start is None:
            self.tables.deal(np.zeros(1, np.int64), drawn=True, **breakers)
        self._begin()
        self._show()

    def _begin(self):
        """Initialise PettingZoo's attributes for the current table."""
        self._last = None
        self._record.begin_episode()
        self.agents = list(PLAYERS)
        self.rewards = dict.fromkeys(PLAYERS, 0.0)
        self._cumulative_rewards = dict.fromkeys(PLAYERS, 0.0)
        self._account()

    def _account(self, striker=None):
        """Whose turn it is, and the infos; ``striker``: who has just had one."""
        frame = self.frame
        over = frame.phase == "over"
        self.terminations = dict.fromkeys(PLAYERS, over)
        self.truncations = dict.fromkeys(PLAYERS, bool(self.tables.stopped()[0]) and not over)
        self.agent_selection = PLAYERS[frame.striker]
        self.infos = {name: self._info(striker, k) for k, name in enumerate(PLAYERS)}

    def step(self, action: Action) -> None:
        """Play the action of the selected player.

        ``action``: float (k,) within [-1, 1], or a choice; None once the player has terminated or is
        truncated. ValueError if the action is not in the action space; then nothing is played.
        gymnasium.error.ResetNeeded if no player is left. SimulationError if the shot cannot be computed.
        """
        if not self.agents:
            raise gymnasium.error.ResetNeeded(
                f"the frame {self.tables.unplayable}: call reset() before step()"
            )
        name: Any = self.agent_selection  # of PettingZoo's own type
        if self.terminations[name] or self.truncations[name]:
            self._was_dead_step(action)
            return
        striker, out = int(self.tables.game[0, STRIKER]), self.tables.output()
        a = self.tables.seats[striker].actions.check(action)
        self._pictures.require_display()
        crew = Crew(self._record.buffers, (), self._watch)
        self._record.begin_step()
        played = self.tables.turn(
            lambda which, buffers: self.tables.prepare(which, np.array([a]), buffers, striker), out, crew
        )[0]
        self._last = out if played else None
        self._cumulative_rewards[name] = 0.0
        gained, winner = self.tables.pay(0), self.frame.winner
        self.rewards = {
            player: frame_reward(self.options.reward, gained, winner, k) for k, player in enumerate(PLAYERS)
        }
        self._account(striker)
        self._accumulate_rewards()
        self._show(played=bool(played))

    def _watch(self, k, buffers, j, own):
        self._record.saw(self.tables, k, buffers, j, own)

    def _info(self, striker, player):
        """The keys of ``SnookerEnv``'s info: what the last stroke was, whoever played it, and the frame as
        the player sees it."""
        info = self.tables.info_of(player, self._last)
        info["opponent_strokes"] = int(self._last is not None and striker is not None and striker != player)
        if isinstance(self.tables.seats[player].actions, Choices):
            info["action_mask"] = self.action_mask(PLAYERS[player])
        return info

    def get_state(self) -> dict[str, Any]:
        """Return the whole state: table, frame, number of strokes and random stream.

        Returns JSON types.
        """
        return self.tables.get_state(0) | {"rng": self.np_random.bit_generator.state}

    def set_state(self, state: dict[str, Any]) -> None:
        """Restore a state; the next stroke continues identically. Rewards not yet collected become zero.

        ``state``: a result of ``get_state``. ValueError if the state is invalid; then nothing has changed.
        """
        self._take(Start(state=self.tables.checked(state, self.np_random, either=True)), seeded=False)
        self._begin()

    def _take(self, start, *, seeded):
        rng = start.take(self.tables, 0)
        if rng is not None and not seeded:
            self.np_random.bit_generator.state = rng
            self._seeded = True

    def render(self) -> Picture:
        """Return the table with the paths of the last shot.

        Returns uint8 (H, W, 3) with "rgb_array", str with "ansi", None otherwise.
        """
        return self._pictures.render(self.tables, 0, self._record.strokes, self._record.recent())

    def _show(self, *, played=False):
        self._pictures.show(self.tables, self._record.strokes, played=played)

    def close(self) -> None:
        """Close the window, if there is one."""
        self._pictures.close()
