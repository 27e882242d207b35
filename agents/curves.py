"""How fast do agents learn? A chart of the points a visit over the time and the shots of training.

    python -m agents.curves "ppo_value=runs/value-?" "targets=runs/target-?" [--out runs/curves.png]

Read from the ``results.json`` of finished runs (train.py). Thin lines: one training seed each, points a visit
of the last 1,000 visits on the tables of training, exploring. Discs, and the line of ``ghost_ball``: held-out
tables, a run at its end, without exploration, with two standard errors. A run with expert iteration starts its
line where it begins to play; what a run with --start brought along is not counted. Shots are taken to be
spread evenly over the time, and the machine was shared: minutes say a factor, not a percentage.
"""

from itertools import cycle
from pathlib import Path
from typing import Any

from commands.lifecycle import command, needs, parser_of

with needs("agents.curves"):
    import numpy as np

    from commands import picture_style
    from commands.files import read_json, writable
    from snooker_env import __version__
    from snooker_env.checks import choice, refuse

    from .evaluation.destinations import formats
    from .evaluation.entrants import Entrant

PICTURE = Path("runs", "curves.png")
LEVELS = ("trained", "ghost_ball")
"""Whose score on held-out visits is drawn: the run's own at its end, and that of the rule-based player."""
LEAST = 0.1
"""Points a visit; the scale is logarithmic, lines below it are not drawn, discs are drawn there."""
PANELS = (
    ("minutes", "minutes of training, expert iteration included"),
    ("shots", "shots played in training"),
)


def run_of(path):
    """What a finished run kept. Raises ValueError."""
    file = Path(path) / "results.json"
    if not file.is_file():
        raise refuse("run", str(path), "must be the folder of a finished run: it holds results.json")
    run = read_json("run", file, "must be what today's train.py writes")
    try:
        imitating = run["imitation"][-1]["seconds"] if run["imitation"] else 0.0
        shots = np.array([at["steps"] for at in run["curve"]], float)
        points = np.array([at["points"] for at in run["curve"]], float)
        minutes = (imitating + (run["seconds"] - imitating) * shots / run["steps"]) / 60.0
        ends = ((name, run["evaluation"][name]) for name in LEVELS)
        levels = {name: (float(end["points_a_visit"]), float(end["points_a_visit_se"])) for name, end in ends}
        end = run["steps"], run["seconds"] / 60.0
        return {"shots": shots, "minutes": minutes, "points": points, "end": end, "levels": levels}
    except (ValueError, LookupError, TypeError, AttributeError, ArithmeticError):
        raise refuse("run", str(file), "must be what today's train.py writes") from None


def figures_of(agents):
    """What is drawn of ``agents``, JSON-able: label -> list of ``run_of``."""
    drawn = {}
    for label, runs in agents.items():
        lines, ends = [], []
        for run in runs:
            seen, (score, error) = run["points"] >= LEAST, run["levels"]["trained"]
            lines.append({name: run[name][seen].tolist() for name in ("minutes", "shots", "points")})
            interval = {"points": score, "low": score - 2 * error, "high": score + 2 * error}
            ends.append(dict(zip(("shots", "minutes"), run["end"], strict=True)))
            ends[-1] |= {name: max(value, LEAST) for name, value in interval.items()}
        drawn[label] = {"lines": lines, "ends": ends}
    level = next(iter(agents.values()))[0]["levels"]["ghost_ball"][0]
    return {"version": __version__, "ghost_ball": level, "agents": drawn}


def draw(drawn, file):
    """Draw what ``figures_of`` gives, or what is kept of it."""
    note = (
        "Lines and bands (range of the training seeds): visits of training, with exploration. Discs: the finished agents on held-out\n"
        "tables, without exploration; vertical lines: 95 % intervals. ghost_ball: the rule-based player."
    )
    with picture_style.drawing() as plt:
        foot = f"python -m agents.curves, snooker_env {drawn['version']}, professional execution errors"
        title = "How fast the agents learn: points a visit"
        figure, sides = picture_style.page(plt, 5.4, title, note, foot=foot, columns=2, sharey=True)
        for (label, of), colour in zip(drawn["agents"].items(), cycle(picture_style.SERIES), strict=False):
            for axes, (name, _) in zip(sides, PANELS, strict=True):
                for line in of.get("lines", ()):
                    axes.plot(line[name], line["points"], color=colour, lw=1.2, alpha=0.85)
                if "bands" in of:
                    band = of["bands"][name]
                    axes.fill_between(band["x"], band["low"], band["high"], color=colour, alpha=0.55, lw=1.0)
                for i, end in enumerate(of["ends"]):
                    reach = [[end["points"] - end["low"]], [end["high"] - end["points"]]]
                    disc: dict[str, Any] = {"fmt": "o", "ms": 6, "mec": "white", "mew": 0.8}
                    disc |= {"elinewidth": 1.4, "color": colour}
                    named = label if i == 0 else None
                    axes.errorbar(end[name], end["points"], reach, label=named, **disc)
        for axes, (_, name) in zip(sides, PANELS, strict=True):
            axes.axhline(drawn["ghost_ball"], color=picture_style.INK, lw=1.1, ls=":")
            picture_style.log_axis(axes.xaxis)
            picture_style.log_axis(axes.yaxis, subs=(1, 2, 5))
            axes.set_xlabel(name)
        how = {"va": "bottom", "size": picture_style.SMALL, "color": picture_style.INK}
        at = 0.01, drawn["ghost_ball"]
        sides[0].annotate("ghost_ball", at, xycoords=("axes fraction", "data"), **how)
        sides[0].set_ylabel("points a visit")
        sides[1].legend(loc="lower right")
        picture_style.save(figure, file)
        plt.close(figure)


@command("agents.curves")
def main(argv=None):
    """Check, draw. Exit code 0."""
    p = parser_of("python -m agents.curves", __doc__)
    what = "a run folder, or LABEL=FOLDER,FOLDER,... or patterns"
    p.add_argument("agents", nargs="+", metavar="AGENT", help=what)
    p.add_argument("--out", type=Path, default=PICTURE, help="the picture [runs/curves.png]")
    args = p.parse_args(argv)
    try:
        choice("out", args.out.suffix, formats())
        drawn = figures_of(_runs(args.agents))
        writable("out", args.out)
    except ValueError as error:
        p.error(str(error))
    draw(drawn, args.out)
    print(args.out)
    return 0


def _runs(texts):
    """label -> list of ``run_of``. Raises ValueError."""
    agents = {agent.label: [run_of(run) for run in agent.runs] for agent in map(Entrant.of, texts)}
    if len(agents) < len(texts):
        raise refuse("agents", " ".join(texts), "must have another label each")
    if len({run["levels"]["ghost_ball"] for runs in agents.values() for run in runs}) > 1:
        same = "must have been judged on the same tables: ghost_ball's score differs"
        raise refuse("agents", " ".join(texts), same)
    return agents


if __name__ == "__main__":
    raise SystemExit(main())
