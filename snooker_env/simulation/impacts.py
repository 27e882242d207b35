"""How does one compute a single impact, or a strike? Checked input in, plain arrays out."""

from math import hypot, pi
from typing import Any

import numpy as np

from .._lib.check import array, number, refuse
from .._lib.jit import entry
from .._lib.types import Fidelity, Floats, Real, Vector
from ..physics.arrays import Law
from ..physics.columns import P_E_B
from ..physics.cue import MAX_ELEVATION, strike_ball
from ..physics.impact import contact
from ..physics.impact.polynomial import WORK
from ..physics.parameters import FASTEST, FASTEST_IMPACT, MOST_SPIN_IMPACT, Physics, PhysicsLike
from .shot import SimulationError


@entry(what="the impact of two balls", seconds=10)
def _collide_balls(v1, w1, v2, w2, normal, phys, fidelity, n_steps):
    law = Law(phys, fidelity, n_steps)
    return contact.collide_balls(v1, w1, v2, w2, normal, law, phys[P_E_B], np.empty(WORK))


@entry(what="the impact with a cushion", seconds=9)
def _collide_cushion(v, w, normal, phys, fidelity, n_steps):
    e = contact.cushion_restitution(v[0] * normal[0] + v[1] * normal[1], phys)
    return contact.collide_cushion(v, w, normal, Law(phys, fidelity, n_steps), e, np.empty(WORK))


_strike_ball = entry(strike_ball)


def _unit_normal(normal):
    nx, ny, nz = array("normal", normal, (3,)).tolist()
    size = float(np.hypot(nx, ny))
    if abs(nz) > 1e-9 or abs(size - 1.0) > 1e-6:
        allowed = f"must be a horizontal unit vector: z = 0, length 1 to 1e-6 (it is {hypot(nx, ny, nz):.7g})"
        raise refuse("normal", (nx, ny, nz), allowed)
    return nx / size, ny / size


def _solve(kernel, what, before, normal, physics, fidelity) -> Any:
    """Velocities and spins after an impact, of those ``before`` by name; SimulationError if it does not end."""
    physics, solver = Physics.of(physics), contact.parse_fidelity(fidelity)
    most = {"v": (FASTEST_IMPACT, "m/s"), "w": (MOST_SPIN_IMPACT, "rad/s")}
    args = tuple(tuple(array(name, x, (3,), *most[name[0]]).tolist()) for name, x in before.items())
    *after, solved = kernel(*args, _unit_normal(normal), physics.packed_for(solver), *solver)
    if not solved:
        words = f"did not end at fidelity {fidelity!r}; try another fidelity"
        raise SimulationError(f"the {what} of {', '.join(before)} = {args} {words}")
    return tuple(map(np.array, after))


def collide_balls(
    v1: Vector,
    w1: Vector,
    v2: Vector,
    w2: Vector,
    normal: Vector,
    physics: PhysicsLike = None,
    fidelity: Fidelity = "standard",
) -> tuple[Floats, Floats, Floats, Floats]:
    """The frictional impact of two balls on the cloth (Mathavan, Jackson & Parkin 2014, 2.1 to 2.4).

    Parameters
    ----------
    v1, w1, v2, w2 : array_like, float (3,)
        Velocities [m/s] and spins [rad/s] of the balls, components within 1e6 m/s and 1e9 rad/s of zero.
    normal : array_like, float (3,)
        Horizontal unit vector from ball 1 to ball 2.
    physics : None, str, dict or Physics
        The constants, as ``Physics.of`` takes them; None is "paper".
    fidelity : str
        How it is solved: "fast" (closed form for free spheres), "standard", "reference" (tightest tolerance),
        or "euler:N" (the paper's own scheme with N of eq. 14).

    Returns
    -------
    v1, w1, v2, w2 : float64 (3,)
        Velocities [m/s], with the vertical one of a lifted ball, and spins [rad/s] after it; unchanged if the
        balls do not approach each other. ValueError for bad input, SimulationError if the computation of the impact
        does not end.

    Examples
    --------
    >>> import snooker_env as sn
    >>> v1, w1, v2, w2 = sn.collide_balls((1, 0, 0), (0, 0, 0), (0, 0, 0), (0, 0, 0), (1, 0, 0))
    >>> v1.round(3).tolist(), v2.round(3).tolist()
    ([0.055, 0.0, 0.0], [0.945, 0.0, 0.0])
    """
    before = {"v1": v1, "w1": w1, "v2": v2, "w2": w2}
    return _solve(_collide_balls, "impact", before, normal, physics, fidelity)


def collide_cushion(
    v: Vector, w: Vector, normal: Vector, physics: PhysicsLike = None, fidelity: Fidelity = "standard"
) -> tuple[Floats, Floats]:
    """The impact of a ball with the nose of a cushion (Mathavan, Jackson & Parkin 2010).

    Parameters
    ----------
    v, w : array_like, float (3,)
        Velocity [m/s] and spin [rad/s], components within 1e6 m/s and 1e9 rad/s of zero.
    normal : array_like, float (3,)
        Horizontal unit vector INTO the cushion.
    physics, fidelity
        As in ``collide_balls``, but "fast" integrates with a loose tolerance: no closed form has the cloth's
        reaction, worth 7 % of the rebound.

    Returns
    -------
    v, w : float64 (3,)
        Velocity [m/s] and spin [rad/s] after it; unchanged if the ball does not move into the cushion. Errors as of
        ``collide_balls``.

    Examples
    --------
    >>> import snooker_env as sn
    >>> v, w = sn.collide_cushion((1, 0, 0), (0, 0, 0), (1, 0, 0))
    >>> bool(v[0] < 0)
    True
    """
    return _solve(_collide_cushion, "cushion impact", {"v": v, "w": w}, normal, physics, fidelity)


def strike(
    speed: Real,
    aim: Real,
    side: Real = 0.0,
    top: Real = 0.0,
    elevation: Real = 0.0,
    physics: PhysicsLike = None,
) -> tuple[Floats, Floats]:
    """The cue ball's velocity and spin just after the strike of the cue.

    Side spin deflects it from the aim (squirt: to the left for right side), with an elevated cue it swerves.
    The bed takes the downward part of the speed, speed sin(elevation), and the cloth rubs by as much: friction
    mu_s speed sin(elevation) against the slip, at most what makes the ball roll.

    Parameters
    ----------
    speed : float
        Speed that the cue gives the ball, along the cue [m/s], in [0, 1000].
    aim : float
        Direction of the cue [rad], anticlockwise from +x, in [-2 pi, 2 pi].
    side, top : float
        Offset of the tip over R, + right and + up as the player sees the ball; together at most
        ``Physics.max_offset``.
    elevation : float
        Angle between the cue and the cloth, butt raised [rad], in [0, 1.5].
    physics : None, str, dict or Physics
        The constants, as ``Physics.of`` takes them; None is "paper".

    Returns
    -------
    v, w : float64 (3,)
        Velocity [m/s] and angular velocity [rad/s]. ValueError for a miscue (an offset beyond
        ``Physics.max_offset``, 0.5 by default), or a number out of range.

    Examples
    --------
    >>> import snooker_env as sn
    >>> v, w = sn.strike(2.0, 0.0)
    >>> v.tolist(), w.tolist()
    ([2.0, 0.0, 0.0], [0.0, 0.0, 0.0])
    """
    physics = Physics.of(physics)
    speed, aim = number("speed", speed, 0, FASTEST), number("aim", aim)
    if abs(aim) > 2.0 * pi:
        raise refuse("aim", aim, "must be in radians, within a turn of 0; from degrees: np.radians(degrees)")
    side, top = number("side", side), number("top", top)
    elevation = number("elevation", elevation, 0, MAX_ELEVATION)
    if hypot(side, top) > physics.max_offset * (1 + 1e-12):
        allowed = f"tip offset {hypot(side, top):.4g} R is a miscue, must be within {physics.max_offset} R of the ball's centre"
        raise refuse("(side, top)", (side, top), allowed)
    constants = physics.R, physics.mu_s, physics.end_mass_ratio, physics.bed_restitution
    v, w = _strike_ball(speed, aim, side, top, elevation, *constants)
    return np.array(v), np.array(w)
