"""How well do agents play, and do they play position? A research tool with held-out tables, all noise levels and
several training seeds.

    python -m agents.evaluate --agent ghost_ball runs/ppo_value-0
    python -m agents.evaluate --agent "ppo=runs/ppo_value-*" "targets=runs/target-*" --against targets \\
        --json runs/main.json --markdown runs/main.md
    python -m agents.evaluate --agent "fast=runs/fast-*" "reference=runs/ref-*" --fidelity fast reference
    python -m agents.evaluate --agent search_2000 --visits 50 --noise professional

All agents play the same tables with the same execution errors, stroke by stroke: 2,000 opened tables (with spread
reds) that no training uses, no two equal or mirrored. --layouts selects other tables. Every agent plays under every
value of --noise, --fidelity, --physics and --cue, so agents trained under A and B give a table of A against B. (The
aim of a discrete choice is solved with the physics of the test.) For the leaderboard, use
``python -m snooker_env.benchmark`` instead.

An agent is a ``NAME`` (of ``snooker_env.players()``), a model's .zip or run folder, LABEL=PATH,PATH,... with
one PATH per training seed (a PATH may be a pattern), or MODULE:CLASS for your own player, whose module is imported.
Models of train.py and results/weights are read as plain data. Any other model of Stable-Baselines3 or sb3-contrib,
trained on a visit (one turn at the table) with the environment's own observation, holds pickled Python code that runs
when it is loaded. It needs --trust and, unless its actions are the default ones, --options, for example aim=target.
Intervals are 95 % bootstrap intervals over training seeds and visits (snooker_env/benchmark/statistics.py). Ratios
are paired: numerator and denominator use the same tables.
"""

import shlex
import shutil
import sys
from itertools import islice, product
from pathlib import Path

from agents._lib.lifecycle import INTERRUPTED, command, needs, parser_of

with needs("agents.evaluate"):
    import numpy as np

    import snooker_env
    from agents._lib.files import writable, write_atomic, write_json
    from agents._lib.physics_option import physics_option
    from agents._lib.provenance import provenance
    from agents._lib.tables import show
    from snooker_env.benchmark import HELD_OUT_SEED, play_visits
    from snooker_env.benchmark.statistics import RESAMPLES
    from snooker_env.benchmark.tasks import tables_of
    from snooker_env.checks import integer, parse_fidelity, refuse
    from snooker_env.game.layouts import plan_of
    from snooker_env.players.saved_models import add_model_options
    from snooker_env.progress import Progress
    from snooker_env.tasks import Noise

    from .cluster import (
        KEPT,
        ClusterError,
        Here,
        add_ray,
        checked_ray,
        in_order,
        kept_at,
        place,
        play_and_keep,
    )
    from .evaluation.entrants import Entrant, entrants_of
    from .evaluation.metrics import AXES, EntrantMetrics
    from .evaluation.travel import pack
    from .evaluation.visit_figures import counts
    from .evaluation.visits import join_parts, parts_of, play
    from .report import markdown, parts, verdict

LAYOUT, VISITS, OTHERS = "held_out", 2000, 500
"""Default layout and its visits, and the visits on other requested layouts."""
NOISES = ("none", "professional", "amateur", "club")
REFERENCE = "ghost_ball"


def parts_of_agent(agent, condition, seeds):
    """The parts of an agent under a condition: one list per run."""
    return [parts_of(pack(agent, k), k, condition, seeds) for k in range(len(agent.runs))]


def play_agent(agent, condition, seeds, resamples, results=None):
    """Compute ``EntrantMetrics`` from every run of the agent on the tables with these seeds.

    ``results`` yields the results of its parts next; by default they are played here.
    """
    each = parts_of_agent(agent, condition, seeds)
    if results is None:
        results = in_order(Here().play_parts(play, [part for run in each for part in run]))
    runs = [join_parts(list(islice(results, len(run))), len(seeds)) for run in each]
    counted = [counts(strokes) for strokes in runs]
    columns = {name: np.stack([one[name] for one in counted]) for name in counted[0]}
    return EntrantMetrics(agent, columns, runs, resamples)


def _conditions(report, seeds):
    """Every combination of layout, noise, fidelity and physics."""
    for layout, *at in product(seeds, *(report["protocol"][axis] for axis in AXES)):
        yield {"layout": layout, **dict(zip(AXES, at, strict=True))}


def all_parts(report, agents, seeds):
    """All parts of the report's protocol, in the order in which ``evaluate`` takes them."""
    return [
        part
        for condition in _conditions(report, seeds)
        for agent in agents
        for run in parts_of_agent(agent, condition, seeds[condition["layout"]])
        for part in run
    ]


def parser():
    p = parser_of("python -m agents.evaluate", __doc__)
    add = p.add_argument
    what = "NAME, MODEL (a .zip, an .npz of plain weights, or a run's folder), LABEL=PATH,PATH,... "
    what += f"or MODULE:CLASS; NAME: {', '.join(snooker_env.players())}"
    add("--agent", nargs="+", required=True, metavar="AGENT", help=what)
    add_model_options(p)
    what = f"agents to compare with [{REFERENCE}]"
    add("--against", nargs="+", default=[REFERENCE], metavar="LABEL", help=what)
    what = f"LAYOUT or LAYOUT=VISITS [{LAYOUT}={VISITS}; other layouts {OTHERS} visits]"
    add("--layouts", nargs="+", default=[LAYOUT], metavar="LAYOUT", help=what)
    add("--visits", type=int, help="visits on every layout, for a quick trial or a slow player")
    add("--noise", nargs="+", default=list(NOISES), help=f"levels of execution noise [{' '.join(NOISES)}]")
    what = "fast, standard, reference or euler:N [standard]"
    add("--fidelity", nargs="+", default=["standard"], help=what)
    what = "paper, match, or one with changes: paper,mu_bb=marlow [paper]"
    add("--physics", nargs="+", default=["paper"], help=what)
    add(
        "--cue",
        nargs="+",
        default=["real"],
        choices=("free", "real"),
        help="whether rails and balls obstruct the cue [real]",
    )
    add_ray(p)
    add("--resamples", type=int, default=RESAMPLES, help=f"bootstrap samples [{RESAMPLES}]")
    add("--json", type=Path, help="write every figure here")
    add("--markdown", type=Path, help="write the tables here")
    return p


def parse_evaluation(args):
    """Read (agents, references, {layout: seeds of its tables}) from the command line. Raises ValueError."""
    agents = entrants_of(args.agent, args, "agent")
    labels = [agent.label for agent in agents]
    for label in args.against:
        if label == REFERENCE and label not in labels:
            agents.append(Entrant(REFERENCE, (REFERENCE,)))
        elif label not in labels:
            raise refuse("against", label, f"must be one of {', '.join(labels)}, {REFERENCE}")
    sizes = {}
    for text in args.layouts:
        name, _, n = text.partition("=")
        plan_of(name)
        visits = args.visits if args.visits is not None else n or (VISITS if name == LAYOUT else OTHERS)
        if isinstance(visits, str) and not visits.isdecimal():
            raise refuse("layouts", text, "must be LAYOUT or LAYOUT=VISITS")
        sizes[name] = integer("visits", int(visits), 2, 2**20)
    checks = ((Noise.of, args.noise), (parse_fidelity, args.fidelity), (physics_option, args.physics))
    for check, values in checks:
        for value in values:
            check(value)
    integer("resamples", args.resamples, 100, 10**6)
    checked_ray(args.ray)
    for name in ("json", "markdown"):
        writable(name, getattr(args, name))
    seeds = {name: tables_of(name, visits) for name, visits in sizes.items()}
    return agents, list(dict.fromkeys(args.against)), seeds


def evaluate(report, agents, seeds, results):
    """Add all figures of the report's protocol to the report, one whole condition at a time, from the ``results`` of
    ``all_parts``."""
    p = report["protocol"]
    for condition in _conditions(report, seeds):
        layout, metrics = condition["layout"], {}
        for agent in agents:
            played = play_agent(agent, condition, seeds[layout], p["resamples"], results)
            metrics[agent.label] = played
        rows = []
        for agent in agents:
            mine = metrics[agent.label]
            others = [metrics[label] for label in p["against"] if label != agent.label]
            played = {"visits": len(seeds[layout]), "runs": len(agent.runs)}
            rows.append({"agent": agent.label, **condition, **played, **mine.result(others)})
        report["results"] += rows


@command("agents.evaluate")
def main(argv=None):
    """Check, play, report. Exit code 0, or 130 if interrupted; complete conditions are kept."""
    p = parser()
    argv = sys.argv[1:] if argv is None else argv
    args = p.parse_args(argv)
    try:
        agents, references, seeds = parse_evaluation(args)
    except ValueError as error:
        p.error(str(error))
    snooker_env.warmup()
    for agent in agents:  # compile before timing
        play_visits(agent.player(0), 2)
    protocol: dict[str, object] = {"layouts": {name: len(s) for name, s in seeds.items()}}
    protocol |= {"against": references} | {axis: list(dict.fromkeys(getattr(args, axis))) for axis in AXES}
    report = provenance(shlex.join(["python", "-m", "agents.evaluate", *argv]), HELD_OUT_SEED)
    report |= {"protocol": protocol | {"resamples": args.resamples}}
    report |= {"agents": [{"label": agent.label, "runs": agent.origins()} for agent in agents], "results": []}
    why, code = "", 0
    job = all_parts(report, agents, seeds)
    try:
        total = sum(len(args["seeds"]) for _, args in job)
        with place(args.ray) as where, Progress("evaluation", total, "visits") as progress:

            def play_and_count():
                for k, result in play_and_keep(play, job, where):
                    part = job[k][1]
                    layout = part["condition"]["layout"] + where.says
                    progress.at(progress.done + len(part["seeds"]), layout)
                    yield k, result

            evaluate(report, agents, seeds, in_order(play_and_count()))
    except KeyboardInterrupt:
        why, code = "interrupted", INTERRUPTED
    except ClusterError as error:
        why, code = str(error), 1
    if code:
        complete, conditions = len(report["results"]) // len(agents), list(_conditions(report, seeds))
        kept = f"finished parts are kept in {KEPT}; repeat the command to continue" if args.ray else ""
        kept = kept or ("the others are lost" if complete else "nothing is kept")
        many = f"{complete} of {len(conditions)} parts (one layout and noise level each)"
        report["incomplete"] = f"{why} after {many}: {kept}"
        print(f"agents.evaluate: {report['incomplete']}", file=sys.stderr)
    if report["results"]:
        write(report, args)
    if args.ray and not code:
        shutil.rmtree(kept_at(play, job))
    return code


def write(report, args):
    """Write the requested files and print the tables; files that cannot be written are named at the end."""
    files, failed = {name: getattr(args, name) for name in ("json", "markdown")}, []
    if "incomplete" in report:
        # not over an existing file, which may be complete
        beside = lambda file: file.with_name(f"{file.stem}.incomplete{file.suffix}")  # noqa: E731
        files = {name: beside(file) if file and file.exists() else file for name, file in files.items()}
    writers = {
        "json": lambda file: write_json(file, report),
        "markdown": lambda file: write_atomic(file, markdown(report)),
    }
    for name, file in files.items():
        try:
            if file:
                writers[name](file)
        except OSError as error:
            failed.append(f"{file} cannot be written: {error.strerror or error}")
            files[name] = None
    show(parts(report))  # last, because the reader of a pipe may stop early, like head
    for name, file in files.items():
        if file:
            print(f"{name}: {file}")
    show(verdict(report))
    if failed:
        raise SystemExit(f"agents.evaluate: {'; '.join(failed)}")


if __name__ == "__main__":
    raise SystemExit(main())
