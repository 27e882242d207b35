"""What do balls that fly change in play? The same strokes with and without ``Physics.flight``, by cue speed.

    python -m benchmarks.flight [--tables 400] [--shots 600] [--json FILE] [--out FOLDER]

Strokes at direct pots of opened tables, as the planner proposes them, with a real cue and a professional's errors; and
break-offs with every speed and any side at the end reds of the pack, level as the cue allows. Both ways play the same
stroke with the same errors. The errors alone, a second draw of them, give the scale.

Then the time: shots of ``benchmarks.scene``, each way in turn, by shots in which no ball flies and shots in which one does.
"""

import itertools

import numpy as np

import snooker_env as sn
from snooker_env.game.balls import CUE, SPOTS
from snooker_env.geometry import BALL_RADIUS
from snooker_env.physics.impact import contact
from snooker_env.planning import Planner, Positions, VisitJudge, at_pots

from ._common.command import Command, at_least, run, save_json
from .scene.models import SCENES
from .speed.clock import Way, time_ways

SPEEDS = (0.2, 1.0, 2.0, 3.0, 4.0, 5.5, 7.0)
"""Edges of the ranges of cue speeds [m/s]."""
EACH = 12
"""Strokes of a table."""


def compared(flat, flying, others):
    """Of the same strokes: shares that score, go off the table, score one way only, and how far apart the cue ball stops."""
    on = lambda one: one.potted[:, CUE] == -1  # noqa: E731
    apart = lambda a, b: 1e3 * np.hypot(*(a.places - b.places)[on(a) & on(b), CUE].T)  # noqa: E731
    made, flown = flat.points > 0, flying.points > 0
    shift = apart(flat, flying)
    return {
        "strokes": len(made),
        "pots": float(made.mean()),
        "pots_flying": float(flown.mean()),
        "other_end": float((made != flown).mean()),
        "other_end_by_errors": float((made != (others.points > 0)).mean()),
        "shift_mm": float(np.median(shift)),
        "shift_by_errors_mm": float(np.median(apart(flat, others))),
        "off": float((flying.potted == -2).any(axis=1).mean()),
        "cue_off": float((flying.potted[:, CUE] == -2).mean()),
    }


def table_of(flat, flying, others, speed):
    """``compared`` for each range of speeds, and for all."""
    rows = {}
    for low, high in (*itertools.pairwise(SPEEDS), (SPEEDS[0], SPEEDS[-1])):
        some = (low <= speed) & (speed <= high)
        if some.any():
            rows[f"{low:g} to {high:g}"] = compared(*(_some(one, some) for one in (flat, flying, others)))
    return rows


def _some(stops, which):
    return stops._replace(**{name: getattr(stops, name)[which] for name in ("places", "potted", "points")})


def played(at, rows, strokes, physics, errors, more):
    """The strokes without flight, with it, and without it under other errors."""
    options = {"cue": "real", "noise": "professional", "elevation": True}
    flat, flying = (
        Planner({**options, "physics": {"preset": physics, "flight": flight}}) for flight in (False, True)
    )
    return (
        flat.play_strokes(at, rows, strokes, errors=errors),
        flying.play_strokes(at, rows, strokes, errors=errors),
        flat.play_strokes(at, rows, strokes, errors=more),
    )


def pots(tables, physics, rng, seed):
    """Strokes at pots: positions, rows, strokes."""
    env = sn.SnookerVectorEnv(tables, layout="opened", physics=physics, cue="real", noise="professional")
    env.reset(seed=list(range(seed, seed + tables)))
    at = Positions.of(env)
    strokes = at_pots(VisitJudge(env), at, EACH, rng.integers(2**32, size=tables)).strokes
    env.close()
    rows = np.repeat(np.arange(tables), EACH)
    flat = strokes.reshape(-1, 5)
    there = flat[:, 0] > 0.0
    return at, rows[there], flat[there]


def break_offs(n, rng):
    """n break-offs: the cue ball in the D, at an end red of the pack, full to thin."""
    side = rng.choice([-1.0, 1.0], n)
    cue = np.column_stack([side * rng.uniform(0.06, 0.22, n), np.full(n, SPOTS[0, 1] - 0.02)])
    yellow, green, brown, blue, pink, black = (tuple(spot) for spot in SPOTS[16:22].tolist())
    positions = [
        sn.Position(
            cue=tuple(place),
            reds=SPOTS[1:16].tolist(),
            yellow=yellow,
            green=green,
            brown=brown,
            blue=blue,
            pink=pink,
            black=black,
            on="red",
        )
        for place in cue.tolist()
    ]
    red = SPOTS[np.where(side > 0, 15, 11)]
    way = red - cue
    aim = np.arctan2(way[:, 1], way[:, 0]) + rng.uniform(-2, 2, n) * BALL_RADIUS / np.hypot(*way.T)
    strokes = np.column_stack(
        [rng.uniform(2.0, 7.0, n), rng.uniform(-0.3, 0.3, n), rng.uniform(-0.3, 0.3, n), aim, np.zeros(n)]
    )
    return Positions.of(positions), np.arange(n), strokes


def shown(title, rows):
    """Print one table."""
    print(f"\n{title}")
    print(
        "  cue speed [m/s]  strokes    pots   flying  other end  (errors)   cue ball off by [mm]  (errors)   off the table  cue ball"
    )
    for name, row in rows.items():
        print(
            f"  {name:15s} {row['strokes']:8,d} {row['pots']:7.1%} {row['pots_flying']:8.1%} {row['other_end']:10.1%}"
            f" {row['other_end_by_errors']:9.1%} {row['shift_mm']:20.1f} {row['shift_by_errors_mm']:11.1f}"
            f" {row['off']:14.2%} {row['cue_off']:9.2%}"
        )


TIMED = ("full tables", "cut pots, soft", "cut pots, firm", "cushion first")
IN_THE_AIR = (sn.EventKind.LAND, sn.EventKind.RAIL, sn.EventKind.OFF)


def times(n, physics, seed):
    """Time of shots with flight over that without, by whether a ball flies."""
    code, found = contact.parse_fidelity("standard"), {}
    ways = {flight: sn.Physics.preset(physics, flight=flight) for flight in (False, True)}
    print("\nTime of a shot with flight over without      none flies    one flies    share that flies")
    for scene in TIMED:
        shots = SCENES[scene](n, ways[False], seed)
        v, w = shots.struck(seed=seed + 1)
        log = sn.simulate_batch(shots.positions, v, w, physics=ways[True], events=True).events or []
        flies = np.array([np.isin(events["kind"], IN_THE_AIR).any() for events in log])
        took = time_ways(
            {str(flight): Way(constants, code) for flight, constants in ways.items()},
            (shots.positions, v, w),
            7,
        )
        without, with_it = took["False"].min(0), took["True"].min(0)
        ratio = [float(with_it[which].sum() / without[which].sum()) for which in (~flies, flies)]
        found[scene] = {"none flies": ratio[0], "one flies": ratio[1], "share": float(flies.mean())}
        print(f"  {scene:40s} {ratio[0]:12.3f} {ratio[1]:12.3f} {flies.mean():16.0%}")
    return found


def main():
    """Command line."""
    parser = Command("flight", __doc__, seed=0)
    parser.add_argument(
        "--tables", type=at_least(2), default=400, help="opened tables, and break-offs over ten [400]"
    )
    parser.add_argument("--shots", type=at_least(20), default=600, help="shots timed in each scene [600]")
    parser.add_argument("--physics", default="match", choices=("match", "paper"), help="[match]")
    options = parser.options()
    rng, found = np.random.default_rng(options.seed), {}
    for title, scene in (
        ("Strokes at pots", pots(options.tables, options.physics, rng, 80_000_000 + options.seed)),
        ("Break-offs", break_offs(10 * options.tables, rng)),
    ):
        errors, more = (rng.standard_normal((len(scene[1]), 5)) for _ in range(2))
        found[title] = table_of(*played(*scene, options.physics, errors, more), scene[2][:, 0])
        shown(title, found[title])
    timed = times(options.shots, options.physics, options.seed)
    figures = {"physics": options.physics, "tables": options.tables, "scenes": found, "times": timed}
    save_json(options.json, figures)


if __name__ == "__main__":
    run(main)
