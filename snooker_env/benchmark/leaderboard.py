"""How are results compared? A table for each task, and performance profiles, at most 100 columns wide."""

from collections.abc import Iterable, Sequence
from html import escape
from textwrap import wrap
from typing import Any

from .._lib.text_tables import format_figure, markdown_table, text_table
from .tasks import TASKS, Task

WIDTH = 100
CLASSES = {
    "model_free": "model-free",
    "foresight": "foresight",
    "planning": "planning",
    "undeclared": "undecl.",
    "degenerate": "degenerate",
}
# The budgets in the order of the table
TRAINED = {"none": "0", "50k": "50 k", "1M": "1 M", "5M": "5 M", "open": "open", "unknown": "?"}
Table = tuple[list[str], list[list[str]]]  # heading and rows

LEGEND = (
    "adjusted: the score less luck, by which agents are sorted, with its 95 % bootstrap interval over training seeds and episodes; a share "
    "that was never or always seen has the exact one-sided 95 % bound. score: mean of all episodes. IQM: mean of the middle half. "
    "training: the budget of simulated shots. seeds: training seeds. shots: simulated shots a decision (d: declared). ms: time of a "
    "decision on one table. *: not official. Left out: thresholds that no agent reached and, on the page, all but the best degenerate "
    "agent."
)
PROVED = (
    "A result is its strokes: check plays each episode again from its seed and computes all figures anew. "
    "[What a file cannot prove](benchmark.md#what-a-file-cannot-prove) is the word of its author; to doubt a row, let its agent play on "
    "fresh seeds."
)


def plain(text: str) -> str:
    """A text that a file gives, as one line of Markdown without markup of its own."""
    safe = escape(text, quote=False).replace("[", "&#91;").replace("`", "&#96;")
    return " ".join(safe.split())


def board(results: Iterable[dict[str, Any]], task: Task) -> Table:
    """A task's table: classes and budgets apart, the best first."""

    def order(result: dict[str, Any]) -> tuple[int, int]:
        agent = result["agent"]
        return list(CLASSES).index(agent["class"]), list(TRAINED).index(agent["budget"])

    score = "score" if task.counts else "share %"
    head = ["class, training", "agent", "adjusted", score, "IQM", "seeds", "shots", "ms"]
    rows = [_row(result, task) for result in sorted(_of(results, task), key=order)]
    keep = [c for c, name in enumerate(head) if task.counts or name != "IQM"]
    return [head[c] for c in keep], [[row[c] for c in keep] for row in rows]


def _of(results: Iterable[dict[str, Any]], task: Task) -> list[dict[str, Any]]:
    """The results of a task that have figures, the best first: by what is less luck."""
    mine = [one for one in results if one["task"] == task.id and one["figures"] is not None]
    return sorted(mine, key=lambda one: (-one["figures"]["adjusted"]["value"], one["agent"]["label"]))


def _row(result: dict[str, Any], task: Task) -> list[str]:
    """The row of a result."""
    agent, figures, alone = result["agent"], result["figures"], result["timing"]["one_table_ms"]
    shots, middle, scale = agent["simulated_shots"], figures["iqm"], 1.0 if task.counts else 100.0
    return [
        f"{CLASSES[agent['class']]}, {TRAINED[agent['budget']]}",
        agent["label"] + ("" if result["protocol"]["official"] else " *"),
        format_figure(figures["adjusted"], scale),
        f"{scale * figures['score']['value']:.1f}",
        "" if middle is None else f"{middle['value']:.1f}",
        str(len(agent["sources"])),
        "?" if shots is None else f"{shots:,.0f}{' d' if agent['declared'] else ''}",
        "" if alone is None else _ms(alone),
    ]


def _ms(value: float) -> str:
    """Milliseconds with three digits."""
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}" if value >= 0.01 else "<0.01"


def profile(results: Iterable[dict[str, Any]], task: Task) -> Table:
    """The performance profile: share of episodes [%] with at least so many points, a row for each agent."""
    rows = []
    for one in _of(results, task):
        shares = [_share(figure) for figure in one["figures"]["profile"]]
        rows.append([one["agent"]["label"], *shares, str(one["figures"]["best"])])
    return ["agent", *(f">= {t}" for t in task.thresholds if t <= task.most), "best"], rows


def _share(figure: dict[str, Any]) -> str:
    """A share [%]; where it was never or always seen, the exact bound of it."""
    sign, name = ">= ", "low"
    if not figure["exact"] or figure["value"] == 0.0:
        sign, name = ("<= ", "high") if figure["exact"] else ("", "value")
    return f"{sign}{100 * figure[name]:.1f}"


def _reached(table: Table) -> Table:
    """A profile without the thresholds that no agent reached."""
    head, rows = table
    keep = [c for c in range(len(head)) if not all(row[c].startswith("<=") for row in rows)]
    return [head[c] for c in keep], [[row[c] for c in keep] for row in rows]


def lines(
    results: Sequence[dict[str, Any]], *, markdown: bool = False, awaited: Sequence[str] = ()
) -> list[str]:
    """Leaderboard and profiles of all tasks; labels ``awaited`` are named where their result is missing."""

    def table(head: list[str], rows: list[list[str]], label: int, left: int = 1) -> list[str]:
        """A table whose column ``label`` holds labels: of a page as plain text."""
        if not markdown:
            return text_table(head, rows, left)
        safe = [[plain(cell) if c == label else cell for c, cell in enumerate(row)] for row in rows]
        return markdown_table(head, safe, left)

    made: list[str] = []
    for task in TASKS.values():
        seeing = [one for one in results if one["agent"]["class"] != "degenerate"]
        blind = _of((one for one in results if one["agent"]["class"] == "degenerate"), task)
        head, rows = board([*seeing, *(blind[:1] if markdown else blind)], task)
        labels = {one["agent"]["label"] for one in results if one["task"] == task.id}
        lacking = [label for label in awaited if label not in labels]
        if not rows and not lacking:
            continue
        judged = f"Judged by {task.measure}, {task.episodes:,} episodes."
        made += [f"{'## ' if markdown else ''}{task.id}: {task.title}", "", *wrap(judged, WIDTH), ""]
        made += [*table(head, rows, 1, 2), ""] if rows else []
        made += [*wrap(f"Missing: {', '.join(lacking)}.", WIDTH), ""] if lacking else []
        shares = profile(seeing, task)
        if task.counts and shares[1]:
            title = "Share of episodes [%] with at least so many points, of agents that look at the table:"
            made += [title, "", *table(*_reached(shares), 0), ""]
    return [*made, *wrap(LEGEND, WIDTH)]


def page(results: Sequence[dict[str, Any]], awaited: Sequence[str] = ()) -> str:
    """The leaderboard as a Markdown page.

    Parameters
    ----------
    results : sequence of dict
        Results without faults, as ``read_result`` returns them.
    awaited : sequence of str
        Labels that are named where their result is missing.

    Returns
    -------
    str

    Examples
    --------
    >>> from snooker_env.benchmark import page
    >>> page([]).splitlines()[0]
    '# Leaderboard'
    """
    words = [
        "The rules are in [the benchmark](benchmark.md). This page is made by `results/make.sh leaderboard`."
    ]
    if results:
        versions = sorted({one["software"]["snooker_env"] for one in results})
        machines = sorted({f"{one['machine']['cpu']}, {one['machine']['cores']} cores" for one in results})
        made_on = "; ".join(map(plain, machines))
        words[0] += f" snooker_env {', '.join(map(plain, versions))}; machine: {made_on}."
    tables = lines(results, markdown=True, awaited=awaited)
    head = [line for text in (*words, PROVED) for line in (*wrap(text, WIDTH), "")]
    return "\n".join(["# Leaderboard", "", *head, *tables]) + "\n"
