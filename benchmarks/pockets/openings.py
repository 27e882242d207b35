"""How large are the pockets' openings?"""

from math import cos, sin, sqrt

import numpy as np

PUBLISHED = (
    "published: a match pocket is 3 1/2 in (88.9 mm) wide at the fall of the slate, a club pocket 3 5/8 in (92.1), a wide one\n"
    "  4 in (101.6) (G. Large, gclbilliards.com); the Standard Association's template of 1896: 3 5/8 in, its fall in the middle\n"
    "  pockets slightly on the table's side of the cushions' inner line (Broadfoot, Billiards). Today's templates are not published."
)


def _in_pocket(pocket):
    """Its jaws as (depth along the axis from the aim point, distance from the axis, radius); depth of the
    fall's centre, its radius."""
    u, aim = np.array([cos(pocket.axis), sin(pocket.axis)]), np.array(pocket.aim)
    jaws = pocket.table.jaws[:, :2] - aim
    x, y, radius = pocket.table.falls[0]
    return (
        jaws @ u,
        np.abs(jaws @ np.array([-u[1], u[0]])),
        pocket.table.jaws[:, 2],
        (np.array([x, y]) - aim) @ u,
        radius,
    )


def openings(pocket):
    """Widths [m] across a preset's pocket: the mouth where the jaws begin, the throat where the arcs end, and
    at the fall.

    at the fall: between the noses on the line across the fall's middle (none where the jaws begin behind it);
    fall to jaw: between the two points at which the fall meets the jaws.
    """
    depth, across, radius, fall, edge = (a[0] if np.ndim(a) else a for a in _in_pocket(pocket))
    noses = pocket.table.noses
    if (noses[:, 0] == 0).all():
        mouth = float(noses[:, 3].max() - noses[:, 4].min())
    else:
        top, right = noses[noses[:, 0] == 1][0], noses[noses[:, 0] == 0][0]
        mouth = sqrt((right[2] - top[4]) ** 2 + (top[2] - right[4]) ** 2)
    at_fall = 2 * (across - sqrt(radius**2 - depth**2)) if abs(depth) < radius else np.nan
    # where the two circles cross: the fall about (fall, 0), the jaw about (depth, across); of both places the
    # one on the table's side
    d = np.hypot(depth - fall, across)
    ux, uy = (depth - fall) / d, across / d
    along = (d * d + edge**2 - radius**2) / (2 * d)
    off = sqrt(edge**2 - along**2)
    _, meets = min((fall + along * ux - side * off * uy, along * uy + side * off * ux) for side in (-1, 1))
    return {
        "mouth": mouth,
        "at the fall": float(at_fall),
        "fall to jaw": 2 * float(meets),
        "throat": 2 * float(across - radius),
    }


def clean(pocket, R):
    """The largest offset [m] from the axis at which a ball touches no jaw: half of what the throat leaves."""
    return openings(pocket)["throat"] / 2 - R
