"""How is the benchmark run? By ``python -m snooker_env.benchmark`` tasks, run, check, table or profile; the rules: docs/benchmark.md."""

import argparse
import os
import shlex
import sys
from collections.abc import Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

import numpy as np

from .._check import integer, refuse
from .._warmup import warmup
from ..progress import Progress
from .agents import Agent
from .checking import afresh, faults, replayed
from .leaderboard import lines, page, profile, shown, text_table
from .models import ForeignModelPlayer, options_of_words
from .program import AgentError
from .results import missing, read_result
from .run import judge
from .tasks import FREE, HELD_OUT_SEED, TASKS, task_of

NAME = "python -m snooker_env.benchmark"


def parser() -> argparse.ArgumentParser:
    """The command line.

    Returns
    -------
    argparse.ArgumentParser
    """
    p = argparse.ArgumentParser(NAME, description="Judge agents on named tasks by the rules of docs/benchmark.md.")
    commands = p.add_subparsers(dest="command", required=True)
    commands.add_parser("tasks", help="list the tasks")
    run = commands.add_parser("run", help="play a task and write its result file")
    run.add_argument("tasks", nargs="+", metavar="TASK", help="ids of tasks, or all")
    _agent(run)
    run.add_argument("--label", help="name in the tables (default: from the agent)")
    run.add_argument("--episodes", type=int, help="fewer episodes, for a first try; such a result is not official")
    run.add_argument("--training-shots", type=int, metavar="N", help="all simulated shots of its training; 0: not trained")
    run.add_argument("--simulated-shots", type=int, metavar="N", help="declare simulated shots a decision that are not counted here")
    run.add_argument("--out", metavar="PATH", help="result file, or folder for several tasks (default: TASK.LABEL.json)")
    run.add_argument("--resume", action="store_true", help="go on with an incomplete result file; leave a complete one as it is")
    run.add_argument("--force", action="store_true", help="replace result files that are there")
    check = commands.add_parser("check", help="verify result files; exit code 1 if one is wrong")
    check.add_argument("files", nargs="+", metavar="FILE")
    check.add_argument("--replay", type=int, metavar="N", help="have --agent play N episodes again: the same strokes?")
    check.add_argument("--fresh", type=int, metavar="N", help="have --agent play N episodes on fresh seeds: the same mean?")
    _agent(check, required=False)
    table = commands.add_parser("table", help="print the leaderboard of result files")
    table.add_argument("files", nargs="*", metavar="FILE")
    table.add_argument("--markdown", metavar="FILE", help="write it as a page")
    table.add_argument("--awaited", nargs="+", default=[], metavar="LABEL", help="agents that the page names where their result is missing")
    shares = commands.add_parser("profile", help="print performance profiles of result files")
    shares.add_argument("files", nargs="+", metavar="FILE")
    return p


def _agent(p, required=True):
    p.add_argument(
        "--agent", required=required,
        help='a name, a .zip of Stable-Baselines3, LABEL=ZIP,ZIP (training seeds), MODULE:CLASS or program:"COMMAND"',
    )  # fmt: skip
    p.add_argument("--options", nargs="+", default=[], metavar="KEY=VALUE", help="how a model's actions are read, as aim=target")
    p.add_argument("--trust", action="store_true", help="run the pickled code in a model's file")
    p.add_argument("--timeout", type=float, default=60.0, help="seconds that a program has for a stroke (default: 60)")
    p.add_argument("--threads", type=int, help="threads that play the tables (default: one for each core)")


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command. Exit code 0; 1 for a wrong file or a failed agent; 2 for wrong arguments; 130 after Ctrl-C.

    Parameters
    ----------
    argv : sequence of str, optional

    Returns
    -------
    int
    """
    given = list(sys.argv[1:] if argv is None else argv)
    args = parser().parse_args(given)
    try:
        return {"tasks": _tasks, "run": _run, "check": _check, "table": _table, "profile": _profile}[args.command](args, given)
    except (ValueError, TypeError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except (AgentError, ImportError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    except BrokenPipeError:  # nobody reads on: ... | head
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except OSError as error:
        print(f"error: {error.filename or 'the output'}: {error.strerror}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 130


def _tasks(args, given):
    rows = [[task.id, task.title, task.judged_layout, str(task.frozen["noise"]), f"{task.episodes:,}"] for task in TASKS.values()]
    print("\n".join(text_table(["task", "what", "judged on", "noise", "episodes"], rows, 4)))
    print(f"\nFree options: {', '.join(FREE)}. All others are frozen.")
    return 0


def _agent_of(args, **more):
    return Agent.of(args.agent, options=options_of_words(args.options), trust=args.trust, timeout=args.timeout, **more)


def _run(args, given):
    tasks = list(TASKS.values()) if args.tasks == ["all"] else [task_of(name) for name in args.tasks]
    agent = _agent_of(args, label=args.label, training_shots=args.training_shots, shots_declared=args.simulated_shots)
    out = Path(args.out or ".")
    if len(tasks) > 1 and out.suffix == ".json":
        raise refuse("out", args.out, "must be a folder for several tasks")
    for task in tasks:
        if args.episodes is not None:
            integer("episodes", args.episodes, 2, task.episodes)
        player = agent.player(task)  # whatever is wrong is said before the first task is played
        if isinstance(player, ForeignModelPlayer) and not agent.options and "action" not in player.options and task is tasks[0]:
            print('aim=absolute is assumed, as in Snooker-v0: give "--options aim=target" to a model trained with that', file=sys.stderr)
        close = getattr(player, "close", None)
        if callable(close):
            close()
    files = [out if out.suffix == ".json" else out / f"{task.id}.{agent.label}.json" for task in tasks]
    for file in files:
        if file.exists() and not args.resume and not args.force:
            raise refuse("out", str(file), "must be a new file; --resume goes on with an incomplete result, --force replaces it")
        file.parent.mkdir(parents=True, exist_ok=True)
    warmup()
    worst = 0
    for task, file in zip(tasks, files, strict=True):
        command = f"{NAME} {shlex.join(given)}"
        with _speaking(task) as tick:
            found = judge(
                task, agent, episodes=args.episodes, out=file, resume=args.resume, command=command, threads=args.threads, tick=tick
            )
        worst = max(worst, _said(found, task, file))
        if worst == 130:
            break
    return worst


@contextmanager
def _speaking(task):
    """A ``tick`` of ``judge`` that says how far it is."""
    with ExitStack() as ending:
        begun: list[Progress] = []

        def tick(played, total):
            if not begun:
                begun.append(ending.enter_context(Progress(task.id, total, "episodes", done=played)))
            begun[0].at(played)

        yield tick


def _said(found, task, file):
    """Print a result in short; its exit code."""
    why = found["incomplete"]
    if why is not None:
        print(f"error: {why}", file=sys.stderr)
    if found["rows"]:
        agent, figures = found["agent"], found["figures"]
        if figures is not None:
            what = shown(figures["score"], 1.0 if task.counts else 100.0)
            unit = task.measure if task.counts else f"% ({task.measure})"
            where = f"{len(found['rows']):,} episodes, class {agent['class']}, budget {agent['budget']}"
            print(f"{task.id}  {agent['label']}: {what} {unit}, {where}")
        wants = "; ".join(missing(found, task))
        print(f"not official ({wants}): {file}" if wants else f"official: {file}")
    return 0 if why is None else 130 if why.startswith("interrupted") else 1


def _check(args, given):
    asked = args.replay is not None or args.fresh is not None
    if asked != (args.agent is not None):
        raise refuse("agent", args.agent, "must be given with --replay or --fresh, and only then")
    if asked and len(args.files) > 1:
        raise refuse("files", args.files, "must be one file with --agent")
    wrong = False
    for file in args.files:
        try:
            found = read_result(file)
            said = faults(found, args.threads)
        except ValueError as error:
            said = [str(error)]
        except OSError as error:
            said = [f"cannot be read: {error.strerror}"]
        if not said and asked:
            said = _by_agent(args, found)
        for line in said:
            print(f"{file}: {line}")
        if not said:
            kind = "official" if found["protocol"]["official"] else "sound, not official"
            print(f"{file}: {kind}, {found['agent']['label']} on {found['task']}, {len(found['rows']):,} episodes")
        wrong |= bool(said)
    return int(wrong)


def _by_agent(args, found):
    """What the agent itself says against its file."""
    agent, said = _agent_of(args, label=found["agent"]["label"]), []
    if args.replay is not None:
        said = replayed(found, agent, integer("replay", args.replay, 1, 2**20), args.threads)
    if args.fresh is not None and not said:
        seed = int(np.random.default_rng().integers(2 * HELD_OUT_SEED, 2**31))
        mean, error, said = afresh(found, agent, integer("fresh", args.fresh, 2, 2**20), seed, args.threads)
        print(f"fresh seeds from {seed} on: {mean:.4g}, the file has {found['figures']['score']['value']:.4g}, +- {error:.2g} apart")
    return said


def _sound(files):
    """The results in these files, each checked."""
    results = []
    for file in files:
        found = read_result(file)
        said = faults(found)
        if said:
            raise ValueError(f"{file}: {said[0]} ({len(said)} faults: see check)")
        results.append(found)
    return results


def _table(args, given):
    results = _sound(args.files)
    if args.markdown:
        from .._files import write_atomic

        write_atomic(args.markdown, page(results, args.awaited))
        print(args.markdown)
        return 0
    print("\n".join(lines(results)))
    return 0


def _profile(args, given):
    results = _sound(args.files)
    for task in TASKS.values():
        head, rows = profile(results, task)
        if rows:
            print("\n".join([f"{task.id}: share of episodes [%] with at least so many {task.score}", "", *text_table(head, rows), ""]))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
