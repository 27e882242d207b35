"""Where do the tables of the layout "opened" come from? From frames whose reds are spread by hard strokes."""

from math import atan2

import numpy as np

from snooker_env.game import layouts
from snooker_env.game.apply_ruling import settle_table
from snooker_env.game.balls import CUE, N_BALLS, N_REDS, REDS_MASK, BallOn, mask_of
from snooker_env.game.in_hand import within_d
from snooker_env.game.pots import pots
from snooker_env.game.referee import Situation, Stroke
from snooker_env.geometry import BALL_RADIUS, BAULK_Y, D_RADIUS
from snooker_env.physics.impact.contact import parse_fidelity
from snooker_env.physics.parameters import Physics
from snooker_env.physics.table import Table
from snooker_env.simulation import play
from snooker_env.simulation.impacts import strike

PHYSICS, TABLE, FIDELITY = Physics.preset("match"), Table.preset("match"), parse_fidelity("standard")
SPREAD = 6.0  # m: mean distance of the reds from their centre of mass, times 15, that counts as opened
STROKES = 8


def stroke(rng, positions, on_table):
    """Play one hard stroke at a red. Returns the settled table, or None if a ball other than the cue ball left it."""
    red = positions[rng.integers(1, 1 + N_REDS)]
    aim = atan2(red[1] - positions[CUE, 1], red[0] - positions[CUE, 0]) + rng.normal(0.0, 0.02)
    speed, side, top = rng.uniform([3.0, -0.3, -0.3], [6.5, 0.3, 0.3]).tolist()
    v, w = strike(speed, aim, side, top, 0.0, PHYSICS)
    velocities, spins = np.zeros((N_BALLS, 2)), np.zeros((N_BALLS, 3))
    velocities[CUE], spins[CUE] = v[:2], w
    shot = play((positions, velocities, spins, on_table), PHYSICS, TABLE, FIDELITY, path=False)
    potted = mask_of(np.flatnonzero(shot.potted >= 0))
    if potted & REDS_MASK:
        return None
    situation = Situation(on_table=mask_of(np.flatnonzero(on_table)), ball_on=BallOn.RED)
    _, positions, on_table = settle_table(shot.positions, on_table, situation, Stroke(potted=potted, first=2))
    if not on_table[CUE]:
        positions, on_table = in_hand(rng, positions, on_table)
    return positions, on_table


def in_hand(rng, positions, on_table):
    """Place the cue ball at a free random place in the D."""
    while True:
        place = rng.uniform((-D_RADIUS, BAULK_Y - D_RADIUS), (D_RADIUS, BAULK_Y))
        others = positions[on_table]
        if within_d(*place) and np.all(np.hypot(*(others - place).T) > 2 * BALL_RADIUS + layouts.GAP):
            positions[CUE], on_table[CUE] = place, True
            return positions, on_table


def opened_table(rng):
    """One opened table, or None if this frame gives none."""
    table = layouts.layout("break_off", rng)
    for _ in range(STROKES):
        table = stroke(rng, *table)
        if table is None:
            return None
        reds = table[0][1 : 1 + N_REDS]
        if np.hypot(*(reds - reds.mean(0)).T).sum() > SPREAD:
            return table[0] if len(pots(*table, REDS_MASK)) else None
    return None


def make(size, seed):
    """Tables (size, 22, 2), rounded to 0.1 micrometres (within the engine's tolerance for touching), and the frames played."""
    rng = np.random.default_rng(seed)
    tables, frames = [], 0
    while len(tables) < size:
        frames += 1
        table = opened_table(rng)
        if table is not None:
            tables.append(table.astype(np.float32))
    return np.array(tables), frames
