"""How are execution errors given on the command line? As LEVEL or LEVEL*SCALE, for example ``professional*1.2``."""

from dataclasses import asdict, replace

from snooker_env.checks import number, refuse
from snooker_env.tasks import Noise

ERRORS = "aim_deg", "speed_rel", "speed_abs", "offset_mm", "elevation_deg"


def scale_noise(noise, scale):
    """Every error times ``scale``; how errors of direction grow with the speed is kept."""
    return replace(noise, **{name: getattr(noise, name) * scale for name in ERRORS})


def noise_option(text):
    """The environment's option ``noise`` for this text: the level's name, or a dict. Raises ValueError."""
    level, star, scale = text.partition("*")
    noise = Noise.of(level)
    if not star:
        return level
    try:
        scale = float(scale)
    except ValueError:
        raise refuse("noise", text, "must be LEVEL or LEVEL*SCALE") from None
    return asdict(scale_noise(noise, number("noise scale", scale, 0.01, 100.0)))
