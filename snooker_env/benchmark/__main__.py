"""How is the benchmark run? Its commands; rules: docs/benchmark.md."""

import argparse
import shlex
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from .._lib.check import integer, refuse
from .._lib.command import exit_code
from .._lib.files import write_atomic
from .._lib.text_tables import format_figure, text_table
from ..players.program import AgentError
from ..players.saved_models import add_model_options, options_of_words
from ..progress import ticking
from .agents import Agent, is_player_name, seat
from .checking import faults
from .degenerate_check import ABOVE, results, winners
from .leaderboard import board, lines, page
from .playing import COLUMNS
from .results import missing, read_result
from .run import judge
from .tasks import FREE, TASKS, Task, task_of
from .warmup import warmup

NAME = "python -m snooker_env.benchmark"
NOTHING = 0.02
"""A share of episodes that bring something, so small that the actions may be read wrongly: ``random`` scores in a third."""


def parser() -> argparse.ArgumentParser:
    what = "Judge agents on fixed tasks. docs/benchmark.md has the rules."
    p = argparse.ArgumentParser(NAME, description=what)
    commands = p.add_subparsers(dest="command", required=True)
    commands.add_parser("tasks", help="list the tasks")
    run = commands.add_parser("run", help="play a task and write its result file")
    run.add_argument("tasks", nargs="+", metavar="TASK", help="task ids, or all")
    add = run.add_argument
    what = 'player name, .zip of Stable-Baselines3, LABEL=ZIP,ZIP (training seeds), MODULE:CLASS or program:"COMMAND"'
    add("--agent", required=True, help=what)
    add_model_options(run)
    how = "seconds that a program may take for one stroke (default: 60)"
    add("--timeout", type=float, default=60.0, help=how)
    add("--label", help="name of the agent in tables (default: taken from --agent)")
    add("--episodes", type=int, help="play fewer episodes as a trial; the result is then not official")
    help_ = "shots simulated in all of its training; 0 for an untrained agent"
    add("--training-shots", type=int, metavar="N", help=help_)
    help_ = "declare the shots simulated for one decision if this process cannot count them"
    add("--simulated-shots", type=int, metavar="N", help=help_)
    add("--out", metavar="PATH", help="result file, or folder for several tasks (default: TASK.LABEL.json)")
    add("--resume", action="store_true", help="continue an incomplete result file; keep a complete one")
    add("--force", action="store_true", help="overwrite existing result files")
    check = commands.add_parser("check", help="verify result files; the exit code is 1 if one is wrong")
    check.add_argument("files", nargs="+", metavar="FILE")
    help_ = "play policies that do not look at the table; the exit code is 1 if one wins a task"
    silly = commands.add_parser("degenerate", help=help_)
    silly.add_argument("tasks", nargs="*", metavar="TASK", help="task ids (default: all)")
    help_ = "folder of the result files [results/leaderboard]"
    silly.add_argument("--out", metavar="FOLDER", default="results/leaderboard", help=help_)
    for one in (run, check, silly):
        one.add_argument(
            "--threads", type=int, help="threads that play the tables (default: one for each core)"
        )
    table = commands.add_parser("table", help="print the leaderboard of result files")
    table.add_argument("files", nargs="*", metavar="FILE")
    table.add_argument("--markdown", metavar="FILE", help="write the tables into this Markdown page instead")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command. Exit code 0; 1: wrong file or failed agent; 2: wrong arguments; 130: Ctrl-C."""
    words = list(sys.argv[1:] if argv is None else argv)

    def play() -> int:
        args = parser().parse_args(words)
        args.line = f"{NAME} {shlex.join(words)}"
        try:
            return COMMANDS[args.command](args)
        except (ValueError, TypeError, AgentError) as error:
            print(f"error: {error}", file=sys.stderr)
            return 1 if isinstance(error, AgentError) else 2

    return exit_code("error", play)


def _tasks(args: argparse.Namespace) -> int:
    head = ["task", "what", "judged on", "noise", "episodes"]
    rows = [
        [task.id, task.title, task.judged_layout, task.frozen_options["noise"], f"{task.episodes:,}"]
        for task in TASKS.values()
    ]
    print("\n".join(text_table(head, rows, 4)))
    print(f"\nFree options: {', '.join(FREE)}. All others are frozen.")
    return 0


def _run(args: argparse.Namespace) -> int:
    """Play tasks; wrong arguments are refused before the first one is played."""
    tasks = list(TASKS.values()) if args.tasks == ["all"] else [task_of(name) for name in args.tasks]
    shots = {"training_shots": args.training_shots, "shots_declared": args.simulated_shots}
    how = {"options": options_of_words(args.options), "trust": args.trust, "timeout": args.timeout}
    agent = Agent.of(args.agent, label=args.label, **shots, **how)
    out = Path(args.out or ".")
    if len(tasks) > 1 and out.suffix == ".json":
        raise refuse("out", args.out, "must be a folder if there are several tasks")
    files = [out if out.suffix == ".json" else out / f"{task.id}.{agent.label}.json" for task in tasks]
    for task, file in zip(tasks, files, strict=True):
        if file.exists() and not args.resume and not args.force:
            how = "--resume continues an incomplete result, --force overwrites it"
            raise refuse("out", str(file), f"must be a new file; {how}")
        if args.episodes is not None:
            integer("episodes", args.episodes, 2, task.episodes)
        with seat(agent, task, 0):
            pass
    for file in files:
        file.parent.mkdir(parents=True, exist_ok=True)
    warmup()
    worst, more = 0, {name: getattr(args, name) for name in ("episodes", "resume", "threads")}
    for task, file in zip(tasks, files, strict=True):
        if worst < 130:
            with ticking(task.id, "episodes") as tick:
                result = judge(task, agent, out=file, command=args.line, tick=tick, **more)
            worst = max(worst, _report(result, task, file))
    return worst


def _report(result: dict[str, Any], task: Task, file: Path) -> int:
    """Print a result in short; its exit code."""
    why, agent, figures = result["incomplete"], result["agent"], result["figures"]
    if why is not None:
        print(f"error: {why}", file=sys.stderr)
    if figures is not None:
        scale = 1.0 if task.counts else 100.0
        score, adjusted = (format_figure(figures[name], scale) for name in ("score", "adjusted"))
        unit = task.measure if task.counts else f"% ({task.measure})"
        where = f"{len(result['rows']):,} episodes, class {agent['class']}, budget {agent['budget']}"
        print(f"{task.id}  {agent['label']}: {score} {unit}, {adjusted} less luck, {where}")
    if why is None and suspicious(result, task):
        asks = f"Nearly every episode scored nothing. Are the actions of {agent['label']} read as in its training?"
        print(f"{asks} A model trained with aim=target needs --options aim=target.", file=sys.stderr)
    if result["rows"]:
        wants = "; ".join(missing(result, task))
        print(f"not official ({wants}): {file}" if wants else f"official: {file}")
    return 0 if why is None else 130 if why.startswith("interrupted") else 1


def suspicious(result: dict[str, Any], task: Task) -> bool:
    """Whether an agent whose actions could be read otherwise scores nothing where any other scores."""
    scores = [row[COLUMNS.index("score")] for row in result["rows"]]
    models = not all(map(is_player_name, result["agent"]["sources"]))
    brought = sum(score > 0 for score in scores)
    return bool(scores) and models and task.score in ("points", "legal") and brought <= NOTHING * len(scores)


def _check(args: argparse.Namespace) -> int:
    worst = 0
    for file in args.files:
        try:
            result = read_result(file)
            wrong = faults(result, args.threads)
        except ValueError as error:
            wrong = [str(error).removeprefix(f"path = {str(file)!r}: ")]
        except OSError as error:
            wrong = [f"cannot be read: {error.strerror}"]
        for line in wrong:
            print(f"{file}: {line}")
        if not wrong:
            kind = "official" if result["protocol"]["official"] else "sound, not official"
            what = f"{result['agent']['label']} on {result['task']}, {len(result['rows']):,} episodes"
            print(f"{file}: {kind}, {what}")
        worst |= bool(wrong)
    return worst


def _degenerate(args: argparse.Namespace) -> int:
    tasks = [task_of(name) for name in args.tasks] or list(TASKS.values())
    folder, wrong = Path(args.out), list[str]()
    folder.mkdir(parents=True, exist_ok=True)
    warmup()
    for task in tasks:
        some = list(results(task, folder, args.threads))
        head, rows = board(some, task)
        print("\n".join([f"{task.id}: {task.measure}", "", *text_table(head, rows, 3), ""]), flush=True)
        wrong += winners(some)
    print("\n".join(wrong or ["No degenerate policy stands above " + ", ".join(ABOVE) + "."]))
    return int(bool(wrong))


def _table(args: argparse.Namespace) -> int:
    results = [read_result(file) for file in args.files]
    for file, result in zip(args.files, results, strict=True):
        if wrong := faults(result):
            raise ValueError(f"{file}: {wrong[0]} ({len(wrong)} faults: see check)")
    if args.markdown:
        text = Path(args.markdown).read_text(encoding="utf-8")
        write_atomic(args.markdown, page(text, results))
    print(args.markdown or "\n".join(lines(results)))
    return 0


COMMANDS = {call.__name__[1:]: call for call in (_tasks, _run, _check, _degenerate, _table)}

if __name__ == "__main__":
    raise SystemExit(main())
