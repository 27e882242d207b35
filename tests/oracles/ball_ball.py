"""What do the velocities of two balls become in one frictional impact?

Source: Mathavan, Jackson & Parkin (2014), *Sports Engineering* 17, 227-237, as corrected in
``shared/reference/physics.md``; model and units: ``tests/oracles/__init__.py``; method: ``march``.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .march import AT_ZERO, Regime, Vector, Z, add, cross, dot, march, norm, normalized, scale

Friction = float | Callable[[float], float]


class _BallBall:
    """Two balls in contact at ``+R n`` of ball 1; the ball that the friction between them presses into the
    cloth is found at the start."""

    def __init__(self, normal: Vector, mu_bb: Friction, mu_s: float, state: list[float]):
        self.n, self.mu_s = normal, mu_s
        self.mu = mu_bb
        slip_up = self.slip_between(state)[2]
        # Friction on ball 1 is against its slip relative to ball 2: if it slips upwards it is pressed down.
        self.pressed = 1 if slip_up > 0.0 else 2 if slip_up < 0.0 else 0

    def closing(self, y) -> float:
        return dot((y[0] - y[6], y[1] - y[7], y[2] - y[8]), self.n)

    def slip_between(self, y) -> Vector:
        """Velocity of ball 1's surface at the contact relative to ball 2's, without its normal part."""
        n = self.n
        surface_1 = add(y[0:3], cross(y[3:6], n))  # v + w x (R n)
        surface_2 = add(y[6:9], cross(y[9:12], scale(-1.0, n)))  # v + w x (-R n)
        u = add(surface_1, scale(-1.0, surface_2))
        return add(u, scale(-dot(u, n), n))

    def slips(self, y) -> tuple[Vector, Vector]:
        if self.pressed == 0:
            return self.slip_between(y), (0.0, 0.0, 0.0)
        k = 0 if self.pressed == 1 else 6
        surface = add(y[k : k + 3], cross(y[k + 3 : k + 6], scale(-1.0, Z)))  # v + w x (-R z)
        return self.slip_between(y), (surface[0], surface[1], 0.0)

    def friction(self, slip: Vector, speed: float) -> Vector:
        mu = self.mu(speed) if callable(self.mu) else self.mu
        return scale(-mu, normalized(slip))

    def regime(self, y) -> Regime:
        between, cloth = self.slips(y)
        speed = norm(between)
        # Zero slip between the balls stays: the normal impulse does not drive it and the cloth acts only
        # through the friction there.
        if speed <= AT_ZERO:
            return Regime("stick", "off")
        f = self.friction(between, speed)
        if self.pressed == 0 or f[2] == 0.0:
            return Regime("slip", "off")
        if norm(cloth) > AT_ZERO:
            return Regime("slip", "slip")
        # Coulomb's law at zero cloth slip: the rate at which the other forces drive it, against the friction
        # there. The rate is at least 1 + 5/2 |f_z|, so that 7/2 mu_s |f_z| cannot hold it while mu_s <= 5/7
        # (nor while mu_s mu_bb < 2/7).
        drive = self.slips(self.apply(f, 0.0, (0.0, 0.0, 0.0)))[1]
        # a friction impulse changes the cloth slip by 7/2 of itself per unit mass
        if 3.5 * self.mu_s * abs(f[2]) >= norm(drive):
            raise ValueError("the cloth contact would stick (mu_s > 5/7 and more): outside this oracle")
        return Regime("slip", "slip", None, normalized(drive))

    def rates(self, y, regime: Regime) -> list[float]:
        if regime.main == "stick":
            return [*self.apply((0.0, 0.0, 0.0), 0.0, (0.0, 0.0, 0.0)), self.closing(y)]
        between, cloth = self.slips(y)
        f = self.friction(between, norm(between))
        reaction, cloth_friction = 0.0, (0.0, 0.0, 0.0)
        if regime.cloth == "slip":
            reaction = abs(f[2])
            direction = regime.cloth_start or normalized(cloth)
            cloth_friction = scale(-self.mu_s * reaction, direction)
        return [*self.apply(f, reaction, cloth_friction), self.closing(y)]

    def apply(self, f: Vector, reaction: float, cloth_friction: Vector) -> list[float]:
        """Rates of the twelve velocities per unit of P/M. ``f``: friction on ball 1 from ball 2; the rest
        acts on the pressed ball."""
        n = self.n
        on_1 = add(scale(-1.0, n), f)
        on_2 = scale(-1.0, on_1)
        # Moment of each impulse about the centre over I = 2/5 M R^2, times R: 5/2 of (arm / R) x impulse.
        spin_1, spin_2 = scale(2.5, cross(n, on_1)), scale(2.5, cross(scale(-1.0, n), on_2))
        from_cloth = add(cloth_friction, scale(reaction, Z))
        cloth_spin = scale(2.5, cross(scale(-1.0, Z), from_cloth))
        if self.pressed == 1:
            on_1, spin_1 = add(on_1, from_cloth), add(spin_1, cloth_spin)
        elif self.pressed == 2:
            on_2, spin_2 = add(on_2, from_cloth), add(spin_2, cloth_spin)
        return [*on_1, *spin_1, *on_2, *spin_2]

    def margins(self, _y, _regime: Regime) -> dict[str, float]:
        return {}


def ball_ball(
    v1,
    w1,
    v2,
    w2,
    normal,
    *,
    R: float,
    M: float,
    e: float,
    mu_bb: Friction,
    mu_s: float,
):
    """Velocities and spins after the frictional impact of two equal balls on a rough cloth.

    Source: Mathavan, Jackson & Parkin (2014), section 2, as corrected in physics.md 1.1. While ball 1's
    surface slips upwards past ball 2's, friction presses ball 1 into the cloth and lifts ball 2 (downwards:
    the reverse); the cloth answers with a reaction that holds the pressed ball's height and with friction
    against its slip on the cloth. Energetic restitution.

    v1, w1, v2, w2 : velocities [m/s] and spins [rad/s], shape (3,), table frame (z up); vertical velocities
    must be 0.
    normal : horizontal unit vector from the centre of ball 1 to that of ball 2.
    R, M : radius [m] and mass [kg]. ``e`` : restitution, 0..1. ``mu_s`` : ball-cloth friction.
    mu_bb : ball-ball friction, a number or a callable of the slip speed [m/s].

    Returns (v1, w1, v2, w2) as float64 arrays. The vertical velocity of the lifted ball is part of the
    result. The balls must approach.
    """
    v1, w1, v2, w2 = (np.array(a, dtype=float) for a in (v1, w1, v2, w2))
    n = normalized(tuple(map(float, normal)))
    unit = max(float(np.linalg.norm(a)) for a in (v1, R * w1, v2, R * w2))
    state = [float(c) / unit for a in (v1, R * w1, v2, R * w2) for c in a]
    law = (lambda s: mu_bb(s * unit)) if callable(mu_bb) else mu_bb
    out = np.array(march(state, _BallBall(n, law, mu_s, state), e)) * unit
    return out[0:3], out[3:6] / R, out[6:9], out[9:12] / R
