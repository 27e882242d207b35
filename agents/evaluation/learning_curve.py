"""How did an agent learn? A curve on a terminal or in a picture compares its points a visit with those of other players."""

from typing import NamedTuple

from agents._lib.picture_style import BLUE, GREY, INK, ORANGE, drawing, number, page, save

from .training_summary import interval

_COLUMNS, _ROWS = 60, 16
"""Size of the curve on a terminal in characters."""


class LearningCurve(NamedTuple):
    """A training curve, with means of held-out visits for comparison."""

    agent: str
    points: list
    """"steps" and "points" of each point: over the last 1000 visits, in which the agent explores."""
    figures: dict
    """Figures of ``training_summary.evaluate``; "trained" is the agent with its preferred choices."""

    @property
    def levels(self):
        """Points a visit, less luck, of the other players: {name: points}."""
        return {name: one["adjusted_a_visit"] for name, one in self.figures.items() if name != "trained"}

    def text(self):
        """The lines of the curve on a terminal: ``*`` the training, ``O`` the trained agent, ``-`` the others."""
        _, end, _ = interval(self.figures["trained"])
        most = max(1.0, end, *self.levels.values(), *(one["points"] for one in self.points))
        last = self.points[-1]["steps"]
        rows = [[" "] * _COLUMNS for _ in range(_ROWS)]

        def row(points):
            return round((1.0 - max(points, 0.0) / most) * (_ROWS - 1))

        names = {}
        for name, points in self.levels.items():
            rows[row(points)] = ["-"] * _COLUMNS
            names.setdefault(row(points), []).append(f"{name} {points:.1f}")
        for one in self.points:
            rows[row(one["points"])][round(one["steps"] / last * (_COLUMNS - 2))] = "*"
        rows[row(end)][-1] = "O"
        names.setdefault(row(end), []).insert(0, f"{self.agent} {end:.1f}")
        lines = [
            f"{most * (1 - k / (_ROWS - 1)):5.1f} |{''.join(one)} {', '.join(names.get(k, ()))}".rstrip()
            for k, one in enumerate(rows)
        ]
        foot = f"{'0':<{_COLUMNS - len(f'{last:,}') - 6}}{last:,} shots"
        return ["points a visit during training (*) and on held-out tables (O, -)", *lines, f"{'':7}{foot}"]

    def draw(self, file, seconds):
        """Draw the curve; ``seconds`` is the duration of the training."""
        last, (low, end, high) = self.points[-1]["steps"], interval(self.figures["trained"])
        visits = self.figures["trained"]["visits"]
        few = "".join(f" ({n}: {one['visits']})" for n, one in self.figures.items() if one["visits"] < visits)
        title = f"{self.agent}: {last:,} shots of training in {seconds / 60:.1f} minutes"
        note = (
            "Line: the last 1,000 visits in training, where the agent explores. Dot: the trained agent, with its 95 %\n"
            f"interval, and the other players, on {visits} held-out tables{few}, adjusted for luck."
        )
        with drawing() as plt:
            figure, axes = page(plt, 3.6, title, note, rows=1)
            for name, level in self.levels.items():
                axes.axhline(level, color=GREY, linewidth=1.2, linestyle=(0, (4, 3)))
                axes.annotate(
                    f"{name} {level:.1f}",
                    (1.0, level),
                    xycoords=axes.get_yaxis_transform(),
                    xytext=(6, 0),
                    textcoords="offset points",
                    va="center",
                    color=INK,
                )
            axes.plot(
                [one["steps"] for one in self.points], [one["points"] for one in self.points], color=BLUE
            )
            axes.errorbar([last], [end], [[end - low], [high - end]], color=ORANGE, marker="o")
            axes.annotate(
                f"{end:.1f}",
                (last, end),
                xytext=(-8, 6),
                textcoords="offset points",
                ha="right",
                color=ORANGE,
            )
            axes.set(xlabel="shots", ylabel="points a visit", xlim=(0, 1.02 * last), ylim=(0, None))
            axes.xaxis.set_major_formatter(number)
            save(figure, file)
