"""How does the player ``geometric`` play? Direct pots, else banks, plants and cannons; aims are simulated.

Each shot is simulated without execution errors, at aims around its line and a few speeds. The widest interval
of aims that pot gives the shot, and its middle the aim.
"""

from math import atan2

import numpy as np

from snooker_env.game import N_BALLS, SPOTS, BallOn
from snooker_env.planning import Planner, Positions
from snooker_env.players import BoundPlayer, Strokes
from snooker_env.players.player import placed

from ..features import indirect_pots as geometry
from ..features.indirect_pots import AIM_X, AIM_Y, BALL, COLUMNS, GHOST_X, GHOST_Y, REACH

SPEEDS = (1.8, 2.9, 4.4)
"""Cue speeds [m/s] at which the shots are tried."""
AIMS = 40
"""Aims tried a speed."""


def widest_run(good):
    """Start and length of the longest run of True in each row of ``good`` (m, n), that nearest the middle."""
    m, n = good.shape
    lengths, run = np.zeros((m, n), np.int64), np.zeros(m, np.int64)
    for i in range(n):
        run = np.where(good[:, i], run + 1, 0)
        lengths[:, i] = run
    centres = np.abs(np.arange(n) - 0.5 * (lengths - 1) - 0.5 * (n - 1))
    last = np.argmax(lengths - centres / (2.0 * n), axis=1)
    length = lengths[np.arange(m), last]
    return last - length + 1, length


def plain(speeds, aims):
    """Strokes (n, 5) without spin."""
    strokes = np.zeros((len(aims), 5))
    strokes[:, 0], strokes[:, 3] = speeds, aims
    return strokes


class Aimer:
    """Finds shots under the rules of ``options``, all of them strokes without spin.

    ``speed``: cue speed [m/s] of the first attempt.
    """

    def __init__(self, options, speed):
        self._planner, self._speed = Planner(options, noise="none", threads=1), speed
        # compile now, so that decision times exclude it
        geometry.indirect(np.array(SPOTS), np.ones(N_BALLS, np.bool_), BallOn.RED, *self._bed)

    @property
    def _bed(self):
        return self._planner.table, self._planner.physics

    def strokes(self, at):
        """A stroke for each of n ``Positions``: (n, 5).

        In this order, until one pots without execution errors: the widest direct pot along its solved line;
        the direct pot with the widest interval of aims; the indirect pot with the widest one. If none does,
        the first line (without a direct pot: at what is seen of a ball on, or an escape).
        """
        n, ball_on = len(at), at.ball_on.copy()
        shots, counts = np.empty((n, 1, COLUMNS)), np.empty(n, np.int64)
        geometry.direct_pots(at.positions, at.on_table, ball_on, shots, counts)
        lines = self._solve(at, np.arange(n), shots[:, 0], (self._speed,))[:, 0]
        strokes = plain(np.full(n, self._speed), lines)
        for k in np.flatnonzero(~self.pots(at, np.arange(n), strokes)).tolist():
            one, (p, on) = at[k : k + 1], (at.positions[k], at.on_table[k])
            best = self.widest(one, geometry.direct(p, on, ball_on[k]))
            best = best or self.widest(one, geometry.indirect(p, on, ball_on[k], *self._bed))
            if best:
                strokes[k] = best[0]
        return strokes

    def widest(self, one, shots):
        """The shot with the widest potting interval of aims in the only position of ``one``: (its stroke, half
        the width [rad], index of the shot, index of the speed); None if none pots."""
        if len(shots) == 0:
            return None
        lines = self._solve(one, np.zeros(len(shots), np.int64), shots, SPEEDS).ravel()
        speeds, reaches = np.tile(SPEEDS, len(shots)), np.repeat(shots[:, REACH], len(SPEEDS))
        middles, widths = self._scan(one, speeds, lines, reaches)
        best = int(np.argmax(widths))
        if widths[best] == 0.0:
            return None
        # scan the potting interval again, one step wider: its width is then accurate to a few percent
        reach = 0.5 * widths[best] + 2.0 * reaches[best] / AIMS
        finer = self._scan(one, speeds[best : best + 1], middles[best : best + 1], np.array([reach]))
        middle, width = (finer[0][0], finer[1][0]) if finer[1][0] > 0.0 else (middles[best], widths[best])
        return plain(speeds[best : best + 1], [middle])[0], 0.5 * width, *divmod(best, len(SPEEDS))

    def _scan(self, one, speeds, lines, reaches):
        """Middle and width [rad] of the widest potting interval near ``lines``: (m,) each, 0 without one."""
        steps = 2.0 * reaches / AIMS
        aims = lines[:, None] + steps[:, None] * (np.arange(AIMS) - 0.5 * (AIMS - 1))
        tries = plain(np.repeat(speeds, AIMS), aims.ravel())
        starts, lengths = widest_run(self.pots(one, np.zeros(len(tries), np.int64), tries).reshape(-1, AIMS))
        return lines + steps * (starts + 0.5 * (lengths - 1) - 0.5 * (AIMS - 1)), steps * lengths

    def _solve(self, at, rows, shots, speeds):
        """Directions of the cue ball (m, s) [rad] for shots (m, COLUMNS) at their aim points by speed."""
        m, s = len(shots), len(speeds)
        aims = np.empty((m, s))
        plain = shots[:, BALL] < 0.0
        for j in np.flatnonzero(plain).tolist():
            x, y = at.positions[rows[j], 0]
            aims[j] = atan2(shots[j, GHOST_Y] - y, shots[j, GHOST_X] - x)
        pots = np.repeat(np.flatnonzero(~plain), s)
        balls, ghosts = shots[pots, BALL].astype(np.int64), shots[pots][:, [GHOST_X, GHOST_Y]]
        targets, tried = shots[pots][:, [AIM_X, AIM_Y]], np.tile(speeds, len(pots) // s)
        solved = self._planner.pot_aim(at, rows[pots], balls, targets, tried, ghosts=ghosts)
        aims[~plain] = solved.reshape(-1, s)
        return aims

    def pots(self, at, rows, strokes):
        """Which of these strokes score, each on a copy of its position: (m,) bool."""
        return self._planner.play(at, rows, strokes=strokes).points > 0.0


class Geometric(BoundPlayer):
    """Direct pots, else banks, plants and cannons (``indirect_pots``), aims without execution errors.

    Parameters
    ----------
    speed : float
        Cue speed [m/s] of its first attempt.
    """

    name, training_shots = "geometric", 0

    def __init__(self, speed=2.3):
        self._speed = speed

    def _bind(self, options):
        self._aimer = Aimer(options, self._speed)

    def play(self, positions, seeds):
        _ = self.options  # it must be bound
        at = Positions.of(positions)
        visits, places = placed(at, seeds)
        parts = [self._aimer.strokes(visits[k : k + 1]) for k in range(len(at))]
        return Strokes(np.concatenate([np.empty((0, 5)), *parts]), places)
