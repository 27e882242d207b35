"""How far do balls go astray without each model? Draws ``scene.png`` from the figures of
``python -m benchmarks.scene``."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from agents._lib import picture_style, provenance

from .models import MODELS
from .verdicts import CHAOS, ERRORS, reasons


class Panel(NamedTuple):
    """One of the tables."""

    reason: str
    """The figure by which a model matters, as ``reasons`` names it."""
    title: str
    rows: list[str]
    value: Callable
    """The number of a cell, from the model's figures."""
    norm: Any
    text: str
    """How that number is written."""
    colours: Any
    ticks: tuple


def draw(figures, out):
    """Three tables in colour: how far the cue ball stops off, how many shots end otherwise, what the model
    costs."""
    scenes = figures["scenes"]
    rows = list(next(iter(scenes.values()))["rows"])
    names = [name for name in rows if name not in (ERRORS, CHAOS)]
    mixed = [*names, ERRORS, CHAOS]
    note = (
        "Rows: the model left out. Columns: kinds of shots. Bold: it matters, which means more than a tenth of what a\n"
        "professional's execution errors do. For scale, below the line: those errors, and the same shots aimed 1e-9 rad aside."
    )
    played = f"{figures['shots']} shots of each kind, physics {figures['physics']!r}"
    foot = f"python -m benchmarks.scene, {played}; {provenance.line(figures)}"
    with picture_style.drawing() as plt:
        from matplotlib.colors import LogNorm, Normalize

        heat, balance = picture_style.HEAT, picture_style.BALANCE
        panels = (
            Panel(
                "cue",
                "How far away the cue ball stops, median [mm]",
                mixed,
                lambda r: r["cue_mm"][0],
                LogNorm(1, 1000),
                "{:.3g}",
                heat,
                (1, 10, 100, 1000),
            ),
            Panel(
                "changed",
                "Shots that end otherwise: other balls drop, or the ball aimed at is missed [%]",
                [*names, ERRORS, CHAOS],
                lambda r: 100 * r.get("changed", np.nan),
                Normalize(0, 60),
                "{:.1f}",
                heat,
                (0, 20, 40, 60),
            ),
            Panel(
                "cost",
                "Time of a shot with the model over time without",
                names,
                lambda r: r.get("cost", np.nan),
                LogNorm(1 / 6, 6),
                "{:.2f}",
                balance,
                (0.2, 0.5, 1, 2, 5),
            ),
        )
        heights = [len(panel.rows) for panel in panels]
        title = "What each model of the physics is worth: shots played without it"
        fig, axes = picture_style.page(
            plt, 2.5 + 0.3 * sum(heights), title, note, foot=foot, rows=3, height_ratios=heights
        )
        for ax, panel in zip(axes, panels, strict=True):
            _table(fig, ax, scenes, panel)
        picture_style.save(fig, out)


def _table(fig, ax, scenes, panel):
    """One table, a cell for each model and scene."""
    reason, title, rows, value, norm, text, colours, ticks = panel
    grid = np.array([[value(s["rows"][name]) for s in scenes.values()] for name in rows])
    shown = ax.imshow(
        np.where(np.isfinite(grid), np.maximum(grid, 1e-9), np.nan), norm=norm, cmap=colours, aspect="auto"
    )
    for i, name in enumerate(rows):
        for j, s in enumerate(scenes.values()):
            x = grid[i, j]
            if np.isfinite(x):
                at = norm(max(x, 1e-9))
                bold = name not in (ERRORS, CHAOS) and reason in reasons(s["rows"][name], s["rows"])
                dark = at > 0.55 if colours == picture_style.HEAT else abs(at - 0.5) > 0.32
                ax.text(
                    j,
                    i,
                    "0" if x < 5e-4 else text.format(x),
                    ha="center",
                    va="center",
                    size=picture_style.SMALL,
                    color="white" if dark else picture_style.INK,
                    weight="bold" if bold else "normal",
                )
    for line in np.arange(0.5, len(rows) - 1):
        ax.axhline(line, color=picture_style.PAGE, lw=1.0)
    for line in np.arange(0.5, len(scenes) - 1):
        ax.axvline(line, color=picture_style.PAGE, lw=1.0)
    if ERRORS in rows:
        ax.axhline(sum(name in MODELS for name in rows) - 0.5, color=picture_style.INK, lw=1.4)
    ax.grid(False)
    ax.spines[:].set_visible(False)
    ax.set_title(title)
    ax.set_xticks(
        range(len(scenes)),
        [scene.replace(", ", ",\n").replace(" ", "\n", 1) if len(scene) > 9 else scene for scene in scenes],
    )
    ax.set_yticks(range(len(rows)), rows)
    ax.tick_params(length=0, labelcolor=picture_style.INK)
    picture_style.colour_bar(
        fig, shown, ax, "", ticks, extend="max" if colours == picture_style.HEAT else "neither", aspect=18
    )
