"""From how many steps on does the paper's scheme hold? Its errors, the energy it creates, the impacts and
shots that do not end.

Used by ``python -m benchmarks.stability``: measured, not judged.
"""

import numpy as np

import snooker_env as sn
from snooker_env import Table
from snooker_env.game.balls import SPOTS
from snooker_env.physics.engine import Status
from snooker_env.physics.impact import contact
from snooker_env.simulation import _run

from ..fuzz import R
from .impacts import any_impacts, collide, impact_figures
from .shots import strike_balls

EULER_STEPS = (1, 2, 3, 5, 10, 20, 50, 100, 200, 1000, 10_000)


def euler_table():
    """For each N: impacts that do not end, error against "reference" (median, worst), energy gained (e 0.89,
    e 1), shots lost of 40."""
    cases, out = any_impacts(200, 12), {}
    p = np.tile(SPOTS, (40, 1, 1))
    p[:, 0] = (0.1, -1.2)
    motion = strike_balls(p, np.linspace(1, 6, 40), np.pi / 2 + np.linspace(-0.12, 0.1, 40))
    for n in EULER_STEPS:
        name, errors, unsolved = f"euler:{n}", [], 0
        for case in cases:
            got, want = collide(case, "paper", name), collide(case, "paper", "reference")
            if got is None or want is None:
                unsolved += 1
                continue
            errors.append(
                np.abs((got - want) * np.where(np.arange(4)[:, None] % 2, R, 1.0)).max()
                / np.linalg.norm(case[0])
            )
        row = {
            "unsolved": unsolved,
            "error_median": float(np.median(errors)),
            "error_worst": float(np.max(errors)),
        }
        for e in (0.89, 1.0):
            row[f"gain e {e:g}"] = impact_figures(cases, {"e_b": e}, (name,))["energy"]
        if n <= 1000:
            physics = sn.Physics(e_b=1.0, e_c=1.0)
            # not checked on the way: speeds reach 1e150 m/s
            state = p.copy(), *(a.copy() for a in motion), np.ones(p.shape[:2], bool)
            row["lost"] = int(
                (
                    _run(state, physics, Table.preset("match"), (contact.EULER, n), 3000).status != Status.OK
                ).sum()
            )
        out[n] = row
    return out


def euler_lines(rows):
    """The table of the paper's scheme."""
    lines = [
        "the paper's scheme     not ended of 200   error median    worst   energy gained, e 0.89     e 1   shots not ended of 40 (e 1)"
    ]
    for n, r in rows.items():
        gains = "".join(
            f"{r[k]:>12.2g}" if r[k] > 0 else f"{'none':>12}" for k in ("gain e 0.89", "gain e 1")
        )
        lost = r.get("lost", "-")
        lines.append(
            f"  euler:{n:<14}{r['unsolved']:>16}{r['error_median']:>15.1e}{r['error_worst']:>9.1e}{gains:>32}{lost:>20}"
        )
    return lines
