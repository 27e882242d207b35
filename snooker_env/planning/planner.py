"""What would strokes lead to? ``Planner`` plays them on copies of positions by the rules."""

import copy
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike

from .._lib.check import array, integer, refuse, refuse_what
from .._lib.types import Bools, Environment, Floats, Integers, Ints, Scalars, Singles, Vectors, Words
from ..game.balls import N_BALLS
from ..geometry import BALL_RADIUS
from ..physics.cue import MAX_ELEVATION
from ..tasks.noise import Noise, NoiseLike
from ..tasks.options import Options, Rules, options_of
from ..tasks.rewards import REWARDS
from ..tasks.tables import I_FIRST, I_PENALTY, I_POINTS
from ..tasks.threads import Threads, processors
from .aims import Dynamics, check_columns, law_of, solve_aims
from .positions import Positions, PositionsLike, bare, check_has_stroke, integers
from .stroke_columns import COLUMNS, SPEED
from .strokes import check_strokes, decode
from .trials import TrialVisits

RulesLike: TypeAlias = Environment | Options | Mapping[str, Any]  # a dict: fields of ``Options``
Keys: TypeAlias = Integers | Sequence[Integers] | None


class Outcomes(NamedTuple):
    """What n strokes led to.

    Attributes
    ----------
    points, penalty, goes_on : numpy.ndarray
        float64 (n,), points scored, 0 for a miss or a foul; int64 (n,), penalty points of a foul, or 0; bool (n,), whether
        the visit continues.
    first : numpy.ndarray
        int64 (n,). Id of the ball struck first (the lowest of several at once); -1 if none was.
    places, potted : numpy.ndarray
        float64 (n, 22, 2), centres at rest [m] before colours are respotted, of a potted ball where it fell;
        int64 (n, 22), pocket of each ball, an index into ``snooker_env.POCKETS``, or -1.
    afterstates, observations : Positions, numpy.ndarray
        n rows, with colours respotted and the ball on for the next stroke; float32 (n, 121), ``observation="flat"`` of them.

    Examples
    --------
    >>> from snooker_env.planning import Planner, Position
    >>> outcomes = Planner({"action": "discrete"}).play(Position(cue=(0.0, 0.9), black=(0.4, 1.3)), [0], [67])
    >>> outcomes.points.tolist(), outcomes.goes_on.tolist(), int(outcomes.first[0]), int(outcomes.potted[0, 21])
    ([7.0], [False], 21, 3)
    """

    points: Floats
    penalty: Ints
    goes_on: Bools
    first: Ints
    places: Floats
    potted: Ints
    afterstates: Positions
    observations: Singles


class Planner:
    """Plays strokes on copies of positions exactly as the environment would: same physics, rules and errors.

    Each stroke is judged as one of a *visit*, which ends with the first miss, foul or clearance. With ``conditions="drawn"``
    positions of an environment are played with the constants of their tables, others with those of ``physics``.

    A *stroke* is a row of five numbers in SI: cue speed [m/s], side and top (tip offset over R, to the right and up), the
    direction in which the cue ball leaves the tip [rad], elevation of the cue [rad]. The cue itself points aside from that
    direction by the squirt of the side; under a raised cue the cloth then turns the ball.

    Parameters
    ----------
    env_or_options : Env, VectorEnv, AECEnv, Options or dict
        An environment of this package, wrapped or not, an ``Options``, or a dict of its fields.
    noise, threads : optional
        Execution noise, a str, dict or ``Noise``, in place of the environment's; an int in [1, 1024], by default one for each
        processor, on which no result depends.

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
        self, env_or_options: RulesLike, *, noise: NoiseLike | None = None, threads: int | None = None
    ):
        rules = options_in(env_or_options).rules
        errors = rules.noise if noise is None else Noise.of(noise)
        plain = {"reward": REWARDS[0], "one_stroke": False, "observation": "flat"}
        self.rules: Rules = replace(rules, noise=errors, **plain)
        usual = min(1024, processors())
        self.threads: int = usual if threads is None else integer("threads", threads, 1, 1024)
        self._threads, self._visits = Threads(self.threads), TrialVisits(self.rules, 0)

    def play(
        self, positions: PositionsLike, rows: Integers, actions: Vectors | Integers, keys: Keys = None
    ) -> Outcomes:
        """Play n actions, each on a copy of its position, and return ``Outcomes``.

        ``rows`` int (n,): row of the m ``positions`` (see ``Positions.of``) for each action. ``actions``: float (n, k),
        or int (n,) with ``action="discrete"``. The errors are drawn by ``keys``, int (n,) in [0, 2**64), or (n, 2) with a
        counter as a saved state has them: equal keys give equal errors (common random numbers); without noise None.

        ValueError for arguments out of range and for positions that are invalid or have no stroke to play,
        SimulationError if a shot cannot be computed. Threads may call this at once; a stroke takes 20 us."""
        at, which = self._read(positions, rows)
        told = self.rules.actions.check(cast(ArrayLike, actions), len(which))
        return self._play(at[which], told, _streams(keys, len(which), self.rules.noise.silent), None)

    def play_strokes(
        self,
        positions: PositionsLike,
        rows: Integers,
        strokes: Vectors,
        keys: Keys = None,
        *,
        errors: Vectors | None = None,
    ) -> Outcomes:
        """Play n strokes, float (n, 5) in SI, as ``play`` does actions; a cue ball in hand is played from where it lies.

        The errors are drawn by ``keys``, or they are ``errors``, float (n, 5) in standard deviations, of speed, side, top,
        aim and elevation, and no kicks."""
        (at, which), noise = self._read(positions, rows), self.rules.noise
        told, n = check_strokes(strokes, len(which)), len(which)
        streams = _streams(keys, n, noise.silent or errors is not None)
        if errors is not None:
            if keys is not None:
                allowed = "must be one of them: the errors are drawn or passed"
                raise refuse_what("keys, errors", "both", allowed)
            return self._play(at[which], told, streams, array("errors", errors, (n, COLUMNS)))
        drawn = np.zeros((n, COLUMNS)) if noise.silent else noise.errors_of(streams)
        return self._play(at[which], told, streams, drawn, noise.kick)

    def _read(self, positions: PositionsLike, rows: Integers) -> tuple[Positions, Ints]:
        """The positions as visits, and the checked rows."""
        at = Positions.of(positions).as_visits().known_to(self.rules)
        which = integers("rows", rows, 0, len(at) - 1)
        check_has_stroke(at, which, self.rules.table, self.rules.physics.R)
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
        points, where = out.reals[:, I_POINTS].copy(), (visits.places, visits.potted)
        return Outcomes(points, penalty, ~after.over, first, *where, after, out.observations)

    def strokes_of(
        self, positions: PositionsLike, rows: Integers, actions: Vectors | Integers
    ) -> tuple[Floats, Positions]:
        """Decode actions or choices, see ``play``: float64 (n, 5), the strokes that they mean, without errors; and the n
        ``Positions`` that they are played from, with a cue ball in hand on the place that the action names."""
        at = Positions.of(positions)
        which = integers("rows", rows, 0, len(at) - 1)
        told = self.rules.actions.check(cast(ArrayLike, actions), len(which))
        return decode(self.rules, at, which, told)

    def pot_aim(
        self,
        positions: PositionsLike,
        rows: Integers,
        balls: Integers,
        targets: Vectors,
        strokes: Scalars | Vectors,
        *,
        ghosts: Vectors | None = None,
    ) -> Floats:
        """Solve the direction of the cue ball that sends a ball to a point, with throw, swerve and curve: float64 (n,) [rad].

        ``rows``, ``balls`` int (n,): row of the m ``positions``, and id of the ball to send, in [1, 21]. ``targets`` float
        (n, 2): where to [m], for a pocket its ``snooker_env.geometry.POCKET_AIMS[:, :2]``. ``strokes`` float (n, 5), of which
        the aims are not read; or float, scalar or (n,): cue speeds [m/s] of strokes in the middle of the ball. ``ghosts``
        float (n, 2): ghost-ball centres [m]; by default 2 R behind the ball as seen from the target.

        Only these two balls are simulated, on unbounded cloth; secant steps correct the direction until the ball passes the
        point by less than 1e-6 rad. If none succeeds (a soft stroke or a thin cut), the best direction tried is returned."""
        at, offset = Positions.of(positions).known_to(self.rules), self.rules.physics.max_offset
        which = integers("rows", rows, 0, len(at) - 1)
        n = len(which)
        ids, to = integers("balls", balls, 1, N_BALLS - 1, n), array("targets", targets, (n, 2))
        present = at.on_table[which, ids] & at.on_table[which, 0]
        if not present.all():
            k = int(np.argmin(present))
            raise refuse(f"balls[{k}]", int(ids[k]), "must be on the table, and the cue ball too")
        if ghosts is None:
            lie = at.positions[which, ids]
            along = to - lie
            behind = lie - 2.0 * BALL_RADIUS * along / np.maximum(np.hypot(*along.T), 1e-9)[:, None]
        else:
            behind = array("ghosts", ghosts, (n, 2))
        played, aims = np.zeros((n, COLUMNS)), np.empty(n)
        depth = np.ndim(strokes)  # type: ignore[arg-type]
        if depth == 2:
            played[:] = array("strokes", strokes, (n, COLUMNS))
        else:
            played[:, SPEED] = array("strokes", strokes, (n,) if depth else ())
        most = (np.inf, offset, offset, np.inf, MAX_ELEVATION)
        check_columns(played, (0.0, -offset, -offset, -np.inf, 0.0), most)
        law = law_of(Dynamics.of(self.rules), at)
        solve_aims((at.positions, at.on_table), which, ids, to, behind, played, law, aims)
        return aims


def options_in(source: object) -> Options:
    """The ``Options`` of an environment, of a dict, or as they are; ValueError for anything else."""
    if isinstance(source, Mapping):
        source = options_of(None, source)
    options = source if isinstance(source, Options) else getattr(bare(source), "options", None)
    if not isinstance(options, Options):
        allowed = "must be an environment of snooker_env, an Options, or a dict of its fields"
        raise refuse_what("env_or_options", f"a {type(source).__name__}", allowed)
    return options


def _streams(keys: Keys, n: int, silent: bool) -> Words:
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
