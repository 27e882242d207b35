"""Which constants suit a table best? Those shared by all of its shots, fitted while each shot keeps its own strike."""

import json
import sys
import time

import numpy as np

from snooker_env.physics.parameters import Physics

from .cma import Cma
from .paths import Judge
from .strikes import fit, refit

SEARCHED = {
    "mu_s": (0.06, 0.40),
    "mu_r": (0.0036, 0.0060),
    "spin_decel": (1.0, 40.0),
    "e_b": (0.85, 1.0),
    "mu_bb": (0.0, 0.20),
    "e_c": (0.70, 1.0),
    "e_c_knee": (0.2, 3.0),
    "e_c_power": (0.0, 0.5),
    "mu_c": (0.03, 0.45),
    "sin_theta": (0.05, 0.45),
}
"""The fields that are fitted, and the range of each."""
MIDDLING = 0.15
"""An error that counts half [m]: one shot that goes another way should not decide."""


def rms(judge, strike):
    """Root mean square distance of the cue ball from its samples [m]."""
    return float(np.sqrt(judge.squares(strike[None])[0, : judge.offsets[1]].mean()))


def loss(errors):
    """What is minimised over the constants: the mean over shots of e / (1 + e / MIDDLING)."""
    errors = np.asarray(errors)
    return float((errors / (1 + errors / MIDDLING)).mean())


def played(physics, judges, strikes, seed=0, **options):
    """Strikes fitted again with other constants, and their errors [m]."""
    found, errors = [], []
    for judge, strike in zip(judges, strikes, strict=True):
        judge.use(physics)
        best, _ = refit(judge, strike, seed, **options)
        found.append(best)
        errors.append(rms(judge, best))
    return found, errors
