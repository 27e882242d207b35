"""How are learning curves shown? One table for each task that judges the agents, the code of each row, and a picture."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from statistics import median
from typing import Any

from agents._lib.picture_style import GREY, SERIES, drawing, number, page, save
from agents._lib.tables import TextTable
from agents._lib.tables import page as text_page
from snooker_env.checks import refuse

PLACES = {
    "visit": ("points a visit", "{:.1f}"),
    "hard pot": ("share of pots, one stroke", "{:.2f}"),
    "escape": ("share of fair strokes", "{:.2f}"),
    "safety": ("points of lead a stroke", "{:.1f}"),
}
"""Task that judges the agents -> what a point means, and the format of the figures."""
TITLE = "What plain Stable-Baselines3 learns, by the form of the action"
BEGIN, END = "<!-- curves -->\n", "<!-- /curves -->"
"""``agents.curves`` writes everything on a page between these marks."""
LEGEND = (
    "Each cell is the median over training seeds [lowest, highest] of the deterministic policy on held-out tables, with a "
    "professional's errors and a real cue. ± is 1.96 standard errors over the episodes of one seed, for the seed with the largest "
    "error. untrained: the policy before its first shot. PPO plays whole rollouts, so up to 4,095 shots more than stated. shots/s: "
    "shots per second of processor time, learning included."
)
_DASHES = ((0, (1, 2)), (0, (4, 3)), (0, (7, 2, 1, 2)))


def _points(content: dict[str, Any], row: str, shots: int) -> list[dict[str, Any]]:
    return [one for one in content["points"] if (one["row"], one["shots"]) == (row, shots)]


def _shots(content: dict[str, Any], place: str) -> list[int]:
    """The numbers of shots after which this task judged the agents, without 0."""
    known = {one["shots"] for one in content["points"] if content["rows"][one["row"]]["place"] == place}
    return sorted(known - {0})


def _rows(content: dict[str, Any], place: str) -> list[str]:
    known = {one["row"] for one in content["points"]}
    return [name for name, row in content["rows"].items() if row["place"] == place and name in known]


def _spread(values: Sequence[float], form: str) -> str:
    """Median and range, or the value alone if there is only one."""
    low, middle, high = (form.format(value) for value in (min(values), median(values), max(values)))
    return middle if len(values) == 1 else f"{middle} [{low}, {high}]"


def _cell(points: Sequence[dict[str, Any]], form: str) -> str:
    if not points:
        return ""
    error = form.format(1.96 * max(one["error"] for one in points))
    return f"{_spread([one['points'] for one in points], form)} ± {error}"


def _rate(content: dict[str, Any], name: str) -> str:
    """Shots per second of processor time up to the last point of each seed: the median over seeds."""
    last: dict[int, dict[str, Any]] = {}
    for one in content["points"]:
        if one["row"] == name and one["shots"] > last.get(one["seed"], {"shots": 0})["shots"]:
            last[one["seed"]] = one
    rates = [one["played"] / one["processor_seconds"] for one in last.values()]
    return f"{median(rates):,.0f}" if rates else ""


def table_of(content: dict[str, Any], place: str) -> TextTable:
    """The points of the agents that this task judged."""
    (words, form), rows, shots = PLACES[place], [], _shots(content, place)
    for name in _rows(content, place):
        cells = [_cell(_points(content, name, k), form) for k in (0, *shots)]
        seeds = {one["seed"] for one in content["points"] if one["row"] == name}
        algorithm = content["rows"][name]["algorithm"]
        rows.append([name, algorithm, *cells, _rate(content, name), str(len(seeds))])
    beside = ", ".join(f"{player} {_cell([one], form)}" for player, one in levels_at(content, place).items())
    title = f"{place[0].upper()}{place[1:]}: {words}" + (f". For comparison: {beside}" if beside else "")
    head = ["row", "algorithm", "untrained", *(f"{k:,} shots" for k in shots), "shots/s", "seeds"]
    return TextTable(title, head, rows, 2, 2)


def tables_of(content: dict[str, Any]) -> Iterator[TextTable]:
    """One table for each task that judged agents."""
    yield from (table_of(content, place) for place in PLACES if _rows(content, place))


def levels_at(content: dict[str, Any], place: str) -> dict[str, dict[str, Any]]:
    """The points of players that do not learn on this task, by name."""
    return {one["player"]: one for one in content["levels"] if one["place"] == place}


def _code(content: dict[str, Any]) -> str:
    """The code that each row trains."""
    known = {one["row"] for one in content["points"]}
    return "\n".join(f"* {name}: `{row['code']}`" for name, row in content["rows"].items() if name in known)


def title(content: dict[str, Any]) -> str:
    """The heading of the report."""
    return f"{TITLE}: {content['visits']} episodes a point"


def parts(content: dict[str, Any]) -> Iterator[TextTable | str]:
    """Yield tables no wider than a terminal, and sentences, in order."""
    for table in tables_of(content):
        yield from table.narrow()
    yield LEGEND
    yield from _code(content).splitlines()


def markdown(content: dict[str, Any]) -> str:
    """The page of the curves."""
    made = content["made"]
    commands = "\n".join(dict.fromkeys(one["command"] for one in made))
    where = "; ".join(
        dict.fromkeys(
            f"{one['software']['snooker_env']} at {one['commit']} on {one['machine']}, Python {one['software']['python']}"
            for one in made
        )
    )
    return text_page(
        title(content), commands, f"snooker_env {where}", [*tables_of(content), LEGEND, _code(content)]
    )


def fill(text: str, content: dict[str, Any], file: Path) -> str:
    """Fill the marked part of a page in ``docs/agents`` with the points of visits. ValueError if the page has no marks."""
    before, begin, rest = text.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise refuse("page", str(file), f"must hold the lines {BEGIN.strip()} and {END}")
    table = table_of(content, "visit")
    shown = [0, *(k for k, head in enumerate(table.header) if head.endswith(" shots"))]
    rows = [[row[k].partition(" ±")[0] for k in shown] for row in table.rows]
    points = TextTable(table.title, [table.header[k] for k in shown], rows, 1, 1).markdown()
    picture = "![points a visit by shots of training](../../results/pictures/curves.png)"
    words = (
        "Each cell is the median over training seeds [lowest, highest] on held-out tables, which no agent trains on. "
        "[All rows](../../results/agents/curves.md) has errors, rates and code; `bash results/make.sh curves` makes them."
    )
    return "\n\n".join([before + begin.strip(), picture, points, words, end + after])


def draw(content: dict[str, Any], file: Path) -> None:
    """Draw the curves of visits: one panel for the menu and one for the other forms of action."""
    shots, others = _shots(content, "visit"), levels_at(content, "visit")
    note = (
        f"Points a visit of the deterministic policy on {content['visits']} held-out tables, a professional's errors, a real cue.\n"
        "Line: median over training seeds; band: their range. Dashed: players that do not learn."
    )
    with drawing() as plt:
        figure, panels = page(plt, 5.2, TITLE, note, rows=1, columns=2, sharey=True)
        for axes, menu in zip(panels, (True, False), strict=True):
            rows = [
                name
                for name in _rows(content, "visit")
                if (content["rows"][name]["form"] == "strokes") == menu
            ]
            for name, colour in zip(rows, SERIES, strict=False):
                at = {
                    k: [one["points"] for one in found] for k in shots if (found := _points(content, name, k))
                }
                axes.plot(list(at), list(map(median, at.values())), color=colour, marker="o", label=name)
                low, high = list(map(min, at.values())), list(map(max, at.values()))
                axes.fill_between(list(at), low, high, color=colour, alpha=0.2, linewidth=0)
            for (player, one), dashes in zip(others.items(), _DASHES, strict=False):
                label = f"{player} {one['points']:.1f}"
                axes.axhline(one["points"], color=GREY, linewidth=1.2, linestyle=dashes, label=label)
            axes.set_xscale("log")
            axes.set_xticks(shots, list(map(number, shots)))
            axes.set_xticks([], minor=True)
            of_menu = 'action="strokes", observation="strokes"'
            axes.set(title=of_menu if menu else 'action="box"', xlabel="shots of training", ylim=(0, None))
            axes.legend(loc="upper left", bbox_to_anchor=(0.0, -0.2), ncols=2)
        panels[0].set_ylabel("points a visit")
        save(figure, file)
