"""What would strokes lead to? ``Planner`` plays them on copies of positions by the rules."""

import copy
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._lib.check import array, integer, refuse, refuse_what
from .._lib.types import Environment, Floats, Integers, Ints, Scalars, Vectors, Words
from ..tasks.noise import Noise, NoiseLike
from ..tasks.options import Options, Rules, options_of
from ..tasks.rewards import REWARDS
from ..tasks.tables import I_FIRST, I_PENALTY, I_POINTS
from ..tasks.threads import Threads, processors
from .aims import Dynamics, solved_aims
from .positions import Positions, PositionsLike, bare, check_has_stroke, rows_of
from .stroke_columns import COLUMNS
from .strokes import check_strokes, decode
from .trials import TrialVisits


class Outcomes(NamedTuple):
    """What n strokes led to, as ``Planner.play`` and ``Planner.play_strokes`` return it.

    Attributes
    ----------
    points, penalty : numpy.ndarray
        float64 (n,), points scored, 0 for a miss or a foul; int64 (n,), penalty points of a foul, or 0.
    goes_on : numpy.ndarray
        bool (n,). Whether the visit continues after the stroke.
    first : numpy.ndarray
        int64 (n,). Id of the ball struck first (the lowest of several at once); -1 if none was.
    places, potted : numpy.ndarray
        float64 (n, 22, 2), centres at rest [m] before colours are respotted, of a potted ball where it fell;
        int64 (n, 22), pocket of each ball, an index into ``snooker_env.POCKETS``, or -1.
    afterstates : Positions
        n rows: the balls at rest, with colours respotted, and the ball on for the next stroke.
    observations : numpy.ndarray
        float32 (n, 121). The flat observation of each afterstate, as ``observation="flat"`` of a visit.

    Examples
    --------
    >>> from snooker_env.planning import Planner, Position
    >>> outcomes = Planner({"action": "discrete"}).play(Position(cue=(0.0, 0.9), black=(0.4, 1.3)), [0], [67])
    >>> outcomes.points.tolist(), outcomes.goes_on.tolist(), int(outcomes.first[0]), int(outcomes.potted[0, 21])
    ([7.0], [False], 21, 3)
    """

    points: NDArray[np.float64]
    penalty: NDArray[np.int64]
    goes_on: NDArray[np.bool_]
    first: NDArray[np.int64]
    places: NDArray[np.float64]
    potted: NDArray[np.int64]
    afterstates: Positions
    observations: NDArray[np.float32]


class Planner:
    """Plays strokes on copies of positions exactly as the environment would: same physics, rules and errors.

    Each stroke is judged as one of a *visit*, which ends with the first miss, foul or clearance; penalties,
    free balls, the foul-and-miss rule and the opponent of a frame are not covered.

    A *stroke* is a row of five numbers in SI: cue speed [m/s], side and top (tip offset over R, to the right
    and up), the direction in which the cue ball leaves the tip [rad], elevation of the cue [rad]. The cue
    itself points aside from that direction by the squirt of the side; under a raised cue the cloth then turns
    the ball.

    With ``conditions="drawn"`` positions that were taken from an environment are played with the constants of
    their tables; other ones, and all of a planner with "fixed", with those of ``physics``.

    Parameters
    ----------
    env_or_options : Env, VectorEnv, AECEnv, Options or dict
        An environment of this package, wrapped or not, an ``Options``, or a dict of its fields: the action
        format, the noise, the physics, the table and the fidelity.
    noise : str, dict or Noise, optional
        Execution noise in place of the environment's; "none" plays all strokes as intended.
    threads : int, optional
        Number of threads, in [1, 1024]; default one for each processor. Results do not depend on it.

    Examples
    --------
    >>> import numpy as np
    >>> from snooker_env.planning import Planner, Position
    >>> planner = Planner({"action": "discrete", "noise": "club"})
    >>> position = Position(cue=(0.0, 0.9), black=(0.4, 1.3))
    >>> planner.play(position, np.zeros(20, int), np.full(20, 67), keys=np.arange(20)).points.shape
    (20,)
    """

    def __init__(
        self,
        env_or_options: Environment | Options | Mapping[str, Any],
        *,
        noise: NoiseLike | None = None,
        threads: int | None = None,
    ):
        rules = options_in(env_or_options).rules
        errors = rules.noise if noise is None else Noise.of(noise)
        plain = {"reward": REWARDS[0], "one_stroke": False, "observation": "flat"}
        self._rules = replace(rules, noise=errors, **plain)
        usual = min(1024, processors())
        self._threads = Threads(usual if threads is None else integer("threads", threads, 1, 1024))
        self._visits = TrialVisits(self._rules, 0)

    @property
    def threads(self) -> int:
        """Number of threads that play strokes, an int."""
        return self._threads.threads

    @property
    def rules(self) -> Rules:
        """What decides a stroke's outcome, a ``Rules``."""
        return self._rules

    def play(
        self,
        positions: PositionsLike,
        rows: Integers,
        actions: Vectors | Integers,
        keys: Integers | Sequence[Integers] | None = None,
    ) -> Outcomes:
        """Play n actions, each on a copy of its position, and return ``Outcomes``.

        ``rows`` int (n,): row of the m ``positions`` (see ``Positions.of``) for each action. ``actions``: float (n, k),
        or int (n,) with ``action="discrete"``. The errors are drawn by ``keys``, int (n,) in [0, 2**64), or (n, 2) with a
        counter as a saved state has them: equal keys give equal errors for every stroke (common random numbers).
        Without noise no keys are needed.

        ValueError for arguments out of range and for positions that are invalid or have no stroke to play,
        SimulationError if a shot cannot be computed. Threads may call this at once; a stroke takes 20 us."""
        at, which = self._read(positions, rows)
        told = self._rules.actions.check_many(cast(ArrayLike, actions), len(which))
        return self._play(at[which], told, _streams(keys, len(which), self._rules.noise.silent), None)

    def play_strokes(
        self,
        positions: PositionsLike,
        rows: Integers,
        strokes: Vectors,
        keys: Integers | Sequence[Integers] | None = None,
        *,
        errors: Vectors | None = None,
    ) -> Outcomes:
        """Play n strokes, float (n, 5) in SI, as ``play`` does actions; a cue ball in hand is played from where it lies.

        The errors are drawn by ``keys``, or they are ``errors``, float (n, 5) in standard deviations, of speed, side, top,
        aim and elevation, and no kicks."""
        at, which = self._read(positions, rows)
        n = len(which)
        told, streams = (
            check_strokes(strokes, n),
            _streams(keys, n, self._rules.noise.silent or errors is not None),
        )
        if errors is not None:
            if keys is not None:
                raise refuse_what(
                    "keys, errors", "both", "must be one of them: the errors are drawn or passed"
                )
            return self._play(at[which], told, streams, array("errors", errors, (n, COLUMNS)))
        drawn = np.zeros((n, COLUMNS)) if self._rules.noise.silent else self._rules.noise.errors_of(streams)
        return self._play(at[which], told, streams, drawn, self._rules.noise.kick)

    def _read(self, positions: PositionsLike, rows: Integers) -> tuple[Positions, Ints]:
        """The positions as visits, and the checked rows."""
        at = Positions.of(positions).as_visits().known_to(self._rules)
        which = rows_of(at, rows)
        check_has_stroke(at, which, self._rules.table, self._rules.physics.R)
        return at, which

    def _play(
        self, after: Positions, told: Floats, streams: Words, errors: Floats | None, kick: float = 0.0
    ) -> Outcomes:
        """Play checked actions, or strokes under ``errors``, on ``after``, which is played in place."""
        visits = copy.copy(self._visits)
        visits.kick = kick
        visits.lay(after, streams, errors)
        out, n = visits.output(), len(told)
        visits.step(told, np.zeros(n, np.bool_), out, self._threads)
        penalty, first = (out.counts[:, column].copy() for column in (I_PENALTY, I_FIRST))
        points = out.reals[:, I_POINTS].copy()
        where = visits.places, visits.potted
        return Outcomes(points, penalty, ~after.over, first, *where, after, out.observations)

    def strokes_of(
        self, positions: PositionsLike, rows: Integers, actions: Vectors | Integers
    ) -> tuple[NDArray[np.float64], Positions]:
        """Decode actions or choices (n, k) or (n,), see ``play``: which strokes do they mean?

        Returns float64 (n, 5), strokes in SI without errors, and n ``Positions`` that they are played from,
        with a cue ball in hand on the place that the action names."""
        at = Positions.of(positions)
        which = rows_of(at, rows)
        return decode(
            self._rules, at, which, self._rules.actions.check_many(cast(ArrayLike, actions), len(which))
        )

    def pot_aim(
        self,
        positions: PositionsLike,
        rows: Integers,
        balls: Integers,
        targets: Vectors,
        strokes: Scalars | Vectors,
        *,
        ghosts: Vectors | None = None,
    ) -> NDArray[np.float64]:
        """Solve aims as ``planning.pot_aim`` with this planner's physics and fidelity: float64 (n,)."""
        dynamics = Dynamics.of(self._rules)
        at = Positions.of(positions).known_to(self._rules)
        return solved_aims(at, rows, balls, targets, strokes, ghosts, dynamics)


def options_in(source: object) -> Options:
    """The ``Options`` of an environment, of a dict, or as they are; ValueError for anything else."""
    if isinstance(source, Mapping):
        source = options_of(None, source)
    options = source if isinstance(source, Options) else getattr(bare(source), "options", None)
    if not isinstance(options, Options):
        allowed = "must be an environment of snooker_env, an Options, or a dict of its fields"
        raise refuse_what("env_or_options", f"a {type(source).__name__}", allowed)
    return options


def _streams(keys: Integers | Sequence[Integers] | None, n: int, silent: bool) -> NDArray[np.uint64]:
    """The random stream of each stroke, key and counter: uint64 (n, 2)."""
    streams = np.zeros((n, 2), np.uint64)
    if keys is None and silent:
        return streams
    allowed = f"{n} integers in [0, 2**64), a noise sample for each stroke"
    if keys is None:
        raise refuse("keys", None, f"must be given with execution noise: {allowed}")
    # NumPy converts a list of large and small integers to floats
    numbers = keys if isinstance(keys, np.ndarray) else np.array(keys, object)
    whole = (isinstance(k, int | np.integer) and 0 <= k < 2**64 for k in numbers.flat)
    if numbers.dtype == object and all(whole):
        numbers = numbers.astype(np.uint64)
    if numbers.shape not in ((n,), (n, 2)):
        raise refuse_what("keys", f"array of shape {numbers.shape}", f"must be {allowed}")
    negative = numbers.dtype.kind == "i" and bool((numbers < 0).any())
    if negative or numbers.dtype.kind not in "iu":
        what = "negative numbers" if negative else f"array of {numbers.dtype}"
        raise refuse_what("keys", what, f"must be {allowed}")
    streams[:, : numbers.ndim] = numbers.reshape(n, -1)
    return streams
