"""How far do balls go astray without each model? Draws ``scene.png`` from the figures of
``python -m benchmarks.scene``."""

import numpy as np

from agents._lib import picture_style, provenance

from .models import MODELS
from .verdicts import ERRORS, reasons

WORDS = {
    "cloth in a ball-ball impact": "cloth grips balls that collide",
    "cushion: tight tolerance": "fine steps at a cushion",
    "cushion: cloth (the ODE)": "cloth grips a ball at a cushion",
    "cushion: friction, nose, ODE": "friction and height of cushions",
    "jaw arcs": "round jaws of the pockets",
    "drop takes time": "a ball takes time to drop",
    "Marlow's law": "friction of balls by speed",
    "spin decay": "side spin fades",
    "balls that fly": "balls leave the cloth (added)",
}
"""A model in a few words."""
LEAST = 0.7
"""Where the axis of distances begins [mm]: what is less is drawn there."""


def draw(figures, out):
    """Three panels, a row a model: shift of the cue ball, changed outcomes, time."""
    scenes = figures["scenes"]
    names = [name for name in MODELS if name in next(iter(scenes.values()))["rows"]]
    note = (
        "Each row leaves one part of the physics out and plays the same shots. Dot: the change in the kind of shot that it changes most.\n"
        "Bar: what a professional's execution errors change in that kind. Orange: it matters, as in some kind of shot it changes more\n"
        "than a tenth of that. Right: median and range over the kinds of shots."
    )
    played = f"{figures['shots']} shots of each of {len(scenes)} kinds, physics {figures['physics']!r}"
    foot = f"python -m benchmarks.scene, {played}; {provenance.line(figures)}"
    with picture_style.drawing() as plt:
        title = "What each part of the physics is worth: shots played without it"
        fig, axes = picture_style.page(
            plt, 5.6, title, note, foot=foot, columns=3, sharey=True, width_ratios=(1.15, 1, 0.8)
        )
        _effect(axes[0], scenes, names, "cue", lambda row: max(row["cue_mm"][0], LEAST))
        _effect(axes[1], scenes, names, "changed", lambda row: 100 * row.get("changed", 0.0))
        _times(axes[2], scenes, names)
        axes[0].set(xlabel="median [mm]", title="The cue ball stops elsewhere", xlim=(LEAST * 0.8, 20000))
        picture_style.log_axis(axes[0].xaxis)
        axes[1].set(xlabel="share of the shots [%]", title="Other balls drop or are hit", xlim=(-2, 115))
        axes[2].set(xlabel="time with it / without it", title="Time of a shot", xlim=(0.85, 2.6))
        axes[0].set_yticks(range(len(names)), [WORDS[name] for name in names])
        axes[0].set_ylim(len(names) - 0.4, -0.6)
        for ax in axes:
            ax.tick_params(axis="y", length=0, labelcolor=picture_style.INK)
        picture_style.save(fig, out)


def _effect(ax, scenes, names, reason, value):
    """Of each model the kind of shot in which it does most, beside a professional's errors in the same."""
    for y, name in enumerate(names):
        kind = max(scenes, key=lambda kind: value(scenes[kind]["rows"][name]))
        x, by_errors = (value(scenes[kind]["rows"][row]) for row in (name, ERRORS))
        matters = any(reason in reasons(one["rows"][name], one["rows"]) for one in scenes.values())
        how = {"textcoords": "offset points", "va": "center", "size": picture_style.SMALL}
        ax.plot(x, y, "o", color=picture_style.ORANGE if matters else picture_style.GREY, ms=6)
        if x > LEAST:
            ax.barh(y, by_errors, 0.5, color=picture_style.GRID)
            ax.annotate(kind, (max(x, by_errors), y), (7, 0), **how)
        else:
            ax.annotate("almost nothing", (x, y), (7, 0), color=picture_style.QUIET, **how)


def _times(ax, scenes, names):
    """Least, median and greatest time of a shot with each model over that without, over the kinds of shots."""
    for y, name in enumerate(names):
        low, middle, high = np.quantile([one["rows"][name]["cost"] for one in scenes.values()], (0, 0.5, 1))
        ax.plot((low, high), (y, y), color=picture_style.BLUE, lw=2)
        ax.plot(middle, y, "o", color=picture_style.BLUE, ms=6)
    ax.axvline(1.0, color=picture_style.GREY, lw=1)
