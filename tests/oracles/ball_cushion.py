"""What do the velocity and the spin of a ball become in one frictional impact on a cushion?

Source: Mathavan, Jackson & Parkin (2010), *Proc. IMechE C* 224, 1863-1873, as corrected in
``shared/reference/physics.md``; model and units: ``tests/oracles/__init__.py``; method: ``march``.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq, root

from .march import AT_ZERO, ZERO_SLIP, Regime, Vector, Z, add, cross, dot, march, norm, normalized, scale

# A sticking contact is released once the friction that would hold it exceeds the limit by this fraction, not
# at the very limit, where the slip it would start with has no rate yet. The impulse that passes meanwhile is
# of the same order, the error of its square.
RELEASE = 1e-9


class _BallCushion:
    """One ball against a cushion whose nose is above the centre; ``m`` is the unit vector from the centre to the contact."""

    def __init__(self, normal: Vector, mu_w: float, mu_s: float, sin_theta: float):
        cos_theta = math.sqrt(1.0 - sin_theta**2)
        self.m = add(scale(cos_theta, normal), scale(sin_theta, Z))
        self.t1 = cross(normal, Z)  # along the cushion
        self.t2 = cross(self.t1, self.m)  # completes the tangent plane, pointing up
        self.mu_w, self.mu_s = mu_w, mu_s

    def closing(self, y) -> float:
        return dot(y[0:3], self.m)

    def slips(self, y) -> tuple[Vector, Vector]:
        at_nose = add(y[0:3], cross(y[3:6], self.m))  # v + w x (R m)
        at_nose = add(at_nose, scale(-dot(at_nose, self.m), self.m))
        at_cloth = add(y[0:3], cross(y[3:6], scale(-1.0, Z)))  # v + w x (-R z)
        return at_nose, (at_cloth[0], at_cloth[1], 0.0)

    def apply(self, f: Vector, reaction: float, cloth_friction: Vector) -> list[float]:
        """Rates of the six velocities per unit of P/M under the cushion's push -m and friction f, and the cloth's answer."""
        from_nose = add(scale(-1.0, self.m), f)
        from_cloth = add(cloth_friction, scale(reaction, Z))
        spin = scale(2.5, add(cross(self.m, from_nose), cross(scale(-1.0, Z), from_cloth)))
        return [*add(from_nose, from_cloth), *spin]

    def cloth_answer(self, f: Vector, law: str, direction: Vector | None = None) -> tuple[float, Vector]:
        """Reaction N' that holds the ball's height and the cloth's friction, for a nose friction ``f``; affine in ``f``."""
        if law == "off":
            return 0.0, (0.0, 0.0, 0.0)
        reaction = dot(self.m, Z) - f[2]
        if law == "slip":
            return reaction, scale(-self.mu_s * reaction, direction)
        drive = self.slips(self.apply(f, reaction, (0.0, 0.0, 0.0)))[1]
        # the friction that holds: it changes the cloth slip by 7/2 of itself
        return reaction, scale(-2.0 / 7.0, drive)

    def coulomb(self, f: Vector, airborne: bool, cloth_slip: Vector | None):
        """Law, reaction, friction and starting direction of the cloth contact for a given ``f``;
        ``cloth_slip`` None: it is zero."""
        if airborne or dot(self.m, Z) - f[2] <= 0.0:
            return "off", 0.0, (0.0, 0.0, 0.0), None
        if cloth_slip is not None:
            return "slip", *self.cloth_answer(f, "slip", normalized(cloth_slip)), None
        reaction, hold = self.cloth_answer(f, "stick")
        if norm(hold) <= self.mu_s * reaction:
            return "stick", reaction, hold, None
        start = scale(-1.0, normalized(hold))
        return "slip", reaction, scale(-self.mu_s * reaction, start), start

    def tangent(self, a: float, b: float) -> Vector:
        return add(scale(a, self.t1), scale(b, self.t2))

    def holding(self, law: str, direction: Vector | None = None) -> Vector:
        """The nose friction that keeps the nose's slip constant under one affine law of the cloth."""

        def rate(a, b):
            f = self.tangent(a, b)
            r = self.slips(self.apply(f, *self.cloth_answer(f, law, direction)))[0]
            return np.array([dot(r, self.t1), dot(r, self.t2)])

        base = rate(0.0, 0.0)
        a, b = np.linalg.solve(np.column_stack([rate(1.0, 0.0) - base, rate(0.0, 1.0) - base]), -base)
        return self.tangent(float(a), float(b))

    def holding_any(self, airborne: bool, cloth_slip: Vector | None) -> Vector:
        """The nose friction that keeps the nose's slip constant when the cloth's law depends on it (Coulomb, N' >= 0)."""
        candidates = ["off"] if airborne else ["slip" if cloth_slip is not None else "stick", "off"]
        direction = None if cloth_slip is None else normalized(cloth_slip)
        for law in candidates:
            f = self.holding(law, direction)
            if self.coulomb(f, airborne, cloth_slip)[0] == law:
                return f

        def rate(p):
            f = self.tangent(*p)
            r = self.slips(self.apply(f, *self.coulomb(f, airborne, cloth_slip)[1:3]))[0]
            return [dot(r, self.t1), dot(r, self.t2)]

        f = self.holding(candidates[0], direction)
        solution = root(rate, [dot(f, self.t1), dot(f, self.t2)], tol=1e-15)
        if max(abs(c) for c in rate(solution.x)) > 1e-12:
            raise RuntimeError("no friction holds the nose's slip")
        return self.tangent(*(float(c) for c in solution.x))

    def start_direction(self, airborne: bool, cloth_slip: Vector | None) -> Vector:
        """Unit vector d of a slip that starts from zero: its rate under the friction -mu_w d is along d itself."""

        def rate(angle):
            d = self.tangent(math.cos(angle), math.sin(angle))
            f = scale(-self.mu_w, d)
            r = self.slips(self.apply(f, *self.coulomb(f, airborne, cloth_slip)[1:3]))[0]
            return d, r

        def across(angle):
            d, r = rate(angle)
            return dot(cross(d, r), self.m)

        angles = np.linspace(0.1234, 0.1234 + 2.0 * math.pi, 361)
        values = [across(a) for a in angles]
        found = []
        for i in range(360):
            if values[i] * values[i + 1] <= 0.0 and values[i] != 0.0:
                d, r = rate(brentq(across, angles[i], angles[i + 1], xtol=1e-15))
                if dot(d, r) > 0.0:
                    found.append(d)
        if len(found) != 1:
            raise RuntimeError(f"{len(found)} directions in which the slip may start, expected one")
        return found[0]

    def regime(self, y) -> Regime:
        nose, cloth = self.slips(y)
        airborne = y[2] > AT_ZERO
        cloth_slip = cloth if norm(cloth) > AT_ZERO else None
        nose_start = None
        if norm(nose) > AT_ZERO:
            main, f = "slip", scale(-self.mu_w, normalized(nose))
        else:
            main, f = "stick", self.holding_any(airborne, cloth_slip)
            if norm(f) > self.mu_w:
                main, nose_start = "slip", self.start_direction(airborne, cloth_slip)
                f = scale(-self.mu_w, nose_start)
        law, _reaction, _friction, cloth_start = self.coulomb(f, airborne, cloth_slip)
        # no slip at either contact leaves v_y = 0 and nothing that would end the impact
        if main == law == "stick":
            raise ValueError(
                "the ball is wedged between cushion and cloth (mu_w, mu_s too high): outside this oracle"
            )
        return Regime(main, law, nose_start, cloth_start)

    def nose_friction(self, y, regime: Regime, cloth_direction: Vector | None) -> Vector:
        if regime.main == "slip":
            direction = regime.main_start
            if direction is None:
                nose = self.slips(y)[0]
                direction = normalized(nose)
            return scale(-self.mu_w, direction)
        return self.holding(regime.cloth, cloth_direction)

    def answer(self, y, regime: Regime) -> tuple[Vector, float, Vector]:
        cloth_direction = None
        if regime.cloth == "slip":
            cloth = self.slips(y)[1]
            cloth_direction = regime.cloth_start or normalized(cloth)
        f = self.nose_friction(y, regime, cloth_direction)
        return f, *self.cloth_answer(f, regime.cloth, cloth_direction)

    def rates(self, y, regime: Regime) -> list[float]:
        return [*self.apply(*self.answer(y, regime)), self.closing(y)]

    def margins(self, y, regime: Regime) -> dict[str, float]:
        f, reaction, cloth_friction = self.answer(y, regime)
        g = {}
        if regime.main == "stick":
            g["nose holds"] = (1.0 + RELEASE) * self.mu_w - norm(f)
        if regime.cloth == "stick":
            g["cloth holds"] = (1.0 + RELEASE) * self.mu_s * reaction - norm(cloth_friction)
        if regime.cloth == "off":
            # On the cloth again: it has come down (v_z is back at zero) and nothing lifts it any more.
            g["in the air"] = max(y[2] - ZERO_SLIP, f[2] - dot(self.m, Z))
        else:
            g["pressed"] = reaction + RELEASE
        return g


def ball_cushion(v, w, normal, *, R: float, M: float, e: float, mu_w: float, mu_s: float, sin_theta: float):
    """Velocity and spin after the frictional impact of a ball on a cushion, the cloth's reaction and friction
    included.

    Source: Mathavan, Jackson & Parkin (2010), with Coulomb's law at zero slip as in physics.md 1.4: the
    contact sticks only if the friction that holds it is within ``mu_w``; if not, it slips in the direction in
    which the other forces drive it. The cushion pushes the ball into the cloth (N' >= 0); where its friction
    would lift the ball instead, N' = 0 and the ball rises.

    v, w : velocity [m/s] (horizontal) and spin [rad/s], shape (3,), table frame (z up).
    normal : horizontal unit vector INTO the cushion.
    R, M : radius [m] and mass [kg]. ``e`` : energetic restitution. ``mu_w``, ``mu_s`` : friction of ball on
    cushion and on cloth.
    sin_theta : height of the cushion's nose above the ball's centre over R.

    Returns (v, w) as float64 arrays, the vertical velocity of a ball that was lifted included. The ball must approach.
    """
    v, w = np.array(v, dtype=float), np.array(w, dtype=float)
    n = normalized(tuple(map(float, normal)))
    unit = max(float(np.linalg.norm(v)), float(np.linalg.norm(R * w)))
    state = [float(c) / unit for a in (v, R * w) for c in a]
    out = np.array(march(state, _BallCushion(n, mu_w, mu_s, sin_theta), e)) * unit
    return out[0:3], out[3:6] / R
