"""Are the pot rates of ``benchmarks.execution`` right? Monte Carlo apart from the environment: errors,
strike, geometry typed anew."""

from __future__ import annotations

import math

import numpy as np
import pytest

import snooker_env as sn
from benchmarks.execution import pot_shots
from snooker_env.tasks.noise import LEVELS

R, END_MASS_RATIO, MU_SLIDE, MU_ROLL, G = 0.02625, 30.0, 0.21, 0.0127, 9.81
POTS = {pot.name: pot for pot in pot_shots.POTS}
STRAIGHT, RED, HALF = (
    "long: baulk line, 1 m to go, straight",
    "red 0.6 m, 20 deg, 1.1 m to go",
    "half ball 1.2 m, 30 deg, 1.0 m to go",
)
N = 4000
CASES = [(name, level) for name in (STRAIGHT, RED, HALF) for level in ("professional", "club", "olympiad")]


def squirt(b):
    """TP A.31, b over R."""
    return np.arctan(2.5 * b * np.sqrt(1 - b * b) / (1 + END_MASS_RATIO + 2.5 * (1 - b * b)))


def errors(level, speed, n, seed):
    """(n,) each: speed [m/s], aim [rad], side and top over R, elevation [rad], for a level stroke without
    spin."""
    noise, rng = LEVELS[level], np.random.default_rng(seed)
    lapse = np.where(rng.random(n) < noise.lapse, noise.lapse_factor, 1.0)
    faster = math.sqrt(1.0 + (noise.growth * speed) ** 2)
    speeds = speed + lapse * rng.normal(size=n) * math.hypot(noise.speed_rel * speed, noise.speed_abs)
    side, top = lapse * rng.normal(size=(2, n)) * noise.offset_mm * faster / (1e3 * R)
    wide = np.radians([[noise.aim_deg * faster], [noise.elevation_deg]])
    aim, elevation = lapse * rng.normal(size=(2, n)) * wide
    return speeds, aim, side, top, np.maximum(elevation, 0.0)


def close(share, other, n, slack=0.0):
    """Two shares of n tries each: within four standard errors of their difference."""
    middle = 0.5 * (share + other)
    return abs(share - other) < 4 * math.sqrt(2 * (middle * (1 - middle) + 1 / n) / n) + slack


@pytest.mark.parametrize(("name", "level"), CASES)
def test_the_same_pots_by_strokes_typed_anew(name, level):
    """Spin (5/2) v b / R about the axis across the cue, the cue raised by the elevation, friction of the bed that
    it presses the ball into; only the shot itself is the engine's."""
    shot = pot_shots.aimed(POTS[name], sn.Physics(), "match")
    speed, aim, side, top, raised = errors(level, shot.stroke[0], N, 11)
    way = shot.stroke[1] + aim + squirt(side)
    ahead = np.column_stack([np.cos(way), np.sin(way), 0 * way])
    right = np.column_stack([np.sin(way), -np.cos(way), 0 * way])
    cue = np.cos(raised)[:, None] * ahead - np.sin(raised)[:, None] * [0, 0, 1]
    offset = side[:, None] * right + top[:, None] * np.cross(right, cue)
    velocities, spins = np.zeros((N, 2, 2)), np.zeros((N, 2, 3))
    velocities[:, 0] = (speed * np.cos(raised))[:, None] * ahead[:, :2]
    spins[:, 0] = 2.5 * speed[:, None] / R * np.cross(offset, cue)
    slip = velocities[:, 0] + R * np.column_stack([-spins[:, 0, 1], spins[:, 0, 0]])
    size = np.maximum(np.hypot(*slip.T), 1e-300)
    push = -np.minimum(2 / 7, MU_SLIDE * speed * np.sin(raised) / size)[:, None] * slip
    velocities[:, 0] += push
    spins[:, 0, :2] += 2.5 / R * np.column_stack([push[:, 1], -push[:, 0]])
    end = sn.simulate_batch(np.repeat(shot.pot.positions[None], N, 0), velocities, spins)
    made = (end.potted[:, 1] == 3) & (end.potted[:, 0] < 0)
    found = pot_shots.rolls(shot, level, N, 5, sn.Physics(), "match")
    assert close(made.mean(), found.rate, N), (made.mean(), found.rate)
