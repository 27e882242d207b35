"""How well does the player execute a shot? Gaussian errors of aim, speed, tip offset and elevation.

What decides a pot is the total error of the cue ball's direction (``Noise.direction_deg``): the aim, and the squirt of a tip that is off to
the side. No measurement of a snooker player's errors in these units was found. So the levels are set by what players achieve, on these
pockets; ``python -m benchmarks.hand`` prints their pot rates beside the published figures, ``--fit`` the errors that meet them.

* "professional": 0.035 deg in all. Professionals are said to pot 50 to 65 % of long pots, and so does this level, as the mean over three
  pots of our choice (26, 62 and 84 %); a player who always takes the likeliest pot then scores, in play, nearly as often as
  professionals are said to pot what they choose, 88 to 95 %: about 88 % of all that it tries, 91 % where its chance is half or more.
* "amateur", "club": 0.048 and 0.114 deg in all. Aim errors given for such players (0.05 deg good amateur, 0.08 to 0.12 club) were derived
  as total errors for pockets with an effective half window of 22 mm; these give the same mean rate of four pots on these pockets.
  All these figures are second-hand: no statistics behind them were found.
* "robot": 0.046 deg in all: 90 % of pots of moderate difficulty, the cue ball 0.15 m from where it would stop without errors. The robot of
  Mathavan, Jackson & Parkin (2015, doi 10.1109/TMECH.2015.2461547) potted 90 % and left the cue ball 100 to 200 mm from where it was
  wanted. No more is in its abstract. The pots ("moderate" in benchmarks.hand) are our choice, and so is to put its whole error of position
  into the speed, which so stands for what its plan did not know, too.
* "olympiad": the Computer Olympiad's billiards, as defined there: aim 0.125 deg, elevation 0.1 deg, speed 0.075 m/s, offsets 0.5 mm. The
  squirt of the offset comes on top of the aim: 0.149 deg in all.

A pot that loses the cue ball counts as missed, also in the fit: 17 % of a professional's strokes at the longest straight pot, without spin,
end so. If it counted as made, as in that derivation, the fit would give about 0.040, 0.056 and 0.122 deg. The aim errors given for
professionals, 0.02 to 0.03 deg, make 83 to 92 % of those four pots, this level 76 %; both figures cannot be met at once, and we took the
long pots.

Our choices: aim and squirt have half of the variance each, which no measurement tells apart. The errors are drawn independently, so the tip
error is small. A real cue turns about the bridge hand; if that is R over the squirt's slope (0.35 m) behind the ball, squirt cancels the
turn, and a real tip may well be off by more. The height errs as much as the side. Speed: 1.75 % (professional), 2.5 %, 4 % (club), between
what is said of pool players: a good one rolls a ball the length of a table to within an inch or two, 0.5 to 1 % of the speed, a learner to
within a diamond, 6 % (Waldron, Pool Table Stimpmeter, 2009). Elevation: 0.1 to 0.3 deg; it hardly matters with a level cue.
"""

from dataclasses import asdict, dataclass, fields
from math import degrees, hypot, radians, sqrt
from typing import TypeAlias

import numpy as np

from .._check import choice, number, refuse
from .._jit import kernel
from .._types import Floats, NoiseName
from ..game.philox import normals
from ..physics.cue import MAX_ELEVATION
from ..physics.parameters import Physics, PhysicsLike

# Places in the packed deviations: 1 if there is no noise, then speed [m/s] and over the speed, tip offset over R, aim and elevation [rad].
(N_SILENT, N_SPEED, N_SPEED_REL, N_TIP, N_AIM, N_ELEVATION) = range(6)


@kernel
def executed(speed, side, top, aim, elevation, noise, stream):
    """The shot as executed: three blocks are drawn from ``stream``, nothing if ``noise``, as ``Noise.pack`` gives it, is silent."""
    if noise[N_SILENT]:
        return speed, side, top, aim, elevation
    a, b = normals(stream)
    c, d = normals(stream)
    e, _ = normals(stream)
    return (
        max(0.0, speed + a * sqrt(noise[N_SPEED] ** 2 + (noise[N_SPEED_REL] * speed) ** 2)),
        side + b * noise[N_TIP],
        top + c * noise[N_TIP],
        aim + d * noise[N_AIM],
        min(MAX_ELEVATION, max(0.0, elevation + e * noise[N_ELEVATION])),
    )


@dataclass(frozen=True, kw_only=True)
class Noise:
    """Standard deviations of one shot's execution, all >= 0.

    Parameters
    ----------
    aim_deg : float
        Aim [deg].
    speed_rel : float
        Speed, as a share of the speed.
    speed_abs : float
        Speed [m/s], added to the relative part in squares.
    offset_mm : float
        Tip offset, each of side and height [mm].
    elevation_deg : float
        Elevation [deg].

    Raises
    ------
    ValueError
        If a number is negative or not finite.

    Examples
    --------
    >>> from snooker_env.tasks import LEVELS, Noise
    >>> LEVELS["club"].aim_deg, Noise(speed_rel=0.02).silent
    (0.08, False)
    """

    aim_deg: float = 0.0
    speed_rel: float = 0.0
    speed_abs: float = 0.0
    offset_mm: float = 0.0
    elevation_deg: float = 0.0

    def __post_init__(self) -> None:
        for f in fields(self):
            object.__setattr__(self, f.name, number(f"noise.{f.name}", getattr(self, f.name), 0))

    @classmethod
    def of(cls, noise: "NoiseLike") -> "Noise":
        """What users may pass as ``noise``.

        Parameters
        ----------
        noise : str, dict or Noise
            A level's name, or a dict of fields of ``Noise``, the others 0.

        Returns
        -------
        Noise

        Raises
        ------
        ValueError
            For anything else.

        Examples
        --------
        >>> from snooker_env.tasks import Noise
        >>> Noise.of({"aim_deg": 0.1}).speed_rel
        0.0
        """
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
    def silent(self) -> bool:
        """No noise at all: nothing is drawn then."""
        return not (self.aim_deg or self.speed_rel or self.speed_abs or self.offset_mm or self.elevation_deg)

    def direction_deg(self, physics: PhysicsLike = None) -> float:
        """Total error of the cue ball's direction: the aim's and that of the tip's squirt, added in squares.

        A tip error of b R to the side turns the ball by (5/2) b / (7/2 + end_mass_ratio), the squirt of a small offset [TP A.31]: with the
        usual ratio of 30 by 0.163 deg for each millimetre. For strokes without intended side; the swerve of a nearly level cue is left out.

        Parameters
        ----------
        physics : None, str, dict or Physics
            As ``Physics.of`` takes it.

        Returns
        -------
        float
            Standard deviation [deg].
        """
        world = Physics.of(physics)
        tip = self.offset_mm * 1e-3 / world.R
        return hypot(self.aim_deg, degrees(2.5 * tip / (3.5 + world.end_mass_ratio)))

    def pack(self, R: float) -> Floats:
        """What the kernels must know.

        Parameters
        ----------
        R : float
            The ball's radius [m].

        Returns
        -------
        float64 (6,)
            Places ``N_*`` of this module.
        """
        tip = self.offset_mm * 1e-3 / R
        return np.array([self.silent, self.speed_abs, self.speed_rel, tip, radians(self.aim_deg), radians(self.elevation_deg)], np.float64)


NoiseLike: TypeAlias = Noise | dict[str, float] | NoiseName
"""What users may pass as ``noise``, see ``Noise.of``."""

LEVELS: dict[str, Noise] = {
    "none": Noise(),
    "professional": Noise(aim_deg=0.025, speed_rel=0.0175, offset_mm=0.15, elevation_deg=0.1),
    "amateur": Noise(aim_deg=0.034, speed_rel=0.025, offset_mm=0.21, elevation_deg=0.2),
    "club": Noise(aim_deg=0.08, speed_rel=0.04, offset_mm=0.5, elevation_deg=0.3),
    "robot": Noise(aim_deg=0.033, speed_rel=0.08, offset_mm=0.2, elevation_deg=0.1),
    "olympiad": Noise(aim_deg=0.125, speed_abs=0.075, offset_mm=0.5, elevation_deg=0.1),
}
