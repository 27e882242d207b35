"""How does the cue move the ball? Speed, aim, offset, elevation -> velocity and spin; squirt, miscue.

A raised cue presses the ball into the bed while it pushes, and the cloth rubs: ``rubbed``.
"""

from math import atan, cos, hypot, pi, sin, sqrt

from .._check import number, refuse
from .._jit import entry, kernel
from .._types import Real
from .parameters import FASTEST, Physics

MAX_ELEVATION = 1.5
"""Highest elevation of the cue [rad]: just below the vertical."""


@kernel
def squirt(side, end_mass_ratio):
    """Angle a between aim and path [rad], anticlockwise for right side [Alciatore, TP A.31].

    tan a = (5/2) b sqrt(1 - b^2) / (1 + m_r + (5/2) (1 - b^2)); b: side offset / R, m_r: ball mass / end
    mass.
    """
    return atan(2.5 * side * sqrt(1.0 - side * side) / (1.0 + end_mass_ratio + 2.5 * (1.0 - side * side)))


@kernel
def rubbed(v, w, press, mu_s, R):
    """(vx, vy) [m/s] and (wx, wy) [rad/s] of a ball after the bed has given it ``press`` [m/s], the upward
    impulse over the mass: friction mu_s ``press`` against the slip, or 2/7 of the slip, and the ball rolls."""
    (vx, vy), (wx, wy) = v, w
    ux, uy = vx - R * wy, vy + R * wx
    slip, friction = hypot(ux, uy), mu_s * press
    if 3.5 * friction >= slip:
        vx, vy = vx - ux / 3.5, vy - uy / 3.5
        return (vx, vy), (-vy / R, vx / R)
    dx, dy = -friction * ux / slip, -friction * uy / slip
    return (vx + dx, vy + dy), (wx + 2.5 * dy / R, wy - 2.5 * dx / R)


@kernel
def struck(speed, aim, side, top, elevation, R, mu_s, end_mass_ratio):
    """The cue ball's (vx, vy, vz) [m/s] and (wx, wy, wz) [rad/s] after a strike that is no miscue.

    Spin [TP A.30]: w = (5/2) (speed / R) b x d; b: tip offset over R, d: unit vector along the cue; (5/2) v
    |b| / R if level. The bed takes the downward part of the speed, and the cloth rubs by as much.
    """
    aim += squirt(side, end_mass_ratio)
    c, s, ce, se = cos(aim), sin(aim), cos(elevation), sin(elevation)
    q = 2.5 * speed / R
    # offset = side right + top up: right (s, -c, 0), up (se c, se s, ce), the cue along (ce c, ce s, -se)
    wx, wy, wz = q * (side * se * c - top * s), q * (side * se * s + top * c), q * side * ce
    vx, vy = speed * ce * c, speed * ce * s
    if elevation > 0.0:
        (vx, vy), (wx, wy) = rubbed((vx, vy), (wx, wy), speed * se, mu_s, R)
    return (vx, vy, 0.0), (wx, wy, wz)


@entry
def _struck(speed, aim, side, top, elevation, R, mu_s, end_mass_ratio):
    return struck(speed, aim, side, top, elevation, R, mu_s, end_mass_ratio)


def strike(
    speed: Real, aim: Real, side: Real, top: Real, elevation: Real, physics: Physics
) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """``struck`` for Python, with its input checked; see ``snooker_env.strike``."""
    speed = number("speed", speed, 0, FASTEST)
    aim = number("aim", aim)
    if abs(aim) > 2.0 * pi:
        raise refuse("aim", aim, "must be in radians, within a turn of 0; from degrees: np.radians(degrees)")
    side, top = number("side", side), number("top", top)
    elevation = number("elevation", elevation, 0, MAX_ELEVATION)
    if hypot(side, top) > physics.max_offset * (1 + 1e-12):
        allowed = f"tip offset {hypot(side, top):.4g} R is a miscue, must be within {physics.max_offset} R of the ball's centre"
        raise refuse("(side, top)", (side, top), allowed)
    constants = physics.R, physics.mu_s, physics.end_mass_ratio
    return _struck(speed, aim, side, top, elevation, *constants)
