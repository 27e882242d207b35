"""How accurately does a player execute a shot? Errors of aim, speed, tip offset and elevation, now and then large ones.

Each of a stroke's five errors is normal, and all five are ``lapse_factor`` times as large in a *lapse*, which a stroke
is with the probability ``lapse``. So each error is a mixture of two normal laws, and large errors come together.

The total error of the cue ball's direction (``Noise.direction_deg``), of aim and squirt, decides a pot. No measurement
of snooker players' errors was found: docs/validation/execution_errors.md has the sources of the levels and our choices."""

from dataclasses import asdict, dataclass, fields, replace
from math import degrees, erf, hypot, radians, sqrt
from statistics import NormalDist
from typing import NamedTuple, TypeAlias

import numpy as np

from .._lib.check import choice, number, refuse
from .._lib.jit import entry, kernel
from .._lib.types import Floats, NoiseName, Words
from ..game.philox import normals, pair
from ..physics.cue import MAX_ELEVATION
from ..physics.parameters import Physics, PhysicsLike

# Packed deviations: 1 if there are none, speed [m/s], speed (relative), tip offset / R, aim, elevation [rad];
# the probability of a kick; by how much those of tip and aim grow with the elevation [1/rad], 0 for a free cue, and
# with the speed [s/m]; the normal number from which a stroke is a lapse, inf for never, and how many times larger its
# errors are.
N_SILENT, N_SPEED, N_SPEED_REL, N_TIP, N_AIM, N_ELEVATION, N_KICK = range(7)
N_STEEPER, N_FASTER, N_LAPSE, N_LAPSE_FACTOR = range(7, 11)
DRAWN = 6  # standard normal numbers that a stroke draws: five errors, and one that says whether it is a lapse
_SHAPE = ("growth", "lapse", "lapse_factor")  # fields of ``Noise`` that shape errors and make none
_NORMAL = NormalDist()
KICK = 0.2
"""Friction between balls in a kick: a stun shot's contact sticks with it up to a cut of 45 degrees, so that
more would change nothing there (docs/physics/limits.md). Not measured."""
POT_SPEED = 1.5
"""The cue speed at which one number stands for a player's error of direction [m/s]: about that of a pot."""
TWICE = radians(15.0)
"""The elevation of a real cue at which errors of tip and aim are twice those of a level one [rad]: an estimate."""


class Spread(NamedTuple):
    """How the cue ball's direction errs: normally, with the deviation ``core`` [rad], in a lapse with ``factor`` times that."""

    core: float
    lapse: float = 0.0
    factor: float = 1.0


@kernel
def widen(spread, times):
    """The same law with errors ``times`` as large."""
    return Spread(spread.core * times, spread.lapse, spread.factor)


@kernel
def chance_within(tolerance, spread):
    """The chance that an error of the ``Spread`` is within +- ``tolerance`` [rad]: P(|e| < t) = erf(t / (sqrt(2) sigma)) of
    each normal law, weighted by the probability of a lapse."""
    share = tolerance / (spread.core * sqrt(2.0))
    within = erf(share)
    if spread.lapse > 0.0:
        within += spread.lapse * (erf(share / spread.factor) - within)
    return within


@kernel
def with_errors(speed, side, top, aim, elevation, errors, noise):
    """The shot under ``errors`` (5,) in standard deviations, a lapse's factor applied: the only law of errors."""
    more = (1.0 + elevation * noise[N_STEEPER]) * sqrt(1.0 + (noise[N_FASTER] * speed) ** 2)
    return (
        max(0.0, speed + errors[0] * sqrt(noise[N_SPEED] ** 2 + (noise[N_SPEED_REL] * speed) ** 2)),
        side + errors[1] * (noise[N_TIP] * more),
        top + errors[2] * (noise[N_TIP] * more),
        aim + errors[3] * (noise[N_AIM] * more),
        min(MAX_ELEVATION, max(0.0, elevation + errors[4] * noise[N_ELEVATION])),
    )


@kernel
def drawn_errors(stream, noise):
    """The five errors of a shot from a stream, in standard deviations, as a tuple."""
    a, b = normals(stream)
    c, d = normals(stream)
    e, f = normals(stream)
    times = noise[N_LAPSE_FACTOR] if f > noise[N_LAPSE] else 1.0
    return times * a, times * b, times * c, times * d, times * e


@kernel
def execute_stroke(speed, side, top, aim, elevation, noise, stream):
    """A shot with its execution errors: three blocks are drawn from the stream, or nothing without errors."""
    if noise[N_SILENT]:
        return speed, side, top, aim, elevation
    return with_errors(speed, side, top, aim, elevation, drawn_errors(stream, noise), noise)


@kernel
def kick_of(noise, stream):
    """The friction of a shot's first contact in a kick, or 0. It draws one block, or nothing without kicks."""
    if noise[N_KICK] == 0.0:
        return 0.0
    u, _ = pair(stream)
    return KICK if u < noise[N_KICK] else 0.0


@entry
def _errors(streams, noise, out):
    for i in range(len(out)):
        out[i, 0], out[i, 1], out[i, 2], out[i, 3], out[i, 4] = drawn_errors(streams[i], noise)


@dataclass(frozen=True, kw_only=True)
class Noise:
    """Execution errors: standard deviations of one shot, their growth with the speed, lapses and bad contacts. All are
    at least 0, the default.

    Parameters
    ----------
    aim_deg, elevation_deg : float, optional
        Aim and elevation [deg].
    speed_rel, speed_abs : float, optional
        Speed, as a fraction of the speed, and [m/s], combined as the root of the sum of squares.
    offset_mm : float, optional
        Tip offset [mm], for each of side and height.
    growth : float, optional
        How errors of aim and tip grow with the cue speed V: times sqrt(1 + (growth V)^2) [s/m].
    lapse : float, optional
        Probability, in [0, 1], of a lapse: a stroke whose five errors are all larger.
    lapse_factor : float, optional
        How many times as large the errors of a lapse are, at least 1.
    kick : float, optional
        Probability, in [0, 1], of a kick: chalk or dirt between the cue ball and the first ball that it meets, with a
        friction of ``KICK`` = 0.2 in that one impact. Its frequency in play is not known.

    Examples
    --------
    >>> from snooker_env.tasks import LEVELS, Noise
    >>> LEVELS["club"].aim_deg, Noise(speed_rel=0.02).silent
    (0.056, False)
    """

    aim_deg: float = 0.0
    speed_rel: float = 0.0
    speed_abs: float = 0.0
    offset_mm: float = 0.0
    elevation_deg: float = 0.0
    growth: float = 0.0
    lapse: float = 0.0
    lapse_factor: float = 1.0
    kick: float = 0.0

    def __post_init__(self) -> None:
        for f in fields(self):
            least, most = float(f.name == "lapse_factor"), 1 if f.name in ("lapse", "kick") else np.inf
            object.__setattr__(self, f.name, number(f"noise.{f.name}", getattr(self, f.name), least, most))

    @classmethod
    def of(cls, noise: "NoiseLike") -> "Noise":
        """Convert a level's name or a dict of fields; a ``Noise`` is returned itself. ValueError for anything else."""
        if isinstance(noise, cls):
            return noise
        if isinstance(noise, dict):
            for key in noise:
                choice("noise field", key, [f.name for f in fields(cls)])
            return cls(**noise)
        if not isinstance(noise, str) or noise not in LEVELS:
            names = ", ".join(map(repr, LEVELS))
            allowed = f"must be one of {names} or a dict of {list(asdict(cls()))}"
            raise refuse("noise", noise, allowed)
        return LEVELS[noise]

    def scale(self, times: float) -> "Noise":
        """Return a ``Noise`` with every error ``times`` as large; growth, lapses and kicks do not change."""
        errors = (f.name for f in fields(self) if f.name not in (*_SHAPE, "kick"))
        return replace(self, **{name: getattr(self, name) * times for name in errors})

    @property
    def silent(self) -> bool:
        """Whether all deviations are 0 and there are no kicks, a bool; then nothing is drawn."""
        return not any(getattr(self, f.name) for f in fields(self) if f.name not in _SHAPE)

    def direction_deg(self, physics: PhysicsLike = None, *, speed: float = POT_SPEED) -> float:
        """Return the standard deviation [deg] of the cue ball's direction without lapses: aim and squirt together, for a
        cue speed [m/s]; default 1.5, about that of a pot.

        A tip error of b R to the side turns the ball by (5/2) b / (7/2 + end_mass_ratio), the squirt of a
        small offset [TP A.31]: with the usual ratio of 30, 0.163 deg per mm. It holds for strokes without
        intended side; the swerve of a nearly level cue is neglected. ``physics``: see ``Physics.of``; default
        "paper"."""
        constants = Physics.of(physics)
        tip = self.offset_mm * 1e-3 / constants.R
        slow = hypot(self.aim_deg, degrees(2.5 * tip / (3.5 + constants.end_mass_ratio)))
        return slow * hypot(1.0, self.growth * speed)

    def spread(self, physics: PhysicsLike = None, *, speed: float = POT_SPEED) -> Spread:
        """The law of ``direction_deg``, whose standard deviation ``core`` is at least 1e-5 rad."""
        core = max(1e-5, radians(self.direction_deg(physics, speed=speed)))
        return Spread(core, self.lapse, self.lapse_factor)

    def pack(self, R: float, *, real: bool = False) -> Floats:
        """float64 (11,) for kernels, in columns ``N_*``. ``R``: the radius [m]; ``real``: whether errors grow with the elevation."""
        tip, turns = self.offset_mm * 1e-3 / R, (radians(self.aim_deg), radians(self.elevation_deg))
        grows = 1.0 / TWICE if real else 0.0, self.growth
        deviations = self.speed_abs, self.speed_rel, tip, *turns
        lapses = _NORMAL.inv_cdf(1.0 - self.lapse) if 0.0 < self.lapse < 1.0 else np.inf * (0.5 - self.lapse)
        return np.array([self.silent, *deviations, self.kick, *grows, lapses, self.lapse_factor], np.float64)

    def errors_of(self, streams: Words) -> Floats:
        """The errors (n, 5) in standard deviations that shots would draw from ``streams`` (n, 2), which are not changed."""
        out = np.empty((len(streams), 5))
        _errors(streams.copy(), self.pack(1.0), out)
        return out

    def draw_errors(self, rng: np.random.Generator, n: int) -> Floats:
        """The errors (n, 5) in standard deviations of n strokes."""
        return self.errors_from(rng.standard_normal((n, DRAWN)))

    def errors_from(self, normals: Floats) -> Floats:
        """The errors (n, 5) in standard deviations that standard normal numbers (n, ``DRAWN``) stand for."""
        packed = self.pack(1.0)
        times = np.where(normals[:, 5] > packed[N_LAPSE], packed[N_LAPSE_FACTOR], 1.0)
        return normals[:, :5] * times[:, None]


NoiseLike: TypeAlias = Noise | dict[str, float] | NoiseName
"""The types that arguments called ``noise`` accept, see ``Noise.of``."""
_ERRORS = {"aim_deg": 0.014, "speed_rel": 0.017, "offset_mm": 0.085, "elevation_deg": 0.11}
_PROFESSIONAL = Noise(**_ERRORS, growth=1.0, lapse=0.1, lapse_factor=7.0)
LEVELS: dict[str, Noise] = {
    "none": Noise(),
    "professional": _PROFESSIONAL,
    "amateur": _PROFESSIONAL.scale(2.0),
    "club": _PROFESSIONAL.scale(4.0),
    "beginner": _PROFESSIONAL.scale(8.0),
    "robot": Noise(aim_deg=0.033, speed_rel=0.08, offset_mm=0.2, elevation_deg=0.1),
    "olympiad": Noise(aim_deg=0.125, speed_abs=0.075, offset_mm=0.5, elevation_deg=0.1),
}
"""The levels: "none" errs never; "professional", "amateur", "club" and "beginner" are scales of one law; "robot" and
"olympiad" are Gaussian. Sources: above."""
