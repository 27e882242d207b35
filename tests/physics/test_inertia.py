"""Are the constants of an impact those of rigid spheres? Derived again from Newton's and Euler's laws, and compared symbolically."""

import pytest
from sympy import Matrix, Rational, expand, nsimplify, simplify, solve, symbols

from snooker_env.physics.impact import inertia
from snooker_env.physics.impact.inertia import Contact, Impulses, Slips

M, R = symbols("M R", positive=True)
t = symbols("t", real=True)
F1, F2, G1, G2, P, N, LIFT = symbols("F1 F2 G1 G2 p N Z", real=True)
X, Y, UP = Matrix([1, 0, 0]), Matrix([0, 1, 0]), Matrix([0, 0, 1])


def python_of(function):
    """The Python function behind a kernel."""
    return getattr(function, "py_func", function)


class Sphere:
    """A solid sphere, at rest before the impact. ``push``: an impulse per unit mass at the point R n of its surface, n a unit vector."""

    def __init__(self):
        self.v, self.w = Matrix([0, 0, 0]), Matrix([0, 0, 0])

    def push(self, n, per_mass):
        impulse = M * per_mass
        self.v += impulse / M  # Newton
        self.w += (R * n).cross(impulse) / (Rational(2, 5) * M * R**2)  # Euler

    def surface(self, n):
        return self.v + self.w.cross(R * n)


def two_balls():
    """C free, O on the cloth: slips, closing speed, and the load N that keeps O's centre at its height."""
    c, o = Sphere(), Sphere()
    friction = F1 * X + F2 * UP
    c.push(Y, friction - P * Y)
    o.push(-Y, -(friction - P * Y))
    o.push(-UP, G1 * X + G2 * Y + N * UP)
    (load,) = solve(o.v.dot(UP), N)
    o.v, o.w = o.v.subs(N, load), o.w.subs(N, load)
    a, b = c.surface(Y) - o.surface(-Y), o.surface(-UP)
    return [a.dot(X), a.dot(UP), b.dot(X), b.dot(Y), c.v.dot(Y) - o.v.dot(Y)], load


def ball_and_nose():
    """The contact R sin(t) above the centre. The ball's vertical velocity is Z, with the load N that this takes."""
    from sympy import cos, sin

    ball = Sphere()
    normal, second = Matrix([0, cos(t), sin(t)]), Matrix([0, -sin(t), cos(t)])
    ball.push(normal, F1 * X + F2 * second - P * normal)
    ball.push(-UP, G1 * X + G2 * Y + N * UP)
    (load,) = solve(ball.v.dot(UP) - LIFT, N)
    ball.v, ball.w = ball.v.subs(N, load), ball.w.subs(N, load)
    a, b = ball.surface(normal), ball.surface(-UP)
    return [a.dot(X), a.dot(second), b.dot(X), b.dot(Y), ball.v.dot(normal)], load


def as_used(contact):
    """The slips and the load as the kernels compute them, symbolically."""
    contact = Contact(*(nsimplify(value, rational=True) for value in contact))
    impulses = Impulses(F1, F2, G1, G2, P, 0, LIFT)
    after = python_of(inertia.slips_after)(impulses, Slips(0, 0, 0, 0, 0), contact)
    return [nsimplify(value, rational=True) for value in after], contact.n_p * P + contact.n_f * F2


def of_cushion():
    from sympy import cos, sin

    return python_of(inertia.cushion)(sin(t), cos(t))


def wrong(contact, derived):
    """Which of the slips, the closing speed and the load (5) differ from what was derived."""
    slips, load = derived
    load = load.subs(LIFT, 0)  # a lifted ball has no load
    used, load_used = as_used(contact)
    names = (*Slips._fields, "load")
    each = zip(names, (*used, load_used), (*slips, load), strict=True)
    return [n for n, u, d in each if simplify(expand(u - d)) != 0]


CASES = {"balls": (lambda: inertia.BALLS, two_balls), "cushion": (of_cushion, ball_and_nose)}


@pytest.mark.parametrize("kind", CASES)
def test_the_constants_are_those_of_rigid_spheres(kind):
    contact, derive = CASES[kind]
    assert wrong(contact(), derive()) == []
