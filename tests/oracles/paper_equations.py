"""What do the paper's own equations make of an impact of two balls? In multi-precision arithmetic, as a
second oracle.

Source: Mathavan, Jackson & Parkin (2014), *Sports Engineering* 17, 227-237, as corrected in
``shared/reference/physics.md``.

Method. The paper's scalar equations (3) and (4) in its contact frame, the normal impulse ``P`` itself as the
independent variable, mpmath arithmetic, extrapolated modified midpoint (Gragg-Bulirsch-Stoer, order 16) with
steps graded towards the singular points, stops found by Newton's method on the step length.
"""

from __future__ import annotations

import mpmath
import numpy as np


def multiprecision(v1, w1, v2, w2, n, R, e, mu_bb, mu_s, digits):
    """The paper's equations (3), (4) in its frame, X tangent, Y from ball C = 1 to ball O = 2, Z up;
    ``digits`` decimal digits."""
    with mpmath.workdps(digits):
        mpf = mpmath.mpf
        nx, ny = mpf(n[0]), mpf(n[1])
        length = mpmath.sqrt(nx * nx + ny * ny)
        nx, ny = nx / length, ny / length

        def to_frame(a):  # X = Y x Z = (ny, -nx)
            x, y, z = (mpf(float(c)) for c in a)
            return [x * ny - y * nx, x * nx + y * ny, z]

        def to_table(x, y, z):
            return np.array([float(x * ny + y * nx), float(y * ny - x * nx), float(z)])

        radius = mpf(R)
        vc, vo = to_frame(v1), to_frame(v2)
        wc, wo = ([radius * c for c in to_frame(w)] for w in (w1, w2))  # R w
        law = mu_bb if callable(mu_bb) else (lambda _s: mu_bb)
        y = _PaperImpact(vc + wc + vo + wo + [mpf(0)], law, mpf(mu_s), mpf(e)).run()
        return to_table(*y[0:3]), to_table(*y[3:6]) / R, to_table(*y[6:9]), to_table(*y[9:12]) / R


class _PaperImpact:
    """State: C's velocity (0-2) and R w (3-5), O's velocity (6-8) and R w (9-11), work (12); variable P/M.
    The paper's frame."""

    COLUMNS = 8  # of the extrapolation table: order 16

    def __init__(self, state, law, mu_s, e):
        self.y, self.law, self.mu_s, self.e = state, law, mu_s, e
        self.unit = max(abs(c) for c in state)
        self.zero = self.unit * mpmath.mpf(10) ** -16
        self.tolerance = self.unit * mpmath.mpf(10) ** -17
        self.push = (state[1] - state[7]) * mpmath.mpf(10) ** -9  # of the closing speed
        self.sticks = False
        z_slip = self.slip_a(state)[1]
        self.o_pressed, self.c_pressed = z_slip < 0, z_slip > 0
        self.fraction = mpmath.mpf("0.5")
        self.cloth_direction = None

    @staticmethod
    def slip_a(y):
        """Eq. (5) with (11b): C's surface relative to O's at A, along X and Z."""
        return (y[0] - y[5]) - (y[6] + y[11]), (y[2] + y[3]) - (y[8] - y[9])

    def slip_cloth(self, y):
        """Eq. (9) with (11e), (11f), of the pressed ball."""
        return (y[6] - y[10], y[7] + y[9]) if self.o_pressed else (y[0] - y[4], y[1] + y[3])

    def impulses(self, y):
        """P1', P2' on C at A (eq. 6); the cloth's N' (eq. 7) and the direction of its slip."""
        if self.sticks:
            return 0, 0
        x, z = self.slip_a(y)
        s = mpmath.sqrt(x * x + z * z)
        mu = mpmath.mpf(self.law(s))
        return -mu * x / s, -mu * z / s

    def rates(self, y):
        p1, p2 = self.impulses(y)
        zero = mpmath.mpf(0)
        cx = cy = cn = ox = oy = on = zero
        if p2 != 0:
            bx, by = self.cloth_direction or self.slip_cloth(y)
            k = -self.mu_s * abs(p2) / mpmath.sqrt(bx * bx + by * by)
            if self.o_pressed:
                ox, oy, on = k * bx, k * by, p2  # eq. (7b), (8c), (8d)
            else:
                cx, cy, cn = k * bx, k * by, -p2  # eq. (7a), (8a), (8b)
        half5 = mpmath.mpf(5) / 2
        return [
            p1 + cx,
            cy - 1,
            p2 + cn,  # eq. (3a)-(3c)
            half5 * (p2 + cy),
            -half5 * cx,
            -half5 * p1,  # eq. (3d)-(3f), times R
            ox - p1,
            oy + 1,
            on - p2,  # eq. (4) and its five companions
            half5 * (p2 + oy),
            -half5 * ox,
            -half5 * p1,
            y[1] - y[7],  # eq. (10a)
        ]

    def extrapolate(self, y, h):
        """One Gragg-Bulirsch-Stoer step of length h; returns the new state and its error estimate."""
        table, first = [], self.rates(y)
        for column in range(1, self.COLUMNS + 1):
            n = 2 * column
            step = h / n
            previous, now = y, [a + step * f for a, f in zip(y, first, strict=True)]
            for _ in range(n - 1):
                previous, now = (
                    now,
                    [a + 2 * step * f for a, f in zip(previous, self.rates(now), strict=True)],
                )
            row = [[(a + b + step * f) / 2 for a, b, f in zip(previous, now, self.rates(now), strict=True)]]
            for j in range(1, column):
                weight = 1 / ((mpmath.mpf(n) / (n - 2 * j)) ** 2 - 1)
                row.append([a + (a - b) * weight for a, b in zip(row[j - 1], table[-1][j - 1], strict=True)])
            table.append(row)
        return table[-1][-1], max(abs(a - b) for a, b in zip(table[-1][-1], table[-1][-2], strict=True))

    def longest_step(self, y, remaining):
        """A fraction of the impulse to the nearest singular point (slip at A zero, cloth slip zero), or what
        remains."""
        h = remaining
        p1, p2 = self.impulses(y)
        if p1 != 0 or p2 != 0:
            h = min(h, self.fraction * mpmath.hypot(*self.slip_a(y)) / (7 * mpmath.hypot(p1, p2)))
        if p2 != 0:
            h = min(h, self.fraction * mpmath.hypot(*self.slip_cloth(y)) / mpmath.mpf("1.5"))
        return h

    def leave_zero_cloth_slip(self, y):
        """From zero cloth slip the friction is against the driving rate: a midpoint step so short that its
        error is nothing."""
        p1, p2 = self.impulses(y)
        half5 = mpmath.mpf(5) / 2
        self.cloth_direction = (-p1, 1 + half5 * p2) if self.o_pressed else (p1, -1 + half5 * p2)
        h = self.push
        middle = [a + h / 2 * f for a, f in zip(y, self.rates(y), strict=True)]
        self.cloth_direction = None
        return [a + h * f for a, f in zip(y, self.rates(middle), strict=True)]

    def advance(self, y, remaining):
        """The next accepted step of at most ``remaining`` (regime switches included)."""
        if not self.sticks and mpmath.hypot(*self.slip_a(y)) <= self.zero:
            self.sticks = True
        if self.impulses(y)[1] != 0 and mpmath.hypot(*self.slip_cloth(y)) <= self.zero:
            return self.leave_zero_cloth_slip(y)
        h = self.longest_step(y, remaining)
        while True:
            new, error = self.extrapolate(y, h)
            if error <= self.tolerance:
                return new
            h /= 2

    def solve_for(self, y, h, gauge, slope):
        """From the last state before a stop, Newton on the step length (first guess h) until ``gauge`` is
        zero."""
        for _ in range(12):
            new, _error = self.extrapolate(y, h)
            correction = gauge(new) / slope(new)
            if abs(correction) <= self.tolerance / 100:
                return new
            h -= correction
        raise RuntimeError("Newton's method did not find the end of the phase")

    def run(self):
        def closing(y):
            return y[1] - y[7]

        def closing_slope(y):
            rate = self.rates(y)
            return rate[1] - rate[7]

        # Both loops: guess the impulse to the stop as if the closing speed fell at 2 per unit (so it does but
        # for the cloth), step towards a little beyond it, and solve from the last state before it.
        y = self.y
        while True:
            guess = closing(y) / 2
            new = self.advance(y, guess * mpmath.mpf("1.2"))
            if closing(new) <= 0:
                break
            y = new
        y = self.solve_for(y, guess, closing, closing_slope)
        if self.e == 0:
            return y
        target = (1 - self.e**2) * y[12]
        while True:
            guess = (closing(y) + mpmath.sqrt(closing(y) ** 2 + 4 * (y[12] - target))) / 2
            new = self.advance(y, guess * mpmath.mpf("1.2"))
            if new[12] <= target:
                return self.solve_for(y, guess, lambda a: a[12] - target, closing)
            y = new
