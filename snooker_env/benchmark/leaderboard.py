"""How are results compared? One table for each task, ranked by the score less luck, at most 100 columns wide."""

from collections.abc import Iterable, Sequence
from textwrap import wrap
from typing import Any

from .._lib.check import refuse_what
from .._lib.text_tables import format_figure, markdown_table, text_table
from .tasks import TASKS, Task

WIDTH = 100
FOLDER = "results/leaderboard"
LEGEND = (
    "Ranked by adjusted, the mean score less luck, with its 95 % interval. anchor: should win nothing, has no rank. training: simulated "
    "shots of training (5 ×: of each of five seeds). shots: simulated shots a decision (d: declared, not counted). *: not official."
)
BEGIN, END = "<!-- tables -->", "<!-- /tables -->"
"""``table --markdown`` writes everything on a page between these lines."""


def is_anchor(result: dict[str, Any]) -> bool:
    """Whether the agent of a result is a policy that should win nothing."""
    agent = result["agent"]
    return agent["class"] == "degenerate" or agent["label"] == "random"


def board(
    results: Iterable[dict[str, Any]], task: Task, *, markdown: bool = False
) -> tuple[list[str], list[list[str]]]:
    """Heading and rows of a task's table, the best agent first; in Markdown with links to the files."""
    mine = [one for one in results if one["task"] == task.id and one["figures"] is not None]
    mine.sort(key=lambda one: (-one["figures"]["adjusted"]["value"], one["agent"]["label"]))
    places = iter(range(1, len(mine) + 1))
    score = "score" if task.counts else "share %"
    head = ["#", "agent", "class", "adjusted", score, "training", "shots"]
    rows = [["" if is_anchor(one) else str(next(places)), *_row(one, task, markdown)] for one in mine]
    return [*head, "result"] if markdown else head, rows


def _row(result: dict[str, Any], task: Task, markdown: bool) -> list[str]:
    """The row of a result, without its rank."""
    agent, figures, scale = result["agent"], result["figures"], 1.0 if task.counts else 100.0
    shots, training, label = agent["simulated_shots"], agent["training_shots"], agent["label"]
    seeds = f"{len(agent['sources'])} × " if len(agent["sources"]) > 1 else ""
    cells = [
        (f"`{label}`" if markdown else label) + ("" if result["protocol"]["official"] else " *"),
        "anchor" if is_anchor(result) else agent["class"],
        format_figure(figures["adjusted"], scale),
        f"{scale * figures['score']['value']:.1f}",
        seeds + ("?" if training is None else _in_short(training)),
        "?" if shots is None else f"{shots:,.0f}{' d' if agent['declared'] else ''}",
    ]
    link = f"[{result['date'][:10]}](../{FOLDER}/{task.id}.{label}.json)"
    return [*cells, link] if markdown else cells


def _in_short(shots: int) -> str:
    """A number of shots with three digits: 18.4 M."""
    for size, unit in ((1e9, " G"), (1e6, " M"), (1e3, " k")):
        if shots >= 0.9995 * size:
            return f"{shots / size:.3g}{unit}"
    return str(shots)


def _tables(results: Sequence[dict[str, Any]], markdown: bool) -> list[str]:
    """The tables of all tasks that have results, line by line."""
    made: list[str] = []
    for task in TASKS.values():
        head, rows = board(results, task, markdown=markdown)
        if rows:
            table = markdown_table(head, rows, 3) if markdown else text_table(head, rows, 3)
            judged = f"Judged by {task.measure}, {task.episodes:,} episodes for each training seed."
            made += [f"{'## ' * markdown}{task.id}: {task.title}", "", *wrap(judged, WIDTH), "", *table, ""]
    return made


def lines(results: Sequence[dict[str, Any]]) -> list[str]:
    """The tables of all tasks, for a terminal."""
    return [*_tables(results, markdown=False), *wrap(LEGEND, WIDTH)]


def page(text: str, results: Sequence[dict[str, Any]]) -> str:
    """A Markdown page with the tables of results without faults between its marks. ValueError if it has none."""
    before, begin, rest = text.partition(f"{BEGIN}\n")
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise refuse_what("markdown", "a page without marks", f"must hold the lines {BEGIN} and {END}")
    return "\n".join([before + begin, *_tables(results, markdown=True), end + after])
