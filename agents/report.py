"""How is an evaluation told? Its tables and sentences, for a terminal and as Markdown; every word follows from the figures.

``report`` is what agents/evaluate.py writes as JSON.
"""

from dataclasses import dataclass

SEEDS = 5
"""Fewer training seeds than that are pointed out."""
SAME = 0.1
"""Times that differ by less than this share are called equal."""
AXES = ("noise", "fidelity", "physics")
USUAL = {"layout": "held_out", "noise": "professional", "fidelity": "standard", "physics": "paper"}


@dataclass
class Table:
    """Cells as text; the first ``left`` columns are words, the others numbers."""

    title: str
    header: list
    rows: list
    left: int
    grouped: bool = False
    """Whether rows with the same first cell belong together."""


def _pm(figure, form="{:.2f}", scale=1.0):
    """A figure with its interval."""
    if figure["value"] is None:
        return ""
    value = form.format(scale * figure["value"])
    if figure["low"] is None:
        return value
    return f"{value} [{form.format(scale * figure['low'])}, {form.format(scale * figure['high'])}]"


def _share(figure):
    return _pm(figure, "{:.1f}", 100.0)


def _between(values, form="{:,.0f}"):
    """One number, or the least and the most of several."""
    known = [v for v in values if v is not None]
    if not known:
        return ""
    low, high = form.format(min(known)), form.format(max(known))
    return low if low == high else f"{low} to {high}"


def _picked(report, **condition):
    return [r for r in report["results"] if all(r[key] == value for key, value in condition.items())]


def main_condition(report):
    """Where the comparison in words, and the picture, are taken: the usual of everything that was played, else its first value."""
    p = report["protocol"]
    return {
        name: USUAL[name] if USUAL[name] in p[key] else next(iter(p[key]))
        for name, key in (("layout", "layouts"), *zip(AXES, AXES, strict=True))
    }


def agents_table(report):
    """Who plays, and how each was trained."""
    header = ["agent", "recipe", "trained: noise", "fidelity", "physics", "seeds", "gamma", "taught", "shots", "seconds", "shots/s"]
    rows = []
    for agent in report["agents"]:
        runs = agent["runs"]
        if "recipe" not in runs[0]:
            rows.append([agent["label"], "not trained", "", "", "", str(len(runs)), *[""] * (len(header) - 6)])
            continue
        words = [", ".join(sorted({str(run[key]) for run in runs})) for key in ("recipe", "noise", "fidelity", "physics")]
        rates = [run["shots"] / run["seconds"] if run["seconds"] else None for run in runs]
        numbers = [_between([run[key] for run in runs]) for key in ("imitated", "shots", "seconds")]
        gammas = ", ".join(sorted({f"{run['gamma']:g}" for run in runs}))
        rows.append([agent["label"], *words, str(_seeds(runs)), gammas, *numbers, _between(rates)])
    return Table("The agents", header, rows, left=5)


def _seeds(runs):
    """Training seeds of these runs: a model given twice is one."""
    return len({run["seed"] for run in runs})


GIVEN = (("imitated", "positions taught", 0.0), ("shots", "shots", 0.0), ("seconds", "seconds of training", SAME))
"""What agents are given: how it is kept, how it is called, and by what share it may differ to be called equal."""


def fairness(report):
    """Sentences: were the trained agents given the same, and are the tables new to them?"""
    trained = [agent for agent in report["agents"] if "recipe" in agent["runs"][0]]
    said = []
    for agent in trained:
        n = _seeds(agent["runs"])
        if n < SEEDS:
            few = "1 training seed: its intervals say nothing about other seeds" if n == 1 else f"{n} training seeds, fewer than {SEEDS}"
            said.append(f"{agent['label']} has {few}.")
        known = {run["layout"] for run in agent["runs"]} & {*report["protocol"]["layouts"], USUAL["layout"]}
        said += [f"{agent['label']} was trained on layout {layout}: its tables are not new to it." for layout in sorted(known)]
    if len(trained) > 1:
        for key, name, share in GIVEN:
            given = {agent["label"]: [run[key] for run in agent["runs"]] for agent in trained}
            unknown = [label for label, values in given.items() if None in values]
            values = [value for some in given.values() for value in some]
            if unknown:
                said.append(f"Whether the trained agents had equal {name} cannot be said: not known of {', '.join(unknown)}.")
            elif max(values) <= (1 + share) * min(values):
                said.append(f"The trained agents had equal {name} ({_between(values)}).")
            else:
                said.append(f"The trained agents had unequal {name} ({_between(values)}).")
    return said


def comparison(report):
    """Sentences: each agent against those it is compared with."""
    at, said, told = main_condition(report), [], set()
    rows = {r["agent"]: r for r in _picked(report, **at)}
    for name, row in rows.items():
        for other, ratios in row["ratios"].items():
            if (other, name) in told:  # the other way round
                continue
            told.add((name, other))
            ratio, mine, its = ratios["points_a_visit"], row["figures"], rows[other]["figures"]
            if ratio["value"] is None or ratio["low"] is None:
                continue
            apart = ratio["low"] > 1 or ratio["high"] < 1
            start = f"{name} makes {_pm(ratio)} times the points of {other}"
            start += "" if apart else f", a difference that {row['visits']:,} visits do not show"
            shares = [
                f"{words} {100 * mine[key]['value']:.1f} against {100 * its[key]['value']:.1f} %"
                for key, words in (
                    ("next_pot_after_a_pot", "after a pot it pots again:"), ("easy_pot_left_by_a_pot", "an easy pot is left:"),
                    ("high_colour_after_a_red", "after a red it pots pink or black:"),
                ) if mine[key]["value"] is not None and its[key]["value"] is not None
            ]  # fmt: skip
            said.append(f"{start}; {'; '.join(shares)}." if shares else f"{start}.")
    where = ", ".join(f"{key} {value}" for key, value in at.items())
    return [f"On {where}:", *said] if said else []


def crossed(report):
    """Points a visit of every agent under every value of an axis that has more than one."""
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
                cells = [
                    _pm(_picked(report, agent=agent["label"], **rest, **{axis: value})[0]["figures"]["points_a_visit"]) for value in p[axis]
                ]
                rows.append([agent["label"], made, *cells])
            under = ", ".join(f"{key} {value}" for key, value in rest.items() if key != "layout")
            header = ["agent", f"trained under {axis}", *(f"played under {value}" for value in p[axis])]
            tables.append(Table(f"{layout}: points a visit, {under}", header, rows, left=2))
    return tables


def conditions(report):
    """Two tables for every layout and world: what was scored, and how the cue ball was placed."""
    p, tables = report["protocol"], []
    for layout, visits in p["layouts"].items():
        for physics in p["physics"]:
            for fidelity in p["fidelity"]:
                scored, placed = [], []
                for r in _picked(report, layout=layout, physics=physics, fidelity=fidelity):
                    f, head = r["figures"], [r["noise"], r["agent"]]
                    ratios = [_pm(r["ratios"][other]["points_a_visit"]) if other in r["ratios"] else "1" for other in p["against"]]
                    scored.append(
                        [*head, _pm(f["points_a_visit"]), _pm(f["points_a_visit_iqm"]), *ratios, _pm(f["pots_a_visit"]),
                         _pm(f["pots_a_visit_iqm"]), *(_share(f[key]) for key in ("centuries", "maximums", "clearances")),
                         str(r["longest_break"])]
                    )  # fmt: skip
                    shares = ("pot_rate", "next_pot_after_a_pot", "easy_pot_left_by_a_pot")
                    colours = ("high_colours", "high_colour_after_a_red")
                    placed.append(
                        [*head, *(_share(f[key]) for key in shares), _pm(f["colour_value"]), *(_share(f[key]) for key in colours),
                         _pm(f["fouls_a_visit"]), f"{r['ms_a_decision']:.2f}"]
                    )  # fmt: skip
                where = f"{layout}, {visits:,} visits, physics {physics}, fidelity {fidelity}"
                times = [f"times {other}" for other in p["against"]]
                tables.append(
                    Table(f"{where}: what was scored", ["noise", "agent", "points a visit", "inter-quartile", *times, "pots a visit",
                          "inter-quartile", "centuries %", "147s %", "clearances %", "best"], scored, 2, True)
                )  # fmt: skip
                tables.append(
                    Table(f"{where}: how the cue ball was placed", ["noise", "agent", "pot rate %", "next pot %", "easy left %",
                          "colour's value", "high colours %", "high after red %", "fouls a visit", "ms"], placed, 2, True)
                )  # fmt: skip
    return tables


LEGEND = (
    "[low, high]: 95 % bootstrap interval over training seeds and visits. inter-quartile: mean of the middle half of all visits. "
    "times X: points over those of X on the same tables, paired. next pot: pots that left a ball and were followed by another. "
    'easy left: of these, those that left a pot whose line may err by 4 mrad, as on "pots:easy". high: pink or black, of all colours '
    "potted, and after all reds potted. ms: a decision's time, all tables played at once."
)


def parts(report):
    """Everything in order: ``Table`` or str."""
    return [agents_table(report), *fairness(report), *comparison(report), *crossed(report), *conditions(report), LEGEND]


def show(report):
    """Print it; tables are as wide as they need."""
    import rich.box
    import rich.console
    import rich.table

    narrow, wide = rich.console.Console(), rich.console.Console(width=1000)
    for part in parts(report):
        if isinstance(part, str):
            narrow.print(part, highlight=False, markup=False)
            continue
        table = rich.table.Table(title=part.title, box=rich.box.SIMPLE, pad_edge=False, title_justify="left")
        for k, name in enumerate(part.header):
            table.add_column(name, justify="left" if k < part.left else "right", no_wrap=True)
        for k, row in enumerate(part.rows):
            if k and part.grouped and row[0] != part.rows[k - 1][0]:
                table.add_section()
            table.add_row(*(cell.replace("[", "\\[") for cell in row))
        wide.print(table)


def markdown(report, picture=None):
    """The same as one Markdown text."""
    out = [
        "# How the agents play", "", "Made by", "", "```bash", report["command"], "```", "",
        f"at commit {report['commit']} on {report['machine']}, Python {report['python']}.", "",
    ]  # fmt: skip
    if picture:
        out += [f"![where the cue ball stops after a red, and what follows]({picture})", ""]
    for part in parts(report):
        if isinstance(part, str):
            out += [part, ""]
            continue
        marks = [":--" if k < part.left else "--:" for k in range(len(part.header))]
        out += [f"**{part.title}**", ""]
        out += ["| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in (part.header, marks, *part.rows)]
        out.append("")
    return "\n".join(out)
