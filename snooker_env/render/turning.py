"""How is a ball oriented at any time of a shot? Its spin, integrated once, as unit quaternions (w, x, y, z).
q is the rotation since the start: v of the ball is q v q* in the table frame, as spins are."""

import numpy as np

from .._types import Floats
from ..simulation import Shot

STEP = 1 / 240
"""Time between stored rotations [s]: at 100 rad/s the ball turns by a quarter of a right angle in it."""


class Turning:
    """The rotation of one ball of a ``Shot``."""

    def __init__(self, shot: Shot, ball: int):
        self._shot, self._ball = shot, int(ball)
        count = int(shot.duration / STEP) + 1
        spins = shot.at((np.arange(count) + 0.5) * STEP)[2][:, self._ball]
        turns = rotation(spins * STEP)
        self._kept = np.empty((count + 1, 4))
        self._kept[0] = 1.0, 0.0, 0.0, 0.0
        for k in range(count):
            self._kept[k + 1] = product(turns[k], self._kept[k])

    def at(self, t: float) -> Floats:
        """The unit quaternion (4,) at a time [s] from the start of the shot."""
        k = min(int(t / STEP), len(self._kept) - 1)
        rest = t - k * STEP
        return product(rotation(self._shot.at(k * STEP + rest / 2)[2][self._ball] * rest), self._kept[k])


def rotation(turn: Floats) -> Floats:
    """The quaternion (..., 4) of a rotation about the axis ``turn`` (..., 3) by its length [rad]."""
    turn = np.asarray(turn, dtype=np.float64)
    angle = np.linalg.norm(turn, axis=-1, keepdims=True)
    return np.concatenate([np.cos(angle / 2), turn * (np.sinc(angle / (2 * np.pi)) / 2)], axis=-1)


def product(a: Floats, b: Floats) -> Floats:
    """The product of two quaternions (4,): the rotation ``b``, then ``a``."""
    (aw, ax, ay, az), (bw, bx, by, bz) = a.tolist(), b.tolist()
    w, x = aw * bw - ax * bx - ay * by - az * bz, aw * bx + ax * bw + ay * bz - az * by
    y, z = aw * by - ax * bz + ay * bw + az * bx, aw * bz + ax * by - ay * bx + az * bw
    return np.array([w, x, y, z])


def matrix(q: Floats) -> Floats:
    """The rotation of a quaternion as a matrix (3, 3)."""
    w, x, y, z = q.tolist()
    across = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])  # of the axis: across @ v is its product with v
    return np.eye(3) + 2 * w * across + 2 * across @ across
