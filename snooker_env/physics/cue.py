"""How does the cue move the ball? Speed, aim, offset, elevation -> velocity and spin; squirt, miscue.

A raised cue presses the ball into the bed, and the cloth rubs (``flight.rub_bed``). Where balls fly, the bed throws it up."""

from math import atan, cos, sin, sqrt

from .._lib.jit import kernel
from .flight import SETTLE, rub_bed

MAX_ELEVATION = 1.5  # highest elevation of the cue [rad]: just below the vertical


@kernel
def squirt(side, end_mass_ratio):
    """Angle a between aim and path [rad], anticlockwise for right side [Alciatore, TP A.31].

    tan a = (5/2) b sqrt(1 - b^2) / (1 + m_r + (5/2) (1 - b^2)); b: side offset / R, m_r: ball mass / end mass."""
    return atan(2.5 * side * sqrt(1.0 - side * side) / (1.0 + end_mass_ratio + 2.5 * (1.0 - side * side)))


@kernel
def strike_ball(speed, aim, side, top, elevation, R, mu_s, end_mass_ratio, e_t):
    """The cue ball's (vx, vy, vz) [m/s] and (wx, wy, wz) [rad/s] after a strike that is no miscue.

    Spin [TP A.30]: w = (5/2) (speed / R) b x d; b: tip offset over R, d: unit vector along the cue. The bed takes the
    downward part of the speed and gives back e_t of it, as in any landing; 0: no ball flies."""
    aim += squirt(side, end_mass_ratio)
    c, s, ce, se = cos(aim), sin(aim), cos(elevation), sin(elevation)
    q = 2.5 * speed / R
    # offset = side right + top up: right (s, -c, 0), up (se c, se s, ce), the cue along (ce c, ce s, -se)
    wx, wy, wz = q * (side * se * c - top * s), q * (side * se * s + top * c), q * side * ce
    vx, vy = speed * ce * c, speed * ce * s
    up = 0.0
    if elevation > 0.0:
        up = e_t * speed * se if e_t * speed * se >= SETTLE else 0.0
        (vx, vy), (wx, wy) = rub_bed((vx, vy), (wx, wy), speed * se + up, mu_s, R)
    return (vx, vy, up), (wx, wy, wz)
