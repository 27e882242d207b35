"""How do simulated paths lie over measured ones? Draws ``real_shots.png``: three shots, and the errors of all."""

import numpy as np

from agents._lib import picture_style, provenance

from .tracks import HALF

COLOURS = (picture_style.BLUE, picture_style.ORANGE, picture_style.GREEN)
PUBLISHED = 0.223
"""Median rms error of the cue ball over all 182 shots, of tailuge's billiards, dist/fit [m]."""


WORDS = ("shot at 10 %", "shot at 50 %", "shot at 90 %")


def chosen(shots):
    """The shots at 10, 50 and 90 % of the cue ball's error, of those held out if there are any: their places in the list."""
    held = [k for k, s in enumerate(shots) if s["part"] == "held out"] or range(len(shots))
    order = sorted(held, key=lambda k: shots[k]["cue_rms"])
    return [order[min(int(q * len(order)), len(order) - 1)] for q in (0.1, 0.5, 0.9)]


def draw(figures, judges, strikes, out):
    """The picture; ``judges`` and ``strikes`` in the order of ``figures["shots"]``."""
    shots = figures["shots"]
    foot = f"python -m benchmarks.real_shots FILE; {provenance.line(figures)}"
    note = (
        "Dots: measured, the cue ball blue; rings: where the balls begin. Lines: the engine, with one set of constants for all shots;\n"
        "only the strike is fitted. Right: the cue ball's root mean square error over a whole shot; left: shots at 10, 50 and 90 % of it."
    )
    title = "Real three-cushion shots, and the engine's"
    with picture_style.drawing() as plt:
        fig, axes = picture_style.page(
            plt, 5.4, title, note, foot=foot, columns=4, width_ratios=(1, 1, 1, 1.35)
        )
        for ax, k, word in zip(axes, chosen(shots), WORDS, strict=False):
            _table(ax, judges[k], strikes[k], f"{word}: {100 * shots[k]['cue_rms']:.1f} cm", shots[k])
        _errors(axes[3], figures)
        picture_style.save(fig, out)


def _table(ax, judge, strike, title, figures):
    shot = judge.shot
    end = figures["seconds"]
    times = np.arange(0.0, end, 0.01)
    paths = judge.places(strike, times)
    for k, (ball, colour) in enumerate(zip(shot.balls, COLOURS, strict=True)):
        ax.plot(*ball.xy.T, ".", ms=2.2, color=colour, alpha=0.55, mew=0)
        ax.plot(*paths[:, k].T, "-", lw=0.9, color=colour)
        ax.plot(*ball.xy[0], "o", ms=7, mfc="none", mec=colour, mew=1.2)
    x, y = HALF
    ax.plot([-x, x, x, -x, -x], [-y, -y, y, y, -y], color=picture_style.INK, lw=1.2)
    ax.set_aspect("equal")
    ax.set_xlim(-x - 0.05, x + 0.05)
    ax.set_ylim(-y - 0.05, y + 0.05)
    ax.axis("off")
    ax.set_title(title)


def _errors(ax, figures):
    for name, colour in (("used for the constants", picture_style.GREY), ("held out", picture_style.BLUE)):
        errors = sorted(100 * s["cue_rms"] for s in figures["shots"] if s["part"] == name)
        if errors:
            ax.plot(
                np.linspace(0, 100, len(errors)),
                errors,
                "-",
                marker=".",
                ms=4,
                lw=1.2,
                color=colour,
                label=name,
            )
    ax.axhline(100 * PUBLISHED, color=picture_style.ORANGE, lw=1.2, label="published: median")
    ax.set_yscale("log")
    ax.set_ylim(0.8, 100)
    ax.set_yticks([1, 2, 5, 10, 20, 50, 100], ["1", "2", "5", "10", "20", "50", "100"])
    ax.set_xlabel("share of the shots [%]")
    ax.set_title("error of the cue ball [cm]")
    ax.legend(loc="upper left")
