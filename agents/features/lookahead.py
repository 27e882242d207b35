"""What would a shot lead to? Choices played on copies of tables, and what the positions they leave promise."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from math import erf, exp, pi, radians, sqrt

import numpy as np

from snooker_env._jit import entry
from snooker_env.game.balls import BALL_RADIUS, N_BALLS, VALUES, BallOn, balls_on_kernel, bits
from snooker_env.game.pots import POCKETS, POT_COLUMNS, find_pots
from snooker_env.physics.cloth import COLUMNS
from snooker_env.physics.cue import squirt
from snooker_env.physics.impact.polynomial import WORK
from snooker_env.tasks.box_actions import MAX_SPEED, MIN_SPEED
from snooker_env.tasks.discrete_actions import POTS, SIZE, chosen, masks
from snooker_env.tasks.observations import SIZE as SIZE_SEEN
from snooker_env.tasks.stroke import Shooter
from snooker_env.tasks.visit import BALL_ON, OVER, Returned, Visits, Work

_ANY_COLOUR = int(BallOn.ANY_COLOUR)

CHUNK = 128
"""Copies played in one go: their work space stays in the cache."""

FOLLOWS = 25.0
"""Points that a pot is worth beside its own: what the rest of the visit brings, or less where less is left on the table."""
SECOND, THIRD = 0.15, 0.05
"""What the second and the third best pot of a position add: they leave a choice of where to go next."""
FAR = 0.1
"""How much less likely a pot is for each metre that the balls have to run."""
BY_HAND = (FOLLOWS, SECOND, THIRD, FAR)
SURE = (1e4, 1e-3, 0.0, 0.0)
"""The same for one who never errs: all that is left follows."""


@entry
def _prospects(positions, on_table, game, spread, constants, values, chances):
    """For n tables: ``values`` (n,) of the positions, by hand, and ``chances`` (n, most) to make each of the widest pots.

    ``spread`` [rad] as ``spread_of`` gives it, ``constants`` as ``BY_HAND``.
    """
    found = np.empty((16, POT_COLUMNS))
    follows, second, third, far = constants
    for k in range(len(values)):
        chances[k, :] = 0.0
        values[k] = 0.0
        p, on = positions[k], balls_on_kernel(game[k, BALL_ON], bits(on_table[k]))
        many = find_pots(p, on_table[k], on, BALL_RADIUS, found) if on_table[k, 0] else 0
        left = 7.0 if game[k, BALL_ON] == _ANY_COLOUR else 0.0  # points: a black for each red, and after a red that was potted
        for i in range(1, N_BALLS):
            if on_table[k, i]:
                left += 8.0 if VALUES[i] == 1 else VALUES[i]
        a = b = c = 0.0
        for j in range(many):
            ball, pocket, gx, gy = int(found[j, 0]), int(found[j, 1]), found[j, 2], found[j, 3]
            path = sqrt((gx - p[0, 0]) ** 2 + (gy - p[0, 1]) ** 2)
            run = sqrt((POCKETS[pocket, 0] - p[ball, 0]) ** 2 + (POCKETS[pocket, 1] - p[ball, 1]) ** 2)
            chance = erf(found[j, 5] / (spread * sqrt(2.0))) * exp(-far * (path + run))
            if j < chances.shape[1]:
                chances[k, j] = chance
            rest = max(0.0, left - VALUES[ball])
            worth = chance * (VALUES[ball] + follows * (1.0 - exp(-rest / follows)))
            if worth > a:
                a, b, c = worth, a, b
            elif worth > b:
                b, c = worth, b
            elif worth > c:
                c = worth
        values[k] = a + second * b + third * c


def spread_of(noise, physics):
    """Standard deviation [rad] of the cue ball's direction under a ``Noise``, tip errors included; at least 1e-5."""
    return max(1e-5, radians(noise.direction_deg(physics)))


def prospects_of(at, spread, constants=BY_HAND, most=POTS):
    """``prospects`` of a ``Position``: its values (n,) and the chances (n, most) of the widest pots."""
    values, chances = np.empty(len(at)), np.empty((len(at), most))
    _prospects(at.positions, at.on_table, at.game, spread, constants, values, chances)
    return values, chances


class Position:
    """Tables to copy shots from: positions (m, 22, 2), on_table (m, 22), game (m, 5)."""

    def __init__(self, positions, on_table, game):
        self.positions, self.on_table, self.game = positions, on_table, game

    def __len__(self):
        return len(self.game)

    def __getitem__(self, rows):
        return Position(self.positions[rows], self.on_table[rows], self.game[rows])


@entry(what="the choices as actions", uses=(chosen,))
def _as_actions(positions, on_table, game, rows, picks, phys, end_mass_ratio, fidelity, n_steps, out):
    found, motion, phase, work = np.empty((POTS, POT_COLUMNS)), np.empty((2, COLUMNS)), np.empty(2, np.int64), np.empty(WORK)
    for i in range(len(rows)):
        k = rows[i]
        on = balls_on_kernel(game[k, BALL_ON], bits(on_table[k]))
        speed, side, top, aim, _ = chosen(
            picks[i], positions[k], on_table[k], on, phys, end_mass_ratio, fidelity, n_steps, found, motion, phase, work
        )
        out[i, 0] = 2.0 * (speed - MIN_SPEED) / (MAX_SPEED - MIN_SPEED) - 1.0
        out[i, 1], out[i, 2] = 2.0 * side, 2.0 * top
        turned = (aim + squirt(side, end_mass_ratio)) / pi
        out[i, 3] = turned - 2.0 * round(0.5 * turned)


def as_actions(at, rows, picks, shooter):
    """What the choices ``picks[i]`` at ``at[rows[i]]`` are as actions with aim="absolute": float32 (m, 4)."""
    out = np.empty((len(rows), 4), np.float32)
    world, (fidelity, n_steps) = shooter.physics, shooter.fidelity
    _as_actions(
        at.positions, at.on_table, at.game, np.asarray(rows, np.int64), np.asarray(picks, np.int64), world.pack(), world.end_mass_ratio,
        fidelity, n_steps, out,
    )  # fmt: skip
    return out


def choices_at(at):
    """Which choices there are: bool (n, SIZE)."""
    out = np.empty((len(at), SIZE), np.bool_)
    masks(at.positions, at.on_table, at.game[:, BALL_ON], out)
    return out


class Copies:
    """Plays shots on copies of positions: the rules of the tables, but the given noise. On any number of threads the same comes out."""

    def __init__(self, rules, noise, threads=1):
        s = rules.shooter
        self._rules = replace(rules, shooter=Shooter(s.actions, noise, s.physics, s.table, s.fidelity))
        self._desks = [(Visits(self._rules, CHUNK), Work(CHUNK), Returned(CHUNK)) for _ in range(threads)]
        self._none = np.zeros(CHUNK, np.bool_)
        self._pool = ThreadPoolExecutor(threads) if threads > 1 else None
        self.shots = 0

    def play(self, at, rows, actions, keys):
        """``actions[i]`` (choices, or rows of an action space) on a copy of ``at[rows[i]]``, errors from the stream with key ``keys[i]``.

        Returns the points (m,), whether the visit goes on (m,), the ``Position`` left and its flat observations.
        """
        m = len(rows)
        actions = np.asarray(actions, np.float64).reshape(m, -1)
        points, goes_on, left = np.empty(m), np.empty(m, np.bool_), at[rows]
        observations = np.empty((m, SIZE_SEEN), np.float32)

        def play_at(desk, first):
            v, work, out = desk
            for start in range(first * CHUNK, m, len(self._desks) * CHUNK):
                part = slice(start, min(m, start + CHUNK))
                n = part.stop - start
                v.positions[:n], v.on_table[:n], v.game[:n] = left.positions[part], left.on_table[part], left.game[part]
                v.streams[:n, 0], v.streams[:n, 1] = keys[part], 0
                v.play(actions[part], self._none[:n], out, work)
                left.positions[part], left.on_table[part], left.game[part] = v.positions[:n], v.on_table[:n], v.game[:n]
                points[part], goes_on[part], observations[part] = out.reals[:n, 0], v.game[:n, OVER] == 0, out.observations[:n]

        if self._pool is None:
            play_at(self._desks[0], 0)
        else:
            list(self._pool.map(play_at, self._desks, range(len(self._desks))))
        self.shots += m
        return points, goes_on, left, observations

    def prospects(self, at, spread, constants=BY_HAND, most=POTS):
        """``prospects_of``, shared among the threads."""
        if self._pool is None or len(at) < 2 * CHUNK:
            return prospects_of(at, spread, constants, most)
        ends = np.linspace(0, len(at), len(self._desks) + 1).astype(int)
        parts = self._pool.map(lambda a, b: prospects_of(at[a:b], spread, constants, most), ends[:-1], ends[1:])
        values, chances = (np.concatenate(column) for column in zip(*parts, strict=True))
        return values, chances
