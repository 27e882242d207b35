"""What do visits and frames share? n tables side by side: reset, step, infos, states. What differs is in ``visit`` and ``frame``.

A step of n tables is the same whoever asks: ``SnookerEnv`` with one table, ``SnookerVectorEnv`` with thousands, on threads.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeAlias, TypeVar

import numpy as np

from .._jit import kernel
from .._types import Bools, Floats, Ints, Singles, Words
from ..game.balls import N_BALLS, BallOn, balls_on, mask_of_present
from ..game.frame_columns import BALL_ON, IN_HAND, OVER
from ..game.philox import stream_of
from . import discrete_actions, stroke
from .options import NEVER, Rules
from .played import Played, judged, struck

REALS = ("points", "break", "seconds")
COUNTS = ("penalty", "pots", "fouls", "ball_on", "first_ball", "events")
"""What the info of a step says of a stroke in floats and in integers; and "foul", whether ``fouls`` is not 0."""
(I_POINTS, I_BREAK, I_SECONDS) = range(3)
(I_PENALTY, I_POTS, I_FOULS, I_BALL_ON, I_FIRST, I_EVENTS) = range(6)


@kernel
def copy_row(row, to):
    """Copy one row into another."""
    for c in range(len(row)):
        to[c] = row[c]


@kernel
def keep_last(k, out):
    """Keep what table k's rows of the outputs hold where a new episode cannot overwrite it, if there is room; ``out``: six arrays."""
    observations, reals, counts, last_observations, last_reals, last_counts = out
    if last_observations.shape[0]:
        copy_row(observations[k], last_observations[k])
        copy_row(reals[k], last_reals[k])
        copy_row(counts[k], last_counts[k])


@kernel
def tell_stroke(j, k, result, ball_on, seen, duration, n_events, reals, counts):
    """Write what the info of table k says of shot j, on which the referee gave the ``Ruling`` result."""
    reals[k, I_POINTS], reals[k, I_SECONDS] = result.points, duration[j]
    pots, lowest = 0, -1
    for i in range(N_BALLS - 1, 0, -1):
        pots += (seen[j, stroke.DOWN] >> i) & 1
        lowest = i if (seen[j, stroke.FIRST] >> i) & 1 else lowest
    counts[k, I_PENALTY], counts[k, I_POTS], counts[k, I_FOULS] = result.penalty, pots, result.fouls
    counts[k, I_BALL_ON], counts[k, I_FIRST], counts[k, I_EVENTS] = ball_on, lowest, n_events[j]


@kernel
def tell_nothing(k, ball_on, reals, counts):
    """Write the info of table k where no stroke was played."""
    for c in range(reals.shape[1]):
        reals[k, c] = 0.0
    for c in range(counts.shape[1]):
        counts[k, c] = 0
    counts[k, I_BALL_ON], counts[k, I_FIRST] = ball_on, -1


Task: TypeAlias = Callable[[Ints, stroke.ShotBuffers], None]
"""What is done for some tables, which it is given, in the buffers that it is given."""


Watch: TypeAlias = Callable[[int, stroke.ShotBuffers, int, bool], None]
"""Called as ``watch(k, buffers, j, own)`` after each stroke on table k: it is shot j of the buffers, ``own``: the agent's, in a match
anybody's."""


class StepOutput:
    """What a step or a reset of n tables returns, in fresh arrays; ``last`` only if one step both ends episodes and starts new ones."""

    observations: Singles
    """(n, size)"""
    rewards: Floats
    terminated: Bools
    truncated: Bools
    """(n,) each"""
    reals: Floats
    counts: Ints
    """What the infos say: a column for each of ``REALS`` and ``COUNTS``."""
    last_observations: Singles
    last_reals: Floats
    last_counts: Ints
    """The same of the episodes that ended where new ones were started; without rows otherwise."""

    def __init__(self, n: int, size: int, reals: Sequence[str], counts: Sequence[str], *, last: bool = False):
        self.observations = np.zeros((n, size), np.float32)
        self.rewards = np.zeros(n)
        self.terminated, self.truncated = np.zeros(n, np.bool_), np.zeros(n, np.bool_)
        self.reals, self.counts = np.zeros((n, len(reals))), np.zeros((n, len(counts)), np.int64)
        m = n if last else 0
        self.last_observations = np.zeros((m, size), np.float32)
        self.last_reals, self.last_counts = np.zeros((m, len(reals))), np.zeros((m, len(counts)), np.int64)

    @property
    def rows(self) -> tuple[Singles, Floats, Ints, Singles, Floats, Ints]:
        """What an episode's start overwrites, and where its end is kept."""
        return self.observations, self.reals, self.counts, self.last_observations, self.last_reals, self.last_counts


class Crew:
    """Who plays: hands the tables out to threads, or not; ``crew(which, task)`` calls ``task(part, buffers)`` for parts of ``which``.

    This one plays all in one go. ``generators``: of each table, for an opponent that is asked in Python.
    ``watch``: who is told of the strokes, if anybody.
    """

    buffers: Any
    """``ShotBuffers``, or None of a crew that hands out its own."""
    generators: Sequence[Any]
    watch: Watch | None

    def __init__(self, buffers: stroke.ShotBuffers | None = None, generators: Sequence[Any] = (), watch: Watch | None = None):
        self.buffers, self.generators, self.watch = buffers, generators, watch

    def __call__(self, which: Ints, task: Task) -> None:
        """Do it."""
        if len(which):
            task(which, self.buffers)

    def saw(self, which: Ints, buffers: stroke.ShotBuffers, own: bool) -> None:
        """The strokes of the tables ``which`` have just been played."""
        if self.watch is not None:
            for j, k in enumerate(which.tolist()):
                alone = buffers.enlarged.get(j)
                self.watch(k, buffers if alone is None else alone, j if alone is None else 0, own)


_T = TypeVar("_T", bound="Tables")


class Tables(ABC):
    """n tables, each in the middle of its own episode, played by the same ``Rules``; ``limit``: steps after which one is truncated."""

    REALS: tuple[str, ...] = REALS
    COUNTS: tuple[str, ...] = COUNTS
    FLAGS: tuple[str, ...] = ()
    """Those of ``COUNTS`` that infos give as bool."""
    SIZE = 0
    """Numbers in an observation."""
    COLUMNS = 0
    """Of ``game``."""

    rules: Rules
    n: int
    limit: int
    positions: Floats
    """(n, 22, 2) [m]"""
    on_table: Bools
    """(n, 22)"""
    game: Ints
    """(n, COLUMNS): of ``game.frame_columns``."""
    streams: Words
    """(n, 2) key and counter of each table's random numbers."""
    begun: Bools
    """(n,) which tables have an episode, that has perhaps ended."""
    packed: tuple[Floats, Floats, Floats]
    """For the kernels: options of the action, deviations of the noise, physical parameters."""

    def __init__(self, rules: Rules, n: int, *, limit: int = NEVER):
        self.rules, self.n, self.limit = rules, n, limit
        self.positions, self.on_table = np.zeros((n, N_BALLS, 2)), np.zeros((n, N_BALLS), np.bool_)
        self.game = np.zeros((n, self.COLUMNS), np.int64)
        self.game[:, BALL_ON], self.game[:, OVER] = -1, True
        self.streams = np.zeros((n, 2), np.uint64)
        self.begun = np.zeros(n, np.bool_)
        self.packed = rules.packed()

    def seed(self, k: int, rng: np.random.Generator) -> None:
        """Give table k a new stream, its key drawn from a numpy Generator."""
        self.streams[k] = stream_of(rng)

    def output(self, *, last: bool = False, given: Mapping[str, Any] | None = None) -> StepOutput:
        """Fresh arrays for what a step or reset returns, but for those that are ``given`` by their names."""
        out = StepOutput(self.n, self.SIZE, self.REALS, self.COUNTS, last=last)
        for name, array in (given or {}).items():
            array[...] = 0
            setattr(out, name, array)
        return out

    def info(self, out: StepOutput, k: int) -> dict[str, Any]:
        """The info of table k alone, as Python numbers."""
        info: dict[str, Any] = dict(zip(self.REALS, out.reals[k].tolist(), strict=True))
        info |= zip(self.COUNTS, out.counts[k].tolist(), strict=True)
        info |= {name: info[name] != 0 for name in self.FLAGS}
        return info | {"foul": info["fouls"] != 0}

    def infos(self, reals: Floats, counts: Ints, there: Bools) -> dict[str, Any]:
        """Infos as Gymnasium's vector environments give them: an array a key, and a mask of the tables that it is about."""
        infos: dict[str, Any] = {name: column * there for name, column in zip(self.REALS, reals.T, strict=True)}
        infos |= {name: column * there for name, column in zip(self.COUNTS, counts.T, strict=True)}
        infos |= {name: infos[name] != 0 for name in self.FLAGS}
        infos["foul"] = infos["fouls"] != 0
        return infos | {f"_{name}": there.copy() for name in infos}

    def played(self, k: int, buffers: stroke.ShotBuffers, j: int) -> Played:
        """The stroke that table k has just seen, shot j of the buffers, and the table as it left it."""
        game, seen, standing = self.game[k], buffers.seen[j].tolist(), self.standing(k)
        if seen[stroke.SCORED]:
            standing["break_points"] = seen[stroke.BREAK]  # with the stroke that ended the frame, too
        return Played(
            shot=buffers.shot(j, self.rules), cue=struck(buffers, j), positions=self.positions[k].copy(), on_table=self.on_table[k].copy(),
            next_on=BallOn(game[BALL_ON]), in_hand=bool(game[IN_HAND]), over=bool(game[OVER]), **judged(seen), **standing,
        )  # fmt: skip

    def on(self, k: int) -> int:
        """The mask of the balls that may be struck first on table k."""
        return balls_on(int(self.game[k, BALL_ON]), mask_of_present(self.on_table[k]))

    def action_masks(self, which: Ints | None = None) -> Bools:
        """Which discrete actions there are on the tables ``which`` (all if None): bool (len(which), discrete_actions.SIZE)."""
        which = np.arange(self.n) if which is None else which
        out = np.empty((len(which), discrete_actions.SIZE), np.bool_)
        discrete_actions.masks(which, self.positions, self.on_table, self.game, out)
        return out

    def ended(self) -> Bools:
        """On which tables there is nothing more to play: bool (n,)."""
        return ~self.begun | (self.game[:, OVER] != 0)

    def view(self: _T, k: int) -> _T:
        """Table k as tables of their own, of which there is one; they share its state."""
        one = object.__new__(type(self))
        here = slice(k, k + 1)
        for name, value in vars(self).items():
            setattr(one, name, value[here] if name in self._columns() else value)
        one.n = 1
        return one

    def _columns(self) -> tuple[str, ...]:
        """Names of the attributes that hold a row a table."""
        return ("positions", "on_table", "game", "streams", "begun")

    def interrupted(self) -> None:
        """A step or reset was cut short: tables at which it is not the agent's turn need a reset. In a visit there are none."""
        return

    def address(self, which: Ints, actions: Floats, buffers: stroke.ShotBuffers) -> None:
        """Carry the actions (n, k) of the tables ``which`` out up to the strike."""
        (options, noise, phys), (fidelity, n_steps), b = self.packed, self.rules.fidelity, buffers
        stroke.address(
            which, actions, self.positions, self.on_table, self.game, self.streams, options, noise, phys, fidelity, n_steps, b.r, b.v, b.w,
            b.here, b.shots,
        )  # fmt: skip

    def run(self, which: Ints, buffers: stroke.ShotBuffers) -> list[int]:
        """Play the shots of the tables ``which`` that have been struck; returns rows of shots that need ``again``, as a list."""
        m = len(which)
        stroke.run(buffers, m, self.rules, self.packed[2])
        status = buffers.status[:m]
        return np.flatnonzero(status).tolist() if status.any() else []

    def again(self, which: Ints, j: int, buffers: stroke.ShotBuffers) -> stroke.ShotBuffers:
        """Shot j once more with a longer log: its buffers."""
        k = which[j]
        return stroke.run_again(buffers, j, k, self.positions[k], self.on_table[k], self.rules, self.packed[2])

    # what each task says for itself ------------------------------------------------------------------------------------------

    @abstractmethod
    def step(self, actions: Floats, waiting: Bools, out: StepOutput, crew: Crew, *, same_step: bool = False) -> None:
        """One step of all tables: actions (n, k) float64 that were checked, results into ``out``."""

    @abstractmethod
    def reset(self, wanted: Bools, out: StepOutput, crew: Crew) -> None:
        """New episodes on the tables ``wanted`` (n,) bool; what a reset returns of all tables into ``out``."""

    @abstractmethod
    def observe(self, which: Ints, player: int = 0) -> Singles:
        """What ``player`` sees of the tables ``which``: float32 (len(which), SIZE), fresh. A visit has one player."""

    @abstractmethod
    def get_state(self, k: int) -> dict[str, Any]:
        """Table k as JSON types, without "rng"."""

    @abstractmethod
    def checked(self, state: Any, generator: np.random.Generator, *, to_play: bool = False) -> Any:
        """The sound state that a dict describes, for ``set_state``; ValueError if it is none."""

    @abstractmethod
    def set_state(self, k: int, state: Any) -> None:
        """Take over a sound state on table k."""

    @abstractmethod
    def standing(self, k: int) -> dict[str, Any]:
        """Of a ``Played`` on table k what only the task knows: next_player, next_free_ball, scores, break_points, choice, winner."""

    @abstractmethod
    def set_position(self, k: int, positions: Floats, on_table: Bools, game: Ints) -> None:
        """Begin an episode on table k with a sound position, ``game`` being the row of a visit; its random numbers go on."""

    @abstractmethod
    def text(self, k: int) -> str:
        """One line for the pictures."""
