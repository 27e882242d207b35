"""``python -m snooker_env.advice --position FILE --agent NAME``: what would a player do in a position?
``python -m snooker_env.advice coach FILE``: what do recorded strokes say of a player?"""

import argparse
import json
import sys
from collections.abc import Sequence
from typing import Any

from .._lib.command import until_closed
from ..physics.parameters import PRESETS as PHYSICS
from ..planning import Position
from ..players import players
from ..players.model_options import add_model_options, options_of_words
from ..players.resolver import named
from ..tasks.noise import LEVELS
from ..tasks.options import CUES
from .ask import AGENT, OF_FRAMES, advise
from .coach import coach
from .recorded import PLAYED_ON, read_strokes

TABLES = ("match", "tight")  # presets of snooker's size


def main(argv: Sequence[str] | None = None) -> int:
    """Print advice for a position; with the word "coach" first, what recorded strokes say of a player."""
    argv = sys.argv[1:] if argv is None else argv
    try:
        with until_closed():
            _coach(argv[1:]) if argv[:1] == ["coach"] else _advice(argv)
    except (ValueError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


def _coach(argv: Sequence[str]) -> None:
    about = "A player's errors, pots made and expected, what costs most, and drills."
    parser = argparse.ArgumentParser("python -m snooker_env.advice coach", description=about)
    parser.add_argument("file", metavar="FILE", help="recorded strokes (JSON), or a replay (JSON or page)")
    parser.add_argument("--player", type=int, choices=(0, 1), help="of a replay of a frame: whose strokes")
    target = f"whom costs are counted against: {', '.join(LEVELS)} (default: professional)"
    parser.add_argument("--target", default="professional", help=target)
    for name, names in (("cue", CUES), ("physics", PHYSICS), ("table", TABLES)):
        parser.add_argument(f"--{name}", choices=names, help="of the strokes, where the file does not say it")
    parser.add_argument("--seed", type=int, default=0, help="seed of the simulated strokes (default: 0)")
    parser.add_argument("--json", action="store_true", help="print all figures as JSON")
    args = parser.parse_args(argv)
    strokes = read_strokes(args.file, player=args.player)
    told = {name: value for name in PLAYED_ON if (value := getattr(args, name)) is not None}
    found = coach(strokes, target=args.target, options=told, seed=args.seed)
    print(json.dumps(found.to_dict(), indent=1) if args.json else found)


def _advice(argv: Sequence[str]) -> None:
    about = """Ranked strokes of a player, and their outcomes. With the word "coach" first: what recorded strokes say of a
        player, see "coach --help"."""
    parser = argparse.ArgumentParser("python -m snooker_env.advice", description=about)
    from_file = "JSON of a position: from Position.save, or hand-written"
    parser.add_argument("--position", required=True, metavar="FILE", help=from_file)
    for name, default, words in (
        ("noise", "professional", f"execution errors: {', '.join(LEVELS)}"),
        ("n", 5, "largest number of strokes"),
        ("samples", 200, "noise samples of each stroke"),
        ("visits", 40, "visits of each that are continued"),
        ("seed", 0, "seed of the noise samples"),
    ):
        usual = f"{words} (default: {default})"
        parser.add_argument(f"--{name}", type=type(default), default=default, help=usual)
    whom = f"{', '.join(players())}, a model's .zip or MODULE:CLASS (default: {AGENT}; with --scores {OF_FRAMES})"
    parser.add_argument("--agent", help=whom)
    frame = "scores of who plays and of the other: the position is of a frame, and safeties are judged"
    parser.add_argument("--scores", nargs=2, type=int, metavar=("MINE", "OTHERS"), help=frame)
    cue = "whether rails and balls are in the way of the cue (default: free)"
    parser.add_argument("--cue", choices=CUES, default="free", help=cue)
    parser.add_argument("--json", action="store_true", help="print all figures as JSON")
    add_model_options(parser)
    args = parser.parse_args(argv)
    names = ("agent", "scores", "noise", "n", "samples", "visits", "seed", "trust")
    how: dict[str, Any] = {name: getattr(args, name) for name in names}
    if args.options:
        asked = [args.agent] if args.agent else []
        (how["agent"],) = named(asked, args.trust, options_of_words(args.options))
    advice = advise(Position.load(args.position), options={"cue": args.cue}, **how)
    if args.json:
        print(json.dumps(advice.to_dict(), indent=1))
        return
    print(advice.order)
    for k, one in enumerate(advice, 1):
        (low, high), (least, most) = one.chance_interval, one.points_interval
        chance, points = ("pot", f", points {least:.1f} to {most:.1f}") if one.kind == "pot" else ("fair", "")
        print(f"{k}. {one.words}")
        ends = [100 * end for end in one.win_interval or ()]
        won = "; win chance {:.0f} to {:.0f} %".format(*ends) if ends else ""
        print(f"   {chance} {100 * low:.0f} to {100 * high:.0f} %{points}{won} (95 %)", end="")
        x, y = one.stops or (0.0, 0.0)
        print(f"; cue ball stops at ({x:.2f}, {y:.2f}) m, spread {one.spread:.2f} m" if one.stops else "")


if __name__ == "__main__":
    raise SystemExit(main())
