"""Does the engine fly as an independent simulator of tiny steps in three dimensions says? Same events, same places."""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env import EventKind
from snooker_env.physics.arrays import Law
from snooker_env.physics.impact import contact
from snooker_env.physics.impact.polynomial import WORK
from snooker_env.physics.table import Table
from tests.kernels import from_python
from tests.physics.test_shots import check_shot, struck

from . import flight_3d
from .moreau import moreau_tilted

NAMES = {
    EventKind.BALL_BALL: "ball",
    EventKind.CUSHION: "cushion",
    EventKind.JAW: "jaw",
    EventKind.LAND: "land",
    EventKind.RAIL: "rail",
    EventKind.POT: "pot",
    EventKind.DROP: "pot",
    EventKind.OFF: "off",
}
"""What the oracle calls the events that it has, too; it ends a ball's path where it goes over a fall."""
R = sn.Physics().R


def scene(rng, table):
    """A shot that flies: a ball struck down upon, thrown, dropped, or a hard one into others."""
    n, wide = int(rng.integers(1, 5)), np.array([0.8, 1.6]) if table is not None else np.array([0.3, 0.5])
    while True:
        r = np.column_stack([rng.uniform(-wide, wide, (n, 2)), np.zeros(n)])
        if n > 1 and rng.random() < 0.6:  # a ball close ahead
            turn = rng.uniform(-np.pi, np.pi)
            r[1, :2] = r[0, :2] + rng.uniform(0.06, 0.4) * np.array([np.cos(turn), np.sin(turn)])
        apart = min((np.hypot(*(a - b)[:2]) for k, a in enumerate(r) for b in r[:k]), default=1.0)
        if apart > 2.0 * R + 1e-3 and (np.abs(r[:, :2]) < wide).all():
            break
    v, w = np.zeros((n, 3)), np.zeros((n, 3))
    aim = np.arctan2(*(r[1] - r[0])[1::-1]) + rng.normal(0, 0.05) if n > 1 else rng.uniform(-np.pi, np.pi)
    speed = rng.uniform(0.5, 5.0)
    v[0] = speed * np.cos(aim), speed * np.sin(aim), rng.choice([0.0, rng.uniform(0.0, 2.5)])
    w[0] = rng.normal(0, 60, 3)
    if rng.random() < 0.2:
        r[0, 2] = rng.uniform(0.0, 0.2)
    return r, v, w


def met(events):
    """Kind, ball and other ball of each event; of what else is met, engine and oracle have numbers of their own."""
    return [(kind, int(i), int(j) if kind == "ball" else -1) for _, kind, i, j in events]


@pytest.mark.parametrize(
    ("preset", "seed", "many"),
    [("match", 103, 8), *(pytest.param(one, 5, 100, marks=pytest.mark.slow) for one in ("paper", "match"))],
)
def test_shots_that_fly_are_those_of_tiny_steps(preset, seed, many):
    """All events are compared, of balls that meet balls, noses and jaws on the bed and in the air."""
    physics, rng = sn.Physics.preset(preset, flight=True), np.random.default_rng(seed)
    compared = flown = 0
    kinds: dict[str, int] = {}
    for k in range(many):
        name = "match" if k % 5 else None
        table = Table.of(name)
        r, v, w = scene(rng, name)
        shot = sn.simulate(r, v, w, name, physics, "reference")
        log: list = []
        place, fate = flight_3d.simulate(
            r, v, w, physics=physics, table=table if name else None, dt=2e-4, log=log
        )
        if EventKind.DROP in shot.events["kind"]:
            continue  # the oracle does not follow a ball into a pocket
        events = shot.events[["time", "kind", "i", "j"]].tolist()
        own = [(time, NAMES[kind], *balls) for time, kind, *balls in events if kind in NAMES]
        assert met(own) == met(log), k
        np.testing.assert_allclose([e[0] for e in own], [e[0] for e in log], rtol=0, atol=1e-5)
        on = [i for i, f in enumerate(fate) if f == "table"]
        assert [bool(shot.on_table[i]) for i in range(len(r))] == [f == "table" for f in fate]
        np.testing.assert_allclose(shot.positions[on], place[on, :2], rtol=0, atol=1e-6)
        compared += 1
        flown += EventKind.LAND in shot.events["kind"] or EventKind.OFF in shot.events["kind"]
        for _, kind, *_ in own:
            kinds[kind] = kinds.get(kind, 0) + 1
    assert compared > 0.8 * many and flown > 0.6 * many
    assert min(kinds.get(kind, 0) for kind in ("ball", "cushion", "land", "off")) > 0.05 * many, kinds


def test_shots_on_the_bed_are_those_of_tiny_steps():
    """2 to 4 balls on unbounded cloth with side, screw and curve, some with two balls moving, some with a resistance that
    grows with the speed. Shots that hang on a hair (a grazing contact) are not drawn: the aim is at a ball, a third of it
    off centre at the most."""
    for seed in range(16):
        rng, n, drag = np.random.default_rng(seed), 2 + seed % 3, 0.02 * (seed % 4 == 3)
        while True:
            p = rng.uniform(-0.25, 0.25, (n, 2))
            if min(np.hypot(*(a - b)) for k, a in enumerate(p) for b in p[:k]) > 2.0 * R + 5e-3:
                break
        to, tip = p[1] - p[0], rng.uniform(-0.35, 0.35, 2)
        aim = np.arctan2(to[1], to[0]) + rng.uniform(-0.6, 0.6) * 2.0 * R / np.hypot(*to)
        v, w = struck(
            n, rng.uniform(0.5, 5.0), aim, side=tip[0], top=tip[1], elevation=rng.choice([0.0, 0.3])
        )
        if seed % 3 == 0:
            v[1], w[1] = rng.normal(size=2) * 0.3, rng.normal(size=3) * 20
        physics = sn.Physics(roll_drag=drag)
        want, _ = flight_3d.simulate(p, np.column_stack([v, 0 * v[:, 0]]), w, physics=physics, dt=2e-4)
        for fidelity, most in (("reference", 1e-3 if drag else 1e-4), ("standard", 1e-3)):
            shot = sn.simulate(p, v, w, None, physics, fidelity)
            assert np.abs(shot.positions - want[:, :2]).max() < most, (seed, fidelity)
        check_shot(shot)
        if drag:
            assert np.abs(sn.simulate(p, v, w, None).positions - want[:, :2]).max() > 0.01


def test_an_impact_from_above_is_the_oracles():
    """Also with frictions that hold the cloth's slip and the slip between the balls at once."""
    rng, collide = np.random.default_rng(3), from_python(contact.collide_from_above)
    for k in range(12):
        frictions = {} if k % 2 else {"mu_bb": rng.uniform(0.05, 0.3), "mu_s": rng.uniform(0.2, 0.6)}
        physics = sn.Physics.preset("match", e_b=rng.uniform(0.3, 0.95), **frictions)
        tilt, turn = rng.uniform(0.02, 1.5), rng.uniform(-np.pi, np.pi)
        n = np.array([np.cos(tilt) * np.cos(turn), np.cos(tilt) * np.sin(turn), -np.sin(tilt)])
        v, w = rng.normal(0, 1.0, (2, 3)) * (1, 1, 0.5), rng.normal(0, 40, (2, 3)) * (k % 3 > 0)
        v[1, 2] = 0.0
        v[0] += (1.5 - (v[0] - v[1]) @ n) * n
        law = Law(physics.pack(), contact.REFERENCE, 0)
        one = collide(*map(tuple, (v[0], w[0], v[1], w[1], n)), law, physics.e_b, np.zeros(WORK))
        mu = physics.friction_law
        *its, press = moreau_tilted(v[0], w[0], v[1], w[1], n, e=physics.e_b, mu=mu, mu_s=physics.mu_s, R=R)
        assert one[5] and one[4] == pytest.approx(max(0.0, press), abs=2e-6)
        for mine, other, scale in zip(one[:4], its, (1.0, R, 1.0, R), strict=True):
            np.testing.assert_allclose(
                np.multiply(mine, scale), np.multiply(other, scale), atol=2e-6, err_msg=str(k)
            )
