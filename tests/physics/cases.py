"""Which impacts are tested? Seeded random ones over everything that the models claim to cover, and the ones that trip solvers."""

import numpy as np

R = 0.02625


def impacts(n, seed):
    """n ball-ball impacts as dicts (v1, w1, v2, w2, normal, e, mu_bb, mu_s): any spins of both, both moving,
    grazing, head-on without slip, object ball at rest, rolling and stun; e in [0, 1], mu_bb in [0, 0.3]."""
    rng = np.random.default_rng(seed)
    out = []
    while len(out) < n:
        k = len(out)
        angle = rng.uniform(-np.pi, np.pi)
        normal = np.array([np.cos(angle), np.sin(angle), 0.0])
        cut = (
            rng.uniform(-1.55, 1.55)
            if k % 5
            else rng.choice([-1, 1]) * (np.pi / 2 - 10 ** rng.uniform(-4, -1))
        )
        speed = rng.uniform(0.05, 7.0)
        v1 = speed * np.array([np.cos(angle + cut), np.sin(angle + cut), 0.0])
        w1 = rng.normal(size=3) * speed / R * rng.choice([0.0, 0.3, 1.0])
        v2, w2 = np.zeros(3), np.zeros(3)
        if k % 4 == 1:
            w1[:2] = -v1[1] / R, v1[0] / R  # rolling
        if k % 3 == 2:
            v2 = np.array([*rng.normal(size=2) * speed * 0.5, 0.0])
            w2 = rng.normal(size=3) * speed / R * rng.choice([0.0, 0.5])
            if k % 2:
                w2[:2] = -v2[1] / R, v2[0] / R
        if k % 11 == 10:  # head-on without slip
            v1, w1, v2, w2 = speed * normal, np.zeros(3), np.zeros(3), np.zeros(3)
        if (v1 - v2) @ normal <= 0:
            continue
        e = (0.0, 1.0, 0.89, rng.random())[k % 4]
        mu_bb = (0.05, rng.uniform(0, 0.3), 0.3, 0.0, rng.uniform(0, 0.3))[(k // 4) % 5]
        case = {"v1": v1, "w1": w1, "v2": v2, "w2": w2, "normal": normal}
        out.append(case | {"e": e, "mu_bb": mu_bb, "mu_s": rng.uniform(0.1, 0.4)})
    return out


def cushion_impacts(n, seed):
    """n ball-cushion impacts as dicts (v, w, normal, e, mu_w, mu_s): rolling, draw, side, grazing, perpendicular."""
    rng = np.random.default_rng(seed)
    out = []
    for k in range(n):
        angle = rng.uniform(-np.pi, np.pi)
        normal = np.array([np.cos(angle), np.sin(angle), 0.0])
        incidence = rng.uniform(-1.5, 1.5) if k % 4 else 0.0
        speed = rng.uniform(0.05, 7.0)
        v = speed * np.array([np.cos(angle + incidence), np.sin(angle + incidence), 0.0])
        w = rng.normal(size=3) * speed / R * rng.choice([0.0, 0.3, 1.0])
        if k % 2:
            w[:2] = -v[1] / R, v[0] / R
        frictions = {"e": rng.uniform(0.5, 1.0), "mu_w": rng.uniform(0, 0.3), "mu_s": rng.uniform(0, 0.4)}
        out.append({"v": v, "w": w, "normal": normal} | frictions)
    return out
