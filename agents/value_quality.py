"""How good is a learned value of positions? What it says before a planner's strokes, beside what followed.

    python -m agents.value_quality --agent planner --visits 500 --noise professional club
    python -m agents.value_quality --agent planner@runs/ppo_value-0 --json quality.json --markdown quality.md

Correlation with what followed: one visit's luck bounds it, so it says which of two values sees more, not how
good one is. Calibration: positions sorted by the value, in ten equal groups; in each the mean of the value
and of what followed. The rule of thumb is judged in the same positions. Standard errors are over visits.
"""

import shlex
import sys
from pathlib import Path

from commands.lifecycle import command, needs, parser_of

with needs("agents.value_quality"):
    import numpy as np

    import snooker_env
    from commands.files import writable, write_atomic, write_json
    from commands.provenance import provenance
    from commands.tables import TextTable, page, show
    from snooker_env.benchmark import play_visits
    from snooker_env.benchmark.tasks import tables_of
    from snooker_env.checks import integer, refuse
    from snooker_env.planning import RULE_OF_THUMB, SURE, Positions, prospects_of
    from snooker_env.players import BoundPlayer
    from snooker_env.tasks import Noise


GROUPS, LEAST = 10, 20
"""Number of groups of positions, fewer where a group would have fewer than ``LEAST``."""


class Recording(BoundPlayer):
    """A planner that notes the values of the positions that it plays from."""

    def __init__(self, planner):
        self._planner, self.name, self.rows = planner, planner.name, []

    def at(self, rules):
        bound = super().at(rules)
        bound._planner = self._planner.at(rules)
        return bound

    def play(self, positions, seeds):
        at, judge = Positions.of(positions), self._planner.judge
        constants = SURE if judge.noise.silent else RULE_OF_THUMB
        rule = prospects_of(at, judge.spread, constants, rails=judge.dynamics.rails)[0]
        self.rows.append(np.column_stack([at.points, judge.value(at), rule]))
        return self._planner.play(at, seeds)


def quality(player, visits, layout, noise):
    """Figures of the value of ``player``, a planner, over so many visits."""
    recording = Recording(player)
    strokes = play_visits(
        recording, visits, layout=layout, noise=noise, cue="real", first_seed=tables_of(layout, visits)
    )
    so_far, value, rule = np.concatenate(recording.rows).T
    visit = strokes.visit  # strokes are in the order of play, as the planner was asked
    followed = strokes.a_visit(strokes.points)[visit] - so_far
    figures = {"layout": layout, "noise": noise, "visits": visits}
    figures |= {"positions": len(visit), "followed": float(followed.mean())}
    for name, of in (("value", value), ("rule", rule)):
        known = of.std() > 0 and followed.std() > 0
        correlation = float(np.corrcoef(of, followed)[0, 1]) if known else 0.0
        figures[name] = {"mean": float(of.mean()), "correlation": correlation}
    groups = np.array_split(np.argsort(value, kind="stable"), max(1, min(GROUPS, len(visit) // LEAST)))
    figures["groups"] = [
        {"value": float(value[rows].mean()), "followed": float(followed[rows].mean())}
        | {"se": _standard_error(followed[rows], visit[rows])}
        for rows in groups
    ]
    return figures


def _standard_error(values, visit):
    """Of a mean over positions, those of a visit taken together."""
    sums, many = np.bincount(visit, values - values.mean()), np.bincount(visit)
    return float(np.sqrt((sums[many > 0] ** 2).sum()) / len(values))


def parts(report):
    """The figures as tables."""
    for one in report["results"]:
        many = f"{one['visits']} visits, {one['positions']:,} positions"
        where = f"{one['layout']}, noise {one['noise']}: {many}"
        rows = [
            [words, f"{one[name]['correlation']:.3f}", f"{one[name]['mean']:.1f}", f"{one['followed']:.1f}"]
            for name, words in (("value", "learned"), ("rule", "rule of thumb"))
        ]
        head = ["value", "correlation with what followed", "mean", "really followed"]
        yield TextTable(where, head, rows, 1, 1)
        rows = [
            [str(k), f"{g['value']:.1f}", f"{g['followed']:.1f} ± {g['se']:.1f}"]
            for k, g in enumerate(one["groups"], 1)
        ]
        title = "Groups of positions, by the learned value"
        yield TextTable(title, ["group", "mean value", "followed (± s. e.)"], rows, 1, 1)


@command("agents.value_quality")
def main(argv=None):
    """Play, compare, report. Exit code 0."""
    p = parser_of("python -m agents.value_quality", __doc__)
    what = "a planner: planner, planner@MODEL, planner_500@MODEL [planner]"
    p.add_argument("--agent", default="planner", help=what)
    p.add_argument("--visits", type=int, default=500, help="visits under each condition [500]")
    p.add_argument("--layouts", nargs="+", default=["held_out"], help="[held_out]")
    what = "levels of execution noise [professional]"
    p.add_argument("--noise", nargs="+", default=["professional"], help=what)
    p.add_argument("--json", type=Path, help="write every figure here")
    p.add_argument("--markdown", type=Path, help="write the tables here")
    argv = sys.argv[1:] if argv is None else argv
    args = p.parse_args(argv)
    try:
        integer("visits", args.visits, 2, 2**20)
        for layout in args.layouts:
            tables_of(layout, args.visits)
        for level in args.noise:
            Noise.of(level)
        if not args.agent.startswith("planner"):
            raise refuse("agent", args.agent, "must be a planner: planner, planner@MODEL")
        snooker_env.player(args.agent)
        for name in ("json", "markdown"):
            writable(name, getattr(args, name))
    except ValueError as error:
        p.error(str(error))
    snooker_env.warmup()
    line = "python -m agents.value_quality " + shlex.join(argv)
    report = {"command": line, "agent": args.agent, **provenance()}
    conditions = [(layout, noise) for layout in args.layouts for noise in args.noise]
    report["results"] = [quality(snooker_env.player(args.agent), args.visits, *each) for each in conditions]
    if args.json:
        write_json(args.json, report)
    if args.markdown:
        made = f"snooker_env {report['version']}, at commit {report['commit']} on {report['machine']}"
        title = f"How good the value of {args.agent} is"
        write_atomic(args.markdown, page(title, line, made, parts(report)))
    show(parts(report))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
