"""What does plain Stable-Baselines3 learn, and after how many shots? Learning curves for each form of action.

    python -m agents.curves                                   every row, five seeds: days on one core
    python -m agents.curves --rows pot_ppo strokes_ppo --seeds 0 --shots 50000
    python -m agents.curves --markdown curves.md --picture curves.png

A row is an algorithm, a policy, tables and a few settings, as a new user would write them (all are in
agents/evaluation/curve_rows.py). Each training seed learns separately. After 0 and each number of shots, its deterministic
policy plays held-out tables, which no training uses. Each point is appended to --out at once, with its cost. Repeat the
command to continue after a kill: existing points are kept, and a seed with missing points learns from the beginning. Several
processes may write one file if their --rows or --seeds differ. For comparison, the file includes players that do not learn:
random, ghost_ball and the action of zeros.

--markdown, --picture and --page show the contents of the file and are written after each seed.
"""

import shlex
import sys
import time
from pathlib import Path
from typing import Any

from agents._lib.lifecycle import command, needs, parser_of

with needs("agents.curves"):
    import numpy as np
    import torch

    import snooker_env
    from agents._lib.files import writable, write_atomic
    from agents._lib.provenance import provenance
    from snooker_env.benchmark import play_visits
    from snooker_env.benchmark.tasks import tables_of
    from snooker_env.checks import choice, integer, refuse
    from snooker_env.progress import Progress

    from .evaluation.curve_file import keep, read_curves
    from .evaluation.curve_report import draw, fill, levels_at, markdown
    from .evaluation.curve_rows import GAME, PLACES, ROWS, play_nothing

SEEDS, VISITS, MOST_SEED = (0, 1, 2, 3, 4), 300, 999
"""Training seeds, held-out tables per point, and the largest seed: the next one would reach the tables of the evaluation."""


def parser():
    p = parser_of("python -m agents.curves", __doc__)
    add = p.add_argument
    add(
        "--rows", nargs="+", default=list(ROWS), metavar="ROW", help=f"rows to train: {', '.join(ROWS)} [all]"
    )
    add("--seeds", nargs="+", type=int, default=list(SEEDS), help="training seeds [0 1 2 3 4]")
    what = "shots after which the agent is evaluated [50000 200000 1000000; one-stroke tasks 100000]"
    add("--shots", nargs="+", type=int, help=what)
    add("--visits", type=int, default=VISITS, help=f"held-out tables per point [{VISITS}]")
    add("--threads", type=int, help="threads of the tables; results do not depend on it [one per processor]")
    add(
        "--out",
        type=Path,
        default=Path("runs/curves.json"),
        metavar="FILE.json",
        help="the points [runs/curves.json]",
    )
    add("--markdown", type=Path, metavar="FILE", help="write the tables here")
    add("--picture", type=Path, metavar="FILE", help="draw the curves of visits here")
    add(
        "--page",
        type=Path,
        metavar="FILE",
        help="fill the marked part of this page with the picture and points of visits",
    )
    return p


def check(args) -> dict[str, Any]:
    """Read the file and check all options. An invalid option raises ValueError."""
    for row in args.rows:
        choice("rows", row, tuple(ROWS))
    for seed in args.seeds:
        integer("seeds", seed, 0, MOST_SEED)
    for shots in args.shots or ():
        integer("shots", shots, 1, 10**9)
    integer("visits", args.visits, 2, 2**20)
    for place in {ROWS[row].place for row in args.rows}:
        tables_of(PLACES[place].judged_options["layout"], args.visits)
    if args.threads is not None:
        integer("threads", args.threads, 1, 1024)
    for name in ("out", "markdown", "picture", "page"):
        writable(name, getattr(args, name))
    content = read_curves(args.out, args.visits)
    for name in {one["row"] for one in content["points"]}.intersection(args.rows):
        if (code := content["rows"][name]["code"]) != ROWS[name].code():
            raise refuse(
                "rows", name, f"must train what {args.out} holds for it, {code}: or give another --out"
            )
    if args.page is not None:
        if not args.page.is_file():
            raise refuse("page", str(args.page), "must be an existing page")
        fill(args.page.read_text(encoding="utf-8"), content, args.page)
    return content


def measure(values: np.ndarray) -> dict[str, float | int]:
    """Mean and standard error of the returns of episodes."""
    error = float(values.std(ddof=1) / np.sqrt(len(values)))
    return {"points": float(values.mean()), "error": error, "visits": len(values)}


def levels(place: str, args) -> dict[str, dict[str, float | int]]:
    """Measure the players that do not learn."""
    made = {"zero action": measure(play_nothing(place, args.visits, args.threads))}
    if place == "visit":
        seeds = tables_of("held_out", args.visits)
        for name in ("random", "ghost_ball"):
            strokes = play_visits(name, args.visits, first_seed=seeds, threads=args.threads, **GAME)
            made[name] = measure(strokes.a_visit(strokes.points))
    return made


def learn(name: str, seed: int, wanted: list[int], known: set[int], args):
    """Train one seed of a row and yield each of the ``wanted`` points that is not ``known``. Each number of shots is a
    further ``learn``; DQN explores only in the first."""
    row, seconds, processor = ROWS[name], 0.0, 0.0
    agent, tables = row.agent(seed, args.threads)
    with Progress(f"{name}, seed {seed}", wanted[-1], "shots") as progress:
        for shots in wanted:
            if shots > agent.num_timesteps:
                began, busy = time.perf_counter(), time.process_time()
                agent.learn(
                    shots - agent.num_timesteps,
                    callback=lambda *_: progress.at(agent.num_timesteps) or True,
                    reset_num_timesteps=False,
                )
                seconds += time.perf_counter() - began
                processor += time.process_time() - busy
            if shots not in known:
                cost = {"seconds": round(seconds, 2), "processor_seconds": round(processor, 2)}
                place = {"row": name, "seed": seed, "shots": shots, "played": agent.num_timesteps}
                yield place | measure(row.judge(agent, args.visits, args.threads)) | cost
    tables.close()


def show(args) -> None:
    """Write the requested outputs from the file."""
    content = read_curves(args.out, args.visits)
    if args.markdown:
        write_atomic(args.markdown, markdown(content))
    if args.picture:
        draw(content, args.picture)
    if args.page:
        write_atomic(args.page, fill(args.page.read_text(encoding="utf-8"), content, args.page))


@command("agents.curves")
def main(argv=None):
    """Train the missing points and show all. Exit code 0, or 130 if interrupted; each point is kept at once."""
    p = parser()
    argv = sys.argv[1:] if argv is None else argv
    args = p.parse_args(argv)
    try:
        content = check(args)
    except ValueError as error:
        p.error(str(error))
    torch.set_num_threads(1)  # such small networks are slower on more threads
    snooker_env.warmup()
    made = provenance(shlex.join(["python", "-m", "agents.curves", *argv]), args.seeds)
    rows = {name: ROWS[name].describe() for name in args.rows}
    head = {"visits": args.visits, "rows": rows, "made": made}

    def note(name: str, one: dict[str, Any]) -> None:
        keep(args.out, name, one, head)
        words = (value if isinstance(value, str) else f"{key} {value:g}" for key, value in one.items())
        print(*words, flush=True)

    for place in dict.fromkeys(ROWS[row].place for row in args.rows):
        if len(levels_at(content, place)) < (3 if place == "visit" else 1):
            for player, found in levels(place, args).items():
                note("levels", {"place": place, "player": player, **found})
    for seed in args.seeds:
        for name in args.rows:
            wanted = sorted({0, *(args.shots or PLACES[ROWS[name].place].shots)})
            known = {one["shots"] for one in content["points"] if (one["row"], one["seed"]) == (name, seed)}
            if not known.issuperset(wanted):
                for point in learn(name, seed, wanted, known, args):
                    note("points", point)
                show(args)
    show(args)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
