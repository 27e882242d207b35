"""How are 3D vectors computed with in the float oracles? As tuples (x, y, z); table frame, right-handed, z
up."""

from __future__ import annotations

import math

Vector = tuple[float, float, float]
Z: Vector = (0.0, 0.0, 1.0)


def cross(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def add(a: Vector, b: Vector) -> Vector:
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def scale(k: float, a: Vector) -> Vector:
    return (k * a[0], k * a[1], k * a[2])


def norm(a: Vector) -> float:
    return math.sqrt(dot(a, a))


def normalized(a: Vector) -> Vector:
    """``a`` over its length; zero for zero, which happens only inside a step that runs past the event at
    ZERO_SLIP."""
    length = norm(a)
    return scale(1.0 / length, a) if length > 0.0 else a


def unit_horizontal(normal) -> Vector:
    n = tuple(float(c) for c in normal)
    if len(n) == 2:
        n = (*n, 0.0)
    if n[2] != 0.0 or abs(norm(n) - 1.0) > 1e-9:
        raise ValueError(f"normal must be a horizontal unit vector, not {normal}")
    return scale(1.0 / norm(n), n)


def on_the_cloth(*velocities) -> None:
    if any(v[2] != 0.0 for v in velocities):
        raise ValueError(
            "the balls must be on the cloth: a vertical velocity before the impact is not modelled"
        )
