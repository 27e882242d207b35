"""Which models are left out, in which scenes? Kinds of shots, and what is played in place of each model.

Used by ``python -m benchmarks.scene``.
"""

from dataclasses import dataclass

import numpy as np

import snooker_env as sn
from snooker_env import geometry
from snooker_env.physics.impact import contact

from .._common import shot_sets, variants

STANDARD = contact.parse_fidelity("standard")[0]


def head_on_stun(n, w, seed):
    """Full-ball shots without spin at the impact, far from every cushion and jaw, played without errors."""
    return shot_sets.head_on(n, w, seed)


SCENES = {
    "head-on stun": head_on_stun,
    "straight pots": lambda n, w, seed: shot_sets.two_ball(n, w, seed, cut=(0.0, 1.0), speed=(1.0, 3.0)),
    "cut pots, soft": lambda n, w, seed: shot_sets.two_ball(n, w, seed, cut=(10.0, 60.0), speed=(1.0, 2.0)),
    "cut pots, firm": lambda n, w, seed: shot_sets.two_ball(n, w, seed, cut=(10.0, 60.0), speed=(3.0, 5.0)),
    "cushion first": lambda n, w, seed: shot_sets.kicks(n, w, seed),
    "by the rail": lambda n, w, seed: shot_sets.two_ball(
        n, w, seed, place=shot_sets.by_the_rail, run=(0.15, 0.65), cut=(5.0, 50.0), speed=(1.0, 3.0)
    ),
    "full tables": lambda n, w, seed: shot_sets.full_table(n, w, seed),
}


def sharp_jaws():
    """The match table with each jaw's two arcs shrunk to the points of its throat: straight noses on to the
    same opening."""
    match, noses = sn.Table.preset("match"), []
    corner, middle = throats()
    for axis, side, level, low, high in match.noses:
        half = geometry.HALF_LENGTH if axis == 0 else geometry.HALF_WIDTH
        ends = [np.sign(e) * (half - corner if abs(e) > half / 2 else middle) for e in (low, high)]
        noses.append((axis, side, level, *ends))
    points = [
        (sx * (geometry.HALF_WIDTH - corner), sy * geometry.HALF_LENGTH) for sx in (-1, 1) for sy in (-1, 1)
    ]
    points += [
        (sx * geometry.HALF_WIDTH, sy * (geometry.HALF_LENGTH - corner)) for sx in (-1, 1) for sy in (-1, 1)
    ]
    points += [(sx * geometry.HALF_WIDTH, sy * middle) for sx in (-1, 1) for sy in (-1, 1)]
    return sn.Table(
        "sharp", np.array(noses), np.array([(x, y, 0.0, 1.0, 0.0, -1.0) for x, y in points]), match.falls
    )


def throats():
    """Distances [m] from the corner, and from a middle pocket's axis, of the points as far apart as the
    throats are wide."""
    jaws = sn.Table.preset("match").jaws
    arcs = jaws[
        np.hypot(jaws[:, 0] - geometry.HALF_WIDTH, jaws[:, 1] - geometry.HALF_LENGTH).argsort()[:2], :3
    ]
    corner = (np.hypot(*(arcs[0, :2] - arcs[1, :2])) - 2 * arcs[0, 2]) / np.sqrt(2)
    middle = jaws[np.abs(jaws[:, 1]).argmin()]
    return corner, abs(middle[1]) - middle[2]


@dataclass(frozen=True)
class LeftOut:
    """One model, and what a shot is played with when it is left out."""

    instead: str
    product: str
    """What snooker_env does today."""
    code: int = STANDARD
    physics: dict | None = None
    table: sn.Table | None = None
    added: bool = False
    """Whether the model is off by default, and is added here instead of left out."""


EVERY, ALWAYS = "snooker_env has it at standard and reference", "snooker_env has it at every fidelity"
MODELS = {
    "cloth in a ball-ball impact": LeftOut(
        "two free spheres, closed form", f"{EVERY}, not at fast", variants.FREE_BALLS
    ),
    "cushion: tight tolerance": LeftOut(
        "the loose tolerance of fast", f"{EVERY}, not at fast", variants.LOOSE_CUSHION
    ),
    "cushion: cloth (the ODE)": LeftOut("a smooth cloth, closed form", ALWAYS, variants.SMOOTH_CLOTH),
    "cushion: friction, nose, ODE": LeftOut("a mirror with e_c", ALWAYS, variants.MIRROR),
    "jaw arcs": LeftOut("the throat's points", "snooker_env has them on every table", table=sharp_jaws()),
    "drop takes time": LeftOut("dropped at once at the edge", ALWAYS, variants.AT_ONCE),
    "Marlow's law": LeftOut(
        "mu_bb 0.05",
        'snooker_env has it in "match"; "paper" keeps the paper\'s 0.05',
        physics={"mu_bb": 0.05},
    ),
    "spin decay": LeftOut(
        "spin about the vertical stays", "snooker_env has it everywhere", physics={"spin_decel": 0.0}
    ),
    "balls that fly": LeftOut(
        "balls that fly", "snooker_env has it with Physics(flight=True)", physics={"flight": True}, added=True
    ),
}
