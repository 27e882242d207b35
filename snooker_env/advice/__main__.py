"""``python -m snooker_env.advice coach FILE``, ``review FILE``: what recorded strokes say about a player, and what those of a
frame cost."""

import argparse
import json
import sys
from collections.abc import Sequence

from .._lib.command import exit_code
from ..physics.parameters import PRESETS as PHYSICS
from ..progress import Progress
from ..tasks.noise import LEVELS
from ..tasks.options import CUES
from .coach import Coaching, coach
from .recorded import PLAYED_ON, REPLAY, read_document, read_strokes
from .review import SAMPLES, Review, go_through, read_frame


def main(argv: Sequence[str] | None = None) -> int:
    """Print what recorded strokes say about a player, or what those of a frame cost."""
    parser = argparse.ArgumentParser("python -m snooker_env.advice")
    asked = parser.add_subparsers(dest="name", required=True)
    of_player = asked.add_parser("coach", help="a player's errors, expected pots and costs, and drills")
    of_frame = asked.add_parser("review", help="what each stroke of a frame cost, by its choice and errors")
    files = "recorded strokes (JSON), or a replay (JSON or page)", "a replay of a frame (JSON or page)"
    for one, find, file in zip((of_player, of_frame), (_coach, _review), files, strict=True):
        one.set_defaults(find=find)
        one.add_argument("file", metavar="FILE", help=file)
        one.add_argument("--player", type=int, choices=(0, 1), help="whose strokes, in a replay of a frame")
        one.add_argument("--seed", type=int, default=0, help="seed of the simulated strokes (default: 0)")
        one.add_argument("--json", action="store_true", help="print all figures as JSON")
    target = "level that costs are counted against (default: %(default)s)"
    of_player.add_argument("--target", choices=LEVELS, default="professional", help=target)
    for name, names in (("cue", CUES), ("physics", PHYSICS), ("table", ("match", "tight"))):
        of_player.add_argument(f"--{name}", choices=names, help=f"{name} of strokes whose file does not say")
    of_frame.add_argument("--agent", help="agent whose best strokes are compared (default: tactician)")
    of_frame.add_argument("--noise", choices=LEVELS, help="execution errors (default: those of the players)")
    many = "simulations of each stroke (default: %(default)s)"
    of_frame.add_argument("--samples", type=int, default=SAMPLES, help=many)
    args = parser.parse_args(argv)

    def show() -> int:
        try:
            found = args.find(args)
        except (ValueError, OSError) as error:
            print(f"error: {error}", file=sys.stderr)
            return 2
        print(json.dumps(found.to_dict(), indent=1) if args.json else found)
        return 0

    return exit_code(f"{parser.prog} {args.name}", show)


def _coach(args: argparse.Namespace) -> Coaching:
    told = {name: value for name in PLAYED_ON if (value := getattr(args, name)) is not None}
    strokes = read_strokes(args.file, player=args.player)
    return coach(strokes, target=args.target, options=told, seed=args.seed)


def _review(args: argparse.Namespace) -> Review:
    how = {name: getattr(args, name) for name in ("agent", "noise", "samples", "seed")}
    players = (0, 1) if args.player is None else (args.player,)
    steps = go_through(read_document(args.file, {REPLAY: read_frame}), players, **how)
    _, total, found = next(steps)
    with Progress("review", total, "looks") as progress:
        for done, _, found in steps:  # noqa: B007
            progress.at(done)
    return found


if __name__ == "__main__":
    raise SystemExit(main())
