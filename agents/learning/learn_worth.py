"""Learn what positions of frames are worth, by self-play: the worth of the ``tactician``.

    python -m agents.learn_worth --out runs/worth [--rounds 2] [--chance] [--ray local]

Each round plays frames under errors from ``SCALES[0]`` to ``SCALES[1]`` times a professional's, with what the rounds
before have learned, half of them against oneself, the others against a league: past selves and the planner of visits.
Each position, and what its best strokes may leave, is judged by search (``frame_self_play``). A network is then fitted to
the last rounds, and the chance to win to their frames between equals. After each round OUT holds its data and its
weights: the same command goes on from there. The last round's weights are written to OUT/worth.npz, and with --export
into the package. With --chance the network stays that of the package: all frames are between equals, no position is
judged, and the chance to win alone is fitted.
"""

import sys
import time
from pathlib import Path

from commands.lifecycle import command, needs, parser_of

with needs("agents.learn_worth"):
    import numpy as np

    import snooker_env
    from agents.cluster.keep import keep_arrays, kept_arrays, packed
    from agents.cluster.ray_cluster import add_ray, checked_ray, place
    from commands.files import writable, write_atomic
    from snooker_env.checks import integer, refuse
    from snooker_env.planning.frame_search import LEAST
    from snooker_env.planning.learned.dense_layers import Layers
    from snooker_env.planning.learned.frame_features import errors_seen
    from snooker_env.planning.learned.learned_worth import worth_of
    from snooker_env.players.weights import FOLDER, WORTH, learned_worth, worth_in

    from .frame_worth import calibration, fitted, fitted_chance, targets

SCALES = 0.6, 4.5
"""Errors of the frames played, times those of a professional, evenly spread in the logarithm."""
FRAME = {"cue": "real", "miss": "clear_path", "max_strokes": 200}
"""Options of the frames."""
TABLES = 16
"""Frames that one part plays side by side."""
EXPLORE = 0.08
"""Share of strokes that are not the best ones found, so that positions after worse ones are seen, too."""
KEEP, PASSES = 4, 15
"""Rounds whose positions a network is fitted to, and passes over them."""
VISITORS = ("planner",)
"""Players of the league that are no past selves."""
HELD = 8
"""One frame in so many is kept from the fit, to say how good it is."""


def drawn_parts(seed, k, parts, past):
    """The arguments of the parts of round k; ``past``: layers and chance of each round before."""
    rng = np.random.default_rng([seed, k])
    shares = (np.arange(parts) + rng.random(parts)) / parts
    scales = SCALES[0] * (SCALES[1] / SCALES[0]) ** shares
    first, league = 10_000_000 * (seed + 1) + 100_000 * k, [*past, *VISITORS]
    others = [league[rng.integers(len(league))] if i % 2 else None for i in range(parts)]
    return [
        {"scale": float(scale), "seed": first + TABLES * i, "many": TABLES, "other": other}
        for i, (scale, other) in enumerate(zip(scales, others, strict=True))
    ]


def played(where, shared, many):
    """One round: the rows of all parts, with targets; "held" (m,) says which are kept from the fit."""
    parts = where.map("agents.learning.frame_self_play:frames", shared, many)
    for j, part in enumerate(parts):
        part["target"] = targets(part)
        part["held"] = (part["frame"] + j) % HELD == 0
        part["unit"] = part.pop("frame") + TABLES * j
    kept = (
        "seen",
        "hand",
        "target",
        "held",
        "unit",
        "striker",
        "lead",
        "left",
        "last",
        "won",
        "decided",
        "equals",
    )
    rows = {name: np.concatenate([part[name] for part in parts]) for name in kept}
    for name in ("seen", "hand"):
        rows[name] = rows[name].astype(np.float16)
    return rows


def learned(rounds, seed, layers=None):
    """Layers, if they are None, and chance fitted to the rows of some rounds, and figures of the frames kept from the fit."""
    both = {name: np.concatenate([one[name] for one in rounds]) for name in rounds[0]}
    used = ~both["held"]
    in_hand = used & (both["seen"] != both["hand"]).any(axis=1)
    seen = np.concatenate([both["seen"][used], both["hand"][in_hand]]).astype(np.float32)
    wanted = np.concatenate([both["target"][used], both["target"][in_hand]])
    layers = fitted(seen, wanted, seed, PASSES) if layers is None else layers
    said = worth_of(Layers(layers, "relu"), both["seen"].astype(np.float32))
    # a frame that was stopped was won by nobody; nor is it known what follows positions beside the frames, or what an
    # equal would have made of it
    ended, held = both["decided"] & both["equals"], both["held"]
    for some, what in ((used & ended, "fitted"), (held & ended, "kept from the fit")):
        if not some.any():
            raise refuse(
                "frames", len(np.unique(both["unit"])), f"must be more: of those {what} none has ended"
            )
    known = both["lead"], said.astype(np.float64), both["left"], both["last"], errors_seen(both["seen"])
    chance = fitted_chance(*(part[used & ended] for part in (*known, both["won"])))
    wins, won = chance(*known)[held & ended], both["won"][held & ended]
    rmse = lambda worth: float(np.sqrt(np.mean((worth - both["target"])[held] ** 2)))  # noqa: E731
    figures = {
        "positions": len(wanted),
        "rmse": rmse(said),
        "rmse_of_value": rmse(worth_of(None, both["seen"].astype(np.float32))),
        "correlation": float(np.corrcoef(said[held], both["target"][held])[0, 1]),
        "chance_error": calibration(wins, won)[1],
        "stopped": float(1.0 - both["decided"][both["striker"] >= 0].mean()),
    }
    return layers, chance, figures


def arrays_of(layers, chance):
    """The arrays of a file that ``weights.worth_in`` reads."""
    made = {f"worth/{k}/weight": weight for k, (weight, _) in enumerate(layers)}
    made |= {f"worth/{k}/bias": bias for k, (_, bias) in enumerate(layers)}
    return made | {"chance": np.array(chance)}


@command("agents.learn_worth")
def main(argv=None):
    """Play, fit, write. Exit code 0."""
    p = parser_of("python -m agents.learn_worth", __doc__)
    p.add_argument("--out", type=Path, required=True, help="folder of rounds and weights")
    p.add_argument("--rounds", type=int, default=2, help="[2]")
    p.add_argument("--frames", type=int, default=384, help=f"frames of a round, a multiple of {TABLES} [384]")
    p.add_argument("--budget", type=int, default=120, help="average shots of a decision [120]")
    p.add_argument("--seed", type=int, default=0, help="[0]")
    p.add_argument("--export", action="store_true", help="write the weights into the package, too")
    p.add_argument("--chance", action="store_true", help="fit the chance to win alone")
    add_ray(p)
    args = p.parse_args(sys.argv[1:] if argv is None else argv)
    try:
        integer("rounds", args.rounds, 1, 90)
        integer("frames", args.frames, TABLES, 100_000)
        integer("seed", args.seed, 0, 80)  # more would meet the tables of agents.calibrate
        integer("budget", args.budget, LEAST, 10**6)
        if args.frames % TABLES:
            raise refuse("frames", args.frames, f"must be a multiple of {TABLES}")
        checked_ray(args.ray)
        writable("out", args.out / "worth.npz")
    except ValueError as error:
        p.error(str(error))

    def kept(file):
        try:
            return kept_arrays(file)
        except ValueError as error:
            p.error(str(error))

    snooker_env.warmup()
    layers, chance = learned_worth() if args.chance else (None, None)
    given, past, rounds = layers, [], []
    asked = [args.frames, args.budget, args.seed, args.chance]
    with place(args.ray) as where:
        for k in range(args.rounds):
            rows_file, weights_file = args.out / f"round-{k}.npz", args.out / f"worth-{k}.npz"
            shared = {"options": FRAME, "layers": layers, "chance": chance, "explore": EXPLORE}
            shared, began = shared | {"budget": args.budget, "replies": not args.chance}, time.time()
            if rows_file.is_file():
                rows = kept(rows_file)
                if rows.pop("asked").tolist() != asked or "last" not in rows:
                    wanted = "must hold rounds of this version with the same --frames, --budget and --seed"
                    p.error(str(refuse("out", str(args.out), wanted)))
            else:
                parts = drawn_parts(args.seed, k, args.frames // TABLES, past)
                parts = [one | {"other": None} for one in parts] if args.chance else parts
                rows = played(where, shared, parts)
                keep_arrays(rows_file, rows | {"asked": np.array(asked)})
            rounds = [*rounds, rows][-KEEP:]
            if weights_file.is_file():
                layers, chance = worth_in(kept(weights_file))
                past.append((layers, chance))
                continue
            try:
                layers, chance, figures = learned(rounds, args.seed + k, given)
            except ValueError as error:
                p.error(str(error))
            past.append((layers, chance))
            keep_arrays(weights_file, arrays_of(layers, chance))
            frames = len(np.unique(rows["unit"]))
            told = "  ".join(f"{name} {value:.4g}" for name, value in figures.items())
            spent = (
                f"{time.time() - began:.0f} s, {(rows['striker'] >= 0).sum() / frames:.0f} strokes a frame"
            )
            law = " ".join(f"{number:.3g}" for number in chance)
            print(f"round {k}: {told}  chance {law}  {spent}", flush=True)
    content = packed(arrays_of(layers, chance))
    write_atomic(args.out / "worth.npz", content)
    if args.export:
        write_atomic(FOLDER / WORTH, content)
    return 0
