"""Does a constant choice win any task of the benchmark, and how far is each task from saturation?

    python -m benchmarks.constants [--tasks SnookerFrame-v0 ...] [--players planner ...] [--episodes 500]
        [--screened 8] [--lines 1] [--seed 0] [--json FILE] [--out FOLDER]

A constant choice is one of ``action="discrete"``, whatever lies on the table: a pot or line (the widest first), a
speed, a side and a top; its aim is solved. All of the first ``--lines`` lines are screened on tables of training, the
best third three times as long, and so on; the last three then play the judged tables beside the players. "of the most":
the score over the highest that an episode can have. "cleared": the share of episodes that end with an empty table.
"""

from dataclasses import replace

import numpy as np

from commands.tables import shown, text_table
from snooker_env._warmup import warmup
from snooker_env.benchmark import TASKS, Agent
from snooker_env.benchmark.playing import play_episodes
from snooker_env.benchmark.results import figures_of
from snooker_env.tasks import SIDES, SPEEDS, TOPS
from snooker_env.tasks.discrete_actions import POTS, STROKES

from ._common.command import Command, at_least, run, save_json

PLAYERS = ("random", "ghost_ball", "search", "planner", "tactician")
FINALISTS, BATCH = 3, 100


class Constant:
    """Plays one choice."""

    options = {"action": "discrete"}  # noqa: RUF012

    def __init__(self, choice):
        self.choice = choice

    def act(self, observations, masks, seeds):
        """The choice, on each table."""
        return np.full(len(seeds), self.choice)

    @property
    def name(self):
        """The choice in words."""
        pot, stroke = divmod(self.choice, STROKES)
        rest, top = divmod(stroke, len(TOPS))
        speed, side = divmod(rest, len(SIDES))
        return f"line {pot}, {SPEEDS[speed]} m/s, side {SIDES[side]:+.1f}, top {TOPS[top]:+.1f}"


def rows_of(task, player, seeds):
    """The rows of these episodes, batch after batch."""
    rows = []
    for first in range(0, len(seeds), BATCH):
        rows += play_episodes(task, player, seeds[first : first + BATCH]).rows
    return rows


def screened(task, lines, episodes, seed):
    """The best constant choices on tables of training, the best first: at most ``FINALISTS``."""
    training = replace(task, judged_layout=task.changes["layout"])
    left, first = list(range(lines * STROKES)), 1000 * seed
    while len(left) > FINALISTS:
        seeds = list(range(first, first + episodes))
        scores = [np.mean([row[2] for row in rows_of(training, Constant(one), seeds)]) for one in left]
        order = np.argsort(-np.array(scores), kind="stable")
        left = [left[k] for k in order[: max(FINALISTS, len(left) // 3)]]
        first, episodes = first + episodes, 3 * episodes
    return left


def measured(task, player, label, episodes):
    """The figures of a player on the judged tables: "label", "score", "of_most" and "cleared"."""
    figures = figures_of(task, "constants", rows_of(task, player, task.seeds(episodes)))
    assert figures is not None  # every episode was played
    score = figures["score"]
    return {
        "label": label,
        "score": score,
        "of_most": score["value"] / task.most,
        "cleared": figures["cleared"]["value"],
    }


def show(task, found):
    """Print the table of a task."""
    scale, unit = (1.0, "points") if task.counts else (100.0, "%")
    rows = [
        [
            one["label"],
            shown(one["score"], scale),
            f"{100 * one['of_most']:.1f}",
            f"{100 * one['cleared']:.1f}",
        ]
        for one in sorted(found, key=lambda one: -one["score"]["value"])
    ]
    print(f"\n{task.id}: {task.measure}\n")
    print("\n".join(text_table(["player", unit, "of the most [%]", "cleared [%]"], rows)), flush=True)


def main():
    """Measure and print."""
    parser = Command("constants", __doc__, seed=0)
    add = parser.add_argument
    add("--tasks", nargs="+", choices=list(TASKS), default=list(TASKS), metavar="TASK", help="ids [all]")
    add("--players", nargs="*", default=PLAYERS, help=f"names [{' '.join(PLAYERS)}]")
    add("--episodes", type=at_least(2), default=500, help="judged episodes, at most the task's [500]")
    add("--screened", type=at_least(1), default=8, help="episodes of each choice in the first round [8]")
    add("--lines", type=int, choices=range(1, POTS + 1), default=1, help="lines of the choices [1]")
    options = parser.options()
    for name in options.players:
        Agent.of(name)  # says what is wrong with a name before the work
    warmup()
    figures = {}
    for name in options.tasks:
        task = TASKS[name]
        episodes = min(options.episodes, task.episodes)
        found = [measured(task, player, player, episodes) for player in options.players]
        for choice in screened(task, options.lines, options.screened, options.seed):
            constant = Constant(choice)
            found.append(measured(task, constant, constant.name, episodes))
        show(task, found)
        figures[name] = {"episodes": episodes, "most": task.most, "found": found}
    save_json(options.json, figures)
    return 0


if __name__ == "__main__":
    run(main)
