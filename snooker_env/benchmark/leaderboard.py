"""How are results compared? One table for each task, ranked by the score less luck, at most 100 columns wide."""

from collections.abc import Iterable, Sequence
from textwrap import wrap
from typing import Any

from .._lib.text_tables import format_figure, markdown_table, text_table
from .tasks import TASKS, Task

WIDTH = 100
FOLDER = "results/leaderboard"
Table = tuple[list[str], list[list[str]]]  # heading and rows

LEGEND = (
    "Ranked by adjusted, the mean score less luck, with its 95 % interval. anchor: should win nothing, has no rank. training: simulated "
    "shots of training (5 ×: of each of five seeds). shots: simulated shots a decision (d: declared, not counted). *: not official."
)
READ = """\
Every result on the five tasks of [the benchmark](benchmark.md). A row is a file that holds every
stroke, so that `check` can play each episode again.

## How to read the tables

* **adjusted** ranks the agents: the mean score [less luck](benchmark.md#less-luck). It has the
  same expected value as the raw **score**, and varies less. Brackets hold the 95 % interval over
  training seeds and episodes. Agents whose intervals overlap may be equally strong.
* **class** says how an agent decides. `planning` simulates shots; `foresight` simulates none but
  computes in closed form what each stroke would do; `model_free` does neither.
* An `anchor` is a policy that should win nothing, and has no rank. It shows what a task pays without
  skill: `random` strokes, one `constant` choice, the `softest` and the `hardest` stroke at the nearest
  ball on, a deliberate foul (`away`, `softest_away`), and in frames `play_again`, a `ghost_ball` that
  makes the opponent play again after every foul.
* **training** counts the simulated shots of training (5 ×: of each of five seeds), **shots** those of
  one decision; `d` marks a number that the author declared.
* **result** links to the file, by its date. The file says which command, commit and machine made it.

A file [cannot prove everything](benchmark.md#what-a-file-cannot-prove): to doubt a row, let its agent
play on fresh seeds.
"""
SEND = """\
## How to send in a result

Play a task with your agent, then check the file:

```console
$ python -m snooker_env.benchmark run SnookerBreak-v0 --agent model.zip --trust --training-shots 50000 --label mine
$ python -m snooker_env.benchmark check SnookerBreak-v0.mine.json
```

If the second command says `official`, open a pull request that adds the file to
`results/leaderboard`. Say where others find the agent: its code, its weights, and the command that
trained it. `bash results/make.sh leaderboard` makes this page.
"""


def is_anchor(result: dict[str, Any]) -> bool:
    """Whether the agent of a result is a policy that should win nothing."""
    agent = result["agent"]
    return agent["class"] == "degenerate" or agent["label"] == "random"


def board(results: Iterable[dict[str, Any]], task: Task, *, markdown: bool = False) -> Table:
    """The table of a task, the best agent first; in Markdown with links to the files."""
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


def page(results: Sequence[dict[str, Any]], awaited: Sequence[str] = ()) -> str:
    """The leaderboard as a Markdown page, of results without faults. The page names the agents of ``awaited`` that lack a
    result on some task."""
    there = {(one["task"], one["agent"]["label"]) for one in results}
    lacking = [label for label in awaited if any((task, label) not in there for task in TASKS)]
    missing = [*wrap(f"Still missing on at least one task: {', '.join(lacking)}.", WIDTH), ""]
    tables = _tables(results, markdown=True)
    return "\n".join(["# Leaderboard", "", READ, *tables, *(missing if lacking else []), SEND])
