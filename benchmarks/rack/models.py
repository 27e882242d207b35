"""How does each model resolve a break, and how far apart are two of them? The contact laws, the sequence, the
simultaneous solution.

Used by ``python -m benchmarks.rack``, whose docstring states the models and the measures.
"""

import numpy as np

import snooker_env as sn

from .compliant import LAWS, SPAN, R, compliant
from .simultaneous import simultaneous


def shares(v, w, speed):
    """Each ball's energy over the rolling cue ball's."""
    return ((v[:, :2] ** 2).sum(1) + 0.4 * R**2 * (w**2).sum(1)) / (1.4 * speed**2)


def misplaced(a, b):
    """Of two lists of shares: how much would have to change its place, what is lost being a place too."""
    return 0.5 * float(np.abs(a - b).sum() + abs(a.sum() - b.sum()))


def sharers(x):
    return float(x[1:16].sum() ** 2 / (x[1:16] ** 2).sum())


def apart(r):
    """Positions with the last nanometres of overlap taken out, as the engine needs them."""
    r = r.copy()
    for _ in range(1000):
        d = r[None] - r[:, None]
        far = np.hypot(*d.transpose(2, 0, 1))
        bad = np.argwhere(np.triu(far < 2 * R, 1))
        if not len(bad):
            break
        for i, j in bad:
            push = (0.5 * (2 * R - far[i, j]) + 1e-10) * d[i, j] / far[i, j]
            r[i] -= push
            r[j] += push
    return r


class Models:
    """The models, by name: from balls at impact to their state after SPAN, and to rest."""

    def __init__(self, physics):
        self.physics = physics
        self.slippery = sn.Physics.preset("paper", e_b=physics.e_b, mu_bb=0.0)
        self.names = (*LAWS, "sequence", "simultaneous")

    def after(self, name, r, v, w, physics=None):
        """r, v, w after SPAN."""
        physics = physics or self.physics
        if name in LAWS:
            return compliant(r, v, w, physics, LAWS[name])[:3]
        if name == "simultaneous":
            v = simultaneous(r, v, physics.e_b)
        return sn.simulate(r, v, w, "match", physics).at(SPAN)

    def energy(self, name, r, v, w, physics=None):
        """Shares (n,) after SPAN."""
        _, v1, w1 = self.after(name, r, v, w, physics)
        return shares(v1, w1, np.hypot(*v[0]))

    def to_rest(self, name, r, v, w):
        """The whole shot (a ``Shot`` that starts after SPAN for contact laws), and the shares (n,) after
        SPAN."""
        speed = np.hypot(*v[0])
        if name in LAWS:
            r, v, w = self.after(name, r, v, w)
            return sn.simulate(apart(r), v[:, :2], w, "match", self.physics), shares(v, w, speed)
        if name == "simultaneous":
            v = simultaneous(r, v, self.physics.e_b)
        shot = sn.simulate(r, v, w, "match", self.physics)
        _, v, w = shot.at(SPAN)
        return shot, shares(v, w, speed)
