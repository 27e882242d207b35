"""What would strokes lead to? ``Planner`` plays them on copies of positions, under given noise samples, with the rules, on all cores."""

import copy
import os
import threading
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields, is_dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._check import integer, refuse_what
from .._processors import processors
from ..game.layouts import plan_of
from ..physics.parameters import Physics
from ..physics.table import Table
from ..tasks.noise import Noise
from ..tasks.rewards import REWARDS
from ..tasks.stroke import Shooter
from ..tasks.visit import Returned, Rules, Visits, Work
from . import strokes
from .positions import Positions, bare, check_played, frame_table, rows_of

CHUNK = 128
"""Strokes played in one go: their work space stays in the cache."""
LEAST = 8
"""Fewest strokes that are worth a chunk of their own."""


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
    env_or_options : environment, dict or dataclass
        An environment, of one table or many, wrapped or not, a match too; or the keyword arguments of ``gymnasium.make("Snooker-v0",
        ...)``. It says how actions are read, the noise, the physics, the table and the fidelity. It is only read.
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

    def __init__(self, env_or_options: Any, *, noise: Any = None, threads: int | None = None):
        shooter = _shooter_of(env_or_options)
        errors = shooter.noise if noise is None else Noise.of(noise)
        self._shooter = Shooter(shooter.actions, errors, shooter.physics, shooter.table, shooter.fidelity)
        self._threads = min(1024, processors()) if threads is None else integer("threads", threads, 1, 1024)
        self._visits = Visits(Rules(self._shooter, plan_of("colours"), REWARDS[0]), 0)  # no visit begins here: nothing is dealt
        self._free: list[Work] = []
        self._lock = threading.Lock()
        self._pool: ThreadPoolExecutor | None = None
        self._pool_process = 0
        self._shots = 0

    @property
    def shots(self) -> int:
        """Strokes played so far."""
        return self._shots

    @property
    def threads(self) -> int:
        """How many threads play."""
        return self._threads

    @property
    def noise(self) -> Noise:
        """The execution noise that strokes are played with."""
        return self._shooter.noise

    @property
    def physics(self) -> Physics:
        """The world that strokes are played in."""
        return self._shooter.physics

    @property
    def table(self) -> Table:
        """The table that strokes are played on."""
        return self._shooter.table

    @property
    def action_space(self) -> Any:
        """The space that rows of actions are from."""
        return self._shooter.actions.space

    @property
    def discrete(self) -> bool:
        """Whether actions are choices (``action="discrete"``)."""
        return self._shooter.actions.size == 1

    def play(self, positions: Any, rows: ArrayLike, actions: ArrayLike, keys: ArrayLike | None = None) -> Outcomes:
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
        at = Positions.of(positions)
        which = rows_of(at, rows)
        n = len(which)
        rows_of_actions = self._shooter.actions.check_many(actions, n)
        streams = _streams(keys, n, self.noise.silent)
        check_played(at, which, self.table, self.physics.R)
        outcomes = self._strokes(at[which], rows_of_actions, streams)
        with self._lock:
            self._shots += n
        return outcomes

    def _strokes(self, after: Positions, actions: NDArray[np.float64], streams: NDArray[np.uint64]) -> Outcomes:
        """Play a stroke on each row of ``after``, which becomes its afterstate. The one place that knows how visits are played."""
        n = len(after)
        visits, out, waiting = copy.copy(self._visits), Returned(n), np.zeros(n, np.bool_)
        visits.n, visits.streams = n, streams
        visits.positions, visits.on_table, visits.game = after.positions, after.on_table, after.game

        def play(work: Work, start: int, end: int) -> None:
            visits.play(actions[start:end], waiting[start:end], out, work, start)

        self._share(play, n)
        return Outcomes(out.reals[:, 0].copy(), ~after.over, after, out.observations)

    def _share(self, play: Any, n: int) -> None:
        """Call ``play(work, start, end)`` for chunks of n strokes, on as many threads as there are and as are worth it."""
        threads = max(1, min(self._threads, n // LEAST))
        size = CHUNK if threads == 1 else min(CHUNK, max(LEAST, -(-n // (4 * threads))))  # shots differ in length
        starts = iter(range(0, n, size))

        def run() -> None:
            try:
                work = self._free.pop()
            except IndexError:
                work = Work(CHUNK)
            try:
                for start in starts:  # a range's iterator gives each start once, whichever thread asks
                    play(work, start, min(n, start + size))
            finally:
                self._free.append(work)

        if threads == 1:
            run()
            return
        with self._lock:
            if self._pool is None or self._pool_process != os.getpid():  # a forked process has none of its parent's threads
                self._pool, self._pool_process = ThreadPoolExecutor(self._threads - 1, "planner"), os.getpid()
            others = [self._pool.submit(run) for _ in range(threads - 1)]
        try:
            run()
        finally:
            for other in others:
                other.exception()  # wait for all of them, whatever happened
        for other in others:
            other.result()

    def as_actions(self, positions: Any, rows: ArrayLike, choices: ArrayLike) -> NDArray[np.float32]:
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
        return strokes.solved_choices(Positions.of(positions), rows, choices, (self.physics, self._shooter.fidelity))

    def pot_aim(
        self, positions: Any, rows: ArrayLike, balls: ArrayLike, targets: ArrayLike, speeds: ArrayLike, *, side: ArrayLike = 0.0,
        top: ArrayLike = 0.0, elevation: ArrayLike = 0.0, ghosts: ArrayLike | None = None,
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
        world = (self.physics, self._shooter.fidelity)
        return strokes.solved_aims(Positions.of(positions), rows, balls, targets, speeds, side, top, elevation, ghosts, world)

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name != "_lock"} | {"_pool": None, "_free": []}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__ |= state | {"_lock": threading.Lock()}  # threads and locks belong to one process


def _shooter_of(source: Any) -> Shooter:
    """How an environment, or one of these options, reads actions and plays shots."""
    if is_dataclass(source) and not isinstance(source, type):
        source = {field.name: getattr(source, field.name) for field in fields(source)}
    if isinstance(source, Mapping):
        from ..envs.snooker import SnookerEnv

        return SnookerEnv(**source).shooter
    env = bare(source)
    shooter = getattr(env, "shooter", None) or getattr(frame_table(env), "shooter", None)
    if not isinstance(shooter, Shooter):
        raise refuse_what("env_or_options", f"a {type(source).__name__}", "must be an environment of snooker_env, or a dict of its options")
    return shooter


def _streams(keys: ArrayLike | None, n: int, silent: bool) -> NDArray[np.uint64]:
    """The random stream of each stroke, key and counter: uint64 (n, 2)."""
    streams = np.zeros((n, 2), np.uint64)
    if keys is None and silent:
        return streams
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
