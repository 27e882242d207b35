"""``python -m snooker_env mcp``: a language model plays, over standard input and output."""

import argparse
import shlex
import sys
from collections.abc import Sequence

from .._lib.check import refuse
from .._lib.command import exit_code
from ..benchmark.tasks import TASKS
from .server import TRACKS, Desk, FreeGame, JudgedGame, serve

NAME = "python -m snooker_env mcp"
JUDGED = tuple(name for name, task in TASKS.items() if not task.frame)  # visits


def _arguments(words: list[str]) -> argparse.Namespace:
    about = """Serve the Model Context Protocol on standard input and output. Without --out a client starts games as it likes.
        With --out it plays the judged tables of a task once, in order, and python -m snooker_env benchmark check can verify
        the file."""
    p = argparse.ArgumentParser(NAME, description=about)
    add = p.add_argument
    add("--track", choices=TRACKS, help="what the client sees (default: words, menu and picture)")
    add("--out", metavar="FILE", help="result file; an incomplete one is continued")
    add("--task", choices=JUDGED, default=JUDGED[0], help="with --out: the task (default: %(default)s)")
    add("--episodes", type=int, default=50, help="with --out: number of tables (default: %(default)s)")
    add("--label", help="with --out: name of the model in the result (default: mcp)")
    shots = "with --out: simulated shots in the model's training (0: none)"
    add("--training-shots", type=int, metavar="N", help=shots)
    add("--simulated-shots", type=int, metavar="N", help="with --out: simulated shots for each decision")
    return p.parse_args(words)


def _desk(args: argparse.Namespace, command: str) -> Desk:
    if args.out is None:
        if args.label is not None:
            raise refuse("label", args.label, "must be left out without --out")
        return Desk(FreeGame(), args.track)
    if args.track is None:
        raise refuse("track", None, f"must be given with --out: one of {', '.join(TRACKS)}")
    declared = {"label": args.label or "mcp", "training_shots": args.training_shots}
    declared["shots_declared"] = args.simulated_shots
    game = JudgedGame(TASKS[args.task], args.track, args.episodes, args.out, command, **declared)
    return Desk(game, args.track)


def main(argv: Sequence[str] | None = None) -> int:
    """Serve until the client leaves. Exit code 2: wrong arguments; 1: a library is missing; 130: Ctrl-C."""
    words = list(sys.argv[1:] if argv is None else argv)

    def run() -> int:
        args = _arguments(words)
        try:
            server = serve(_desk(args, f"{NAME} {shlex.join(words)}"))
        except ValueError as error:
            print(f"error: {error}", file=sys.stderr)
            return 2
        import anyio
        from mcp.server.stdio import stdio_server

        async def talk() -> None:
            async with stdio_server() as (requests, answers):
                await server.run(requests, answers, server.create_initialization_options())

        anyio.run(talk)
        return 0

    return exit_code("error", run)


if __name__ == "__main__":
    raise SystemExit(main())
