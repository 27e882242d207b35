"""``python -m snooker_env.advice --position FILE --agent NAME``: what would a player do in a position?"""

import argparse
import json
import sys
from collections.abc import Sequence

from ..planning import Position
from ..players import players
from ..tasks.noise import LEVELS
from .ask import AGENT, advise


def main(argv: Sequence[str] | None = None) -> int:
    """Print advice for a position."""
    parser = argparse.ArgumentParser(
        "python -m snooker_env.advice", description="Ranked strokes of a player, and their outcomes."
    )
    parser.add_argument(
        "--position",
        required=True,
        metavar="FILE",
        help="JSON of a position: from Position.save, or hand-written",
    )
    parser.add_argument(
        "--agent",
        default=AGENT,
        help=f"{', '.join(players())}, a model's .zip or MODULE:CLASS (default: {AGENT})",
    )
    parser.add_argument(
        "--noise",
        default="professional",
        help=f"execution errors: {', '.join(LEVELS)} (default: professional)",
    )
    parser.add_argument("--n", type=int, default=5, help="largest number of strokes (default: 5)")
    parser.add_argument(
        "--samples", type=int, default=200, help="noise samples of each stroke (default: 200)"
    )
    parser.add_argument(
        "--visits", type=int, default=40, help="visits of each that are continued (default: 40)"
    )
    parser.add_argument("--seed", type=int, default=0, help="seed of the noise samples (default: 0)")
    parser.add_argument("--json", action="store_true", help="print all figures as JSON")
    parser.add_argument("--trust", action="store_true", help="let code in a model's file run")
    args = parser.parse_args(argv)
    try:
        names = ("agent", "noise", "n", "samples", "visits", "seed", "trust")
        advice = advise(Position.load(args.position), **{name: getattr(args, name) for name in names})
    except (ValueError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    if args.json:
        print(json.dumps(advice.to_dict(), indent=1))
        return 0
    print(advice.order)
    for k, one in enumerate(advice, 1):
        (low, high), (least, most) = one.chance_interval, one.points_interval
        points = f", points {least:.1f} to {most:.1f}" if one.kind == "pot" else ""
        print(f"{k}. {one.words}")
        print(
            f"   {'chance' if one.kind == 'pot' else 'fair'} {100 * low:.0f} to {100 * high:.0f} %{points} (95 %)",
            end="",
        )
        print(
            ""
            if one.stops is None
            else f"; cue ball stops at ({one.stops[0]:.2f}, {one.stops[1]:.2f}) m, spread {one.spread:.2f} m"
        )
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
