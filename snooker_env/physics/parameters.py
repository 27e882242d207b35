"""Which constants does a simulation use? ``Physics``: each with its source, checked, packed for the kernels.

[MJP14] Mathavan, Jackson & Parkin, Sports Eng. (2014); [MJP10] the same, Proc. IMechE C 224 (2010); [Marlow]
The Physics of Pocket Billiards (1994), as fitted by Alciatore (TP A.14); [TP A.30, A.31] Alciatore.
"""

import dataclasses
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, Literal, TypeAlias

import numpy as np

from .._lib.check import choice, number, refuse, truth
from .._lib.types import Floats, Ints, PhysicsName, Solver
from ..geometry import BALL_RADIUS
from . import columns, conditions
from .impact.tables import SIZE, TABLED, Rolling, table_of

MARLOW = (9.951e-3, 0.108, 1.088)
"""Marlow's law of ball-ball friction, mu(s) = a + b exp(-c s), s the slip speed in m/s."""

FASTEST = 1000.0
"""Largest velocity component and cue speed of a shot [m/s]; the hardest strokes reach about 15. Measured: all
invariants hold to 10,000; at 100,000 rounding (1e-16) exceeds the speed that counts as rest: shots do not
end."""
MOST_SPIN = 1e5
"""Largest spin component of a shot [rad/s], of a strike at ``FASTEST``. Measured: right to 1e6; at 1e7 shots do not end."""
FARTHEST = 1e6  # the largest coordinate of a ball [m]: up to there float64 resolves 1e-10 m
FASTEST_IMPACT, MOST_SPIN_IMPACT = 1e6, 1e9
"""The same for one impact alone: its outcome scales with its speeds (but for laws that contain one)."""
_LEAST_DECELERATION, _MOST_DECELERATION = 1e-6, 1e6
_FLIES = 1e-300  # in place of a restitution of 0 of the bed, which says that no ball flies
_LEAST_KNEE, _MOST_POWER = 1e-3, 0.8
"""Bounds of ``e_c_knee`` and ``e_c_power``. The rebound varies with at most the power 1.25 of e
(tests/physics/test_cushion_law.py): with a power up to 0.8 it never falls with the speed."""
_RANGES = {"R": (1e-3, 1), "e_c_power": (0, _MOST_POWER), "nap": (-np.inf, np.inf), "max_offset": (0, 0.999)}
_RANGES |= dict.fromkeys(("M", "g", "spin_decel", "e_c_knee", "end_mass_ratio"), (0, np.inf))
_RANGES |= dict.fromkeys(("mu_s", "mu_r", "roll_drag", "e_b", "e_c", "mu_c"), (0, 1))
_RANGES |= dict.fromkeys(("sin_theta", "e_t"), (0, 0.95))
"""The lowest and highest value of each field that is a number."""


@dataclass(frozen=True, kw_only=True)
class Physics:
    """The physical constants and laws of a simulation, in SI units.

    ``Physics()`` is the preset "paper" (see ``preset``); ``dataclasses.replace`` makes a changed copy. ValueError for a
    value outside its range.

    Parameters
    ----------
    R : float
        Radius of all balls [m], in [0.001, 1]. Snooker: 52.5 mm diameter [MJP14 2.4.3].
    M : float
        Mass of all balls [kg], > 0 [MJP14 2.4.3]. No velocity depends on it: the balls are equal.
    g : float
        Acceleration of gravity [m/s^2], > 0.
    mu_s : float
        Sliding friction between ball and cloth, in [0, 1] [MJP14 2.4.2: measured 0.178 to 0.245].
    mu_r : float
        Rolling resistance: deceleration over g, in [0, 1]. Measured: 0.124 to 0.126 m/s^2, 0.0127 g, on one
        table; a heated one with new cloth needs about 0.010 (docs/physics/constants.md).
    spin_decel : float
        Deceleration of the spin about the vertical [rad/s^2], in every state, >= 0 [MJP14 eq. 21]. With 0
        such a spin stays: a shot ends when no ball moves across the table.
    nap : float
        Acceleration of a rolling ball along +y by the nap, which runs from baulk to the black end [m/s^2]: 0 (none)
        or below mu_r g in size, so that a ball at rest stays. Not measured (docs/physics/limits.md).
    roll_drag : float
        Growth of the rolling resistance with speed [1/m], in [0, 1]: at v m/s a rolling ball decelerates by
        mu_r g + roll_drag v^2. Must be 0 where nap is not. Measured on heated carom cloth (docs/physics/limits.md).
    e_b : float
        Energetic restitution between balls, in [0, 1] [MJP14 2.4.2].
    mu_bb : float, "marlow" or (float, float, float)
        Friction between balls: a constant in [0, 1] [MJP14 2.4.2], ``"marlow"``, or (a, b, c) of the law
        mu(s) = a + b exp(-c s), with the slip speed s in m/s.
    e_c : float
        Energetic restitution at a cushion at low speed, in [0, 1] [MJP10, fitted below 1.5 m/s].
    e_c_knee : float
        Speed into the cushion above which e falls [m/s], >= 0, and >= 0.001 where e_c_power > 0.
    e_c_power : float
        Exponent of that fall, in [0, 0.8]; 0: none. e(v) = e_c up to e_c_knee, and above it
        e_c (v / e_c_knee)^(-e_c_power). An impact that loses energy by yielding has 1/4 (Johnson, Contact Mechanics,
        1985, 11.5).
    e_j : float, optional
        Energetic restitution at a jaw, at every speed, in [0, 1]; None: e_c, without its fall with speed. Not
        measured.
    mu_c : float
        Sliding friction between ball and cushion, in [0, 1] [MJP10].
    sin_theta : float
        Height of the nose above the ball's centre over R, in [0, 0.95]; a nose at 7R/5 gives 0.4 [MJP10].
    end_mass_ratio : float
        Ball mass over the cue's effective end mass, >= 0; it determines the squirt [TP A.31].
    max_offset : float
        Tip offset over R beyond which the tip slips (miscue), in (0, 0.999] [TP A.30].
    flight : bool
        Whether balls can leave the bed; positions and velocities then may have a third column. False: they stay on it,
        as in the paper.
    e_t : float
        Restitution of the bed, in [0, 0.95], where balls fly. Measured nowhere; 0.5 is common.
    tables : bool
        Whether impacts of rolling balls come from tables, except at "reference" and "euler:N": faster and more
        accurate. Presets have stored tables; other constants make theirs at their first use, in 5 to 200 ms (after
        10 s, once, of compiling). False suits constants that are used for few shots.

    Examples
    --------
    >>> import snooker_env as sn
    >>> sn.Physics(mu_bb=0.06).e_b
    0.89
    """

    R: float = BALL_RADIUS
    M: float = 0.1406
    g: float = 9.81
    mu_s: float = 0.21
    mu_r: float = 0.0127
    spin_decel: float = 22.0
    nap: float = 0.0
    roll_drag: float = 0.0
    e_b: float = 0.89
    mu_bb: float | Literal["marlow"] | tuple[float, float, float] = 0.05
    e_c: float = 0.98
    e_c_knee: float = 0.0
    e_c_power: float = 0.0
    e_j: float | None = None
    mu_c: float = 0.14
    sin_theta: float = 0.4
    end_mass_ratio: float = 30.0
    max_offset: float = 0.5
    flight: bool = False
    e_t: float = 0.5
    tables: bool = True

    def __post_init__(self) -> None:
        for field in ("R", "M"):
            value = getattr(self, field)
            if isinstance(value, (list, tuple, np.ndarray)) and np.shape(value)[:1] > (1,):
                allowed = "must be one number: all balls of a shot are equal (docs/physics/limits.md)"
                raise refuse(f"physics.{field}", value, allowed)
        for field, (low, high) in _RANGES.items():
            value, open_low = getattr(self, field), field in ("M", "g", "max_offset")
            object.__setattr__(self, field, number(f"physics.{field}", value, low, high, open_low=open_low))
        if self.e_j is not None:
            object.__setattr__(self, "e_j", number("physics.e_j", self.e_j, 0, 1))
        object.__setattr__(self, "mu_bb", _mu_bb(self.mu_bb))
        object.__setattr__(self, "tables", truth("physics.tables", self.tables))
        object.__setattr__(self, "flight", truth("physics.flight", self.flight))
        if self.e_c_power > 0 and self.e_c_knee < _LEAST_KNEE:
            allowed = f"must be at least {_LEAST_KNEE:g} m/s where e_c_power > 0: above it e(v) = e_c (v / e_c_knee)^(-e_c_power)"
            raise refuse("physics.e_c_knee", self.e_c_knee, allowed)
        if self.nap != 0 and not abs(self.nap) < self.mu_r * self.g:
            allowed = f"must be 0 or below mu_r g = {self.mu_r * self.g:g} m/s^2 in size"
            raise refuse("physics.nap", self.nap, allowed)
        if self.nap != 0 and self.roll_drag != 0:
            allowed = f"must be 0 with physics.nap = {self.nap!r}: no path is known with both"
            raise refuse("physics.roll_drag", self.roll_drag, allowed)

    def __getstate__(self) -> dict[str, Any]:
        """Without the packed arrays: the tables are 230 KB."""
        return {k: v for k, v in self.__dict__.items() if k not in ("_constants", "_with_tables")}

    @classmethod
    def preset(cls, name: PhysicsName = "paper", **fields: object) -> "Physics":
        """The constants of a preset, with any ``fields`` replaced; ValueError if a name or value is wrong.

        "paper": [MJP14] and [MJP10]. "match": measured snooker: e_b 0.94, Marlow's mu_bb(s), and cushion and cloth fitted
        to rebounds up to 3.40 m/s [MJP10, Fig. 7a] and to how far hard throws and a ball off a ramp run on full-size
        tables (docs/physics/constants.md). "carom": a heated three-cushion table and its balls, fitted to 61
        tracked shots of one match (``python -m benchmarks.real_shots``)."""
        choice("physics", name, PRESETS)
        return cls._replace_fields(PRESETS[name], fields) if fields else _WHOLE[name]

    @classmethod
    def of(cls, physics: "PhysicsLike" = None) -> "Physics":
        """The constants for an argument ``physics``: None is "paper", a str names a preset, a dict replaces fields of the
        preset under its key "preset" (or "paper"), a ``Physics`` is itself. ValueError for anything else."""
        if isinstance(physics, cls):
            return physics
        if physics is None or isinstance(physics, str):
            return cls.preset("paper" if physics is None else physics)
        if isinstance(physics, dict):
            rest = dict(physics)
            return cls._replace_fields(PRESETS[choice("physics", rest.pop("preset", "paper"), PRESETS)], rest)
        raise refuse("physics", physics, "must be None, a preset's name, a dict of overrides, or a Physics")

    @classmethod
    def _replace_fields(cls, base: dict[str, Any], fields: dict[str, Any]) -> "Physics":
        known = [f.name for f in dataclasses.fields(cls)]
        for field in fields:
            choice("physics field", field, known)
        return cls(**{**base, **fields})

    def check_stopping(self) -> None:
        """ValueError unless friction brings balls to rest in a finite time that is not zero."""
        for name in ("mu_s", "mu_r"):
            if not _LEAST_DECELERATION <= getattr(self, name) * self.g <= _MOST_DECELERATION:
                bounds = f"times g = {self.g:g} in [{_LEAST_DECELERATION:g}, {_MOST_DECELERATION:g}] m/s^2"
                allowed = f"must be > 0 to simulate a shot, {bounds}: without it no ball comes to rest"
                raise refuse(f"physics.{name}", getattr(self, name), allowed)
        if self.mu_r * self.g - abs(self.nap) < _LEAST_DECELERATION:
            allowed = f"must be at least {_LEAST_DECELERATION:g} m/s^2 below mu_r g = {self.mu_r * self.g:g} m/s^2 in size"
            raise refuse("physics.nap", self.nap, allowed)
        if 0 < self.spin_decel < _LEAST_DECELERATION:
            allowed = f"must be 0 (a spin about the vertical stays) or at least {_LEAST_DECELERATION:g} rad/s^2 to simulate a shot"
            raise refuse("physics.spin_decel", self.spin_decel, allowed)

    @property
    def friction_law(self) -> tuple[float, float, float]:
        """The numbers (a, b, c) of mu_bb(s) = a + b exp(-c s), s in m/s; b = 0 for a constant."""
        if isinstance(self.mu_bb, str):
            return MARLOW
        return self.mu_bb if isinstance(self.mu_bb, tuple) else (self.mu_bb, 0.0, 0.0)

    @property
    def bed_restitution(self) -> float:
        """The restitution of the bed where balls fly, else 0."""
        return max(self.e_t, _FLIES) if self.flight else 0.0

    def pack(self) -> Floats:
        """The constants for the kernels: float64 (22,), at the places ``P_*`` of ``columns.py``, SI units."""
        return self._constants.copy()

    def packed_for(self, solver: Solver) -> Floats:
        """The array that the kernels read, always the same one: nobody may write to it. For a ``solver`` of
        ``parse_fidelity`` that reads tables of rolling impacts, these stand behind the constants."""
        return self._with_tables if self.tables and solver[0] in TABLED else self._constants

    @cached_property
    def _constants(self) -> Floats:
        balls = self.R, self.M, self.g, self.mu_s, self.mu_r, self.spin_decel, self.e_b, *self.friction_law
        cushions = self.e_c, self.e_c_knee, self.e_c_power, self.mu_c, self.sin_theta
        e_j = self.e_c if self.e_j is None else self.e_j
        tables = 0.0, 0.0, 0.0
        return np.array([*balls, *cushions, e_j, self.nap, self.roll_drag, self.bed_restitution, *tables])

    @cached_property
    def _with_tables(self) -> Floats:
        packed = self._constants.copy()
        rail = Rolling(self.sin_theta, self.mu_c, self.mu_s, self.e_c)
        wanted = {columns.P_RAIL: rail, columns.P_JAW: rail._replace(e=float(packed[columns.P_E_J]))}
        if self.friction_law[1] == 0.0:
            wanted[columns.P_BALLS] = Rolling(-1.0, self.friction_law[0], self.mu_s, self.e_b)
        made: dict[Rolling, Floats] = {}
        for place, rolling in wanted.items():
            table = made.get(rolling, table_of(rolling))
            if table is not None:
                made[rolling] = table
                packed[place] = len(packed) + SIZE * list(made).index(rolling)
        return np.concatenate([packed, *made.values()])


def nominal(physics: Physics) -> Floats:
    """The constants (8,) of a ``Physics``, whose own friction between balls has the scale 1."""
    return np.array([1.0 if name == "mu_bb_scale" else getattr(physics, name) for name in conditions.NAMES])


@lru_cache(maxsize=256)  # a table is asked for its constants after every stroke
def physics_with(base: Physics, values: tuple[float, ...]) -> Physics:
    """``base`` with these 8 constants, without tables of rolling impacts: they take longer than its shots."""
    changed = dict(zip(conditions.NAMES, values, strict=True))
    scale, (a, b, c) = changed.pop("mu_bb_scale"), base.friction_law
    friction = (scale * a, scale * b, c) if b else scale * a
    return dataclasses.replace(base, mu_bb=friction, tables=False, **changed)


def pack_into(rows: Floats, which: Ints, values: Floats, base: Physics) -> None:
    """Write the constants (len(which), 8) into rows (n, 22), each ``Physics.pack`` of ``physics_with``."""
    law, scale = base.friction_law, values[:, conditions.MU_BB_SCALE]
    for column, place in _DRAWN.items():
        rows[which, place] = values[:, column]
    rows[which, columns.P_MU_BB_LEAST] = scale * law[0]
    rows[which, columns.P_MU_BB_EXTRA] = scale * law[1]
    if base.e_j is None:
        rows[which, columns.P_E_J] = values[:, conditions.E_C]


PhysicsLike: TypeAlias = Physics | dict[str, Any] | PhysicsName | None  # an argument of ``Physics.of``
_DRAWN = {conditions.MU_S: columns.P_MU_S, conditions.MU_R: columns.P_MU_R, conditions.E_B: columns.P_E_B}
_DRAWN |= {conditions.MU_C: columns.P_MU_C, conditions.E_C: columns.P_E_C}
_DRAWN[conditions.SPIN_DECEL] = columns.P_SPIN


def _mu_bb(value: object) -> float | Literal["marlow"] | tuple[float, float, float]:
    if isinstance(value, (tuple, list)) and len(value) == 3:
        a, b, c = (number("physics.mu_bb", x, 0) for x in value)
        if a + b <= 1:
            return a, b, c
    elif isinstance(value, str) and value == "marlow":
        return value
    elif not isinstance(value, (str, tuple, list)):
        return number("physics.mu_bb", value, 0, 1)
    allowed = 'must be a number in [0, 1], "marlow", or (a, b, c) with a, b, c >= 0 and a + b <= 1'
    raise refuse("physics.mu_bb", value, allowed)


_MATCH = {"mu_r": 0.0114, "e_b": 0.94, "mu_bb": "marlow", "e_c": 0.98, "e_c_knee": 2.02, "e_c_power": 0.243}
_BALLS = {"R": 0.03075, "M": 0.2125, "e_b": 0.917, "mu_bb": 0.0803}
_CLOTH = {"mu_s": 0.146, "mu_r": 0.00431, "roll_drag": 0.0136, "spin_decel": 3.77}
_CUSHION = {"e_c": 0.911, "e_c_knee": 0.695, "e_c_power": 0.0455, "mu_c": 0.238, "sin_theta": 0.201}
_CAROM = {**_BALLS, **_CLOTH, **_CUSHION, "tables": False}  # above the knee no table would be used
PRESETS: dict[str, dict[str, Any]] = {"paper": {}, "match": _MATCH, "carom": _CAROM}
_WHOLE = {name: Physics(**fields) for name, fields in PRESETS.items()}
