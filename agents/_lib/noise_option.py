"""How do you pass execution errors on the command line? As LEVEL or LEVEL*SCALE, for example ``professional*1.2``."""

from dataclasses import asdict

from snooker_env.checks import number, refuse
from snooker_env.tasks import Noise


def noise_option(text):
    """Convert this text to the environment's option ``noise``: a level's name or a dict. Raises ValueError."""
    level, star, scale = text.partition("*")
    noise = Noise.of(level)
    if not star:
        return level
    try:
        scale = float(scale)
    except ValueError:
        raise refuse("noise", text, "must be LEVEL or LEVEL*SCALE") from None
    return asdict(noise.scale(number("noise scale", scale, 0.01, 100.0)))
