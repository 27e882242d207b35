"""What did a training run learn? Held-out visits of its agent and of two simple players, as a table and one sentence."""

from typing import Any

import numpy as np
import rich.box
import rich.console
import rich.table

from snooker_env.benchmark import play_visits, summary, tables_of

from ..features.views import view_of
from ..learning.hyperparameters import SHOT_OPTIONS
from ..players.built_in import GhostBall, Random
from ..players.trained import ModelPlayer, player_options


def evaluate(recipe, model, visits):
    """Figures of held-out visits of the agent, ``ghost_ball`` and ``random``, on the same tables, under the training's noise and physics.

    These are the first tables of ``agents.evaluate``. Raises ValueError if there are not so many tables.
    """
    options = player_options(recipe.env_kwargs)
    players = {"trained": ModelPlayer(model, options, view_of(recipe.view)), "ghost_ball": GhostBall(), "random": Random()}
    shared: dict[str, Any] = {"noise": "none"} | {key: value for key, value in recipe.env_kwargs.items() if key in SHOT_OPTIONS}
    seeds = tables_of("held_out", visits)
    return {name: summary(play_visits(player, visits, first_seed=seeds, **shared)) for name, player in players.items()}


def conclusion(agent, steps, imitated, figures, start=None):
    """The result in one sentence, from the figures; a difference is claimed from two standard errors on.

    ``imitated``: positions of imitation; ``start``: the origin of its initial weights, see ``models.load_weights``, or None.
    """
    trained, ghost, random = (figures[name] for name in ("trained", "ghost_ball", "random"))

    def better(a, b):
        return a["points_a_visit"] - b["points_a_visit"] > 2.0 * np.hypot(a["points_a_visit_se"], b["points_a_visit_se"])

    def made(player):
        return f"{player['pots_a_visit']:.2f} pots and {player['points_a_visit']:.2f} points a visit"

    begun = f" after {imitated:,} positions of imitation" if imitated else ""
    if start:
        begun = f" on top of the {start['shots']:,} of {start['model']}"
    after, visits = f"With {steps:,} shots of training{begun}, {agent}", f"{trained['visits']} visits"
    if not better(trained, random):
        how = "plays worse than" if better(random, trained) else f"is not shown by {visits} to be better than"
        return f"{after} {how} random strokes: {made(trained)} against {made(random)}."
    if better(ghost, trained):
        return f"{after} is better than random strokes but worse than ghost_ball: {made(trained)} against {made(ghost)}."
    if not better(trained, ghost):
        return f"{after} is not shown by {visits} to be better than ghost_ball: {made(trained)} against {made(ghost)}."
    shares = [player["next_pot_after_a_pot"] for player in (trained, ghost)]
    again = "" if None in shares else "; after a pot the next one follows in {:.1f} % against {:.1f} %".format(*(100 * x for x in shares))
    return f"{after} is better than ghost_ball: {made(trained)} against {made(ghost)}{again}."


def show(figures):
    """Print them."""
    title = f"Means of {figures['random']['visits']} held-out visits on the same tables (± standard error)"
    table = rich.table.Table(title=title, box=rich.box.SIMPLE, pad_edge=False, collapse_padding=True)
    table.add_column("agent", no_wrap=True)
    for name in ("pots", "points", "fouls", "pot rate", "next pot", "best"):
        table.add_column(name, justify="right", no_wrap=True)
    for name, f in figures.items():
        cells = [f"{f[key]:.2f} ± {f[key + '_se']:.2f}" for key in ("pots_a_visit", "points_a_visit", "fouls_a_visit")]
        cells += ["-" if f[key] is None else f"{100 * f[key]:.1f} %" for key in ("pot_rate", "next_pot_after_a_pot")]
        cells.append(str(f["longest_break"]))
        table.add_row(name, *cells)
    console = rich.console.Console()
    console.print(table)
    console.print("ghost_ball: the widest pot, always softly. random: a random stroke at one of the direct pots.")
