"""What is each law worth? The shots again without it, every strike searched again near and far from the one that was."""

from dataclasses import replace

from .constants import rms
from .strikes import refine_from


def laws(physics):
    """Name of each law -> (the constants without it, whether the cue is held level)."""
    mean = physics.mu_r + physics.roll_drag * 0.5**2 / physics.g
    return {
        "rolling resistance that grows with speed": (replace(physics, roll_drag=0.0, mu_r=mean), False),
        "cushion's restitution that falls with speed": (replace(physics, e_c_power=0.0), False),
        "friction at the cushion": (replace(physics, mu_c=0.0), False),
        "height of the nose (else at the ball's centre)": (replace(physics, sin_theta=0.0), False),
        "friction between balls (throw)": (replace(physics, mu_bb=0.0), False),
        "decay of spin about the vertical": (replace(physics, spin_decel=0.0), False),
        "raised cue (swerve)": (physics, True),
    }


def without(judge, strike, physics, level, seed):
    """The cue ball's rms error [m] with other constants, or with a level cue, its strike searched near and far."""
    judge.use(physics)
    best, _ = refine_from(judge, strike, seed, level)
    return rms(judge, best)
