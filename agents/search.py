"""How are positions searched to learn from? A search plays visits, and what it thinks of each position is kept.

    python -m agents.search --positions 10000 --out runs/searched

Kept are the strokes that met most noise samples, best first, with their scores. Each part is a file, written whole; the same
command goes on after an interruption, and with other options it is refused. ``read`` gives the data as arrays.
"""

import sys
from pathlib import Path

from commands.lifecycle import command, needs, parser_of

with needs("agents.search"):
    import numpy as np

    import snooker_env
    from commands.files import keep_arrays, kept_arrays
    from commands.physics_option import physics_option
    from snooker_env import SnookerVectorEnv
    from snooker_env.checks import integer, parse_fidelity, refuse
    from snooker_env.game.layouts import plan_of
    from snooker_env.planning import Positions
    from snooker_env.players import VISITS, Strokes, decision_seeds
    from snooker_env.players.search import SearchPlayer
    from snooker_env.progress import Progress
    from snooker_env.tasks import Noise

    from .cluster import digest_of
    from .evaluation.entrants import Entrant
    from .evaluation.travel import sent

TABLES, ROUNDS = 16, 8
"""Tables of a part and decisions on each: a part has the product of them as positions."""
KEPT = 10
"""The most strokes of a decision that are kept, best first; where there are fewer, the rest is NaN."""
CONDITION = "layout", "noise", "fidelity", "physics"


def checked(args):
    """The agent of the command line. Raises ValueError."""
    integer("positions", args.positions, 1, 10**9)
    integer("seed", args.seed, 0, 2**32 - 1)
    if plan_of(args.layout) and args.layout == "held_out":
        raise refuse("layout", args.layout, "must be another: the held-out tables are kept for evaluation")
    Noise.of(args.noise)
    parse_fidelity(args.fidelity)
    physics_option(args.physics)
    agent = Entrant.of(args.agent)
    if len(agent.runs) > 1 or not isinstance(agent.player(0), SearchPlayer):
        wanted = "must be one player that searches: search, planner, with _SHOTS and @MODEL if you wish"
        raise refuse("agent", args.agent, wanted)
    return agent


def searched(player, options, seed, first):
    """What ``player`` thinks of the positions of its visits on the tables from number ``first`` on.

    Returns of n positions "positions" float64 (n, 22, 2) [m], "on_table" bool (n, 22) and "game" int64, as of
    ``Positions``; "strokes" float32 (n, KEPT, 5), as ``Strokes.values``; "scores" float32 (n, KEPT) [points].
    """
    tables = SnookerVectorEnv(TABLES, autoreset_mode="Disabled", **VISITS, **options)
    player = player.at(tables)
    tables.reset(seed=np.random.SeedSequence([seed, first]).generate_state(TABLES).tolist())
    rounds = []
    for decision in range(ROUNDS):
        at = Positions.of(tables)
        ranked = player.rank(at, decision_seeds(seed, first + np.arange(TABLES), decision))
        strokes = np.full((TABLES, KEPT, 5), np.nan, np.float32)
        scores = strokes[..., 0].copy()
        for k, one in enumerate(ranked):
            m = min(KEPT, len(one.strokes))
            strokes[k, :m], scores[k, :m] = one.strokes.values[:m], one.scores[:m]
        seen = {"positions": at.positions, "on_table": at.on_table, "game": at.game}
        rounds.append(seen | {"strokes": strokes, "scores": scores})
        played = Strokes.join([one.strokes[:1] for one in ranked]).actions(tables.options, at)
        _, _, ended, stopped, _ = tables.step(played.astype(np.float32))
        if (done := ended | stopped).any():
            tables.reset(seed=[None] * TABLES, options={"reset_mask": done})
    tables.close()
    return {name: np.concatenate([one[name] for one in rounds]) for name in rounds[0]}


def read(folder):
    """The data in a folder: arrays as of ``searched``. Raises ValueError."""
    files = sorted(Path(folder).glob("part-*.npz"))
    if not files:
        raise refuse("out", str(folder), "must hold data of agents.search")
    parts = [kept_arrays(file) for file in files]
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0] if name != "asked"}


@command("agents.search")
def main(argv=None):
    """Check, search, write. Exit code 0; 130: interrupted, what was searched is kept."""
    p = parser_of("python -m agents.search", __doc__)
    what = "who searches: search_2000, planner_500, planner@MODEL [search_2000]"
    p.add_argument("--agent", default="search_2000", help=what)
    what = f"rounded up to whole parts of {TABLES * ROUNDS}"
    p.add_argument("--positions", type=int, required=True, metavar="N", help=what)
    p.add_argument("--out", type=Path, required=True, help="a folder for these data alone")
    p.add_argument("--layout", default="opened", help="layout of the tables [opened]")
    p.add_argument("--noise", default="professional", help="level of execution noise [professional]")
    p.add_argument("--fidelity", default="standard", help="fast, standard, reference or euler:N [standard]")
    what = "paper, match, or one with changes: paper,mu_bb=marlow [paper]"
    p.add_argument("--physics", default="paper", help=what)
    p.add_argument("--seed", type=int, default=0, help="seed of tables and search [0]")
    args = p.parse_args(sys.argv[1:] if argv is None else argv)
    try:
        agent = checked(args)
        condition = {name: getattr(args, name) for name in CONDITION}
        asked = digest_of([sent(agent, 0), condition, args.seed])
        args.out.mkdir(parents=True, exist_ok=True)
        snooker_env.warmup()
        each, options = TABLES * ROUNDS, condition | {"physics": physics_option(args.physics)}
        many = -(-args.positions // each)
        with Progress("search", each * many, "positions") as progress:
            for k in range(many):
                file = args.out / f"part-{k:06d}.npz"
                if not file.is_file():
                    made = searched(agent.player(0), options, args.seed, k * TABLES)
                    keep_arrays(file, made | {"asked": np.array(asked)})
                elif kept_arrays(file)["asked"].item() != asked:
                    raise refuse("out", str(args.out), "must be new, or hold data of the same options")
                progress.at((k + 1) * each)
    except ValueError as error:
        p.error(str(error))
    print(f"{each * many:,} positions: {args.out}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
