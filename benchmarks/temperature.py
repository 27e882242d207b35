"""At which temperature should a policy propose the planner's strokes? Points at several, on tables that are
kept for such choices.

    python -m benchmarks.temperature [--temperatures 2 4] [--models ppo_value] [--noise LEVEL] [--visits N]
        [--seed 0] [--json FILE] [--out FOLDER]

Opened tables of their own seeds: no training sees them, and no table of results is played on them. All meet
the same execution errors.
"""

from snooker_env import player
from snooker_env.benchmark import play_visits
from snooker_env.planning.learned import policy_proposals

from ._common.command import Command, at_least, run, save_json

FIRST_SEED = 3_000_000
"""Seed of the first table for choices; those of results begin at 1,000,000. ``--seed`` K takes the K-th
million after it."""


def points(model, temperature, noise, visits, seed):
    """Points of each visit of the planner with that model."""
    usual, policy_proposals.TEMPERATURE = policy_proposals.TEMPERATURE, temperature
    try:
        strokes = play_visits(
            player(f"planner@{model}"),
            visits,
            layout="opened",
            noise=noise,
            first_seed=FIRST_SEED + 1_000_000 * seed,
        )
    finally:
        policy_proposals.TEMPERATURE = usual
    return strokes.a_visit(strokes.points)


def main():
    """Play and print."""
    parser = Command("temperature", __doc__, seed=0)
    parser.add_argument(
        "--temperatures",
        nargs="+",
        type=float,
        default=(2.0, 3.0, 4.0, 6.0),
        help="of the policy's scores [2 3 4 6]",
    )
    parser.add_argument(
        "--models",
        nargs="+",
        default=("professional",),
        help="levels with weights, models or runs [professional]",
    )
    parser.add_argument("--noise", default="professional", help="execution errors [professional]")
    parser.add_argument("--visits", type=at_least(2), default=600, help="visits of each [600]")
    args = parser.options()
    if min(args.temperatures) <= 0:
        parser.error(f"temperatures = {min(args.temperatures)}: must be above 0")
    print(f"{'model':30s}temperature  points a visit  more than at {args.temperatures[0]:g}")
    found = {}
    for model in args.models:
        first = None
        for temperature in args.temperatures:
            made = points(model, temperature, args.noise, args.visits, args.seed)
            first = made if first is None else first
            more = made - first
            found[f"{model} {temperature:g}"] = made.tolist()
            errors = [float(one.std(ddof=1)) / len(one) ** 0.5 for one in (made, more)]
            print(
                f"{model:30s}{temperature:11g}{made.mean():10.1f} ± {errors[0]:.1f}{more.mean():+14.1f} ± {errors[1]:.1f}",
                flush=True,
            )
    save_json(args.json, found)
    return 0


if __name__ == "__main__":
    run(main)
