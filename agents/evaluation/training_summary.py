"""What did a training run learn? A table and sentences compare held-out visits of its agent and of simple players."""

from typing import Any

import numpy as np

from agents._lib.tables import text_table
from snooker_env import player
from snooker_env.benchmark import play_visits
from snooker_env.benchmark.tasks import tables_of
from snooker_env.players.search_player import BUDGET, SearchPlayer

from ..learning.hyperparameters import SHOT_OPTIONS
from ..players.trained import player_of_model
from .visit_figures import summary


def evaluate(recipe, model, visits, loop):
    """Measure held-out visits of agent, ``ghost_ball`` and ``random``, with the training's noise and physics.

    The fidelity is the default, unless the settings differ. If the agent has a value of positions, the planner with that
    value and the search with the rule of thumb (``search``) play as well; otherwise the package's planner plays a fifth of the
    visits. The tables are the first of ``agents.evaluate``; ValueError if there are too few. ``loop`` is that of the training.
    """
    trained = player_of_model(model)
    players = {"trained": trained, "ghost_ball": player("ghost_ball"), "random": player("random")}
    if trained.learned is not None:
        players |= {"planner": SearchPlayer("planner", learned=trained.learned), "search": player("search")}
        few = {}
    else:
        players["planner"], few = player("planner"), {"planner": max(2, visits // 5)}
    chosen = {key: value for key, value in recipe.env_kwargs.items() if key in SHOT_OPTIONS}
    shared: dict[str, Any] = {"noise": "none"} | chosen
    # some agents learn on "fast" to save time, but play at the default fidelity
    if not recipe.fidelity_given:
        shared.pop("fidelity", None)
    return held_out(players, visits, loop, few, **shared)


def held_out(players, visits, loop, few=None, **shared):
    """Measure held-out visits of players {name: player} with these environment options, as the loop's last part. ``few``:
    {name: visits} of players with fewer visits."""
    figures, done = {}, 0
    many = {name: (few or {}).get(name, visits) for name in players}
    with loop.progress("evaluation", sum(many.values()), "visits") as progress:
        for name, one in players.items():
            done += many[name]

            def each(going, done=done, name=name):
                progress.at(done - going, name)

            seeds = tables_of("held_out", many[name])
            figures[name] = summary(play_visits(one, many[name], first_seed=seeds, each=each, **shared))
    return figures


def interval(figures):
    """Points a visit, less luck, with the 95 % interval over visits: low, mean, high."""
    mean, error = figures["adjusted_a_visit"], figures["adjusted_a_visit_se"]
    return mean - 1.96 * error, mean, mean + 1.96 * error


def _better(a, b):
    error = np.hypot(a["points_a_visit_se"], b["points_a_visit_se"])
    return a["points_a_visit"] - b["points_a_visit"] > 2.0 * error


def conclusion(agent, steps, imitated, figures):
    """State the result in one sentence, and one on the planner. Claims a difference from two standard errors on.
    ``imitated``: positions of expert iteration."""
    return _of_the_agent(agent, steps, imitated, figures) + _of_the_planner(figures)


def _of_the_agent(agent, steps, imitated, figures):
    trained, ghost, random = (figures[name] for name in ("trained", "ghost_ball", "random"))

    def made(player):
        return f"{player['pots_a_visit']:.2f} pots and {player['points_a_visit']:.2f} points a visit"

    begun = f" after {imitated:,} positions of expert iteration" if imitated else ""
    practice, visits = f"{steps:,} shots of training{begun}", f"{trained['visits']} visits"
    after = f"With {practice}, {agent}"
    unsure = f"{visits} are too few to show that {agent}, with {practice}, is better than"
    if not _better(trained, random):
        how = f"{after} plays worse than" if _better(random, trained) else unsure
        return f"{how} random strokes: {made(trained)} against {made(random)}."
    against = f"ghost_ball: {made(trained)} against {made(ghost)}"
    if _better(ghost, trained):
        return f"{after} is better than random strokes but worse than {against}."
    if not _better(trained, ghost):
        return f"{unsure} {against}."
    one, other = (player["next_pot_after_a_pot"] for player in (trained, ghost))
    if one is not None and other is not None:
        against += f"; after a pot, another follows in {100 * one:.1f} % against {100 * other:.1f} %"
    return f"{after} is better than {against}."


def _of_the_planner(figures):
    """State what learning adds to the planner; empty for an agent without a value of positions."""
    if "search" not in figures:
        return ""
    learned, rule = figures["planner"], figures["search"]
    points = f"{learned['points_a_visit']:.2f} points a visit against {rule['points_a_visit']:.2f}"
    shots = f"with {BUDGET} simulated shots a decision, the planner scores {points}"
    if _better(learned, rule):
        times = learned["points_a_visit"] / rule["points_a_visit"]
        return f" Its value and proposals score {times:.2f} times as much as a hand-written rule: {shots}."
    both = "its value and proposals are"
    unsure = f" {learned['visits']} visits are too few to show that {both} better than"
    how = f" {both.capitalize()} worse than" if _better(rule, learned) else unsure
    return f"{how} a hand-written rule: {shots}."


def show(figures):
    """Print them."""
    rows = []
    for name, f in figures.items():
        means = ("pots_a_visit", "points_a_visit", "fouls_a_visit")
        cells = [f"{f[key]:.2f} ± {f[key + '_se']:.2f}" for key in means]
        cells.insert(2, "{1:.1f} [{0:.1f}, {2:.1f}]".format(*interval(f)))
        shares = (f["pot_rate"], f["next_pot_after_a_pot"])
        cells += ["-" if share is None else f"{100 * share:.1f} %" for share in shares]
        rows.append([name, *cells, str(f["longest_break"])])
    visits = figures["random"]["visits"]
    few = [f"{name}: the first {f['visits']}" for name, f in figures.items() if f["visits"] < visits]
    title = f"Means of {', '.join([f'{visits} held-out visits on the same tables', *few])} (± standard error)"
    head = ["agent", "pots", "points", "less luck [95 %]", "fouls", "pot rate", "next pot", "best"]
    print("", title, *text_table(head, rows), "", sep="\n")
    print("ghost_ball: the widest pot, played softly. random: a random stroke at one of the direct pots.")
    if "planner" in figures:
        by = (
            "the learned value and proposals; search: the same with a rule of thumb"
            if "search" in figures
            else "the package's weights"
        )
        print(f"planner: {BUDGET} simulated shots a decision, with {by}.")
