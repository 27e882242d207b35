"""How is an evaluation reported? As tables and sentences for a terminal or in Markdown, all from its figures.

    python -m agents.report results/agents/*.json

rewrites ``results/agents/*.md`` from the JSON of agents.evaluate, agents.tournament and agents.curves, without playing. --show
prints the tables instead.
"""

import re
from functools import partial
from itertools import product
from pathlib import Path

from agents._lib.lifecycle import command, needs, parser_of

with needs("agents.report"):
    from agents._lib.files import read_json, write_atomic
    from agents._lib.tables import WIDTH, TextTable, format_figure, page, show
    from snooker_env.checks import refuse

    from .evaluation import curve_report, tournament_report
    from .evaluation.curve_file import is_curves
    from .evaluation.metrics import AXES, USUAL, add_bound, main_condition
    from .evaluation.visit_figures import CENTURY, FIGURES, MAXIMUM, most_points

SEEDS = 5
"""The report points out fewer training seeds than this."""
SAME = 0.1
"""Times that differ by less than this share count as equal."""
_pm = partial(format_figure, form="{:.2f}")


def _trials(row, below):
    """How many times a run could have done it: the entry ``below`` of ``visit_figures.counts``; None if not kept."""
    f, visits = row["figures"], row["visits"]
    known = {"visits": visits, "strokes": row["strokes"] / row["runs"]}
    if f["pots_a_visit"]["value"] is not None and f["clearances"]["value"] is not None:
        known["goes_on"] = visits * (f["pots_a_visit"]["value"] - f["clearances"]["value"])
    return (known | row.get("counted", {})).get(below)


_MEANS = "points_a_visit", "adjusted_a_visit", "pots_a_visit", "colour_value"
SHARES = {name: below for name, (_, below) in FIGURES.items() if name not in _MEANS}
"""Figures that are shares, with their denominators. A visit ends with its first foul, so fouls a visit are a share."""


def _share(row, name, form="{:.1f}", scale=100.0):
    """A share with its interval; if it is 0 or 1, with the exact bound."""
    return format_figure(add_bound(row["figures"][name], _trials(row, SHARES[name])), scale, form)


def _between(values, form="{:,.0f}"):
    """One number, or the smallest and largest of several."""
    known = [v for v in values if v is not None]
    if not known:
        return ""
    low, high = form.format(min(known)), form.format(max(known))
    return low if low == high else f"{low} to {high}"


def _pick(report, **condition):
    return [r for r in report["results"] if all(r[key] == value for key, value in condition.items())]


def _other(report):
    """The module that shows this report, unless it is an evaluation."""
    if tournament_report.is_tournament(report):
        return tournament_report
    return curve_report if is_curves(report) else None


def verdict(report):
    """Yield one sentence with the points of each agent in the main condition, or nothing if it was not played."""
    at = main_condition(report)
    made = [f"{row['agent']} {_pm(row['figures']['points_a_visit'])}" for row in _pick(report, **at)]
    return [f"Points a visit on {at['layout']}, noise {at['noise']}: {', '.join(made)}."] if made else []


def _list(words):
    """Join words into a list for a sentence."""
    *others, last = map(str, words)
    return f"{', '.join(others)} and {last}" if others else last


def title(report):
    """The heading: the axis of training and play compared, or the agents and their tables; or the tournament or curves."""
    if other := _other(report):
        return other.title(report)
    p, layouts = report["protocol"], _list(report["protocol"]["layouts"])
    for axis in AXES:
        runs = [run for agent in report["agents"] for run in agent["runs"] if axis in run]
        if len({str(run[axis]) for run in runs}) > 1 and len(p[axis]) > 1:
            who = "planners" if all(run["from"].startswith("planner") for run in runs) else "agents"
            return f"How {who} trained under one {axis} play under another, on {layouts}: {_list(p[axis])}"
    under = "" if len(p["noise"]) > 1 or p["noise"] == [USUAL["noise"]] else f", noise {p['noise'][0]}"
    return f"How {_list(agent['label'] for agent in report['agents'])} play on {layouts}{under}"


def agents_table(report):
    """A table of how and how long each agent was trained, and a sentence on those that were not."""
    rows, known = [], {"Pre-trained, by the noise played": [], "Not trained": []}
    for agent in report["agents"]:
        runs, label = agent["runs"], agent["label"]
        if "recipe" not in runs[0]:
            by_noise = re.fullmatch(r"(planner|tactician)(_\d+)?|stroke_value", runs[0]["from"])
            known["Pre-trained, by the noise played" if by_noise else "Not trained"].append(label)
            continue
        words = [", ".join(sorted({str(run[key]) for run in runs})) for key in ("recipe", *AXES)]
        numbers = [_between([run[key] for run in runs]) for key in ("imitated", "shots", "seconds")]
        gammas = ", ".join(sorted({f"{run['gamma']:g}" for run in runs}))
        rows.append([label, *words, gammas, str(_seeds(runs)), *numbers])
    how = ["agent", "recipe", "trained: noise", *AXES[1:], "gamma", "seeds", "imitated", "shots", "seconds"]
    table = TextTable("The agents that were trained", how, rows, 1, 2 + len(AXES))
    return [table, *(f"{how}: {', '.join(labels)}." for how, labels in known.items() if labels)]


def _seeds(runs):
    """Number of training seeds of these runs; a model given twice counts once."""
    return len({run["seed"] for run in runs})


_SECONDS = "seconds", "seconds of training", SAME
COSTS = (("imitated", "positions imitated", 0.0), ("shots", "shots", 0.0), _SECONDS)
"""Costs of a training: key, name, and the relative difference that counts as equal."""


def fairness(report):
    """Yield sentences: did the trained agents get equal resources, and are the tables new to them?"""
    trained, sentences = [agent for agent in report["agents"] if "recipe" in agent["runs"][0]], []
    for agent in trained:
        label, n = agent["label"], _seeds(agent["runs"])
        if n == 1:
            sentences.append(f"{label} has 1 training seed: its intervals do not cover other seeds.")
        elif n < SEEDS:
            sentences.append(f"{label} has {n} training seeds, fewer than {SEEDS}.")
        known = {run["layout"] for run in agent["runs"]} & {*report["protocol"]["layouts"], USUAL["layout"]}
        told = "was trained on layout"
        sentences += [f"{label} {told} {layout}: its tables are not new to it." for layout in sorted(known)]
    for key, name, share in COSTS if len(trained) > 1 else ():
        costs = {agent["label"]: [run[key] for run in agent["runs"]] for agent in trained}
        unknown = ", ".join(label for label, values in costs.items() if None in values)
        if unknown:
            whether = f"Whether the trained agents had equal {name} is not known"
            sentences.append(f"{whether}: no record for {unknown}.")
            continue
        values = [value for some in costs.values() for value in some]
        same = "equal" if max(values) <= (1 + share) * min(values) else "unequal"
        sentences.append(f"The trained agents had {same} {name} ({_between(values)}).")
    return sentences


def cross(report):
    """Points a visit of every agent under every value of each axis with several values."""
    p, tables = report["protocol"], []
    at = main_condition(report)
    for layout in p["layouts"]:
        for axis in AXES:
            if len(p[axis]) < 2:
                continue
            rest = {key: at[key] for key in AXES if key != axis} | {"layout": layout}
            rows = []
            for agent in report["agents"]:
                made = ", ".join(sorted({str(run[axis]) for run in agent["runs"] if axis in run}))
                played = [_pick(report, agent=agent["label"], **rest, **{axis: value}) for value in p[axis]]
                points = (_pm(some[0]["figures"]["points_a_visit"]) if some else "" for some in played)
                rows.append([agent["label"], made, *points])
            under = ", ".join(f"{key} {value}" for key, value in rest.items() if key != "layout")
            title = f"{layout}: points a visit, played under {axis} ..., {under}"
            tables.append(TextTable(title, ["agent", "trained under", *p[axis]], rows, 2, 2))
    return tables


def conditions(report):
    """One table per layout and condition: points, and how the cue ball was placed."""
    p, tables = report["protocol"], []
    keys = ["noise", "agent"] if len(p["noise"]) > 1 else ["agent"]
    under = "" if len(p["noise"]) > 1 else f"noise {p['noise'][0]}, "
    for layout, visits in p["layouts"].items():
        for physics, fidelity, cue in product(p["physics"], p["fidelity"], p["cue"]):
            rows = _pick(report, layout=layout, physics=physics, fidelity=fidelity, cue=cue)
            where = f"{layout}, {visits:,} visits, {under}physics {physics}, fidelity {fidelity}, {cue} cue"
            columns = _columns(p["against"], most_points(layout))
            cells = [[*(r[key] for key in keys), *(cell(r) for cell in columns.values())] for r in rows]
            tables.append(TextTable(where, [*keys, *columns], cells, len(keys), len(keys), len(keys) > 1))
    return tables


def _columns(against, most):
    """The columns of a condition's table: heading -> cell of a result. Omits breaks above ``most`` points."""

    def figure(name):
        return lambda r: _pm(r["figures"][name])

    def share(name, *more):
        return lambda r: _share(r, name, *more)

    def times(other):
        return lambda r: _pm(r["ratios"][other]["points_a_visit"]) if other in r["ratios"] else ""

    breaks = {"centuries %": ("centuries", CENTURY), "147s %": ("maximums", MAXIMUM)}
    breaks["clearances %"] = ("clearances", 0)
    return {
        "points a visit": figure("points_a_visit"),
        "adjusted": figure("adjusted_a_visit"),
        "IQM": lambda r: _between([r["figures"]["points_a_visit_iqm"]["value"]], "{:.2f}"),
        **{f"times {other}": times(other) for other in against},
        **{heading: share(name) for heading, (name, least) in breaks.items() if least <= most},
        "best": lambda r: str(r["longest_break"]),
        "pot rate %": share("pot_rate"),
        "next pot %": share("next_pot_after_a_pot"),
        "easy left %": share("easy_pot_left_by_a_pot"),
        "high after red %": share("high_colour_after_a_red"),
        "fouls a visit": share("fouls_a_visit", "{:.2f}", 1.0),
        "ms": lambda r: f"{r['ms_a_decision']:.2f}",
    }


LEGEND = (
    "[low, high]: 95 % bootstrap interval over training seeds and visits, or the exact one-sided bound if an event occurred never or "
    "always. adjusted: points less luck (docs/benchmark.md). IQM: mean of the middle half. times X: ratio to the points of X on the same "
    "tables, paired. next pot: share of pots that another pot followed, among those that left a ball. easy left: share of the same pots "
    "that left a pot with a tolerance of at least 4 mrad. high after red: share of potted reds followed by a potted pink or black. ms: "
    "time per decision, all tables played together."
)


def parts(report, width=WIDTH):
    """Yield the whole report in order: ``TextTable`` (none wider than ``width``) or str."""
    if other := _other(report):
        yield from other.parts(report)
        return
    if "incomplete" in report:
        yield f"INCOMPLETE: {report['incomplete']}."
    for made in (agents_table, fairness, cross, conditions):
        for part in made(report):
            yield from [part] if isinstance(part, str) else part.tidy().narrow(width)
    yield LEGEND


def markdown(report):
    """The whole report as a Markdown page."""
    if other := _other(report):
        return other.markdown(report)
    of, where = report["software"], f"commit {report['commit']} on {report['machine']}"
    made = f"snooker_env {of['snooker_env']}, at {where}, Python {of['python']}"
    return page(title(report), report["command"], made, parts(report, 160))


def read(file):
    """Read the report in a JSON file. Raises ValueError."""
    wanted = (
        "must be a file written by agents.evaluate --json, agents.tournament --out or agents.curves --out"
    )
    report = read_json("file", file, wanted)
    try:
        list(parts(report))
        title(report)
    except (ValueError, LookupError, TypeError, AttributeError, ArithmeticError, RuntimeError):
        raise refuse("file", str(file), wanted) from None
    return report


@command("agents.report")
def main(argv=None):
    """Rewrite the Markdown from kept figures, or print it. Exit code 0."""
    p = parser_of("python -m agents.report", __doc__)
    what = "file written by agents.evaluate --json, agents.tournament --out or agents.curves --out"
    p.add_argument("files", nargs="+", type=Path, metavar="FILE.json", help=what)
    p.add_argument("--show", action="store_true", help="print the tables and write nothing")
    args = p.parse_args(argv)
    try:
        reports = {file: read(file) for file in args.files}
    except ValueError as error:
        p.error(str(error))
    for file, report in reports.items():
        if args.show:
            show(parts(report))
            continue
        target = file.with_suffix(".md")
        write_atomic(target, markdown(report))
        print(target)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
