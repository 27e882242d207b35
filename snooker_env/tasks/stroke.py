"""How is a shot carried out, and what does the referee see of it? Noise, strike and engine in one; the event log read as a ``Stroke``."""

from typing import Any

import numpy as np

from .._check import choice, refuse
from .._jit import entry, kernel
from ..game.balls import CUE, N_BALLS, TOUCH, bits
from ..game.referee import Stroke
from ..geometry import BALL_RADIUS
from ..physics import cue
from ..physics.engine import EventKind
from ..physics.impact.contact import parse_fidelity
from ..physics.parameters import Physics
from ..physics.table import Table
from ..simulation import play
from .box_actions import AIMS, Actions, tip
from .discrete_actions import Choices
from .noise import Noise
from .table_fit import bed_of

ACTIONS = ("box", "discrete")
AT_ONCE = 1e-9
"""Contacts nearer than this [s] are simultaneous."""

_BITS = 1 << np.arange(N_BALLS)
_BALL_BALL = int(EventKind.BALL_BALL)


@kernel
def touching_balls(positions, on_table):
    """The mask of the object balls that touch the cue ball."""
    reach = 2.0 * BALL_RADIUS + TOUCH
    mask = 0
    for i in range(1, N_BALLS):
        dx, dy = positions[i, 0] - positions[0, 0], positions[i, 1] - positions[0, 1]
        if on_table[i] and dx * dx + dy * dy < reach * reach:
            mask |= 1 << i
    return mask


@kernel
def first_struck(event_time, event_what, n_events, touching, speed):
    """From the log of a shot played at cue speed ``speed`` [m/s]: the masks of the balls that the cue ball struck first, and of those of
    the balls ``touching`` it before that it moved in leaving."""
    first, start = 0, np.inf
    for e in range(n_events):
        if event_time[e] > start + AT_ONCE:
            break
        if event_what[e, 0] == _BALL_BALL and event_what[e, 1] == CUE:
            start = min(start, event_time[e])
            first |= 1 << event_what[e, 2]
    # A touching ball that the cue ball is played away from is not struck; one it is played into is struck before the cue ball has
    # gone ten times the gap that still counts as touching.
    return first, touching & first if start * speed <= 10 * TOUCH else 0


@entry
def _seen(event_time, event_what, positions, on_table, potted, speed):
    touching = touching_balls(positions, on_table)
    first, moved = first_struck(event_time, event_what, len(event_time), touching, speed)
    return first, touching, moved, bits(potted)


def mask(balls):
    """The mask of a bool array (22,)."""
    return int(balls @ _BITS)


class Shooter:
    """Everything between an intended shot and the balls at rest; one for all players of an environment."""

    def __init__(self, actions: Actions | Choices, noise: Noise, physics: Physics, table: Table, fidelity):
        self.actions: Any = actions  # a frame is never played with Choices
        self.noise, self.physics, self.table, self.fidelity = noise, physics, table, fidelity

    def shoot(self, intended: tuple[float, float, float, float, float], positions, on_table, rng, *, path=False):
        """The ``Shot`` that ``intended`` = (speed, side, top, aim, elevation) becomes; noise is drawn from ``rng``. Nothing is changed."""
        speed, side, top, aim, elevation = self.noise.draw(rng, *intended, self.physics.R)
        side, top = tip(float(side), float(top), self.physics.max_offset)
        v, w = cue.strike(speed, aim, side, top, elevation, self.physics)
        velocities, spins = np.zeros((N_BALLS, 2)), np.zeros((N_BALLS, 3))
        velocities[CUE], spins[CUE] = v[:2], w
        return play(positions, velocities, spins, on_table, self.physics, self.table, self.fidelity, path=path)


def shooter_of(aim, elevation, placement, decision, noise, physics, table, fidelity, action="box"):
    """The ``Shooter`` of an environment's arguments, each as documented in ``SnookerEnv``. Raises ValueError."""
    world = Physics.of(physics)
    if world.R != BALL_RADIUS:
        raise refuse("physics.R", world.R, f"must be {BALL_RADIUS} in Snooker-v0: spots, rack and pockets are made for it")
    world.check_stopping()
    cloth = bed_of(table)
    quality, errors = parse_fidelity(fidelity), Noise.of(noise)
    if choice("action", action, ACTIONS) == "discrete":
        for name, value in (("elevation", elevation), ("placement", placement), ("decision", decision)):
            if value is not False:
                raise refuse(name, value, 'must be False with action="discrete"')
        choice("aim", aim, AIMS)  # it has no say: the aim is solved
        return Shooter(Choices(world), errors, world, cloth, quality)
    return Shooter(Actions(aim, elevation, placement, world, decision), errors, world, cloth, quality)


def stroke_of(shot, positions, on_table, speed):
    """What the referee sees of a ``Shot`` played at cue speed ``speed`` [m/s] from ``positions`` (22, 2) and ``on_table`` (22,): first
    contact, touching balls, pots.

    No ball leaves the table and the cue ball jumps none: the simulation is planar.
    """
    what = np.stack([shot.events[name] for name in ("kind", "i", "j")], axis=1)
    first, touching, moved, potted = _seen(
        shot.events["time"].copy(), what, np.array(positions), np.array(on_table), shot.potted >= 0, float(speed)
    )
    return Stroke(first=first, potted=potted, touching=touching, moved=moved)
