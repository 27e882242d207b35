"""How are execution errors given on the command line? As LEVEL or LEVEL*SCALE, for example ``professional*1.2``."""

from dataclasses import asdict, replace

from snooker_env.checks import number, refuse
from snooker_env.tasks import Noise


def scaled(noise, scale):
    """Errors times ``scale``, those of the speed times its power 0.7, as from a professional to a club player."""
    turns = {name: getattr(noise, name) * scale for name in ("aim_deg", "offset_mm", "elevation_deg")}
    speeds = {name: getattr(noise, name) * scale**0.7 for name in ("speed_rel", "speed_abs")}
    return replace(noise, **turns, **speeds)


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
    return asdict(scaled(noise, number("noise scale", scale, 0.01, 100.0)))
