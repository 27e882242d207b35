"""Which models follow the other data? Throw against cut angle (TP A.14, Doménech's measurements), straight
cushion rebounds.

Used by ``python -m benchmarks.paper``. Throw is the angle [deg] between the object ball's path just after the
impact and the line of centres, > 0 towards the cue ball's side motion. Data: ``throw_tp_a14.csv`` (a
published table, itself computed), ``throw_domenech2023.csv`` and ``cushion_rebound.csv`` (measured, read off
published figures).
"""

from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import minimize_scalar

import snooker_env as sn
from snooker_env.physics.parameters import MARLOW

from .paper_shots import rolling

FOLDER = Path(__file__).parents[1] / "data"
REBOUNDS = FOLDER / "cushion_rebound.csv"
POOL_R = 0.028575
"""Radius [m] of a pool ball, 2.25 in across."""
DOMENECH: dict[str, Any] = {"R": 0.0305, "e_b": 0.968}
DOMENECH_SPEED = 0.80
"""Doménech-Carbó (2023): 61 mm balls, restitution 0.968, the cue ball rolling at 0.80 m/s."""
FAST_REBOUND = 2.5
"""Normal speed [m/s] up to which Mathavan et al. (2010) hold their cushion model to be valid."""


def closed_throw(cut, v0, topspin, radius, e=1.0, law=MARLOW):
    """Throw [deg] of free spheres in closed form, no side (Alciatore, TP A.14). With c the cut, per unit
    mass:

    tangential slip x = v0 sin c, vertical slip z = R w cos c (the roll), s = hypot(x, z), normal impulse P =
    (1+e)/2 v0 cos c; friction impulse F = min(mu(s) P, s/7), mu(s) = a + b exp(-k s), opposite to the slip;
    tan(throw) = F (x/s) / P. F reaches s/7 where it stops the slip: 1/M (two balls, 2/M of motion and 5/M of
    spin) changes s by 7 a unit of impulse.
    """
    c = np.radians(cut)
    x, z = v0 * np.sin(c), radius * topspin * np.cos(c)
    s, p = np.hypot(x, z), 0.5 * (1 + e) * v0 * np.cos(c)
    f = np.minimum((law[0] + law[1] * np.exp(-law[2] * s)) * p, s / 7)
    return np.degrees(np.arctan(f * x / s / p))


def stun_throw_following(cut, v0, e=1.0, law=MARLOW):
    """Throw [deg] of a stun shot in closed form when the friction follows the slip as it dies, not only its
    first value.

    ds/dP = -7 mu(s), mu(s) = a + b exp(-k s), integrates to a exp(k s) + b = (a exp(k s0) + b) exp(-7 a k P);
    F = (s0 - s) / 7. A stun shot's slip is level, so the cloth takes no part and "reference" must agree.
    """
    c, (a, b, k) = np.radians(cut), law
    s0, p = v0 * np.sin(c), 0.5 * (1 + e) * v0 * np.cos(c)
    left = ((a * np.exp(k * s0) + b) * np.exp(-7 * a * k * p) - b) / a
    s = np.log(np.maximum(left, 1.0)) / k  # at 1 the slip has ended
    return np.degrees(np.arctan((s0 - s) / 7 / p))


def solved_throw(cut, v0, topspin, physics, fidelity, *, after_slip=False):
    """Throw [deg] by the package's impact; ``after_slip``: of the path once the ball rolls, not of the one
    just after the impact."""
    c = np.radians(cut)
    _, _, v, w = sn.collide_balls(
        (v0, 0, 0), (0, topspin, 0), (0, 0, 0), (0, 0, 0), (np.cos(c), np.sin(c), 0), physics, fidelity
    )
    x, y = rolling(v, w, physics.R) if after_slip else v[:2]
    return float(cut - np.degrees(np.arctan2(y, x)))


def _read(name):
    return np.genfromtxt(FOLDER / name, delimiter=",", names=True, deletechars="")


A14_SHOTS = {f"{kind} {speed} m/s": (kind, speed) for kind in ("stun", "roll") for speed in (0.447, 1.341)}


def a14_throw(kind, v0, cuts):
    """Throw [deg] of TP A.14's balls at these cuts: closed form, "fast", "reference"; of a stun shot also
    with friction that follows."""
    physics, topspin = sn.Physics(R=POOL_R, e_b=1.0, mu_bb="marlow"), v0 / POOL_R if kind == "roll" else 0.0
    out = {"closed form": closed_throw(cuts, v0, topspin, POOL_R)}
    for fidelity in ("fast", "reference"):
        out[fidelity] = np.array([solved_throw(c, v0, topspin, physics, fidelity) for c in cuts])
    if kind == "stun":
        out["closed form, mu follows"] = stun_throw_following(cuts, v0)
    return out


def a14():
    """TP A.14's table: per kind of shot the cuts, the printed throw and the models' [deg]."""
    table = _read("throw_tp_a14.csv")
    cuts = table["cut_deg"]
    out = {}
    for name, (kind, v0) in A14_SHOTS.items():
        models = a14_throw(kind, v0, cuts)
        out[name] = {
            "cut": cuts.tolist(),
            "printed": table[f"{kind}_{v0}"].tolist(),
            **{k: v.tolist() for k, v in models.items()},
        }
    return out


def domenech_throw(mu_bb, cuts, *, after_slip=False):
    """Throw [deg] of Doménech's balls at these cuts with this ball-ball friction, at "reference"."""
    physics, topspin = sn.Physics(mu_bb=mu_bb, **DOMENECH), DOMENECH_SPEED / DOMENECH["R"]
    return np.array(
        [solved_throw(c, DOMENECH_SPEED, topspin, physics, "reference", after_slip=after_slip) for c in cuts]
    )


def _misfit(residuals):
    r = np.asarray(residuals)
    return {"mean": float(r.mean()), "rms": float(np.sqrt(np.mean(r**2))), "largest": float(np.abs(r).max())}


def domenech():
    """Measured throw: the models' residuals [deg], in all and in bins of cut; the best constant friction; how
    much the data scatter."""
    cut, seen = (_read("throw_domenech2023.csv")[k] for k in ("cut_deg", "throw_deg"))
    found = minimize_scalar(
        lambda mu: np.sum((domenech_throw(mu, cut) - seen) ** 2), bounds=(0.02, 0.3), options={"xatol": 1e-4}
    )
    best = float(getattr(found, "x"))  # noqa: B009 (scipy's result has no typed fields)
    smooth = np.polynomial.Polynomial.fit(cut, seen, 3)(cut)
    laws = {
        "mu 0.05 (paper)": 0.05,
        "Marlow (match)": "marlow",
        "mu 0.10": 0.10,
        f"best constant, mu {best:.3f}": best,
    }
    edges = np.arange(5, 80, 10)
    place = np.digitize(cut, edges)
    values = {name: domenech_throw(mu, cut) for name, mu in laws.items()}
    bins = [
        {
            "from": int(edges[k - 1]),
            "to": int(edges[k]),
            "n": int((place == k).sum()),
            "measured": float(seen[place == k].mean()),
            **{name: float(v[place == k].mean()) for name, v in values.items()},
        }
        for k in range(1, len(edges))
        if (place == k).any()
    ]
    after = domenech_throw(0.10, cut, after_slip=True) - values["mu 0.10"]
    return {
        "n": len(cut),
        "laws": laws,
        "misfit": {name: _misfit(v - seen) for name, v in values.items()},
        "scatter": float(np.sqrt(np.mean((smooth - seen) ** 2))),
        "bins": bins,
        "cut": cut.tolist(),
        "measured": seen.tolist(),
        "largest_change_by_cloth": float(np.abs(after).max()),
    }


def rebound(preset, v0):
    """Rebound speed [m/s] of a ball that rolls straight into the cushion of this preset at v0."""
    physics = sn.Physics.preset(preset)
    v, _ = sn.collide_cushion((0, v0, 0), (-v0 / physics.R, 0, 0), (0, 1, 0), physics, "reference")
    return -float(v[1])


CUSHIONS = {
    "restitution alone": lambda v0: sn.Physics.preset("paper").e_c * v0,
    "paper": lambda v0: rebound("paper", v0),
    "match": lambda v0: rebound("match", v0),
}
"""v0 -> rebound speed [m/s]. "match" was fitted to these data and others (docs/physics/limits.md), "paper" to
those below 1.5 m/s."""


def cushion():
    """Measured rebounds: the models' residuals [m/s] in all, below and above ``FAST_REBOUND``."""
    speed, seen = np.loadtxt(REBOUNDS, delimiter=",", skiprows=1).T
    fast = speed > FAST_REBOUND
    out = {"incident": speed.tolist(), "measured": seen.tolist(), "n_fast": int(fast.sum()), "models": {}}
    for name, model in CUSHIONS.items():
        values = np.array([model(float(s)) for s in speed])
        r = values - seen
        out["models"][name] = {
            "rebound": values.tolist(),
            **_misfit(r),
            "slow": _misfit(r[~fast]),
            "fast": _misfit(r[fast]),
            "ratio_at_largest": float(values[-1] / speed[-1]),
        }
    out["ratio_at_largest"] = float(seen[-1] / speed[-1])
    return out
