"""Where must a pot found by geometry be aimed? Each shot is tried in the simulator without errors, at aims around its line and at a few
speeds: the widest run of neighbouring aims that pot is the shot, its middle the aim.

The player "geometric" plays so: python -m agents.evaluate --agent geometric
"""

from math import atan2, pi
from typing import Any

import numpy as np

from snooker_env._jit import entry
from snooker_env.game.balls import N_BALLS, SPOTS, BallOn
from snooker_env.physics import cloth
from snooker_env.physics.impact.polynomial import WORK
from snooker_env.tasks.box_actions import MAX_SPEED, MIN_SPEED
from snooker_env.tasks.noise import Noise
from snooker_env.tasks.pot_aim import solved_aim
from snooker_env.tasks.visit import BALL_ON

from ..features.indirect_pots import AIM_X, AIM_Y, BALL, COLUMNS, GHOST_X, GHOST_Y, REACH, direct, direct_pots, indirect
from ..features.lookahead import Copies, Position

SPEEDS = (1.8, 2.9, 4.4)
"""Cue speeds [m/s] at which the shots are tried."""
AIMS = 40
"""Aims tried a speed."""


@entry(what="the solving of aims", uses=(solved_aim,))
def _solved(positions, shots, speeds, phys, end_mass_ratio, fidelity, n_steps, aims):
    """``aims`` (m, s) [rad]: the direction of the cue ball that sends the first ball of each shot to its aim point, at each speed.

    positions (m, 22, 2), shots (m, COLUMNS), speeds (s,).
    """
    motion, state, work = np.empty((2, cloth.COLUMNS)), np.empty(2, np.int64), np.empty(WORK)
    for j in range(shots.shape[0]):
        p, row = positions[j], shots[j]
        for i in range(len(speeds)):
            if row[BALL] < 0.0:
                aims[j, i] = atan2(row[GHOST_Y] - p[0, 1], row[GHOST_X] - p[0, 0])
                continue
            aims[j, i] = solved_aim(
                p, int(row[BALL]), row[AIM_X], row[AIM_Y], row[GHOST_X], row[GHOST_Y], speeds[i], 0.0, 0.0, 0.0, phys, end_mass_ratio,
                fidelity, n_steps, motion, state, work,
            )  # fmt: skip


def action_of(speeds, aims):
    """Actions (m, 4) float32 of ``aim="absolute"``: plain strokes at these speeds [m/s] in these directions [rad]."""
    actions = np.zeros((len(aims), 4), np.float32)
    actions[:, 0] = 2.0 * (np.asarray(speeds) - MIN_SPEED) / (MAX_SPEED - MIN_SPEED) - 1.0
    turns = np.asarray(aims) / pi
    actions[:, 3] = turns - 2.0 * np.round(turns / 2.0)
    return actions


def widest_run(good):
    """Start and length of the longest run of True in each row of ``good`` (m, n); of equal ones that nearest to the middle."""
    m, n = good.shape
    lengths, run = np.zeros((m, n), np.int64), np.zeros(m, np.int64)
    for i in range(n):
        run = np.where(good[:, i], run + 1, 0)
        lengths[:, i] = run
    centres = np.abs(np.arange(n) - 0.5 * (lengths - 1) - 0.5 * (n - 1))
    last = np.argmax(lengths - centres / (2.0 * n), axis=1)
    length = lengths[np.arange(m), last]
    return last - length + 1, length


class Aimer:
    """Finds shots at tables that are played by these ``Rules``, with aim="absolute": plain strokes all of them.

    ``speed`` [m/s] of the first one tried.
    """

    def __init__(self, rules, speed):
        s = rules.shooter
        self._shooter, self._copies = s, Copies(rules, Noise())
        self._speed = speed
        self._world: tuple[Any, float, int, int] = (s.physics.pack(), s.physics.end_mass_ratio, s.fidelity[0], s.fidelity[1])
        indirect(np.array(SPOTS), np.ones(N_BALLS, np.bool_), BallOn.RED, s.table, s.physics)  # compiled now, not while a decision is timed

    def actions(self, positions, on_table, game):
        """An action (4,) float32 for each of n tables: positions (n, 22, 2), on_table (n, 22), game (n, 5).

        First the widest direct pot along its solved line or, without a direct pot, the line to the nearest ball on. If that pots nothing
        without errors, the direct pot that the simulator finds the widest; else such an indirect one; else the first line all the same.
        """
        shots, counts, ball_on = np.empty((len(game), 1, COLUMNS)), np.empty(len(game), np.int64), game[:, BALL_ON].copy()
        direct_pots(positions, on_table, ball_on, shots, counts)
        actions = action_of(np.full(len(game), self._speed), self._solve(positions, shots[:, 0].copy(), np.array([self._speed]))[:, 0])
        for k in np.flatnonzero(~self.pots(positions, on_table, game, actions)).tolist():
            p, on, state = positions[k], on_table[k], game[k]
            found = self.widest(p, on, state, direct(p, on, ball_on[k]))
            if found is None:
                found = self.widest(p, on, state, indirect(p, on, ball_on[k], self._shooter.table, self._shooter.physics))
            if found is not None:
                actions[k] = found[0]
        return actions

    def widest(self, positions, on_table, game, shots):
        """Of these shots the one with the widest run of aims that pot, tried on one table: (its action, half the width [rad], which shot,
        which speed); None if none goes in."""
        if len(shots) == 0:
            return None
        lines = self._solve(np.repeat(positions[None], len(shots), axis=0), shots, np.array(SPEEDS)).ravel()
        speeds, reaches = np.tile(SPEEDS, len(shots)), np.repeat(shots[:, REACH], len(SPEEDS))
        middles, widths = self._scan(positions, on_table, game, speeds, lines, reaches)
        best = int(np.argmax(widths))
        if widths[best] == 0.0:
            return None
        # once more where it goes in and a step further: now the width is known to a few percent
        reach = 0.5 * widths[best] + 2.0 * reaches[best] / AIMS
        finer = self._scan(positions, on_table, game, speeds[best : best + 1], middles[best : best + 1], np.array([reach]))
        middle, width = (finer[0][0], finer[1][0]) if finer[1][0] > 0.0 else (middles[best], widths[best])
        return action_of(speeds[best : best + 1], [middle])[0], 0.5 * width, *divmod(best, len(SPEEDS))

    def _scan(self, positions, on_table, game, speeds, lines, reaches):
        """Of the widest run of aims that pot within ``reaches`` of ``lines``: middle and width [rad], (m,) each; width 0 if none does."""
        steps = 2.0 * reaches / AIMS
        aims = lines[:, None] + steps[:, None] * (np.arange(AIMS) - 0.5 * (AIMS - 1))
        tries = action_of(np.repeat(speeds, AIMS), aims.ravel())
        p, on, state = (np.broadcast_to(a, (len(tries), *a.shape)) for a in (positions, on_table, game))
        starts, lengths = widest_run(self.pots(p, on, state, tries).reshape(-1, AIMS))
        return lines + steps * (starts + 0.5 * (lengths - 1) - 0.5 * (AIMS - 1)), steps * lengths

    def _solve(self, positions, shots, speeds):
        """``_solved`` in this world."""
        aims = np.empty((len(shots), len(speeds)))
        _solved(positions, shots, speeds, *self._world, aims)
        return aims

    def pots(self, positions, on_table, game, actions):
        """Which of these actions score, each on a copy of its table: (m,) bool."""
        m = len(actions)
        return self._copies.play(Position(positions, on_table, game), np.arange(m), actions, np.zeros(m, np.uint64))[0] > 0.0
