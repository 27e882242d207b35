"""How are results compared? A leaderboard table for each task, and performance profiles, none wider than 100 columns."""

from collections.abc import Iterable, Sequence
from textwrap import wrap
from typing import Any

from .._tables import markdown_table, shown, text_table
from .playing import COLUMNS
from .tasks import TASKS, Task

WIDTH = 100
CLASSES = {"model_free": "model-free", "planning": "planning", "undeclared": "undecl."}
TRAINED = {"none": "0", "50k": "50 k", "1M": "1 M", "5M": "5 M", "open": "open", "unknown": "?"}
"""In the order of the table."""


def plain(text: str) -> str:
    """A text that a file gives, as one line of Markdown without markup of its own.

    Parameters
    ----------
    text : str

    Returns
    -------
    str

    Examples
    --------
    >>> from snooker_env.benchmark.leaderboard import plain
    >>> plain("a <b> [c](d)\\n# e")
    'a &lt;b&gt; &#91;c](d) # e'
    """
    for sign, entity in (("&", "&amp;"), ("<", "&lt;"), (">", "&gt;"), ("[", "&#91;"), ("`", "&#96;")):
        text = text.replace(sign, entity)
    return " ".join(text.split())


def board(results: Iterable[dict[str, Any]], task: Task) -> tuple[list[str], list[list[str]]]:
    """Heading and rows of a task's table: classes and budgets apart, the best first.

    Parameters
    ----------
    results : iterable of dict
        Sound results; those of other tasks are left out.
    task : Task

    Returns
    -------
    head : list of str
    rows : list of list of str
    """
    mine = [r for r in results if r["task"] == task.id and r["figures"] is not None]

    def order(r):
        agent = r["agent"]
        return list(CLASSES).index(agent["class"]), list(TRAINED).index(agent["budget"]), -r["figures"]["score"]["value"], agent["label"]

    head = ["class, training", "agent", "score" if task.counts else "share %", "IQM", "seeds", "shots", "ms", "ms 1"]
    rows = [_row(r, task) for r in sorted(mine, key=order)]
    if not task.counts:
        head, rows = head[:3] + head[4:], [row[:3] + row[4:] for row in rows]
    return head, rows


def _row(r, task):
    agent, timing, figures = r["agent"], r["timing"], r["figures"]
    mark = "" if r["protocol"]["official"] else " *"
    shots = "?" if agent["simulated_shots"] is None else f"{agent['simulated_shots']:,.0f}{' d' if agent['declared'] else ''}"
    ms = 1e3 * timing["seconds"] / max(1, sum(row[COLUMNS.index("strokes")] for row in r["rows"]))
    alone = timing["one_table_ms"]
    score = shown(figures["score"], 1.0 if task.counts else 100.0)
    middle = "" if figures["iqm"] is None else f"{figures['iqm']['value']:.1f}"
    trained = f"{CLASSES[agent['class']]}, {TRAINED[agent['budget']]}"
    seeds = str(len(agent["sources"]))
    return [trained, agent["label"] + mark, score, middle, seeds, shots, _ms(ms), "" if alone is None else _ms(alone)]


def _ms(value):
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}" if value >= 0.01 else "<0.01"


def profile(results: Iterable[dict[str, Any]], task: Task) -> tuple[list[str], list[list[str]]]:
    """The performance profile of a task: the share of episodes [%] with at least so many points, a row for each agent.

    Parameters
    ----------
    results : iterable of dict
    task : Task

    Returns
    -------
    head : list of str
    rows : list of list of str
    """
    mine = [r for r in results if r["task"] == task.id and r["figures"] is not None]
    mine.sort(key=lambda r: (-r["figures"]["score"]["value"], r["agent"]["label"]))
    head = ["agent", *(f">= {t}" for t in task.thresholds if t <= task.most), "best"]
    rows = [[r["agent"]["label"], *(_share(p) for p in r["figures"]["profile"]), str(r["figures"]["best"])] for r in mine]
    return head, rows


def _share(figure):
    """A share [%]; where it was never or always seen, the exact bound of it."""
    if figure["exact"]:
        return f"<= {100 * figure['high']:.1f}" if figure["value"] == 0.0 else f">= {100 * figure['low']:.1f}"
    return f"{100 * figure['value']:.1f}"


LEGEND = (
    "score: mean of all episodes with its 95 % bootstrap interval over training seeds and episodes; a share that was never or always seen "
    "has the exact one-sided 95 % bound. IQM: mean of the middle half. training: the budget of simulated shots. seeds: training seeds. "
    "shots: simulated shots a decision (d: declared). ms: time of a decision, 100 tables at once; ms 1: one table. *: not official."
)


TWO_PLAYERS = (
    "Two players are called ghost_ball. In these tables it is the agent: one constant choice, the widest pot at one soft speed. The "
    "opponent in the frames is another, a kernel that also breaks off, plays softly and escapes."
)
PROVED = (
    "A result is its strokes: its file holds every one, and check plays each episode again from its seed and computes all figures anew. "
    "What strokes cannot prove is who chose them: that no held-out seed was peeked at, the class and its simulated shots, the budget of "
    "training, times and machines are the word of whoever made the file. Only random and ghost_ball are played again, too. To doubt a row, "
    "let its agent play on fresh seeds: check FILE --agent AGENT --fresh 500."
)
AWAITED = "Rows made before results held their strokes proved nothing and have been taken down. They return as they are played anew."


def lines(results: Sequence[dict[str, Any]], *, markdown: bool = False, awaited: Sequence[str] = ()) -> list[str]:
    """Leaderboard and profiles of all tasks that there are results of.

    Parameters
    ----------
    results : sequence of dict
    markdown : bool
    awaited : sequence of str
        Labels that are named where their result is missing.

    Returns
    -------
    list of str
    """
    made, table = [], markdown_table if markdown else text_table

    def safe(rows, label):
        """The rows, of a page with the label as plain text."""
        return [[plain(cell) if markdown and c == label else cell for c, cell in enumerate(row)] for row in rows]

    for task in TASKS.values():
        head, rows = board(results, task)
        there = {r["agent"]["label"] for r in results if r["task"] == task.id}
        lacking = [label for label in awaited if label not in there]
        if not rows and not lacking:
            continue
        title = f"{task.id}: {task.title}"
        made += [f"## {title}" if markdown else title, ""]
        made += [*wrap(f"Judged by {task.measure}, {task.episodes:,} episodes. {task.note}", WIDTH), ""]
        made += [*table(head, safe(rows, 1), 2), ""] if rows else []
        made += [*wrap(f"Missing: {', '.join(lacking)}.", WIDTH), ""] if lacking else []
        if task.counts and rows:
            shares = profile(results, task)
            made += ["Share of visits [%] with at least so many points:", "", *table(shares[0], safe(shares[1], 0)), ""]
    return [*made, *wrap(LEGEND, WIDTH), "", *wrap(TWO_PLAYERS, WIDTH)]


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
        The text of the page.

    Examples
    --------
    >>> from snooker_env.benchmark import page
    >>> page([]).splitlines()[0]
    '# Leaderboard'
    """
    words = ["The rules are in [the benchmark](benchmark.md). This page is made by `leaderboard/make.sh`."]
    if results:
        versions = sorted({r["software"]["snooker_env"] for r in results})
        machines = sorted({f"{r['machine']['cpu']}, {r['machine']['cores']} cores" for r in results})
        words[0] += f" snooker_env {', '.join(map(plain, versions))}; machine: {'; '.join(map(plain, machines))}."
    tables = lines(results, markdown=True, awaited=awaited)
    words += [PROVED, *([AWAITED] if any(line.startswith("Missing: ") for line in tables) else [])]
    head = [line for text in words for line in (*wrap(text, WIDTH), "")]
    return "\n".join(["# Leaderboard", "", *head, *tables]) + "\n"
