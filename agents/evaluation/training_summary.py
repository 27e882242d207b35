"""What did a training run learn? Held-out visits of its agent and of two simple players, a table of them, and one sentence that follows."""

from typing import Any

import numpy as np
import rich.box
import rich.console
import rich.table

from ..features.views import view_of
from ..learning.hyperparameters import SHOT_OPTIONS
from ..players.built_in import GhostBall, Random
from ..players.trained import ModelPlayer, player_options
from .rollouts import play, summary, tables_of


def evaluate(recipe, model, visits):
    """Figures of held-out visits under the noise and physics of the training, the same tables for each: the agent, the plain geometric
    player, random play.

    They are the first tables of ``agents.evaluate``, and "random" is its player of that name whatever the agent: a stroke drawn from the
    discrete choices, so at a pot that is there. Raises ValueError if there are not so many tables.
    """
    options = player_options(recipe.env_kwargs)
    players = {"trained": ModelPlayer(model, options, view_of(recipe.view)), "ghost_ball": GhostBall(), "random": Random()}
    shared: dict[str, Any] = {"noise": "none"} | {key: value for key, value in recipe.env_kwargs.items() if key in SHOT_OPTIONS}
    seeds = tables_of("held_out", visits)
    return {name: summary(play(player, visits, first_seed=seeds, **shared)) for name, player in players.items()}


def conclusion(agent, steps, imitated, figures, start=None):
    """What was learned, in one sentence that follows from the figures: a difference counts from two standard errors on.

    ``imitated``: positions in which it imitated the search first; ``start``: what it began from, see ``models.load_weights``, or None.
    """
    trained, ghost, random = (figures[name] for name in ("trained", "ghost_ball", "random"))

    def better(a, b):
        return a["points_a_visit"] - b["points_a_visit"] > 2.0 * np.hypot(a["points_a_visit_se"], b["points_a_visit_se"])

    def made(player):
        return f"{player['pots_a_visit']:.2f} pots and {player['points_a_visit']:.2f} points a visit"

    begun = f" after imitating the search in {imitated:,} positions" if imitated else ""
    if start:
        begun = f", on top of what {start['model']} had learned in {start['shots']:,},"
    said, widest = f"In {steps:,} shots{begun} {agent} learned", "the widest pot played softly every time"
    if not better(trained, random):
        less = "worse than" if better(random, trained) else f"no better, as far as {trained['visits']} visits can show, than"
        return f"{said} to play {less} random strokes at the pots there are: {made(trained)} against {made(random)}."
    if better(ghost, trained):
        return f"{said} to pot, but less than {widest}: {made(trained)} against {made(ghost)}."
    if not better(trained, ghost):
        return (
            f"{said} to pot, but not measurably better than {widest} in {trained['visits']} visits: {made(trained)} against {made(ghost)}."
        )
    shares = [player["next_pot_after_a_pot"] for player in (trained, ghost)]
    again = "" if None in shares else "; after a pot the next one follows in {:.1f} % against {:.1f} %".format(*(100 * x for x in shares))
    return f"{said} more than {widest}: {made(trained)} against {made(ghost)}{again}."


def show(figures):
    """Print them."""
    title = f"A visit, over {figures['random']['visits']} held-out ones, the same for all (± standard error)"
    table = rich.table.Table(title=title, box=rich.box.SIMPLE, pad_edge=False, collapse_padding=True)
    table.add_column("agent", no_wrap=True)
    for name in ("pots", "points", "fouls", "pot rate", "next pot", "best"):
        table.add_column(name, justify="right", no_wrap=True)
    for name, f in figures.items():
        cells = [f"{f[key]:.2f} ± {f[key + '_se']:.2f}" for key in ("pots_a_visit", "points_a_visit", "fouls_a_visit")]
        cells += ["-" if f[key] is None else f"{100 * f[key]:.1f} %" for key in ("pot_rate", "next_pot_after_a_pot")]
        cells.append(str(f["longest_break"]))
        table.add_row(name.replace("_", " "), *cells)
    console = rich.console.Console()
    console.print(table)
    console.print("ghost ball: the widest pot, always softly. random: a random stroke at one of the pots there are, whatever the agent.")
