"""What do strokes lead to? Tables of one stroke each, filled with positions, by the rules of visits or of frames."""

from copy import copy
from dataclasses import replace

import numpy as np

from .._lib.jit import entry
from .._lib.types import Floats, Ints, Words
from ..game import frame_columns as columns
from ..game.balls import N_BALLS
from ..game.fouls import AUTO
from ..physics.conditions import END_MASS_RATIO
from ..physics.cue import squirt
from ..tasks import stroke
from ..tasks.box_actions import tip_on_disc
from ..tasks.frames import Frames
from ..tasks.kernel_arrays import C_END_MASS, C_MAX_OFFSET, Packed, StruckArrays, TableArrays
from ..tasks.noise import N_KICK, Noise, drawn_errors, kick_of, with_errors
from ..tasks.options import Rules
from ..tasks.rewards import FRAME_REWARDS
from ..tasks.stroke import ShotBuffers, row_of
from ..tasks.tables import Tables
from ..tasks.threads import Threads
from ..tasks.visit import Visits
from .aims import rows_under
from .positions import Positions
from .stroke_columns import AIM, ELEVATION, SIDE, SPEED, TOP

NO_NOISE = Noise()


@entry(what="strokes under given errors", seconds=2)
def _strike(which, strokes, errors, tables, shots, cues, noise, silent):
    """Strike the strokes (n, 5) of the tables ``which`` under standard normal errors (n, 5)."""
    tables, shots = TableArrays(*tables), StruckArrays(*shots)
    for j in range(which.shape[0]):
        k = which[j]
        cue_row = cues[row_of(k, cues)]
        speed, aim, elevation = strokes[k, SPEED], strokes[k, AIM], strokes[k, ELEVATION]
        side, top = tip_on_disc(strokes[k, SIDE], strokes[k, TOP], cue_row[C_MAX_OFFSET])
        p, on, aim = tables.positions[k], tables.on_table[k], aim - squirt(side, cue_row[C_END_MASS])
        meant = stroke.played_in((speed, side, top, aim, elevation), p, on, cue_row, shots.shots[j])
        struck = with_errors(*meant, errors[k], noise)
        stroke.strike_with(meant, struck, p, on, cue_row, j, shots)
        if silent[N_KICK] > 0.0:  # blocks are drawn as for errors, too
            drawn_errors(tables.streams[k], noise)
        shots.kicks[j] = kick_of(silent, tables.streams[k])


class Struck(Tables):
    """Tables of one stroke each, filled by ``lay``: of strokes (n, 5) with ``errors`` (n, 5), else of actions."""

    errors: Floats | None = None
    kick: float = 0.0  # the probability of a kick in strokes with ``errors``

    def __init__(self, rules: Rules, n: int):
        super().__init__(replace(rules, drawn=False, observed=False, observation="flat"), n)

    def lay(self, after: Positions, streams: Words, errors: Floats | None = None) -> None:
        """Put positions on the tables, with their own constants if they have any; they are played in place."""
        self.n, self.errors, self.streams = len(after), errors, streams
        if after.conditions is not None:
            _, self.cues, _, self.phys = packed_under(after.conditions, self.rules)
        self.positions, self.on_table, self.game = after.positions, after.on_table, after.game

    def address(self, which: Ints, actions: Floats, buffers: ShotBuffers, side: int = 0) -> None:
        if self.errors is None:
            super().address(which, actions, buffers, side)
            return
        _, cues, noise, _ = self.pack()
        silent = (Noise(kick=self.kick) if self.kick else NO_NOISE).pack(1.0)
        _strike(which, actions, self.errors, self.arrays, buffers.struck, cues, noise, silent)


class TrialVisits(Struck, Visits):
    """Visits of one stroke, which keep where it left the balls: ``places`` (n, 22, 2), and ``potted`` (n, 22)."""

    places: Floats
    potted: Ints

    def lay(self, after: Positions, streams: Words, errors: Floats | None = None) -> None:
        super().lay(after, streams, errors)
        self.places, self.potted = np.zeros((self.n, N_BALLS, 2)), np.zeros((self.n, N_BALLS), np.int64)

    def run(self, which: Ints, buffers: ShotBuffers) -> list[int]:
        unfinished = super().run(which, buffers)
        m = len(which)
        self.places[which], self.potted[which] = buffers.r[:m], buffers.potted[:m]
        return unfinished

    def again(self, which: Ints, j: int, buffers: ShotBuffers) -> ShotBuffers:
        one = super().again(which, j, buffers)
        self.places[which[j]], self.potted[which[j]] = one.r[0], one.potted[0]
        return one


class FrameTrials(Struck, Frames):
    """Frames of one stroke: strokes (n, 5) in SI with errors (n, 5) in standard deviations, judged as in a frame."""

    def __init__(self, rules: Rules, threads: Threads):
        super().__init__(replace(rules, reward=FRAME_REWARDS[0], one_stroke=False), 0)  # of a visit, too
        self._crew, self._out = threads, self.output()

    def play(self, at: Positions, rows: Ints, strokes: Floats, errors: Floats) -> Positions:
        """Play n strokes on copies of ``at[rows]``, in which cue balls have been placed and decisions made. Returns what they
        leave: whoever played is still player 0, so that ``STRIKER`` says who comes next."""
        trial, after = copy(self), at[rows]  # a copy: several threads may play at once
        trial.lay(after, np.zeros((len(after), 2), np.uint64), errors)

        def play(which: Ints, buffers: ShotBuffers) -> None:
            trial.address(which, strokes, buffers)
            trial.complete(which, trial._out, buffers, trial._crew, reported=False)

        trial._crew(np.arange(len(after)), play)
        return after

    def lay(self, after: Positions, streams: Words, errors: Floats | None = None) -> None:
        super().lay(after, streams, errors)
        if after.saved is None:
            after.saved = columns.Layouts(after.positions.copy(), after.on_table.copy())
        self._saved_positions, self._saved_on_table = after.saved
        self._played = self._replies = np.zeros(self.n, np.int64)
        self.nominated = np.full(self.n, AUTO, np.int64)


def turn_to_striker(after: Positions) -> Positions:
    """The same positions as their next strikers see them: a copy of the game, the balls are shared."""
    game = columns.strikers_own(after.game)
    return Positions(after.positions, after.on_table, game, after.saved, after.conditions)


def packed_under(conditions: Floats, rules: Rules) -> Packed:
    """``Rules.pack`` with a row for each table."""
    options, cues, noise, _ = rules.pack()
    cues = np.repeat(cues, len(conditions), axis=0)
    cues[:, C_END_MASS] = conditions[:, END_MASS_RATIO]
    return options, cues, noise, rows_under(conditions, rules.physics)
