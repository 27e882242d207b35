"""What do visits and frames share? n tables side by side: reset, step, infos, states, for ``SnookerEnv`` with one
table and ``SnookerVectorEnv`` with thousands, on threads."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from typing import Any, TypeAlias, TypeVar

import numpy as np
from gymnasium import spaces

from .._lib.check import refuse
from .._lib.jit import entry, kernel
from .._lib.types import Bools, Floats, Ints, Masks, Singles, Words
from ..game.balls import COLOURS_MASK, CUE, N_BALLS, BallOn, balls_on, mask_of_present
from ..game.frame_columns import BALL_ON, FREE_BALL, IN_HAND, OVER
from ..game.philox import pair, stream_of
from ..geometry import BALL_RADIUS
from ..physics.conditions import COLUMNS as CONDITIONS
from ..physics.conditions import END_MASS_RATIO, draw_constants, scale_to_unit
from ..physics.conditions import NAMES as CONDITION_NAMES
from ..physics.events import Status
from ..physics.parameters import Physics, nominal, pack_into, physics_with
from ..simulation import WHY, Shot, SimulationError
from . import discrete_actions, observations, stroke
from .box_actions import Actions
from .discrete_actions import Choices
from .foreseen import Errors, foresee
from .kernel_arrays import C_END_MASS, Packed
from .noise import Noise
from .options import NEVER, Rules
from .played import Played, fields_of
from .states import FrameState, State
from .stroke_menu import Menu, menu_masks

REALS = ("points", "break", "seconds")
COUNTS = ("penalty", "pots", "fouls", "ball_on", "first_ball", "events")
"""Entries of a step's info, floats and integers; "foul", whether ``fouls`` is not 0, is added."""
(I_POINTS, I_BREAK, I_SECONDS) = range(3)
(I_PENALTY, I_POTS, I_FOULS, I_BALL_ON, I_FIRST, I_EVENTS) = range(6)


@kernel
def write_stroke_info(k, out, j, shots, ball_on, result):
    """Write the info of table k for shot j, on which the referee made the ``Ruling`` result."""
    reals, counts, seen = out.reals, out.counts, shots.seen[j]
    reals[k, I_POINTS], reals[k, I_SECONDS] = result.points, shots.duration[j]
    pots, lowest = 0, -1
    for i in range(N_BALLS - 1, 0, -1):
        pots += (seen[stroke.DOWN] >> i) & 1
        lowest = i if (seen[stroke.FIRST] >> i) & 1 else lowest
    counts[k, I_PENALTY], counts[k, I_POTS], counts[k, I_FOULS] = result.penalty, pots, result.fouls
    counts[k, I_BALL_ON], counts[k, I_FIRST], counts[k, I_EVENTS] = ball_on, lowest, shots.n_events[j]


@kernel
def write_empty_info(k, out, ball_on):
    """Write the info of table k if no stroke was played."""
    reals, counts = out.reals, out.counts
    for c in range(reals.shape[1]):
        reals[k, c] = 0.0
    for c in range(counts.shape[1]):
        counts[k, c] = 0
    counts[k, I_BALL_ON], counts[k, I_FIRST] = ball_on, -1


@entry
def uniform(which, streams, out):
    """Uniform numbers in [0, 1) from the streams of the tables ``which``: one row of ``out`` each."""
    for j in range(which.shape[0]):
        for c in range(0, out.shape[1], 2):
            out[j, c], out[j, c + 1] = pair(streams[which[j]])


Task: TypeAlias = Callable[[Ints, stroke.ShotBuffers], None]
"""Work on some tables, called as ``task(which, buffers)``."""
Watch: TypeAlias = Callable[[int, stroke.ShotBuffers, int, bool], None]
"""Called as ``watch(k, buffers, j, reported)`` after each stroke on table k; ``reported``: the agent's."""


class StepOutput:
    """The results of a step or reset of n tables; ``last`` only if one step both ends and starts episodes."""

    def __init__(self, n: int, size: int, reals: int, counts: int, *, last: bool = False, choices: int = 0):
        self.observations: Singles = np.zeros((n, size), np.float32)
        self.rewards: Floats = np.zeros(n)
        self.terminated: Bools = np.zeros(n, np.bool_)
        self.truncated: Bools = np.zeros(n, np.bool_)
        # the data of the infos: one column for each of ``REALS`` and ``COUNTS``
        self.reals: Floats = np.zeros((n, reals))
        self.counts: Ints = np.zeros((n, counts), np.int64)
        # the available choices; without rows unless the observations hold them
        self.masks: Masks = np.zeros((n if choices else 0, choices), np.int8)
        # observations, infos and masks of the episodes that ended where new ones were started
        kept = self.observations, self.reals, self.counts, self.masks
        self.last: tuple[Any, ...] = tuple(map(np.zeros_like, kept)) if last else ()

    @property
    def arrays(self) -> tuple[Any, ...]:
        """For kernels: the parts of ``OutputArrays``, in a plain tuple."""
        return self.observations, self.rewards, self.terminated, self.truncated, self.reals, self.counts

    def keep_last(self, ended: Ints) -> None:
        """Keep the rows of the tables ``ended``, before the next episode overwrites them."""
        rows = self.observations, self.reals, self.counts, self.masks
        for kept, row in zip(self.last, rows, strict=True):
            if len(row):
                kept[ended] = row[ended]


class Crew:
    """Runs ``task(part, buffers)``, here on all at once."""

    def __init__(self, buffers: stroke.ShotBuffers | None = None, watch: Watch | None = None):
        self.buffers: stroke.ShotBuffers | None = buffers  # None for a crew that allocates its own
        self.watch: Watch | None = watch

    def __call__(self, which: Ints, task: Task) -> None:
        """Run the task."""
        if len(which):
            assert self.buffers is not None
            task(which, self.buffers)

    def saw(self, which: Ints, buffers: stroke.ShotBuffers, reported: bool) -> None:
        """Report the strokes just played on the tables ``which``."""
        if self.watch is not None:
            for j, k in enumerate(which.tolist()):
                alone = buffers.enlarged.get(j)
                self.watch(k, buffers if alone is None else alone, j if alone is None else 0, reported)


_T = TypeVar("_T", bound="Tables")


class Tables(ABC):
    """n tables, each in the middle of its own episode; ``limit``: steps after which one is truncated."""

    REALS: tuple[str, ...] = REALS
    COUNTS: tuple[str, ...] = COUNTS
    FLAGS: tuple[str, ...] = ()  # those of ``COUNTS`` that infos give as bool
    COLUMNS = 0  # of ``game``

    rules: Rules
    n: int
    limit: int
    positions: Floats  # (n, 22, 2) [m]
    on_table: Bools  # (n, 22)
    nominated: Ints = np.empty(0, np.int64)  # (n,) of frames: what each striker has nominated
    actions: tuple[Actions | Choices, ...]  # of each seat, as the next
    noises: tuple[Noise, ...]
    cues: Floats  # packed: one row, or one a table if the conditions are drawn
    phys: Floats  # packed constants, likewise

    def __init__(self, rules: Rules, n: int, *, limit: int = NEVER):
        self.rules, self.n, self.limit = rules, n, limit
        self.positions, self.on_table = np.zeros((n, N_BALLS, 2)), np.zeros((n, N_BALLS), np.bool_)
        self.game: Ints = np.zeros((n, self.COLUMNS), np.int64)  # columns of ``game.frame_columns``
        self.game[:, BALL_ON], self.game[:, OVER] = -1, True
        self.streams: Words = np.zeros((n, 2), np.uint64)  # key and counter of each table's random stream
        self.begun: Bools = np.zeros(n, np.bool_)  # which have an episode, possibly one that has ended
        self.reals: tuple[str, ...] = self.REALS  # with the constants if they are drawn
        # constants drawn, (n, 8); no rows: they are fixed
        self.conditions: Floats = np.empty((0, CONDITIONS))
        _, self.cues, _, self.phys = rules.pack()
        self._read((rules.actions,), (rules.noise,))
        if rules.drawn:
            self.reals = (*self.REALS, *CONDITION_NAMES)
            self.conditions = np.tile(nominal(rules.physics), (n, 1))
            self.cues, self.phys = np.repeat(self.cues, n, axis=0), np.tile(rules.physics.pack(), (n, 1))
        more = {"replaced": rules.miss != "off", "conditions": rules.observed, "speeds": rules.speeds}
        self.SIZE: int = observations.size_of(rules.observation, self.COLUMNS > FREE_BALL, **more)

    def _read(self, actions: tuple[Actions | Choices, ...], noises: tuple[Noise, ...]) -> None:
        """Take the actions and errors of the seats, also as the kernels need them."""
        rules, real = self.rules, self.rules.cue == "real"
        self.actions, self.noises = actions, noises
        self._own: tuple[tuple[Floats, Floats], ...] = tuple(
            (its.pack(), noise.pack(BALL_RADIUS, real=real))
            for its, noise in zip(actions, noises, strict=True)
        )
        self._errors: tuple[Errors, ...] = tuple(Errors.of(n, rules.physics, rules.speeds) for n in noises)

    def pack(self, side: int = 0) -> Packed:
        """The rules for the kernels, with the actions and errors of the seat ``side``."""
        options, errors = self._own[side]
        return options, self.cues, errors, self.phys

    @property
    def arrays(self) -> tuple[Any, ...]:
        """For kernels: the parts of ``kernel_arrays.TableArrays``, in a plain tuple."""
        return self.positions, self.on_table, self.game, self.streams, self.nominated

    def seed(self, k: int, rng: np.random.Generator) -> None:
        """Give table k a new stream with a key drawn from a NumPy generator."""
        self.streams[k] = stream_of(rng)

    def output(self, *, last: bool = False) -> StepOutput:
        """New arrays for the results of a step or reset."""
        shown = self.actions[0] if self.rules.observation == "masked" else None
        choices = shown.choices if isinstance(shown, Choices) else 0
        sizes = self.n, self.SIZE, len(self.reals), len(self.COUNTS)
        return StepOutput(*sizes, last=last, choices=choices)

    def observation_space(self, side: int = 0) -> spaces.Space[Any]:
        """The space of what the seat ``side`` observes, float32 and int8; a Box, or a Dict of boxes."""
        its = self.actions[side]
        choices = its.choices if isinstance(its, Choices) else 0
        return observations.space(self.rules.observation, self.SIZE, choices)

    def info(self, out: StepOutput, k: int) -> dict[str, Any]:
        """The info of table k alone, as Python numbers."""
        info: dict[str, Any] = dict(zip(self.reals, out.reals[k].tolist(), strict=True))
        info |= zip(self.COUNTS, out.counts[k].tolist(), strict=True)
        info |= {name: info[name] != 0 for name in self.FLAGS}
        return info | {"foul": info["fouls"] != 0}

    def infos(self, reals: Floats, counts: Ints, present: Bools | None = None) -> dict[str, Any]:
        """Infos as of Gymnasium's vector environments: arrays, and masks of the tables that they hold for, or all."""
        present = np.ones(self.n, np.bool_) if present is None else present
        every = zip((*self.reals, *self.COUNTS), (*reals.T, *counts.T), strict=True)
        infos: dict[str, Any] = {name: column * present for name, column in every}
        infos |= {name: infos[name] != 0 for name in self.FLAGS} | {"foul": infos["fouls"] != 0}
        return infos | {f"_{name}": present.copy() for name in infos}

    def record(self, k: int, buffers: stroke.ShotBuffers, j: int) -> Played:
        """The stroke just played on table k, shot j of the buffers, and the table after it."""
        game, standing, fields = self.game[k], self.standing(k), fields_of(buffers, j)
        if fields["points"]:
            standing["break_points"] = fields["break_before"] + fields["points"]  # also if it ended the frame
        balls = {"positions": self.positions[k].copy(), "on_table": self.on_table[k].copy()}
        in_hand, over = game[[IN_HAND, OVER]].astype(bool).tolist()
        after = {"next_on": BallOn(game[BALL_ON]), "in_hand": in_hand, "over": over}
        noise = self.noises[min(fields["player"], len(self.noises) - 1)]  # alone, the agent has both turns
        own = {"shot": self.shot(k, buffers, j), "cue_kind": self.rules.cue, "noise": noise}
        return Played(**own, **balls, **after, **fields, **standing)

    def shot(self, k: int, buffers: stroke.ShotBuffers, j: int) -> Shot:
        """Shot j of the buffers, played on table k."""
        return buffers.shot(j, self.rules.table, self.physics_of(k))

    def on(self, k: int) -> int:
        """The mask of the balls that may be struck first on table k; with a free ball every colour."""
        row, mask = self.game[k], mask_of_present(self.on_table[k])
        free = COLOURS_MASK & mask if self.COLUMNS > FREE_BALL and row[FREE_BALL] else 0
        return balls_on(int(row[BALL_ON]), mask) | free

    def action_masks(self, which: Ints | None = None, side: int = 0) -> Bools:
        """The choices of the seat ``side`` on the tables ``which`` (all if None): bool (len(which), choices); ValueError for a Box."""
        which = np.arange(self.n) if which is None else which
        actions, balls = self.actions[side], (self.positions, self.on_table, self.game)
        if not isinstance(actions, Choices):
            raise refuse("action", "box", 'must be "discrete" or "strokes": a Box has no masks')
        out = np.empty((len(which), actions.choices), np.bool_)
        if isinstance(actions, Menu):
            menu_masks(which, *balls, actions.speeds, self.rules.rule_set.code, out)
        else:
            discrete_actions.masks(which, *balls, actions.pack(), self.rules.cue_row, out)
        return out

    def show_rest(self, which: Ints, out: StepOutput) -> None:
        """Write what the kernels leave of the results for the tables ``which``: strokes foreseen, constants, masks."""
        self.observe_rest(which, which, out.observations)
        if self.rules.drawn:
            out.reals[which, -CONDITIONS:] = self.conditions[which]
        if len(out.masks):
            out.masks[which] = self.action_masks(which)

    def observe_rest(self, which: Ints, at: Ints, rows: Singles, player: int = 0) -> None:
        """Write what they leave of the observations of ``player`` on the tables ``which`` into ``rows[at]``."""
        if self.rules.observation == "strokes":
            tables = self.positions, self.on_table, self.game
            law = self.rules.rule_set.code, self.cues, self.phys, *self.rules.fidelity
            errors = self._errors[min(player, len(self._errors) - 1)]
            foresee(which, at, player, tables, law, errors, rows)
        if self.rules.observed:
            rows[at, -CONDITIONS:] = scale_to_unit(self.conditions[which])

    def are_over(self) -> Bools:
        """Which tables have no stroke left to play: bool (n,)."""
        return ~self.begun | (self.game[:, OVER] != 0)

    def are_told_over(self) -> Bools:
        """Which episodes have ended, and a step has said so: bool (n,)."""
        return self.are_over()

    @property
    def unplayable(self) -> str:
        """Why the first table has no stroke left to play, in words."""
        return "is over" if self.begun[0] else "has not begun"

    def take(self: _T, rows: slice | Ints) -> _T:
        """The tables ``rows``: those of a slice share their state, those of an array are copies."""
        taken = object.__new__(type(self))
        for name, value in vars(self).items():
            setattr(taken, name, value[rows] if name in self._columns() else value)
        taken.n = len(taken.positions)
        return taken

    # the constants of tables

    def draw_conditions(self, which: Ints) -> None:
        """Draw the constants of the tables ``which`` from their own streams; nothing if they are fixed."""
        if self.rules.drawn and len(which):
            shares = np.empty((len(which), CONDITIONS))
            uniform(which, self.streams, shares)
            self.set_conditions(which, draw_constants(shares))

    def set_conditions(self, which: Ints, values: Floats) -> None:
        """Give the tables ``which`` these constants (len(which), 8)."""
        self.conditions[which] = values
        pack_into(self.phys, which, values, self.rules.physics)
        self.cues[which, C_END_MASS] = values[:, END_MASS_RATIO]

    def physics_of(self, k: int) -> Physics:
        """The constants of table k."""
        physics = self.rules.physics
        return physics_with(physics, tuple(self.conditions[k].tolist())) if self.rules.drawn else physics

    def _columns(self) -> tuple[str, ...]:
        """Names of the attributes that hold one row for each table."""
        own = ("conditions", "cues", "phys") if self.rules.drawn else ()
        return ("positions", "on_table", "game", "streams", "begun", *own)

    def interrupt(self) -> None:
        """A step or reset was cut short: tables at which it is not the agent's turn need a reset."""
        return

    def address(self, which: Ints, actions: Floats, buffers: stroke.ShotBuffers, side: int = 0) -> None:
        """Carry the actions (n, k) of the seat ``side`` out up to the strike, on the tables ``which``."""
        packed, fidelity = self.pack(side), self.rules.fidelity
        stroke.address(which, actions, self.arrays, buffers.struck, packed, fidelity)

    def run(self, which: Ints, buffers: stroke.ShotBuffers) -> list[int]:
        """Play the shots that have been struck; returns the rows of those that need ``again``."""
        m, phys = len(which), self.phys
        stroke.run(buffers, m, self.rules, phys if len(phys) == 1 else phys[which])
        status = buffers.status[:m]
        return np.flatnonzero(status).tolist() if status.any() else []

    def again(self, which: Ints, j: int, buffers: stroke.ShotBuffers) -> stroke.ShotBuffers:
        """Play shot j with a longer log in its own buffers, returned; SimulationError if it does not help."""
        k, one, status = which[j], buffers, buffers.status[j]
        while status == Status.LOG_FULL:
            one = self.play_again(k, self.on_table[k], j, buffers, 4 * one.log)
            status = one.status[0]
        if status != Status.OK:
            raise SimulationError(f"the shot on table {k} {WHY[Status(status)]}")
        buffers.enlarged[j] = one
        return one

    def play_again(
        self, k: int, here: Bools, j: int, b: stroke.ShotBuffers, log: int, *, path: bool = False
    ) -> stroke.ShotBuffers:
        """Shot j of ``b``, on table k with the balls ``here``, once more in its own buffers, uncounted; ``path``: with its path."""
        one, shot = stroke.ShotBuffers(1, log, path=path or b.segments.shape[1] > 0), b.shots[j]
        one.shots[0], one.seen[0], one.kicks[0] = shot, b.seen[j], b.kicks[j]
        velocity, spin = shot[[stroke.VX, stroke.VY]], shot[[stroke.WX, stroke.WY, stroke.WZ]]
        one.v[0, CUE], one.w[0, CUE], one.aloft[0, CUE, 1] = velocity, spin, shot[stroke.UZ]
        one.r[0], one.here[0] = self.positions[k], here
        phys = self.phys if len(self.phys) == 1 else self.phys[k : k + 1]
        stroke.run(one, 1, self.rules, phys, again=True)
        return one

    # what each task implements

    @abstractmethod
    def step(
        self, actions: Floats, waiting: Bools, out: StepOutput, crew: Crew, *, same_step: bool = False
    ) -> None:
        """One step of all tables: checked actions (n, k) float64, results into ``out``. Tables ``waiting`` (n,) begin a new episode
        instead; with ``same_step`` those that end begin one at once. After SimulationError a shot's balls lie as before."""

    @abstractmethod
    def reset(self, wanted: Bools, out: StepOutput, crew: Crew) -> None:
        """New episodes on the tables ``wanted`` (n,) bool; the results for all tables into ``out``."""

    @abstractmethod
    def observe(self, which: Ints, player: int = 0) -> Singles:
        """What ``player`` observes on the tables ``which``: float32 (len(which), SIZE), a new array."""

    @abstractmethod
    def get_state(self, k: int) -> dict[str, Any]:
        """Table k as JSON types, without "rng"."""
        balls = {"positions": self.positions[k].tolist(), "on_table": self.on_table[k].tolist()}
        if self.rules.drawn:
            balls["conditions"] = dict(zip(CONDITION_NAMES, self.conditions[k].tolist(), strict=True))
        return balls | {"stream": self.streams[k].tolist()}

    def _set_state(self, k: int, state: State | FrameState) -> None:
        """What all tasks restore alike: the random stream and the constants."""
        self.streams[k] = np.array(state.stream, np.uint64)
        if state.conditions is not None:
            self.set_conditions(np.array([k]), np.array([list(state.conditions.values())]))

    @abstractmethod
    def check_state(
        self, state: Mapping[str, Any], generator: np.random.Generator, *, to_play: bool = False
    ) -> State | FrameState:
        """The valid state that a dict describes; ValueError if it is none, or no shot is left ``to_play``."""

    @abstractmethod
    def set_state(self, k: int, state: State | FrameState) -> None:
        """Restore a valid state on table k."""

    @abstractmethod
    def standing(self, k: int) -> dict[str, Any]:
        """More fields of ``Played``: next_player, next_free_ball, scores, break_points, choice, winner, and of frames frame."""

    @abstractmethod
    def set_position(self, k: int, positions: Floats, on_table: Bools, game: Ints) -> None:
        """Begin an episode on table k with a valid position; ``game``: a visit's row. The stream goes on; the caller draws constants."""

    @abstractmethod
    def text(self, k: int) -> str:
        """One line of text for pictures."""
