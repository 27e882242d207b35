"""Learn what strokes are worth, without simulating them when it plays: the network of ``stroke_value``.

    python -m agents.learn_strokes --out runs/strokes [--rounds 8]

Each round plays visits, under errors from ``SCALES[0]`` to ``SCALES[1]`` times a professional's, with what the rounds before
have learned (the first one half with the planner), and in each
position that comes about tries some of the strokes that the player looks at, each under ``ERRORS`` execution errors. What
they bring and what the planner's value says of what they leave is their worth: a network is fitted to it, on the
positions of its own visits (DAgger; Ross, Gordon & Bagnell 2011). After each round OUT holds its data and its weights:
the same command goes on from there. After the last one a network is fitted for longer, and written to OUT/strokes.npz, and
with --export into the package.
"""

import io
import sys
import time
from itertools import pairwise
from pathlib import Path

from commands.lifecycle import command, needs, parser_of

with needs("agents.learn_strokes"):
    import numpy as np
    import torch
    from torch import nn

    import snooker_env as sn
    from agents.cluster.keep import packed
    from commands.files import writable, write_atomic
    from commands.noise_option import noise_option
    from snooker_env.checks import integer, refuse
    from snooker_env.planning import Planner, Positions
    from snooker_env.planning.learned.stroke_value import LOOKS, POINTS, SAMPLES, SIZE, StrokeValue
    from snooker_env.players import VISITS, Strokes
    from snooker_env.players.player import placed
    from snooker_env.players.search import SearchPlayer
    from snooker_env.players.stroke_value import StrokeValuePlayer
    from snooker_env.players.weights import FOLDER, STROKES, learned_strokes

TABLES, STROKES_EACH, PARTS = 1024, 8, 8
"""Tables of a round, strokes that are played on each, and parts with errors of their own."""
SCALES = 0.7, 4.5
"""Errors of the visits, times those of a professional: half of them below 1.12."""
BEST, OTHERS, ERRORS = 10, 10, 4
"""Strokes of a position that are tried: those that seem best, others at random; and execution errors of each."""
EXPLORE, AMONG = 0.1, 8
"""Share of strokes that are not the one that seems best, but one of the ``AMONG`` best."""
WIDTHS, BATCH, RATE, DECAY = (128, 64), 512, 2e-3, 1e-4
PASSES, LAST_PASSES = 15, 60
"""Over the positions after each round, and after the last one."""
COMPARED = 2.0
"""Weight of what the strokes of a position are worth beside each other; that of the worth itself is 1."""
HELD = 10
"""One table in so many is kept from the fit, to say how good it is."""
FIRST_SEED = 30_000_000
"""The seed of the first table."""


class StrokeNetwork(nn.Sequential):
    """What is seen of strokes (..., SIZE) -> what they are worth (..., 1), in units of ``POINTS``."""

    def __init__(self):
        parts = [nn.Linear(a, b) for a, b in pairwise((SIZE, *WIDTHS, 1))]
        super().__init__(*[part for one in parts for part in (one, nn.ReLU())][:-1])

    def layers(self, mean, deviation):
        """Weight (out, in) and bias (out,) of each layer for what is seen as it is; it was trained on what is seen less
        ``mean``, over ``deviation``."""
        linear = [one for one in self if isinstance(one, nn.Linear)]
        made = [(one.weight.detach().numpy().copy(), one.bias.detach().numpy().copy()) for one in linear]
        weight, bias = made[0]
        made[0] = weight / deviation, bias - (weight / deviation) @ mean
        return made


def fitted(seen, worth, table, seed, passes):
    """The layers of a network fitted to ``worth`` (n, k) points of strokes seen as (n, k, SIZE) on the tables with these
    seeds (n,), and figures of the tables kept from the fit."""
    torch.manual_seed(seed)
    rng, held = np.random.default_rng(seed), table % HELD == HELD - 1
    mean, deviation = seen[~held].mean((0, 1), np.float64), seen[~held].std((0, 1), np.float64) + 1e-3
    scaled = torch.from_numpy(((seen - mean) / deviation).astype(np.float32))
    wanted, network = torch.from_numpy((worth / POINTS).astype(np.float32)), StrokeNetwork()
    used = np.flatnonzero(~held)
    batch = min(BATCH, len(used))
    optimiser = torch.optim.AdamW(network.parameters(), RATE, weight_decay=DECAY)
    steps = max(20, passes * (len(used) // batch))
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, RATE, total_steps=steps)
    for _ in range(passes):
        order = torch.from_numpy(rng.permutation(used))
        for k in range(0, batch * (len(used) // batch), batch):
            off = network(scaled[order[k : k + batch]])[..., 0] - wanted[order[k : k + batch]]
            compared = off - off.mean(dim=1, keepdim=True)
            loss = (off**2).mean() + COMPARED * (compared**2).mean()
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
            schedule.step()
    with torch.no_grad():
        said, true = network(scaled[held])[..., 0].numpy(), wanted[held].numpy()
    beside = [one - one.mean(axis=1, keepdims=True) for one in (said, true)]
    policy = np.where(np.arange(seen.shape[1]) == seen[held][..., 0].argmax(axis=1)[:, None], true, 0.0).sum(
        axis=1
    )
    chosen = np.take_along_axis(true, said.argmax(axis=1)[:, None], 1)[:, 0]
    figures = {
        "positions": len(seen),
        "explained": float(1.0 - ((beside[0] - beside[1]) ** 2).mean() / (beside[1] ** 2).mean()),
        "worth_chosen": POINTS * float(chosen.mean()),
        "worth_of_policy": POINTS * float(policy.mean()),
    }
    return network.layers(mean, deviation), figures


def played(layers, options, seeds, rng):
    """Visits from the tables ``seeds``: what is seen of the strokes tried, float16 (n, k, SIZE), their worth [points],
    float32 (n, k), and the seeds of the tables on which the visits began (n,)."""
    n, env = len(seeds), sn.SnookerVectorEnv(len(seeds), layout="opened", **VISITS, **options)
    env.reset(seed=seeds)
    values: StrokeValue = StrokeValuePlayer(layers or ()).at(env).values
    plain, planner = sn.player("ghost_ball").at(env), Planner(env)
    expert: SearchPlayer = sn.player("planner_60").at(env)  # type: ignore[assignment]
    values.value.threads = planner.threads
    judge = expert.search.value
    kept_seen, kept_worth, kept_table, tried = [], [], [], BEST + OTHERS
    for _ in range(STROKES_EACH):
        at, keys = Positions.of(env), rng.integers(2**32, size=n)
        live = np.flatnonzero(~at.over)
        visits, places = placed(at[live], keys[live])
        found = values.candidates(visits, LOOKS, keys[live])
        scores, every = values.scores(found.seen), np.arange(len(found.rows))[:, None]
        order = np.argsort(-scores, axis=1, kind="stable")
        rest = rng.permuted(order[:, BEST:], axis=1)[:, :OTHERS]
        picks = np.concatenate([order[:, :BEST], rest], axis=1)
        rows = np.repeat(found.rows, tried * ERRORS)
        trials = np.repeat(found.strokes[every, picks].reshape(-1, 5), ERRORS, axis=0)
        points, goes_on, left, _ = planner.play(
            visits, rows, strokes=trials, errors=rng.standard_normal((len(rows), 5))
        )
        worth, on = points.astype(np.float64), np.flatnonzero(goes_on)
        worth[on] += judge(left[on])
        kept_seen.append(found.seen[every, picks].astype(np.float16))
        kept_worth.append(worth.reshape(-1, tried, ERRORS).mean(axis=2).astype(np.float32))
        kept_table.append(np.asarray(seeds)[live[found.rows]])
        chosen = np.where(rng.random(len(scores)) < EXPLORE, rng.integers(AMONG, size=len(scores)), 0)
        strokes = plain.play(visits, keys[live]).values
        strokes[found.rows] = found.strokes[every[:, 0], order[every[:, 0], chosen]]
        if layers is None:  # nothing is learned yet: half of the tables show where a good player comes
            half = np.flatnonzero(np.arange(len(live)) % 2)
            strokes[half] = expert.play(visits[half], keys[live][half]).values
        actions = np.zeros((n, env.options.rules.actions.size))
        actions[live] = Strokes(strokes, places).actions(env.options, at[live])
        env.step(actions)
    env.close()
    return tuple(map(np.concatenate, (kept_seen, kept_worth, kept_table)))


def arrays_of(layers):
    """The arrays of a file that ``weights.learned_strokes`` reads."""
    made = {f"strokes/{k}/weight": weight.astype(np.float32) for k, (weight, _) in enumerate(layers)}
    return made | {f"strokes/{k}/bias": bias.astype(np.float32) for k, (_, bias) in enumerate(layers)}


def _kept_round(file):
    with np.load(io.BytesIO(file.read_bytes()), allow_pickle=False) as arrays:
        return {name: arrays[name] for name in arrays.files}


def _fitted_to(rounds, seed, passes):
    both = {name: np.concatenate([one[name] for one in rounds]) for name in ("seen", "worth", "table")}
    return fitted(both["seen"].astype(np.float32), both["worth"], both["table"], seed, passes)


def told(what, figures, began):
    """Print the figures of a fit."""
    line = "  ".join(f"{name} {value:.4g}" for name, value in figures.items())
    print(f"{what}: {line}  {time.time() - began:.0f} s", flush=True)


@command("agents.learn_strokes")
def main(argv=None):
    """Play, fit, write. Exit code 0."""
    p = parser_of("python -m agents.learn_strokes", __doc__)
    p.add_argument("--out", type=Path, required=True, help="folder of rounds and weights")
    p.add_argument("--rounds", type=int, default=8, help="[8]")
    p.add_argument("--tables", type=int, default=TABLES, help=f"tables of a round [{TABLES}]")
    p.add_argument("--cue", default="real", choices=("real", "free"), help="[real]")
    p.add_argument("--seed", type=int, default=0, help="[0]")
    p.add_argument("--export", action="store_true", help="write the weights into the package, too")
    args = p.parse_args(sys.argv[1:] if argv is None else argv)
    try:
        integer("rounds", args.rounds, 1, 99)
        integer("tables", args.tables, PARTS, 100_000)
        integer("seed", args.seed, 0, 80)
        writable("out", args.out / STROKES)
    except ValueError as error:
        p.error(str(error))
    sn.warmup()
    torch.set_num_threads(1)  # sums do not depend on the number of cores
    layers, rounds, asked = None, [], [args.tables, args.seed, args.cue, LOOKS, SAMPLES, SIZE, SCALES]
    for k in range(args.rounds):
        data, weights, began = args.out / f"round-{k}.npz", args.out / f"strokes-{k}.npz", time.time()
        if data.is_file():
            rows = _kept_round(data)
            if rows.pop("asked").tolist() != list(map(str, asked)):
                p.error(
                    str(
                        refuse(
                            "out",
                            str(args.out),
                            "must hold rounds of this version with the same --tables, --seed and --cue",
                        )
                    )
                )
        else:
            first = FIRST_SEED + 10_000_000 * args.seed + 100_000 * k
            rng, parts = np.random.default_rng([args.seed, k]), []
            shares = (np.arange(PARTS) + rng.random(PARTS)) / PARTS
            for share, seeds in zip(
                shares, np.array_split(np.arange(first, first + args.tables), PARTS), strict=True
            ):
                scale = SCALES[0] * (SCALES[1] / SCALES[0]) ** share**2
                options = {"noise": noise_option(f"professional*{scale}"), "cue": args.cue}
                parts.append(played(layers, options, seeds.tolist(), rng))
            seen, worth, table = map(np.concatenate, zip(*parts, strict=True))
            rows = {"seen": seen, "worth": worth, "table": table}
            write_atomic(data, packed(rows | {"asked": np.array(list(map(str, asked)))}))
        rounds.append(rows)
        if weights.is_file():
            layers = learned_strokes(weights)
            continue
        layers, figures = _fitted_to(rounds, args.seed + k, PASSES)
        write_atomic(weights, packed(arrays_of(layers)))
        told(f"round {k}", figures, began)
    began = time.time()
    layers, figures = _fitted_to(rounds, args.seed, LAST_PASSES)
    told("at last", figures, began)
    content = packed(arrays_of(layers))
    write_atomic(args.out / STROKES, content)
    if args.export:
        write_atomic(FOLDER / STROKES, content)
    return 0
