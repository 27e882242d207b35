"""How well does the player execute a shot? Gaussian errors of aim, speed, tip offset and elevation.

Sources: "olympiad" is the noise of the Computer Olympiad's billiards (aim 0.125 deg, elevation 0.1 deg, speed 0.075 m/s, offsets 0.5 mm).
The aim of the others gives the pot rates of real players (professional 0.02 to 0.03 deg, good amateur 0.05, club 0.08 to 0.12), their
speed is professional 1.5 to 2 %, club 3 to 5 %. For their tip offsets and elevation no figure was found: those are our choice.
"""

from dataclasses import asdict, dataclass, fields
from math import radians

from .._check import choice, number, refuse
from ..physics.cue import MAX_ELEVATION


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
        tip = self.offset_mm * 1e-3 / R
        return (
            max(0.0, speed + z[0] * (self.speed_abs**2 + (self.speed_rel * speed) ** 2) ** 0.5),
            side + z[1] * tip,
            top + z[2] * tip,
            aim + z[3] * radians(self.aim_deg),
            min(MAX_ELEVATION, max(0.0, elevation + z[4] * radians(self.elevation_deg))),
        )


LEVELS = {
    "none": Noise(),
    "professional": Noise(aim_deg=0.025, speed_rel=0.0175, offset_mm=0.5, elevation_deg=0.1),
    "amateur": Noise(aim_deg=0.05, speed_rel=0.025, offset_mm=1.0, elevation_deg=0.2),
    "club": Noise(aim_deg=0.1, speed_rel=0.04, offset_mm=1.5, elevation_deg=0.3),
    "olympiad": Noise(aim_deg=0.125, speed_abs=0.075, offset_mm=0.5, elevation_deg=0.1),
}
