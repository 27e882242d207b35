"""How well does the player execute a shot? Gaussian errors of aim, speed, tip offset and elevation.

Sources: "olympiad" is the noise of the Computer Olympiad's billiards (aim 0.125 deg, elevation 0.1 deg, speed 0.075 m/s, offsets 0.5 mm).
The aim of the others gives the pot rates of real players (professional 0.02 to 0.03 deg, good amateur 0.05, club 0.08 to 0.12), their
speed is professional 1.5 to 2 %, club 3 to 5 %. For their tip offsets and elevation no figure was found: those are our choice.
"""

from dataclasses import asdict, dataclass, fields
from math import radians, sqrt

import numpy as np

from .._check import choice, number, refuse
from .._jit import entry, kernel
from ..game.stream import normals
from ..physics.cue import MAX_ELEVATION

# Places in the packed deviations: 1 if there is no noise, then speed [m/s] and over the speed, tip offset over R, aim and elevation [rad].
(N_SILENT, N_SPEED, N_SPEED_REL, N_TIP, N_AIM, N_ELEVATION) = range(6)


@kernel
def _executed(speed, side, top, aim, elevation, z, noise):
    """The shot as executed, from five standard normal numbers z."""
    return (
        max(0.0, speed + z[0] * sqrt(noise[N_SPEED] ** 2 + (noise[N_SPEED_REL] * speed) ** 2)),
        side + z[1] * noise[N_TIP],
        top + z[2] * noise[N_TIP],
        aim + z[3] * noise[N_AIM],
        min(MAX_ELEVATION, max(0.0, elevation + z[4] * noise[N_ELEVATION])),
    )


@kernel
def executed(speed, side, top, aim, elevation, noise, stream):
    """The shot as executed: three blocks are drawn from ``stream``, nothing if ``noise``, as ``Noise.pack`` gives it, is silent."""
    if noise[N_SILENT]:
        return speed, side, top, aim, elevation
    a, b = normals(stream)
    c, d = normals(stream)
    e, _ = normals(stream)
    return _executed(speed, side, top, aim, elevation, (a, b, c, d, e), noise)


@entry
def _draw(speed, side, top, aim, elevation, z, noise):
    return _executed(speed, side, top, aim, elevation, (z[0], z[1], z[2], z[3], z[4]), noise)


@dataclass(frozen=True, kw_only=True)
class Noise:
    """Standard deviations of one shot's execution, all >= 0.

    Fields:

    * aim_deg: Aim [deg].
    * speed_rel: Speed, as a share of the speed.
    * speed_abs: Speed [m/s], added to the relative part in squares.
    * offset_mm: Tip offset, each of side and height [mm].
    * elevation_deg: Elevation [deg].
    """

    aim_deg: float = 0.0
    speed_rel: float = 0.0
    speed_abs: float = 0.0
    offset_mm: float = 0.0
    elevation_deg: float = 0.0

    def __post_init__(self):
        for f in fields(self):
            object.__setattr__(self, f.name, number(f"noise.{f.name}", getattr(self, f.name), 0))

    @classmethod
    def of(cls, noise):
        """A level's name, or a dict of the fields above (others 0)."""
        if isinstance(noise, cls):
            return noise
        if isinstance(noise, dict):
            for key in noise:
                choice("noise field", key, [f.name for f in fields(cls)])
            return cls(**noise)
        if not isinstance(noise, str) or noise not in LEVELS:
            raise refuse("noise", noise, "must be one of " + ", ".join(map(repr, LEVELS)) + " or a dict of " + str(list(asdict(cls()))))
        return LEVELS[noise]

    @property
    def silent(self):
        """No noise at all: nothing is drawn then."""
        return not (self.aim_deg or self.speed_rel or self.speed_abs or self.offset_mm or self.elevation_deg)

    def draw(self, rng, speed, side, top, aim, elevation, R):
        """The shot as executed: (speed, side, top, aim, elevation). Five numbers are drawn from ``rng`` unless silent."""
        if self.silent:
            return speed, side, top, aim, elevation
        z = rng.standard_normal(5)
        return _draw(float(speed), float(side), float(top), float(aim), float(elevation), z, self.pack(R))

    def pack(self, R):
        """What the kernels must know: float64, places ``N_*`` of this module; R the ball's radius [m]."""
        tip = self.offset_mm * 1e-3 / R
        return np.array([self.silent, self.speed_abs, self.speed_rel, tip, radians(self.aim_deg), radians(self.elevation_deg)], np.float64)


LEVELS = {
    "none": Noise(),
    "professional": Noise(aim_deg=0.025, speed_rel=0.0175, offset_mm=0.5, elevation_deg=0.1),
    "amateur": Noise(aim_deg=0.05, speed_rel=0.025, offset_mm=1.0, elevation_deg=0.2),
    "club": Noise(aim_deg=0.1, speed_rel=0.04, offset_mm=1.5, elevation_deg=0.3),
    "olympiad": Noise(aim_deg=0.125, speed_abs=0.075, offset_mm=0.5, elevation_deg=0.1),
}
