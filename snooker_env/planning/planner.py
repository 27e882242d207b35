"""What would strokes lead to? ``Planner`` plays them on copies of positions, under given noise samples, with the rules, on all cores."""

import copy
import threading
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._check import integer, refuse, refuse_what
from .._types import Environment, Integers, Scalars, Vectors
from ..physics.parameters import Physics
from ..physics.table import Table
from ..tasks.box_actions import Actions
from ..tasks.noise import Noise, NoiseLike
from ..tasks.options import Options, Rules, options_of
from ..tasks.rewards import REWARDS
from ..tasks.tables import I_FIRST, I_PENALTY, StepOutput
from ..tasks.threads import Threads, processors
from ..tasks.visit import Visits
from . import strokes
from .positions import Positions, PositionsLike, bare, check_played, rows_of
from .stops import Stops, WatchedVisits


class Outcomes(NamedTuple):
    """What n strokes led to.

    Attributes
    ----------
    points : float64 (n,)
        Points scored; 0 for a miss or a foul.
    goes_on : bool (n,)
        Whether the visit goes on.
    afterstates : Positions
        n rows: where the balls came to rest, colours respotted, and what is on next.
    observations : float32 (n, 121)
        The flat observations of the afterstates, as ``Snooker-v0`` shows them in a visit.
    """

    points: NDArray[np.float64]
    goes_on: NDArray[np.bool_]
    afterstates: Positions
    observations: NDArray[np.float32]


class Planner:
    """Plays strokes on copies of positions, as the environment would: same physics, same rules, the same errors for the same keys.

    Every stroke is judged as one of a *visit* (``task="visit"``): the visit ends with the first miss, foul or clearance. For an
    environment that plays whole frames this says what a stroke scores and leaves while its player scores; penalties, free balls,
    the foul-and-miss rule and the other player are not planned.

    Parameters
    ----------
    env_or_options : environment, Options or dict
        An environment, of one table or many, wrapped or not, a match too; or its options, as ``Options`` or as the keyword arguments of
        ``gymnasium.make("Snooker-v0", ...)``. They say how actions are read, the noise, the physics, the table and the fidelity.
    noise : str, dict or Noise, optional
        Execution noise to plan with in place of its own; "none": strokes come out as intended.
    threads : int, optional
        How many to use; all processors by default. Results do not depend on it.

    Raises
    ------
    ValueError
        If an argument is none of these.

    Examples
    --------
    >>> import numpy as np
    >>> import snooker_env as sn
    >>> env = sn.SnookerEnv(noise="club", action="discrete")
    >>> _ = env.reset(seed=0)
    >>> planner = sn.planning.Planner(env)
    >>> choices = np.flatnonzero(env.action_masks())[:3]
    >>> keys = np.arange(20, dtype=np.uint64)  # each choice meets the same 20 noise samples
    >>> outcomes = planner.play(env, np.zeros(60, int), np.repeat(choices, 20), np.tile(keys, 3))
    >>> outcomes.points.reshape(3, 20).mean(axis=1).shape, planner.shots
    ((3,), 60)
    """

    def __init__(
        self, env_or_options: Environment | Options | Mapping[str, Any], *, noise: NoiseLike | None = None, threads: int | None = None
    ):
        rules = _rules_of(env_or_options)
        errors = rules.noise if noise is None else Noise.of(noise)
        self._rules = replace(rules, noise=errors, reward=REWARDS[0], opponent=None)
        self._threads = Threads(min(1024, processors()) if threads is None else integer("threads", threads, 1, 1024))
        self._visits, self._watched = Visits(self._rules, 0), WatchedVisits(self._rules, 0)
        self._lock = threading.Lock()
        self._shots = 0

    @property
    def shots(self) -> int:
        """Strokes played so far."""
        return self._shots

    @property
    def threads(self) -> int:
        """How many threads play."""
        return self._threads.threads

    @property
    def noise(self) -> Noise:
        """The execution noise that strokes are played with."""
        return self._rules.noise

    @property
    def physics(self) -> Physics:
        """The world that strokes are played in."""
        return self._rules.physics

    @property
    def table(self) -> Table:
        """The table that strokes are played on."""
        return self._rules.table

    @property
    def action_space(self) -> Any:
        """The space that rows of actions are from."""
        return self._rules.actions.space

    @property
    def discrete(self) -> bool:
        """Whether actions are choices (``action="discrete"``)."""
        return self._rules.actions.size == 1

    def play(
        self, positions: PositionsLike, rows: Integers, actions: Vectors | Integers, keys: Integers | Sequence[Integers] | None = None
    ) -> Outcomes:
        """Play n strokes, each on a copy of its position.

        Parameters
        ----------
        positions : whatever ``Positions.of`` takes
            They are left as they are.
        rows : array_like, int (n,)
            Which position each stroke is played on.
        actions : array_like, float (n, k) or int (n,)
            Rows of the box action space, or choices with ``action="discrete"``.
        keys : array_like, int (n,) or (n, 2), in [0, 2**64)
            The noise sample of each stroke: the key of its random stream, or key and counter as a state holds them under "stream". The
            same key gives the same errors of execution, whatever the stroke (common random numbers). Without noise it may be left out.

        Returns
        -------
        Outcomes
            points, goes_on, afterstates, observations.

        Raises
        ------
        ValueError
            If a row is out of range, an action is not in the action space, an array has another shape, or a position that is played
            is not sound or has no stroke left.
        SimulationError
            If a shot cannot be computed.

        Notes
        -----
        May be called from several threads at once. A stroke costs about 20 us; below a few dozen strokes a call the checks count too.
        """
        after, out = self._strokes(copy.copy(self._visits), positions, rows, actions, keys)
        return Outcomes(out.reals[:, 0].copy(), ~after.over, after, out.observations)

    def stops(
        self, positions: PositionsLike, rows: Integers, actions: Vectors | Integers, keys: Integers | Sequence[Integers] | None = None
    ) -> Stops:
        """Play n strokes as ``play`` does, and keep where each ball stopped.

        Parameters
        ----------
        positions, rows, actions, keys
            As of ``play``.

        Returns
        -------
        Stops

        Raises
        ------
        ValueError, SimulationError
            As ``play``.

        Examples
        --------
        >>> from snooker_env.planning import Planner, Position
        >>> position = Position(cue=(0.0, 0.9), black=(0.4, 1.3))
        >>> stops = Planner({"action": "discrete"}).stops(position, [0], [67])
        >>> int(stops.first[0]), int(stops.potted[0, 21])
        (21, 3)
        """
        visits = copy.copy(self._watched)
        after, out = self._strokes(visits, positions, rows, actions, keys)
        first, penalty = out.counts[:, I_FIRST].copy(), out.counts[:, I_PENALTY].copy()
        return Stops(visits.places, visits.potted, first, out.reals[:, 0].copy(), penalty, ~after.over, after)

    def _strokes(
        self, visits: Visits, positions: PositionsLike, rows: Integers, actions: Vectors | Integers,
        keys: Integers | Sequence[Integers] | None,
    ) -> tuple[Positions, StepOutput]:  # fmt: skip
        """Check and play strokes on fresh ``visits``, each on a copy of its position: the afterstates, and what a step returns of them."""
        at = Positions.of(positions)
        which = rows_of(at, rows)
        n = len(which)
        rows_of_actions = self._rules.actions.check_many(actions, n)
        streams = _streams(keys, n, self.noise.silent)
        check_played(at, which, self.table, self.physics.R)
        after = at[which]  # the one place that knows how visits are played: each row becomes its afterstate
        visits.n, visits.positions, visits.on_table, visits.game, visits.streams = n, after.positions, after.on_table, after.game, streams
        out = visits.output()
        visits.step(rows_of_actions, np.zeros(n, np.bool_), out, self._threads)
        with self._lock:
            self._shots += n
        return after, out

    def as_actions(self, positions: PositionsLike, rows: Integers, choices: Integers) -> NDArray[np.float32]:
        """``snooker_env.planning.as_actions`` in this planner's world.

        Parameters
        ----------
        positions : whatever ``Positions.of`` takes
        rows, choices : array_like, int (n,)

        Returns
        -------
        float32 (n, 4)
            Actions of ``aim="absolute"``.
        """
        if isinstance(self._rules.actions, Actions) and self._rules.actions.aim != "absolute":
            raise refuse("aim", self._rules.actions.aim, 'must be "absolute": what comes out would be read otherwise by this planner')
        return strokes.solved_choices(Positions.of(positions), rows, choices, (self.physics, self._rules.fidelity))

    def pot_aim(
        self, positions: PositionsLike, rows: Integers, balls: Integers, targets: Vectors, speeds: Scalars, *, side: Scalars = 0.0,
        top: Scalars = 0.0, elevation: Scalars = 0.0, ghosts: Vectors | None = None,
    ) -> NDArray[np.float64]:  # fmt: skip
        """``snooker_env.planning.pot_aim`` in this planner's world.

        Parameters
        ----------
        positions, rows, balls, targets, speeds, side, top, elevation, ghosts
            As there.

        Returns
        -------
        float64 (n,)
            Directions of the cue ball [rad].
        """
        world = (self.physics, self._rules.fidelity)
        return strokes.solved_aims(Positions.of(positions), rows, balls, targets, speeds, side, top, elevation, ghosts, world)

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name != "_lock"}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state, _lock=threading.Lock())  # which belongs to one process


def _rules_of(source: Any) -> Rules:
    """How an environment plays, or one of these options."""
    if isinstance(source, Mapping):
        source = options_of(None, source)
    options = source if isinstance(source, Options) else getattr(bare(source), "options", None)
    if not isinstance(options, Options):
        allowed = "must be an environment of snooker_env, an Options, or a dict of its fields"
        raise refuse_what("env_or_options", f"a {type(source).__name__}", allowed)
    return options.rules


def _streams(keys: Integers | Sequence[Integers] | None, n: int, silent: bool) -> NDArray[np.uint64]:
    """The random stream of each stroke, key and counter: uint64 (n, 2)."""
    streams = np.zeros((n, 2), np.uint64)
    if keys is None:
        if silent:
            return streams
        raise refuse("keys", None, f"must be given with execution noise: {n} integers in [0, 2**64), a noise sample for each stroke")
    allowed = f"must be {n} integers in [0, 2**64), a noise sample for each stroke"
    given = keys if isinstance(keys, np.ndarray) else np.array(keys, object)  # NumPy makes floats of a list of large and small integers
    if given.dtype == object and all(isinstance(k, int | np.integer) and 0 <= k < 2**64 for k in given.flat):
        given = given.astype(np.uint64)
    if given.shape not in ((n,), (n, 2)):
        raise refuse_what("keys", f"array of shape {given.shape}", allowed)
    if given.dtype.kind not in "iu" or (given.dtype.kind == "i" and (given < 0).any()):
        raise refuse_what("keys", "negative numbers" if given.dtype.kind == "i" else f"array of {given.dtype}", allowed)
    streams[:, : given.ndim] = given.reshape(n, -1)
    return streams
