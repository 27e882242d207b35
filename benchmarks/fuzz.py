"""Does any shot break an invariant? This plays random shots on every table and checks every invariant of
``_common/invariants.py``.

They cover every kind of scene, fidelity and physics, on the preset tables, rectangles with pockets of any size, and
unbounded cloth.

    python -m benchmarks.fuzz [--shots 1000000] [--seed 0] [--threads 2]
    python -m benchmarks.fuzz --replay SEED BATCH INDEX

``python -m benchmarks.stability`` also runs this after its extremes. A batch depends only on its seed and number, so
that you can replay a failure by seed, batch and index. Exit code 1 if an invariant fails.
"""

import dataclasses
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

import snooker_env as sn
from snooker_env import Pocket, Table
from snooker_env.game.balls import SPOTS
from snooker_env.physics.engine import Status
from snooker_env.physics.impact import contact
from snooker_env.physics.table import MOUTH
from snooker_env.progress import Progress

from ._common import invariants as invariants
from ._common.command import Command, at_least, run, save_figures

R = 0.02625
D = 2 * R
BATCH = 200
PUBLIC = 20
MOST_EVENTS = 1_000_000
"""Maximum number of events. Six in a million of these shots need more than the default 100,000 of ``simulate``: spin
holds balls against others and a cushion, where they bounce until the spin is gone."""
GAPS = np.array([0.0, 0.0, 1e-15, 1e-12, 1e-9, 1e-6])
SCENES = ("scattered", "rack", "cluster", "frozen", "melee", "held")
TABLES = (None, "match", "match", "tight", "uk8", "pool9", "carom", "rectangle", "rectangle")
SNOOKER = (None, "match", "match", "match", "tight")
"""Tables with room for a rack."""
FLIGHT = 0.5
"""Share of batches in which balls fly."""
FIDELITIES = ("fast", "standard", "standard", "reference", "euler:100", "euler:400", "euler:1000")
CONSTANTS = ("paper", "match", "random", "extreme")


@dataclass(frozen=True)
class Batch:
    """``BATCH`` shots of one kind."""

    scene: str
    constants: str
    fidelity: str
    physics: sn.Physics
    table: Table
    positions: np.ndarray
    velocities: np.ndarray
    spins: np.ndarray
    aloft: np.ndarray
    """(b, n, 2): heights of the balls above the bed, and their rates."""

    def states(self):
        """Positions and velocities for ``simulate_batch``, (b, n, 3) if balls fly."""
        if not self.physics.flight:
            return self.positions, self.velocities
        up = self.aloft[..., :1], self.aloft[..., 1:]
        return np.concatenate([self.positions, up[0]], -1), np.concatenate([self.velocities, up[1]], -1)


def _mouth(table):
    """Maximum distance of a drawn ball beyond the noses [m]; 0 on a table without pockets."""
    return MOUTH if len(table.falls) else 0.0


def legal(p, table, R=R):
    """Whether centres (..., 2) are on the table, outside cushions, jaws and pockets."""
    if not len(table.noses):
        return np.ones(p.shape[:-1], bool)
    x, y = p[..., 0], p[..., 1]
    good = (np.abs(p) < table.bounds[:, 1] + _mouth(table)).all(-1)
    for axis, side, level, low, high in table.noses:
        along, across = (y, x) if axis == 0 else (x, y)
        good &= (along < low) | (along > high) | (side * across <= level - R)
    for cx, cy, radius in table.falls:
        good &= np.hypot(x - cx, y - cy) > radius
    for cx, cy, radius, ux, uy, cos_half in table.jaws:
        far = np.hypot(x - cx, y - cy)
        off = (x - cx) * ux + (y - cy) * uy < cos_half * far
        off |= far < radius - R  # this deep behind a facing there is another part of the table
        good &= (far >= (radius + R) * (1 - 1e-15)) | off
    return good


def put(p, placed, todo, draw, anywhere, table, R):
    """Place ball ``placed`` of every table in ``todo`` with ``draw(todo)``, legally and clear of the balls placed
    before.

    If there is no room, ``anywhere(todo)`` replaces ``draw(todo)``."""
    for attempt in range(1000):
        place = draw(todo) if attempt < 100 else anywhere(todo)
        far = np.hypot(*(p[todo, :placed] - place[:, None]).transpose(2, 0, 1)).min(1, initial=9.0)
        good = legal(place, table, R) & (far >= 2 * R * (1 - 1e-15))
        p[todo[good], placed] = place[good]
        todo = todo[~good]
        if not len(todo):
            return
    raise RuntimeError(f"no room for ball {placed}")


def rectangle(rng):
    """Draw a rectangular table for balls of any size, with pockets that fit."""
    R, kinds = rng.uniform(0.015, 0.04), (6, 4, 0)
    pockets: Literal[6, 4, 0] = kinds[rng.integers(3)]

    def pocket(kind, least, most):
        sizes = {
            "mouth": rng.uniform(3, 6) * R,
            "shelf": rng.uniform(-0.5, 2) * R,
            "fall_radius": rng.uniform(2, 4) * R,
        }
        return kind(
            **sizes, cut=rng.uniform(least, most), jaw_radius=float(rng.choice([0.0, rng.uniform(0, 4)])) * R
        )

    while True:
        length, width = rng.uniform(30, 70) * R, rng.uniform(20, 40) * R
        try:
            corner = pocket(Pocket.corner, 135, 150) if pockets else None
            middle = pocket(Pocket.middle, 90, 120) if pockets == 6 else None
            return Table.rectangular(
                length, width, pockets=pockets, corner=corner, middle=middle, ball_radius=R
            )
        except ValueError:
            pass


def _anywhere(rng, table):
    high = np.where(np.isfinite(table.bounds[:, 1]), table.bounds[:, 1], 1.0) + _mouth(table)
    return lambda todo: rng.uniform(-high, high, (len(todo), 2))


def _at_cushion(rng, table, R, seams=0.0):
    """Draw places that touch a nose, an arc or a facing, with a gap of ``GAPS``; a share ``seams`` of them 1 nm to
    1 cm from its end."""

    def draw(todo):
        b = len(todo)
        gap, share, end = rng.choice(GAPS, b), rng.uniform(-1, 1, b), 10 ** rng.uniform(-9, -2, b)
        near = rng.random(b) < seams
        nose = table.noses[rng.integers(len(table.noses), size=b)]
        half, across = (nose[:, 4] - nose[:, 3]) / 2, nose[:, 1] * (nose[:, 2] - R - gap)
        along = (nose[:, 3] + nose[:, 4]) / 2 + np.where(near, np.sign(share) * (half - end), share * half)
        out = np.where(nose[:, :1] == 0, np.column_stack([across, along]), np.column_stack([along, across]))
        if not len(table.jaws):
            return out
        jaw = table.jaws[rng.integers(len(table.jaws), size=b)]
        half, far = np.arccos(jaw[:, 5]), jaw[:, 2] + R + gap
        turn = np.arctan2(jaw[:, 4], jaw[:, 3]) + np.where(
            near, np.sign(share) * np.maximum(half - end / far, 0.0), share * half
        )
        at_jaw = jaw[:, :2] + far[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])
        return np.where(rng.random((b, 1)) < 0.3 + 0.4 * seams, at_jaw, out)

    return draw


def _at_ball(rng, p, placed, lattice, R):
    """Draw places that touch one of the earlier balls, with a gap of ``GAPS``; half of them in the lattice, so that
    loops close."""

    def draw(todo):
        turn = rng.uniform(-np.pi, np.pi, len(todo))
        turn = np.where(
            rng.random(len(todo)) < 0.6, lattice[todo] + np.pi / 3 * rng.integers(6, size=len(todo)), turn
        )
        far = 2 * R + rng.choice(GAPS, len(todo))
        return p[todo, rng.integers(placed, size=len(todo))] + far[:, None] * np.column_stack(
            [np.cos(turn), np.sin(turn)]
        )

    return draw


def layouts(rng, scene, n, table, b=BATCH, R=R):
    """Draw b layouts of n balls: (b, n, 2)."""
    p, every = np.full((b, n, 2), 99.0), np.arange(b)
    if scene == "rack":
        p[:] = SPOTS
        p[:, 0] = np.column_stack([rng.uniform(-0.29, 0.29, b), rng.uniform(-1.6, -1.1, b)])
        near = rng.random(b) < 0.1  # a cue ball that touches the pack
        turn = rng.uniform(-1.7, -1.4, near.sum())
        p[near, 0] = p[near, 1] + (D + rng.choice(GAPS, near.sum()))[:, None] * np.column_stack(
            [np.cos(turn), np.sin(turn)]
        )
        clear = np.hypot(*(p[:, 1:] - p[:, :1]).transpose(2, 0, 1)).min(1) >= D * (1 - 1e-15)
        p[~clear, 0] = 0.1, -1.3
        return p
    lattice = rng.uniform(-np.pi, np.pi, b)
    anywhere = _anywhere(rng, table)
    for ball in range(n):
        draw = anywhere
        if scene == "cluster" and ball:
            draw = _at_ball(rng, p, ball, lattice, R)
        if scene == "frozen" and len(table.noses):
            draw = _at_cushion(rng, table, R) if ball % 2 == 0 else _at_ball(rng, p, ball, lattice, R)
        if scene == "held" and len(table.noses):
            draw = _at_cushion(rng, table, R, seams=0.5)
        put(p, ball, every, draw, anywhere, table, R)
    return p


def motions(rng, scene, p, R):
    """Draw velocities (b, n, 2) and spins (b, n, 3): one struck ball; in a melee, all balls with any spin; held
    balls slow, with any spin."""
    b, n = p.shape[:2]
    v, w = np.zeros((b, n, 2)), np.zeros((b, n, 3))
    if scene in ("melee", "held"):
        fastest, most = (50, 5000) if scene == "melee" else (1, 500)
        speed, spin = (
            10 ** rng.uniform(-9, np.log10(fastest), (b, n)),
            10 ** rng.uniform(-3, np.log10(most), (b, n)),
        )
        turn, axis = rng.uniform(-np.pi, np.pi, (b, n)), rng.normal(size=(b, n, 3))
        if scene == "held":  # some along the sides of the table
            turn = np.where(rng.random((b, n)) < 0.5, np.pi / 2 * rng.integers(4, size=(b, n)), turn)
        v[:] = (speed * (rng.random((b, n)) < 0.7))[..., None] * np.stack([np.cos(turn), np.sin(turn)], -1)
        w[:] = (
            (spin * (rng.random((b, n)) < 0.7))[..., None]
            * axis
            / np.linalg.norm(axis, axis=-1, keepdims=True)
        )
        return v, w
    to = p[np.arange(b), rng.integers(min(1, n - 1), n, b)] - p[:, 0]
    far = np.maximum(np.hypot(*to.T), 2 * R)
    off = np.arcsin(np.clip(2 * R / far, 0, 1)) * rng.uniform(-1.1, 1.1, b)
    off[rng.random(b) < 0.15] = 0.0
    aim = np.where(rng.random(b) < 0.75, np.arctan2(to[:, 1], to[:, 0]) + off, rng.uniform(-np.pi, np.pi, b))
    speed = np.where(rng.random(b) < 0.9, rng.uniform(0.05, 7, b), 10 ** rng.uniform(-9, np.log10(50), b))
    side, top, lean = rng.uniform(-0.5, 0.5, b), rng.uniform(-0.5, 0.5, b), rng.uniform(-0.3, 0.3, b)
    q = 2.5 * speed / R
    v[:, 0] = speed[:, None] * np.column_stack([np.cos(aim), np.sin(aim)])
    w[:, 0] = np.column_stack(
        [q * (lean * np.cos(aim) - top * np.sin(aim)), q * (lean * np.sin(aim) + top * np.cos(aim)), q * side]
    )
    return v, w


def physics_of(rng, name, R):
    """Draw the constants of a batch, with balls of radius R."""
    if name in ("paper", "match"):
        return sn.Physics.preset(name, R=R)
    if name == "random":
        apart = rng.spawn(1)[0]  # so what else is drawn stays
        return sn.Physics(
            R=R,
            roll_drag=apart.uniform(0, 0.03) if apart.random() < 0.5 else 0.0,
            mu_s=rng.uniform(0.02, 0.5),
            mu_r=10 ** rng.uniform(-2.5, -1),
            spin_decel=rng.uniform(1, 60),
            e_b=rng.uniform(0, 1),
            mu_bb=rng.uniform(0, 0.3),
            e_c=rng.uniform(0, 1),
            mu_c=rng.uniform(0, 0.4),
            sin_theta=rng.uniform(0, 0.6),
            e_j=rng.uniform(0, 1),
            e_c_knee=rng.uniform(0.1, 3.0),
            e_c_power=rng.uniform(0, 0.8),
        )
    pick = lambda *values: float(rng.choice(values))  # noqa: E731
    return sn.Physics(
        R=R,
        mu_s=pick(1e-3, 0.21, 0.5, 0.8),
        mu_r=pick(1e-3, 0.0127, 0.1, 1.0),
        spin_decel=pick(0.0, 2.0, 22.0, 500.0),
        e_b=pick(0.0, 0.5, 1.0),
        mu_bb=pick(0.0, 0.05, 0.5, 1.0),
        e_c=pick(0.0, 0.5, 1.0),
        mu_c=pick(0.0, 0.14, 0.5, 1.0),
        sin_theta=pick(0.0, 0.4, 0.9),
    )


def batch(seed, number):
    """Draw batch ``number`` of the fuzz with this seed."""
    rng = np.random.default_rng([seed, number])
    scene, fidelity = str(rng.choice(SCENES)), str(rng.choice(FIDELITIES))
    name = str(rng.choice(CONSTANTS, p=[0.3, 0.3, 0.3, 0.1]))
    if name == "extreme" and fidelity.startswith("euler"):
        name = "random"
    kinds = SNOOKER if scene == "rack" else TABLES
    kind = kinds[int(rng.integers(len(kinds)))]
    table = rectangle(rng) if kind == "rectangle" else Table.of(kind)
    physics = physics_of(rng, name, table.ball.get("R", R))
    # near e = 1 its last step can gain energy without bound, see the table of the scheme
    if fidelity.startswith("euler"):
        physics = dataclasses.replace(physics, e_b=min(physics.e_b, 0.95), e_c=min(physics.e_c, 0.98))
    n = (
        22
        if scene == "rack"
        else int(rng.choice([1, 2, 3, 4] if scene == "held" else [1, 2, 3, 4, 6, 10, 16, 22]))
    )
    p = layouts(rng, scene, n, table, R=physics.R)
    apart = rng.spawn(2)[1]  # so what else is drawn stays
    v, w = motions(rng, scene, p, physics.R)
    aloft = np.zeros((*p.shape[:2], 2))
    if apart.random() < FLIGHT:
        # with more rolling resistance, a ball may rest on others, which is not modelled
        physics = dataclasses.replace(
            physics, flight=True, e_t=apart.uniform(0, 0.9), mu_r=min(physics.mu_r, 0.015)
        )
        struck = aloft if scene in ("melee", "held") else aloft[:, :1]
        chance = apart.random(struck.shape[:2])
        struck[..., 1] = np.where(chance < 0.6, 10 ** apart.uniform(-2, 1, chance.shape), 0.0)
        if scene == "scattered":  # a falling ball
            struck[..., 0] = np.where(chance > 0.8, apart.uniform(0, 0.3, chance.shape), 0.0)
    return Batch(scene, name, fidelity, physics, table, p, v, w, aloft)


def allowed(fidelity, constants="match", flight=False):
    """The bound of each invariant, in the order of ``invariants.NAMES``.

    Euler's steps are not located, so its energy may err by 5/N. "fast" takes steps in cushions to 1e-4, so a ball
    may still approach at 1e-2 of its speed. At the ends of the ranges an impact may lose no energy (no friction,
    restitution 1), which reveals the error of "standard". If balls fly, gravity may press one into others as far as
    a layout may overlap.
    """
    code, n = contact.parse_fidelity(fidelity)
    gain = (
        5 / n
        if n
        else 5e-3
        if code == contact.FAST
        else 1e-5
        if constants == "extreme" and code == contact.STANDARD
        else 1e-9
    )
    parting = 1 / n if n else 1e-2 if code == contact.FAST else 1e-5
    bounds = dict.fromkeys(invariants.NAMES, 0.0)
    bounds |= {
        "jump": 1e-12,
        "below the bed": 1e-12,
        "energy at impact": gain,
        "energy between": 1e-12,
        "energy of all": gain,
        "momentum": 1e-6,
        "parting": parting,
        "overlap": 1e-6 if flight else 1e-9,
        "in cushion": 1e-9,
        "rest": 1e-9,
    }
    return np.array([bounds[name] for name in invariants.NAMES])


def play(one):
    """A batch's ``Checked``."""
    here = np.ones(one.positions.shape[:2], bool)
    code = contact.parse_fidelity(one.fidelity)
    balls = one.positions, one.velocities, one.spins, here, one.aloft
    balls = balls if one.physics.flight else balls[:4]
    return invariants.play(balls, one.physics, one.table, code, MOST_EVENTS)


@dataclass
class Fuzzed:
    """The findings of a fuzz."""

    shots: int = 0
    seconds: float = 0.0
    worst: dict = field(default_factory=dict)
    """Fidelity -> worst figure of each invariant, in the order of ``invariants.NAMES``."""
    share: dict = field(default_factory=dict)
    """The same of each figure over what its own shot allows; where nothing is allowed, 0, or infinity if it fails."""
    events: dict = field(default_factory=dict)
    """Scene -> most events of a shot."""
    drawn: Counter = field(default_factory=Counter)
    """(scene, constants, fidelity) -> shots."""
    failures: list = field(default_factory=list)
    """(batch, index, what, figure, scene, constants, fidelity)"""


def compare_public(one, found, threads):
    """Whether ``simulate_batch`` gives the same bits. It also checks every layout."""
    places, velocities = one.states()
    batch = sn.simulate_batch(
        places,
        velocities,
        one.spins,
        one.table,
        one.physics,
        one.fidelity,
        threads=threads,
        max_events=MOST_EVENTS,
    )
    same = (
        (batch.positions == found.positions).all((1, 2))
        & (batch.duration == found.duration)
        & (batch.event_count == found.n_events)
    )
    return same & (batch.potted == found.potted).all(1) & (batch.on_table == found.on_table).all(1)


def fuzz(shots, seed, threads):
    """Play shots in batches of ``BATCH``, every ``PUBLIC``-th batch through ``simulate_batch`` as well."""
    out, started, count = Fuzzed(), time.perf_counter(), -(-shots // BATCH)

    def one(number):
        drawn = batch(seed, number)
        found = play(drawn)
        return number, drawn, found

    with ThreadPoolExecutor(threads) as pool, Progress("fuzz", count * BATCH, "shots") as progress:
        for first in range(0, count, 50):
            for number, drawn, found in pool.map(one, range(first, min(first + 50, count))):
                _take(out, number, drawn, found, threads)
            out.seconds = time.perf_counter() - started
            progress.at(out.shots, f"{len(out.failures)} failures")
    return out


def _take(out, number, drawn, found, threads):
    """Add a batch's findings."""
    ok = found.status == Status.OK
    labels = drawn.scene, drawn.constants, drawn.fidelity
    out.shots += len(ok)
    out.drawn[labels] += len(ok)
    worst = found.worst[ok].max(0, initial=-np.inf)
    out.worst[drawn.fidelity] = np.maximum(out.worst.get(drawn.fidelity, worst), worst)
    out.events[drawn.scene] = max(out.events.get(drawn.scene, 0), int(found.n_events[ok].max(initial=0)))
    out.failures += [
        (number, int(k), Status(found.status[k]).name, float(found.n_events[k]), *labels)
        for k in np.flatnonzero(~ok)
    ]
    limits = allowed(drawn.fidelity, drawn.constants, drawn.physics.flight)
    none = np.where(worst > 0.0, np.inf, 0.0)
    share = np.where(limits > 0.0, np.maximum(worst, 0.0) / np.maximum(limits, 1e-300), none)
    out.share[drawn.fidelity] = np.maximum(out.share.get(drawn.fidelity, 0.0), share)
    for k, c in np.argwhere((found.worst > limits) & ok[:, None]):
        out.failures.append((number, int(k), invariants.NAMES[c], float(found.worst[k, c]), *labels))
    if number % PUBLIC == 0 and ok.all():
        other = np.flatnonzero(~compare_public(drawn, found, threads))
        out.failures += [(number, int(k), "simulate_batch gives different bits", 1.0, *labels) for k in other]


def lines(found, seed):
    """The fuzz's table, and its failures by kind, each with a shot to replay."""
    most = ", ".join(f"{scene} {n:,}" for scene, n in found.events.items())
    text = [f"fuzz: {found.shots:,} shots in {found.seconds:.0f} s, seed {seed}; most events: {most}"]
    names = invariants.NAMES
    text.append(f"{'worst of':14}" + "".join(f"{name:>17}" for name in names))
    for fidelity in sorted(found.worst):
        text.append(
            f"{fidelity:14}"
            + "".join(f"{'-' if x == -np.inf else f'{x:.1e}':>17}" for x in found.worst[fidelity])
        )
    text.append(f"{'(standard may)':14}" + "".join(f"{x:>17.0e}" for x in allowed("standard")))
    kinds = Counter((what, constants, fidelity) for _, _, what, _, _, constants, fidelity in found.failures)
    text.append(f"{len(found.failures)} failures")
    for kind, n in kinds.most_common():
        number, index, _, figure, scene, _, _ = next(f for f in found.failures if (f[2], f[5], f[6]) == kind)
        what, constants, fidelity = kind
        text.append(
            f"  {n:>6} {what} ({fidelity}, physics {constants}), as --replay {seed} {number} {index} ({scene}, {figure:.3g})"
        )
    return text


def figures_of(found, seed):
    """The findings as JSON data."""
    worst, share = (
        {fidelity: dict(zip(invariants.NAMES, x.tolist(), strict=True)) for fidelity, x in of.items()}
        for of in (found.worst, found.share)
    )
    return {
        "shots": found.shots,
        "seconds": found.seconds,
        "seed": seed,
        "worst": worst,
        "share": share,
        "events": found.events,
        "failures": found.failures,
    }


def replay(seed, number, index):
    """Replay one shot of the fuzz and print the invariants that it breaks. True if none."""
    drawn = batch(seed, number)
    found = play(drawn)
    print(
        f"seed {seed}, batch {number}, shot {index}: {drawn.scene}, {drawn.fidelity}, table {drawn.table.name}, {drawn.physics}"
    )
    print(
        f"positions {drawn.positions[index].tolist()}\nvelocities {drawn.velocities[index].tolist()}\nspins {drawn.spins[index].tolist()}"
    )
    print(
        f"{Status(found.status[index]).name} after {found.n_events[index]} events, {found.duration[index]:.6f} s"
    )
    limits = allowed(drawn.fidelity, drawn.constants, drawn.physics.flight)
    broken = found.worst[index] > limits
    for name, x, limit, bad in zip(invariants.NAMES, found.worst[index], limits, broken, strict=True):
        print(
            f"  {name:18}{x:>12.3g}  allowed {limit:.1g}  {'FAIL' if bad else 'pass'}   {invariants.WHAT[name]}"
        )
    return found.status[index] == Status.OK and not broken.any()


def main():
    """Command line."""
    parser = Command("fuzz", __doc__, seed=0)
    parser.add_argument("--shots", type=at_least(1), default=1_000_000, help="number of shots [1000000]")
    parser.add_argument("--threads", type=at_least(1), default=2, help="[2]")
    parser.add_argument(
        "--replay", type=int, nargs=3, metavar=("SEED", "BATCH", "INDEX"), help="replay one shot"
    )
    options = parser.options()
    if options.replay:
        return int(not replay(*options.replay))
    found = fuzz(options.shots, options.seed, options.threads)
    print("\n".join(lines(found, options.seed)))
    save_figures(options, figures_of(found, options.seed))
    return int(bool(found.failures))


if __name__ == "__main__":
    run(main)
