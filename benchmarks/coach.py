"""Does the coach find a player's errors? This measures it on simulated players with known errors, 100 strokes each.

    python -m benchmarks.coach [--players 200] [--strokes 100] [--pool 100] [--levels club ...]
    [--seed 0] [--json FILE] [--out FOLDER]

``search_30`` chooses the pots in visits (single turns at the table) from opened tables; each player plays them with its
own errors. The coach then estimates the errors and their growth with speed from different knowledge: intended and played
stroke; intended pot and played stroke; intended stroke, and whether the pot was made. "drill" is the straight long blue from
the distance, out of six, at which the player's success is closest to 85 %. Printed are the means of estimate / truth (for a
growth, which may be 0, the growth itself), the root mean square error, half of the median width of the 95 % intervals, the
share of players whose estimate is within 15 %, and the share of intervals that hold the truth, with 95 % intervals of both
shares (Wilson). Tolerances of pots are simulated once for the pool.
"""

from dataclasses import asdict, replace
from math import atan2, hypot

import numpy as np

import snooker_env as sn
from snooker_env.advice import CueStroke, Recorded
from snooker_env.advice import errors as coaching
from snooker_env.advice.outcomes import wilson
from snooker_env.advice.practice import practice_of
from snooker_env.planning import Planner, Positions
from snooker_env.players import VISITS
from snooker_env.tasks.noise import LEVELS, POT_SPEED, Noise

from ._common.command import Command, at_least, run, save_figures

MEANS, COPIES = "search_30", 50
"""The player that chooses the strokes; repetitions of each drill pot's tolerance, each with different errors."""
BASE = LEVELS[coaching.BASE]
WHERE = {"cue": "free", "physics": "paper", "table": "match"}


def errors_like(times, speed_rel, aim_share=0.5, growth=BASE.growth):
    """Errors of direction ``times`` a professional's at 1.5 m/s, with this share of the variance from the aim."""
    whole = BASE.direction_deg() * times / hypot(1.0, growth * POT_SPEED)
    squirt = Noise(offset_mm=1.0).direction_deg(speed=0.0)
    aim, tip = whole * aim_share**0.5, whole * (1.0 - aim_share) ** 0.5 / squirt
    return replace(BASE.scale(times), aim_deg=aim, offset_mm=tip, speed_rel=speed_rel, growth=growth)


PLAYERS = {
    "club": LEVELS["club"],
    "professional": LEVELS["professional"],
    "growth 0": errors_like(3.0, 0.03, growth=0.0),
    "growth 0.5": errors_like(3.0, 0.03, growth=0.5),
    "growth 1": errors_like(3.0, 0.03, growth=1.0),
    "growth 2": errors_like(3.0, 0.03, growth=2.0),
    "straight but rash": errors_like(1.5, 0.06),
    "wild, all of it aim": errors_like(3.0, 0.015, 0.9),
}


def pool_of(n, seed):
    """n intended pots: positions, ``CueStroke``s, balls and pockets."""
    env = sn.SnookerVectorEnv(64, noise="professional", **VISITS)
    exact, noisy = Planner(env.options, noise="none"), Planner(env.options)
    player, pool, deal = sn.player(MEANS).at(env), [], 0
    while len(pool) < n:
        env.reset(seed=np.random.SeedSequence([seed, deal]).generate_state(64).tolist())
        at = Positions.of(env)
        for _ in range(8):
            every = np.arange(len(at))
            strokes = player.play(at, every + 64 * deal).values
            stops = exact.play_strokes(at, every, strokes)
            for k in every.tolist():
                ball = int(stops.first[k])
                if ball > 0 and stops.potted[k, ball] >= 0 and not stops.penalty[k]:
                    # a position renumbers its reds
                    ours = ball if ball > 15 else int(at.on_table[k, 1 : ball + 1].sum())
                    pool.append((at[k], strokes[k], ours, int(stops.potted[k, ball])))
            keys = np.random.default_rng((seed, deal, len(pool))).integers(0, 2**63, len(at))
            stops = noisy.play_strokes(at, every, strokes, keys.astype(np.uint64))
            at = stops.afterstates[stops.goes_on]
            if not len(at):
                break
        deal += 1
    env.close()
    return [Recorded(position=at, intended=intend(row), ball=b, pocket=p) for at, row, b, p in pool[:n]]


def intend(row):
    """Convert a row of five numbers to a ``CueStroke``."""
    speed, side, top, aim, elevation = row.tolist()
    shrink = max(1.0, hypot(side, top) / 0.5)
    return CueStroke(speed=speed, side=side / shrink, top=top / shrink, aim=aim, elevation=elevation)


def drill():
    """The straight long blue of the notebook: blue on its spot, cue ball ``distance`` behind it, to the top right pocket."""
    pocket = np.array((0.874, 1.769))
    to = pocket / hypot(*pocket)
    made = []
    for distance in np.geomspace(0.4, 1.2, 6):
        at = sn.Position(cue=tuple((-distance * to).tolist()), blue=(0.0, 0.0), on="blue")
        stroke = CueStroke(speed=2.0, aim=atan2(to[1], to[0]), top=-0.2)
        made.append(Recorded(position=at, intended=stroke, ball=19, pocket=3))
    return made


def play(pool, rows, noise, rng):
    """Play strokes of the pool with errors. Returns the executed strokes, (n, 5), and whether the pots were made."""
    planner = Planner({"noise": noise})
    at = Positions.of([pool[k].position for k in rows])
    strokes = np.stack([pool[k].intended.numbers() for k in rows])
    z = noise.draw_errors(rng, len(rows))
    stops = planner.play_strokes(at, np.arange(len(rows)), strokes, errors=z)
    balls, pockets = np.array([(pool[k].ball, pool[k].pocket) for k in rows]).T
    made = (stops.potted[np.arange(len(rows)), balls] == pockets) & (stops.penalty == 0)
    return execute(strokes, z, noise), made


def execute(strokes, z, noise):
    """The law of ``tasks.noise`` for strokes (n, 5) with a free cue: speed, side, top, aim of the cue, elevation. The tip
    stays, as in the simulator, on the disc without a miscue."""
    speed, side, top, aim, elevation = strokes.T
    more, tip = np.hypot(1.0, noise.growth * speed), noise.offset_mm * 1e-3 / sn.Physics().R
    squirt = [np.arctan2(*sn.strike(1.0, 0.0, s)[0][1::-1]) for s in side]
    tips = np.stack([side, top]) + z[:, 1:3].T * tip * more
    tips /= np.maximum(1.0, np.hypot(*tips) / sn.Physics().max_offset)
    return np.column_stack(
        [
            np.maximum(0.0, speed + z[:, 0] * np.hypot(noise.speed_abs, noise.speed_rel * speed)),
            *tips,
            aim - squirt + np.radians(noise.aim_deg) * more * z[:, 3],
            np.maximum(0.0, elevation + np.radians(noise.elevation_deg) * z[:, 4]),
        ]
    )


def tell(one, *, cue=None, made=None, intended=True):
    """A stroke of the pool with the knowledge about it after play."""
    names = ("speed", "side", "top", "aim", "elevation")
    return Recorded(
        position=one.position,
        intended=one.intended if intended else None,
        played=None if cue is None else dict(zip(names, cue.tolist(), strict=True)),
        ball=one.ball,
        pocket=one.pocket,
        potted=None if made is None else bool(made),
    )


def told_by_pots(chances, paces, made):
    """Estimate, interval and the truth's speed, from pots made or missed."""
    at = coaching.choose_speed(paces)
    log_l = coaching.weigh_outcomes(coaching.CalledPots([], chances, made, paces), at)
    weights = coaching.normalise(log_l + np.log(coaching.PRIOR)[:, None]).sum(axis=0)
    return coaching.estimate(weights, BASE.direction_deg(speed=at), len(made)), at


def level(name, noise, pool, chances, blues, args):
    """Estimates for players with one level's errors: {kind: (players, 4)}, with estimate, interval and truth of each."""
    rng = np.random.default_rng((args.seed, *name.encode()))
    kinds = ("meant, played", "pot, played", "pot made or not", "drill")
    out = {f"direction: {kind}": [] for kind in kinds} | {
        "growth: meant, played": [],
        "speed: meant, played": [],
    }
    blue = drill()
    paces, drilled = (np.array([one.intended.speed for one in rows]) for rows in (pool, blue))
    here = np.abs(coaching.SCALES - noise.direction_deg(speed=2.0) / BASE.direction_deg(speed=2.0)).argmin()
    rates = blues.reshape(len(blue), COPIES, -1).mean(axis=1)
    best = int(np.abs(rates[:, here] - 0.85).argmin())

    def keep(kind, one, truth):
        out[kind].append((one.value, one.low, one.high, truth))

    for _ in range(args.players):
        rows = rng.choice(len(pool), args.strokes)
        cues, made = play(pool, rows, noise, rng)
        for kind, intended in (("meant, played", True), ("pot, played", False)):
            strokes = [tell(pool[k], cue=cue, intended=intended) for k, cue in zip(rows, cues, strict=True)]
            errors, *_ = coaching.fit_errors(strokes, practice_of(coaching.BASE, WHERE), 0)
            keep(f"direction: {kind}", errors.direction, noise.direction_deg(speed=errors.at))
            if intended:
                keep("growth: meant, played", errors.growth, noise.growth)
                keep("speed: meant, played", errors.speed, noise.speed_rel)
        one, at = told_by_pots(chances[rows], paces[rows], made)
        keep("direction: pot made or not", one, noise.direction_deg(speed=at))
        same = np.full(args.strokes, best)
        _, made = play(blue, same, noise, rng)
        one, at = told_by_pots(rates[same], drilled[same], made)
        keep("direction: drill", one, noise.direction_deg(speed=at))
    return out


def summary(rows):
    """The figures of one kind of knowledge at one level: estimate / truth, or the estimate itself for growth, which may be 0."""
    value, low, high, truth = np.array(rows).T
    held, over = (low <= truth) & (truth <= high), truth if truth.all() else np.ones(len(truth))
    near = np.abs(value - truth) < 0.15 * over
    return {
        "mean": float(np.mean(value / over)),
        "rms_percent": float(100.0 * np.sqrt(np.mean(((value - truth) / over) ** 2))),
        "width_percent": float(100.0 * np.median((high - low) / (2.0 * over))),
        "within_15": [float(near.mean()), *wilson(int(near.sum()), len(near))],
        "covered": [float(held.mean()), *wilson(int(held.sum()), len(held))],
    }


def main():
    """Measure and print."""
    parser = Command("coach", __doc__, seed=0)
    add = parser.add_argument
    add("--players", type=at_least(2), default=200, help="players per level [200]")
    add("--strokes", type=at_least(5), default=100, help="strokes per player [100]")
    add("--pool", type=at_least(5), default=100, help="different strokes [100]")
    add("--levels", nargs="+", choices=PLAYERS, default=tuple(PLAYERS), help="levels of errors [all]")
    args = parser.options()
    pool, practice = pool_of(args.pool, args.seed), practice_of(coaching.BASE, WHERE)
    mark = [tell(one, made=True) for one in pool]
    chances = coaching.simulate_pots(mark, practice, args.seed).chances
    blue = [tell(one, made=True) for one in drill() for _ in range(COPIES)]
    blues = coaching.simulate_pots(blue, practice, args.seed).chances
    print(f"{args.players} players, {args.strokes} strokes each, of {len(pool)}\n")
    print(f"{'':50s}{'mean':>9s}{'rms':>7s}{'+-':>7s}  within 15 %        interval holds the truth")
    figures = {}
    for name in args.levels:
        noise = PLAYERS[name]
        kinds = level(name, noise, pool, chances, blues, args)
        figures[name] = {"noise": asdict(noise)} | {kind: summary(rows) for kind, rows in kinds.items()}
        print(f"{name}: {noise.direction_deg():.4f} deg, speed {100 * noise.speed_rel:.1f} %")
        for kind in kinds:
            one = figures[name][kind]
            shares = ["{:5.1f} % [{:.1f}, {:.1f}]".format(*(100 * x for x in one[key])) for key in SHARES]
            print(
                f"  {kind:48s}{one['mean']:9.4f}{one['rms_percent']:6.1f}%{one['width_percent']:6.0f}%  "
                f"{shares[0]:24s}{shares[1]}",
                flush=True,
            )
    save_figures(args, figures)
    return 0


SHARES = ("within_15", "covered")

if __name__ == "__main__":
    run(main)
