"""Can a table have these shapes? Noses, jaws, falls; pockets must fit the sides and let the ball through."""

from math import hypot

from .._lib.check import refuse
from .._lib.types import Floats
from ..geometry import Bed
from .columns import FALL_RADIUS


def check_shapes(noses: Floats, jaws: Floats, falls: Floats) -> None:
    """Raise ValueError for a nose, jaw or fall that is not valid."""
    for k, (axis, side, _, low, high) in enumerate(noses.tolist()):
        if axis not in (0, 1) or side not in (-1, 1) or not low <= high:
            allowed = "must be axis 0 or 1, side -1 or 1, level, and lo <= hi"
            raise refuse(f"table.noses[{k}]", tuple(noses[k].tolist()), allowed)
    for k, (_, _, radius, ux, uy, cos_half) in enumerate(jaws.tolist()):
        if radius < 0 or abs(hypot(ux, uy) - 1.0) > 1e-6 or abs(cos_half) > 1:
            allowed = "must be x, y, radius >= 0, a unit vector (to 1e-6), and a cosine"
            raise refuse(f"table.jaws[{k}]", tuple(jaws[k].tolist()), allowed)
    for k, radius in enumerate(falls[:, FALL_RADIUS].tolist()):
        if radius <= 0:
            raise refuse(f"table.falls[{k}]", tuple(falls[k].tolist()), "must be x, y, and a radius > 0")


def check_fit(bed: Bed, ball_radius: float | None) -> None:
    """Raise ValueError unless a rectangular table's pockets fit its sides and let its ball through."""
    end = bed.corner.start if bed.corner else 0.0
    middle = bed.middle.start if bed.middle else 0.0
    for name, half, taken in (("width", bed.width / 2, end), ("length", bed.length / 2, end + middle)):
        if not half > taken:
            allowed = f"must be more than {2 * taken:.6g}, the length that the pockets take on that side"
            raise refuse(f"table.{name}", 2 * half, allowed)
    if ball_radius is None:
        return
    for name, pocket in (("corner", bed.corner), ("middle", bed.middle)):
        if pocket is not None and not pocket.throat > 2 * ball_radius:
            allowed = f"must be less than {pocket.throat / 2:.6g}, half the throat of the {name} pockets"
            raise refuse("table.ball_radius", ball_radius, allowed)
