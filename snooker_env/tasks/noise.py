"""How accurately does a player execute a shot? Gaussian errors of aim, speed, tip offset and elevation.

What decides a pot is the total error of the cue ball's direction (``Noise.direction_deg``): the aim error
plus the squirt of a tip that is off to the side. No measurement of a snooker player's errors in these units
was found. So the levels are set by what players achieve, on the pockets of this package.
``python -m benchmarks.execution`` prints their pot rates beside the published figures, and with ``--fit`` the
errors that reproduce them.

=============== ========================= ===========================================================================================
level           error of direction [deg]  set by
=============== ========================= ===========================================================================================
"professional"  0.035                     long pots: professionals are said to pot 50 to 65 %
"amateur"       0.048                     aim error of 0.05 deg, given for a good amateur
"club"          0.114                     aim errors of 0.08 to 0.12 deg, given for club players
"robot"         0.046                     90 % of pots of moderate difficulty, cue ball 0.15 m from where it would stop without errors
"olympiad"      0.149                     the definition of the Computer Olympiad's billiards
=============== ========================= ===========================================================================================

* "professional": the mean over three long pots of our choice lies in that range (26, 62 and 84 %). A player
  who always takes the likeliest pot then makes, in play, about 88 % of the pots that it tries, and 91 % of
  those with a chance of half or more. Professionals are said to make 88 to 95 % of the pots that they choose.
* "amateur", "club": the published aim errors were derived as total errors for pockets with an effective half
  window of 22 mm. These levels give the same mean rate of four pots on these pockets. All figures quoted so
  far are from secondary sources: no statistics behind them were found.
* "robot": the robot of Mathavan, Jackson & Parkin (2015, doi 10.1109/TMECH.2015.2461547) potted 90 % and left
  the cue ball 100 to 200 mm from the planned place. The abstract says no more. The pots ("moderate" in the
  benchmark) are our choice. So is putting the whole error of position into the speed, which therefore
  includes the error of the robot's own predictions.
* "olympiad": aim 0.125 deg, elevation 0.1 deg, speed 0.075 m/s, offsets 0.5 mm, as defined there. The squirt
  of the offset is added to the aim.

A pot that loses the cue ball counts as missed, also in the fit: 17 % of a professional's strokes at the
longest straight pot, without spin, end that way. If it counted as made, as in the published derivation, the
fit would give about 0.040, 0.056 and 0.122 deg. The aim errors published for professionals, 0.02 to 0.03 deg,
make 83 to 92 % of those four pots; this level makes 76 %. Both figures cannot be met at once, and we chose
the long pots.

Our choices:

* Aim and squirt have half of the variance each; no measurement separates them.
* The errors are drawn independently, so the tip error is small. A real cue turns about the bridge. If the
  bridge is R over the squirt's slope (0.35 m) behind the ball, squirt cancels the turn, and a real tip may
  well be off by more.
* The vertical tip error equals the horizontal one.
* Speed: 1.75 % (professional), 2.5 % (amateur), 4 % (club). Of pool players it is said that a good one rolls
  a ball the length of a table to within an inch or two, 0.5 to 1 % of the speed, and a beginner to within a
  diamond, 6 % (Waldron, Pool Table Stimpmeter, 2009).
* Elevation: 0.1 to 0.3 deg; it hardly matters with a level cue.
"""

from dataclasses import asdict, dataclass, fields
from math import degrees, hypot, radians, sqrt
from typing import TypeAlias

import numpy as np

from .._check import choice, number, refuse
from .._jit import entry, kernel
from .._types import Floats, NoiseName, Words
from ..game.philox import normals
from ..physics.cue import MAX_ELEVATION
from ..physics.parameters import Physics, PhysicsLike

# Columns of the packed deviations: 1 if there is no noise, then speed [m/s], speed (relative), tip offset
# over R, aim, elevation [rad].
(N_SILENT, N_SPEED, N_SPEED_REL, N_TIP, N_AIM, N_ELEVATION) = range(6)


@kernel
def with_errors(speed, side, top, aim, elevation, errors, noise):
    """The shot under the standard normal ``errors`` (5,): speed, side, top, aim, elevation. The only law of
    errors; see ``executed``."""
    return (
        max(0.0, speed + errors[0] * sqrt(noise[N_SPEED] ** 2 + (noise[N_SPEED_REL] * speed) ** 2)),
        side + errors[1] * noise[N_TIP],
        top + errors[2] * noise[N_TIP],
        aim + errors[3] * noise[N_AIM],
        min(MAX_ELEVATION, max(0.0, elevation + errors[4] * noise[N_ELEVATION])),
    )


@kernel
def drawn_errors(stream):
    """Five standard normal errors of a shot from a stream, as a tuple."""
    a, b = normals(stream)
    c, d = normals(stream)
    e, _ = normals(stream)
    return a, b, c, d, e


@kernel
def executed(speed, side, top, aim, elevation, noise, stream):
    """A shot with its execution errors. An inner kernel.

    Parameters
    ----------
    speed : float
        Intended speed of the cue [m/s].
    side, top : float
        Intended tip offset over R.
    aim : float
        Intended direction of the cue [rad].
    elevation : float
        Intended elevation of the cue [rad].
    noise : float64 (k,)
        Standard deviations of the errors, as ``Noise.pack`` returns them.
    stream : uint64 (2,)
        Stream of random numbers: key and counter. Three blocks are drawn from it, or nothing if ``noise`` has
        no errors.

    Returns
    -------
    speed, side, top, aim, elevation : float
        The shot as executed, in the same units.
    """
    if noise[N_SILENT]:
        return speed, side, top, aim, elevation
    return with_errors(speed, side, top, aim, elevation, drawn_errors(stream), noise)


@entry
def _errors(streams, out):
    for i in range(len(out)):
        out[i, 0], out[i, 1], out[i, 2], out[i, 3], out[i, 4] = drawn_errors(streams[i])


def errors_of(streams: Words) -> Floats:
    """The errors that shots would draw from ``streams`` (n, 2), which stay as they are: standard normal (n,
    5), as of ``with_errors``."""
    out = np.empty((len(streams), 5))
    _errors(streams.copy(), out)
    return out


@dataclass(frozen=True, kw_only=True)
class Noise:
    """Execution errors: standard deviations of one shot, all at least 0.

    Parameters
    ----------
    aim_deg : float, optional
        Aim [deg]; default 0.
    speed_rel : float, optional
        Speed, as a fraction of the speed; default 0.
    speed_abs : float, optional
        Speed [m/s], combined with the relative part as the root of the sum of squares; default 0.
    offset_mm : float, optional
        Tip offset [mm], for each of side and height; default 0.
    elevation_deg : float, optional
        Elevation [deg]; default 0.

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
        """Convert an argument to a ``Noise``.

        ``noise``: the name of a level (a key of ``LEVELS``), or a dict of fields of ``Noise``; fields left
        out are 0. Returns the argument itself if it is one already. ValueError for anything else.
        """
        if isinstance(noise, cls):
            return noise
        if isinstance(noise, dict):
            for key in noise:
                choice("noise field", key, [f.name for f in fields(cls)])
            return cls(**noise)
        if not isinstance(noise, str) or noise not in LEVELS:
            raise refuse(
                "noise",
                noise,
                "must be one of "
                + ", ".join(map(repr, LEVELS))
                + " or a dict of "
                + str(list(asdict(cls()))),
            )
        return LEVELS[noise]

    @property
    def silent(self) -> bool:
        """Whether all deviations are 0, a bool; then nothing is drawn."""
        return not (self.aim_deg or self.speed_rel or self.speed_abs or self.offset_mm or self.elevation_deg)

    def direction_deg(self, physics: PhysicsLike = None) -> float:
        """Return the total error of the cue ball's direction: aim and squirt together.

        A tip error of b R to the side turns the ball by (5/2) b / (7/2 + end_mass_ratio), the squirt of a
        small offset [TP A.31]. With the usual ratio of 30 that is 0.163 deg for each millimetre. The result
        holds for strokes without intended side; the swerve of a nearly level cue is neglected.

        Parameters
        ----------
        physics : str, dict, Physics or None, optional
            Physical constants, as ``Physics.of`` takes them; default None: the preset "paper".

        Returns
        -------
        float
            Standard deviation [deg].

        Examples
        --------
        >>> from snooker_env.tasks import LEVELS
        >>> round(LEVELS["professional"].direction_deg(), 4)
        0.035
        """
        constants = Physics.of(physics)
        tip = self.offset_mm * 1e-3 / constants.R
        return hypot(self.aim_deg, degrees(2.5 * tip / (3.5 + constants.end_mass_ratio)))

    def pack(self, R: float) -> Floats:
        """Return the deviations as an array for the kernels.

        ``R``: radius of the ball [m]. Returns float64 (6,), in the columns ``N_*`` of this module.
        """
        tip = self.offset_mm * 1e-3 / R
        return np.array(
            [
                self.silent,
                self.speed_abs,
                self.speed_rel,
                tip,
                radians(self.aim_deg),
                radians(self.elevation_deg),
            ],
            np.float64,
        )


NoiseLike: TypeAlias = Noise | dict[str, float] | NoiseName
"""The types that arguments called ``noise`` accept, see ``Noise.of``."""

LEVELS: dict[str, Noise] = {
    "none": Noise(),
    "professional": Noise(aim_deg=0.025, speed_rel=0.0175, offset_mm=0.15, elevation_deg=0.1),
    "amateur": Noise(aim_deg=0.034, speed_rel=0.025, offset_mm=0.21, elevation_deg=0.2),
    "club": Noise(aim_deg=0.08, speed_rel=0.04, offset_mm=0.5, elevation_deg=0.3),
    "robot": Noise(aim_deg=0.033, speed_rel=0.08, offset_mm=0.2, elevation_deg=0.1),
    "olympiad": Noise(aim_deg=0.125, speed_abs=0.075, offset_mm=0.5, elevation_deg=0.1),
}
"""The named levels of execution noise: "none", "professional", "amateur", "club", "robot" and "olympiad", as
``Noise``. The module's docstring gives their sources.
"""
