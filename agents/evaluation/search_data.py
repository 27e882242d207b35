"""How are positions searched to learn from? The command ``python -m agents.search``.

    python -m agents.search --positions 10000 --out runs/searched
    python -m agents.search --positions 1000000 --noise club --out s3://bucket/club --ray 10.0.0.1:6379

A search plays visits, and what it thinks of each position is kept: the strokes that met most noise samples,
best first, with their scores. Data are written in parts as they are played; after an interruption the same
command goes on, and with other options it is refused. One machine and a cluster write the same data, bit for
bit. ``read`` gives them as arrays.
"""

import sys

from commands.lifecycle import command, needs, parser_of

with needs("agents.search"):
    import numpy as np

    import snooker_env
    from commands.physics_option import physics_option
    from snooker_env.checks import integer, parse_fidelity, refuse
    from snooker_env.game.layouts import plan_of
    from snooker_env.players.search import SearchPlayer
    from snooker_env.progress import Progress
    from snooker_env.tasks import Noise

    from ..cluster.job import ClusterError, ended, keys_of
    from ..cluster.keep import Store, digest_of
    from ..cluster.ray_cluster import add_ray, checked_ray, place, software
    from ..evaluation.entrants import Entrant
    from .searched import ROUNDS, TABLES, parts_of
    from .travel import sent

INDEX = "index.json"
"""The file that lists the parts of complete data, in order."""


def parser():
    p = parser_of("python -m agents.search", __doc__)
    what = "who searches: search_2000, planner_500, planner@MODEL [search_2000]"
    p.add_argument("--agent", default="search_2000", help=what)
    what = f"rounded up to whole parts of {TABLES * ROUNDS}"
    p.add_argument("--positions", type=int, required=True, metavar="N", help=what)
    p.add_argument("--out", required=True, metavar="URL", help="a folder or fsspec URL for these data alone")
    p.add_argument("--layout", default="opened", help="layout of the tables [opened]")
    p.add_argument("--noise", default="professional", help="level of execution noise [professional]")
    p.add_argument("--fidelity", default="standard", help="fast, standard, reference or euler:N [standard]")
    what = "paper, match, or one with changes: paper,mu_bb=marlow [paper]"
    p.add_argument("--physics", default="paper", help=what)
    p.add_argument("--seed", type=int, default=0, help="seed of tables and search [0]")
    add_ray(p)
    return p


def checked(args):
    """(agent's data, condition) of the command line. Raises ValueError."""
    integer("positions", args.positions, 1, 10**9)
    integer("seed", args.seed, 0, 2**32 - 1)
    if plan_of(args.layout) and args.layout == "held_out":
        raise refuse("layout", args.layout, "must be another: the held-out tables are kept for evaluation")
    Noise.of(args.noise)
    parse_fidelity(args.fidelity)
    physics_option(args.physics)
    checked_ray(args.ray)
    agent = Entrant.of(args.agent)
    runs = list(agent.runs)
    if len(runs) > 1 or not isinstance(agent.player(0), SearchPlayer):
        wanted = "must be one player that searches: search, planner, with _SHOTS and @MODEL if you wish"
        raise refuse("agent", args.agent, wanted)
    return sent(agent, 0), {name: getattr(args, name) for name in ("layout", "noise", "fidelity", "physics")}


def read(url):
    """The data of a folder or URL: arrays as of ``searched.play``. ValueError if they are incomplete."""
    store = Store(url, "out", only_read=True)
    keys = store.read_json(INDEX).get("parts", [])
    parts = [part for key in keys if (part := store.part(key)) is not None]
    if not parts or len(parts) < len(keys):
        raise refuse("out", url, "must hold complete data: give the command that makes them again")
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


@command("agents.search")
def main(argv=None):
    """Check, search, write. Exit code 0; 130: interrupted; 1: the cluster stopped; all of it is kept."""
    p = parser()
    args = p.parse_args(argv)
    try:
        agent, condition = checked(args)
        about = {"command": "agents.search", "agent": digest_of(agent), "seed": args.seed, **condition}
        store = Store(args.out, "out")
        store.join(about | software())
    except ValueError as error:
        p.error(str(error))
    snooker_env.warmup()
    each, why, code = TABLES * ROUNDS, "", 0
    parts, shared = parts_of(args.positions, args.seed, condition), {"search": agent}
    total = each * len(parts)
    try:
        with place(args.ray) as where, Progress(f"search{where.says}", total, "positions") as progress:
            for _ in ended(parts, shared, where, store):
                progress.at(progress.done + each)
    except KeyboardInterrupt:
        why, code = "interrupted", 130
    except ClusterError as error:
        why, code = str(error), 1
    if code:
        kept = f"{each * len(store.names('parts')):,} of {total:,} positions are kept in {store}"
        print(f"agents.search: {why}; {kept}, the same command goes on", file=sys.stderr)
        return code
    store.write_json(INDEX, {"positions": total, "parts": keys_of(parts, shared)})
    print(f"{total:,} positions: {store}")
    return 0
