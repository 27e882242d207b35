"""``python -m snooker_env.advice coach FILE``: what do recorded strokes say of a player?"""

import argparse
import json
import sys
from collections.abc import Sequence

from .._lib.command import stop_with_reader
from ..physics.parameters import PRESETS as PHYSICS
from ..tasks.noise import LEVELS
from ..tasks.options import CUES
from .coach import coach
from .recorded import PLAYED_ON, read_strokes

TABLES = ("match", "tight")  # presets of snooker's size


def main(argv: Sequence[str] | None = None) -> int:
    """Print what recorded strokes say of a player."""
    about = "A player's errors, pots made and expected, what costs most, and drills."
    parser = argparse.ArgumentParser("python -m snooker_env.advice", description=about)
    parser.add_argument("question", choices=("coach",), help="what is asked")
    parser.add_argument("file", metavar="FILE", help="recorded strokes (JSON), or a replay (JSON or page)")
    parser.add_argument("--player", type=int, choices=(0, 1), help="of a replay of a frame: whose strokes")
    target = f"whom costs are counted against: {', '.join(LEVELS)} (default: professional)"
    parser.add_argument("--target", default="professional", help=target)
    for name, names in (("cue", CUES), ("physics", PHYSICS), ("table", TABLES)):
        parser.add_argument(f"--{name}", choices=names, help="of the strokes, where the file does not say it")
    parser.add_argument("--seed", type=int, default=0, help="seed of the simulated strokes (default: 0)")
    parser.add_argument("--json", action="store_true", help="print all figures as JSON")
    args = parser.parse_args(argv)
    told = {name: value for name in PLAYED_ON if (value := getattr(args, name)) is not None}
    try:
        with stop_with_reader():
            strokes = read_strokes(args.file, player=args.player)
            found = coach(strokes, target=args.target, options=told, seed=args.seed)
            print(json.dumps(found.to_dict(), indent=1) if args.json else found)
    except (ValueError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
