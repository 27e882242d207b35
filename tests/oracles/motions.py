"""How do the oracles' own tests write down a ball's motion and compare two results?"""

from __future__ import annotations

import math

import numpy as np

R, M, G = 0.02625, 0.1406, 9.81
BALLS = {"R": R, "M": M}
STILL = np.zeros(3)
NORTH = np.array([0.0, 1.0, 0.0])


def heading(speed, cut):
    """Velocity at an angle to NORTH."""
    return speed * np.array([math.sin(cut), math.cos(cut), 0.0])


def rolling(v, share=1.0, side=0.0):
    """Spin of a ball that rolls with ``v`` (times ``share``), with vertical spin ``side``."""
    return np.array([-share / R * v[1], share / R * v[0], side])


def in_speeds(state):
    """v and R w of a result, one array."""
    return np.concatenate([np.asarray(a) * (R if k % 2 else 1.0) for k, a in enumerate(state)])
