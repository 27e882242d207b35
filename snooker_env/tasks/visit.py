"""How is a visit played, on one table or on thousands? Strokes until the first miss, foul or clearance."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from .._lib.jit import entry, kernel
from .._lib.types import Bools, Floats, Ints, Singles
from ..game.apply_ruling import settle_visit
from ..game.balls import N_BALLS, BallOn, balls_on_kernel, bits, next_on_kernel
from ..game.fouls import FLAG, VISIT
from ..game.frame_columns import BALL_ON, IN_HAND, OVER, POINTS, STEPS, VISIT_COLUMNS
from ..game.layouts import deal_tables
from ..game.pots import POT_COLUMNS
from ..geometry import BALL_RADIUS
from ..physics.engine import Status
from . import observations
from .kernel_arrays import C_RAILS, OutputArrays, PlayedArrays
from .lines import POTS
from .options import NEVER, Rules
from .rewards import REWARDS, reward_of
from .states import State, check_visit
from .stroke import JUMPED, ShotBuffers, see, write_ruling
from .tables import I_BREAK, Crew, StepOutput, Tables, write_empty_info, write_stroke_info

_OK = int(Status.OK)


@kernel
def _observe(out, positions, on_table, state, view, pots):
    """Write the observation of one table; ``pots``: work space."""
    on = balls_on_kernel(state[BALL_ON], bits(on_table))
    seen = positions, on_table, state[BALL_ON], on, state[IN_HAND], state[POINTS]
    if view.pots:
        observations.observe_pots_into(out, *seen, view, pots)
    else:
        observations.observe_into(out, *seen)


@entry(what="the referee of visits", seconds=4)
def _conclude(which, positions, on_table, game, shots, rules, view, output):
    """Judge the shots that came to rest, write all results. ``rules``: reward, limit of steps, one stroke."""
    shots, out, (reward, limit, one_stroke) = PlayedArrays(*shots), OutputArrays(*output), rules
    view, pots = observations.View(*view), np.empty((POTS, POT_COLUMNS))
    for j in range(which.shape[0]):
        if shots.status[j] != _OK:
            continue
        k = which[j]
        p, on, state = positions[k], on_table[k], game[k]
        facts = see(j, shots, p, on)
        for i in range(N_BALLS):
            p[i, 0], p[i, 1] = shots.r[j, i, 0], shots.r[j, i, 1]
        ball_on, flags = state[BALL_ON], FLAG.JUMP if shots.seen[j, JUMPED] else 0
        ruling = settle_visit(p, on, ball_on, state[POINTS], facts, flags, BALL_RADIUS)
        write_ruling(shots.seen[j], 0, ball_on, False, state[POINTS], ruling)
        state[BALL_ON], state[IN_HAND] = ruling.ball_on, ruling.in_hand
        state[POINTS] += ruling.points
        state[STEPS] += 1
        state[OVER] = one_stroke or ruling.visit_end != VISIT.CONTINUES
        out.rewards[k] = reward_of(reward, ruling.points, ruling.penalty)
        out.terminated[k], out.truncated[k] = state[OVER], state[STEPS] >= limit
        _observe(out.observations[k], p, on, state, view, pots)
        write_stroke_info(k, out, j, shots, ball_on, ruling)
        out.reals[k, I_BREAK] = state[POINTS]


@entry(what="the start of a visit", seconds=1)
def _begin(which, fresh, in_hand, tables, view, output):
    """Write the results of a reset; ``fresh``: start visits, already dealt."""
    (positions, on_table, game, _, _), out = tables, OutputArrays(*output)
    view, pots = observations.View(*view), np.empty((POTS, POT_COLUMNS))
    for j in range(which.shape[0]):
        k = which[j]
        mask, state = bits(on_table[k]), game[k]
        if fresh:
            state[BALL_ON], state[IN_HAND] = next_on_kernel(mask), in_hand
            state[POINTS] = state[OVER] = state[STEPS] = 0
        _observe(out.observations[k], positions[k], on_table[k], state, view, pots)
        write_empty_info(k, out, state[BALL_ON])
        out.reals[k, I_BREAK] = state[POINTS]


@entry
def observe(which, positions, on_table, game, view, out):
    """The observations of the tables ``which``: one row of ``out`` each."""
    view, pots = observations.View(*view), np.empty((POTS, POT_COLUMNS))
    for j in range(which.shape[0]):
        k = which[j]
        _observe(out[j], positions[k], on_table[k], game[k], view, pots)


class Visits(Tables):
    """n tables, each in the middle of its own visit."""

    COLUMNS = VISIT_COLUMNS

    def __init__(self, rules: Rules, n: int, *, limit: int = NEVER):
        super().__init__(rules, n, limit=limit)
        spread = rules.noise.spread(rules.physics, speed=observations.SHOWN_SPEED)
        pots, rails = rules.observation == "pots", rules.cue_row[C_RAILS:]
        self._view: observations.View = observations.View(pots, spread, rails)

    def step(
        self, actions: Floats, waiting: Bools, out: StepOutput, crew: Crew, *, same_step: bool = False
    ) -> None:
        """See ``Tables.step``. After SimulationError others may have been played, a cue ball stays placed."""
        anew = bool(waiting.any())

        def play(which, buffers):
            playing = which[~waiting[which]] if anew else which
            if len(playing):
                self._play(playing, actions, out, buffers)
                crew.saw(playing, buffers, True)
            if same_step:
                ended = which[out.terminated[which] | out.truncated[which]]
                out.keep_last(ended)
                self._begin(ended, out)
            elif anew:
                self._begin(which[waiting[which]], out)

        crew(np.arange(self.n), play)

    def _play(self, which: Ints, actions: Floats, out: StepOutput, buffers: ShotBuffers) -> None:
        self.address(which, actions, buffers)
        unfinished = self.run(which, buffers)
        self._conclude(which, buffers, out)
        for j in unfinished:
            self._conclude(which[j : j + 1], self.again(which, j, buffers), out)

    def _conclude(self, which: Ints, b: ShotBuffers, out: StepOutput) -> None:
        rules = REWARDS.index(self.rules.reward), self.limit, self.rules.one_stroke
        tables = self.positions, self.on_table, self.game
        _conclude(which, *tables, b.played, rules, self._view, out.arrays)
        self.show_rest(which, out)

    def _begin(self, which: Ints, out: StepOutput, *, fresh: bool = True) -> None:
        if len(which):
            plan = self.rules.plan
            if fresh:
                deal_tables(which, plan.code, plan.tables, self.streams, self.positions, self.on_table)
                self.draw_conditions(which)
            _begin(which, fresh, plan.in_hand, self.arrays, self._view, out.arrays)
            self.show_rest(which, out)

    def reset(self, wanted: Bools, out: StepOutput, crew: Crew) -> None:

        def begin(which, buffers):
            self._begin(which[wanted[which]], out)
            self._begin(which[~wanted[which]], out, fresh=False)

        self.begun[wanted] = True
        crew(np.arange(self.n), begin)

    def observe(self, which: Ints, player: int = 0) -> Singles:
        rows = np.empty((len(which), self.SIZE), np.float32)
        observe(which, self.positions, self.on_table, self.game, self._view, rows)
        self.observe_rest(which, np.arange(len(which)), rows)
        return rows

    def get_state(self, k: int) -> dict[str, Any]:
        """See ``Tables.get_state``: the fields of a ``states.State`` except "rng"."""
        ball_on, in_hand, points, over, _ = self.game[k].tolist()
        visit = {"ball_on": ball_on, "in_hand": bool(in_hand), "points": points, "over": bool(over)}
        return super().get_state(k) | visit

    def check_state(
        self, state: Mapping[str, Any], generator: np.random.Generator, *, to_play: bool = False
    ) -> State:
        return check_visit(state, self.rules, generator, to_play=to_play)

    def set_state(self, k: int, state: State) -> None:
        """See ``Tables.set_state``; its steps are counted from 0."""
        self.positions[k], self.on_table[k] = state.positions, state.on_table
        self.game[k] = state.ball_on, state.in_hand, state.points, state.over, 0
        self._set_state(k, state)
        self.begun[k] = True

    def standing(self, k: int) -> dict[str, Any]:
        """See ``Tables.standing``: there is one player, whose break is its score."""
        points = int(self.game[k, POINTS])
        now = {"scores": (points,), "break_points": points, "winner": None, "choice": False}
        return now | {"next_player": 0, "next_free_ball": False}

    def set_position(self, k: int, positions: Floats, on_table: Bools, game: Ints) -> None:
        self.positions[k], self.on_table[k], self.game[k] = positions, on_table, game
        self.begun[k] = True

    def text(self, k: int) -> str:
        on = BallOn(self.game[k, BALL_ON]).name.lower().replace("_", " ")
        return f"break {self.game[k, POINTS]}   on: {on}   reds: {int(self.on_table[k, 1:16].sum())}"
