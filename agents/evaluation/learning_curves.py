"""How fast do agents learn? A picture of the visits they play in training, over the time they have trained and over their shots.

    python -m agents.curves "ppo_mask=runs/mask-?" "pots only=runs/gamma0-?" [--out agents/pictures/curves.png]

Read from the ``results.json`` of finished runs (train.py). Thin lines: one training seed each, points a visit of the last 1,000 visits on
the tables of training, exploring. Discs, and the line of ``ghost_ball``: held-out tables, a run at its end playing what it thinks best,
with two standard errors. A run that imitated first starts its line where it begins to play; what a run with --start brought along is not
counted. Shots are taken to be spread evenly over the time, and the machine was shared: minutes say a factor, not a percentage.
"""

import argparse
import json
from pathlib import Path

from commands.lifecycle import command, needs

with needs("agents.curves"):
    import matplotlib as mpl
    import numpy as np
    from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

    from commands.files import save_figure, writable
    from snooker_env.checks import choice, refuse

    from .destinations import formats
    from .entrants import Entrant

    mpl.use("Agg")
    import matplotlib.pyplot as plt

PICTURE = Path(__file__).parents[1] / "pictures" / "curves.png"
LEVELS = ("trained", "ghost_ball")
"""Of whom a run's score on held-out visits is drawn: its own at its end, the plain player's across."""
LEAST = 0.1
"""Points a visit; the scale is logarithmic, lines below it are not drawn, discs are drawn there."""


def run_of(path):
    """What a finished run kept. Raises ValueError."""
    file = Path(path) / "results.json"
    if not file.is_file():
        raise refuse("run", str(path), "must be the folder of a finished run: it holds results.json")
    try:
        run = json.loads(file.read_text(encoding="utf-8"))
        imitating = run["imitation"][-1]["seconds"] if run["imitation"] else 0.0
        shots = np.array([at["steps"] for at in run["curve"]], float)
        points = np.array([at["points"] for at in run["curve"]], float)
        minutes = (imitating + (run["seconds"] - imitating) * shots / run["steps"]) / 60.0
        ends = {name: run["evaluation"][name] for name in LEVELS}
        levels = {name: (float(end["points_a_visit"]), float(end["points_a_visit_se"])) for name, end in ends.items()}
        return {"shots": shots, "minutes": minutes, "points": points, "end": (run["steps"], run["seconds"] / 60.0), "levels": levels}
    except (ValueError, KeyError, TypeError, IndexError, AttributeError):
        raise refuse("run", str(file), "must be what today's train.py writes") from None


def draw(agents, file):
    """Draw ``agents``: label -> list of ``run_of``."""
    figure, sides = plt.subplots(1, 2, figsize=(11, 4.6), sharey=True, layout="constrained")
    for k, (label, runs) in enumerate(agents.items()):
        colour = f"C{k % 10}"
        for i, run in enumerate(runs):
            score, error = run["levels"]["trained"]
            for axes, x, end in zip(sides, (run["minutes"], run["shots"]), run["end"][::-1], strict=True):
                drawn = run["points"] >= LEAST
                axes.plot(x[drawn], run["points"][drawn], color=colour, lw=1.0, alpha=0.8)
                axes.errorbar(
                    end, max(score, LEAST), 2 * error, fmt="o", ms=4, color=colour, elinewidth=0.9, label=label if i == 0 else None
                )
    level = next(iter(agents.values()))[0]["levels"]["ghost_ball"][0]
    for axes in sides:
        axes.axhline(level, color="#888888", lw=0.9, ls=":")
    sides[0].annotate("ghost_ball", (0.01, level), xycoords=("axes fraction", "data"), fontsize=8, color="#555555", va="bottom")
    for axes, name in zip(sides, ("minutes of training, imitation included", "shots played in training"), strict=True):
        axes.set(xscale="log", yscale="log", xlabel=name)
        for axis, subs in ((axes.xaxis, (1,)), (axes.yaxis, (1, 2, 5))):
            axis.set_major_locator(LogLocator(subs=subs))
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.10g}"))
            axis.set_minor_locator(NullLocator())
        axes.grid(alpha=0.25, which="both", lw=0.5)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    sides[0].set_ylabel("points a visit")
    sides[0].legend(frameon=False, fontsize=9)
    figure.suptitle("Lines: in training, exploring. Discs and ghost_ball: held-out visits, at the end, playing the best", fontsize=11)
    save_figure(figure, file, dpi=110)
    plt.close(figure)


@command("agents.curves")
def main(argv=None):
    """Check, draw. Exit code 0."""
    p = argparse.ArgumentParser("python -m agents.curves", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("agents", nargs="+", metavar="AGENT", help="a run folder, or LABEL=FOLDER,FOLDER,... or patterns")
    p.add_argument("--out", type=Path, default=PICTURE, help="the picture [agents/pictures/curves.png]")
    args = p.parse_args(argv)
    try:
        choice("out", args.out.suffix, formats())
        agents = {agent.label: [run_of(run) for run in agent.runs] for agent in map(Entrant.of, args.agents)}
        if len(agents) < len(args.agents):
            raise refuse("agents", " ".join(args.agents), "must have another label each")
        judged = {run["levels"]["ghost_ball"] for runs in agents.values() for run in runs}
        if len(judged) > 1:
            raise refuse("agents", " ".join(args.agents), "must have been judged on the same tables: ghost_ball's score differs")
        writable("out", args.out)
    except ValueError as error:
        p.error(str(error))
    draw(agents, args.out)
    print(args.out)
    return 0
