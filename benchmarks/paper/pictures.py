"""What do the paper's figures and the other data look like? Draws ``paper.png`` and ``paper_data.png`` from the figures of
``python -m benchmarks.paper``."""

import numpy as np
from cycler import cycler
from matplotlib.patches import Circle, Patch

import snooker_env as sn
from snooker_env.render.scene import outline

from .._common.command import pyplot, save_figure
from .other_data import A14_SHOTS, CUSHIONS, a14_throw, domenech_throw
from .paper_shots import CURVED, HEAD_ON, MEASURED_TO, POT, QUANTITIES, SIDES, TOPS, R

STYLE: dict = {
    "font.size": 9, "axes.titlesize": 10, "axes.titleweight": "bold", "axes.spines.top": False, "axes.spines.right": False,
    "axes.grid": True, "grid.color": "0.9", "axes.axisbelow": True, "legend.frameon": False, "legend.fontsize": 8.5, "lines.linewidth": 1.6,
    "axes.prop_cycle": cycler(color=["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00"]),
}  # fmt: skip
BARS = {
    "inelastic pucks": "0.75",
    "elastic, then cloth": "#56b4e9",
    "inelastic, then cloth": "#0072b2",
    "planar friction, then cloth": "#e69f00",
    "reference": "#d55e00",
}
"""The models drawn, with their colours; ``reference`` is the paper's own equations."""
LIMIT = 22.0
"""Bars beyond this [%] are cut and carry their value."""


def _spin_panel(ax, shots):
    """Fig. 1: cue ball paths of one pot with different top and side."""
    colours = dict(zip(TOPS, ("#b2182b", "#ef8a62", "0.5", "#67a9cf", "#2166ac"), strict=True))
    marks = dict(zip(SIDES, "<o>", strict=True))
    parts = outline(sn.Table.preset("match"))
    for nose in parts.noses:
        ax.plot(*np.asarray(nose).T, color="0.35", lw=2)
    for x, y, radius in parts.falls:
        ax.add_patch(Circle((x, y), radius, color="0.2"))
    for top, side, _, shot in shots:
        path = shot.at(np.linspace(0, shot.duration, 600))[0][:, 0]
        ax.plot(*path.T, color=colours[top], lw=1.0)
        ax.plot(*path[-1], marks[side], color=colours[top], ms=6, mec="0.2", mew=0.5)
    ax.add_patch(Circle(POT["cue"], R, fc="white", ec="0.2"))
    ax.add_patch(Circle(POT["object"], R, fc="#c00000", ec="0.2"))
    ax.annotate("cue ball", POT["cue"], xytext=(8, -3), textcoords="offset points", fontsize=8)
    ax.annotate("red, potted\nevery time", POT["object"], xytext=(0, -26), textcoords="offset points", fontsize=8)
    ax.set(aspect="equal", xlim=(-0.7, 0.97), ylim=(0.28, 1.86), xlabel="x [m]", ylabel="y [m]")
    ax.set_title(f"Fig. 1: one pot at {POT['speed']:g} m/s, tip offsets of the cue")
    ax.grid(False)
    tips = {t: f"{'top' if t > 0 else 'back'} {abs(t):g} R" if t else "centre" for t in TOPS[::-1]}
    handles = [ax.plot([], [], color=colours[t], label=label)[0] for t, label in tips.items()]
    names = {s: "no side" if s == 0 else f"{'right' if s > 0 else 'left'} {abs(s):g} R" for s in SIDES}
    handles += [ax.plot([], [], marks[s], color="0.6", mec="0.2", label=names[s])[0] for s in SIDES]
    ax.legend(handles=handles, loc="upper left", bbox_to_anchor=(0.0, 0.93), fontsize=8.5)


def _head_on_panel(ax):
    speeds = np.linspace(0.1, 2.0, 39)
    labels = ("no friction, fast: (1+e)/2", "reference", "reference, match (e 0.94, Marlow)")
    for name, label, style in zip(("fast", "reference", "reference, physics match"), labels, ("--", "-", "-."), strict=True):
        ax.plot(speeds, [HEAD_ON[name](v) / v for v in speeds], style, label=label)
    ax.set(xlabel="speed of the rolling cue ball [m/s]", ylabel="object ball / cue ball speed", ylim=(0.93, 0.99), xlim=(0, 2))
    ax.set_title("Fig. 4: full hit, just after the impact")
    ax.legend(loc="upper left")


def _curve_panel(ax, curves):
    for found in curves:
        path = found["path"] * 1e3
        (line,) = ax.plot(*path.T, label=f"μ {found['mu_bb']:.2f}: turns by {found['leaves_deg'] - found['rolls_deg']:.2f}°")
        ax.plot(found["length"] * 1e3, found["aside"] * 1e3, "o", color=line.get_color(), ms=5)
    ax.plot([], [], "o", ms=5, color="0.5", label="slip ends")
    ax.axhline(0, color="0.5", lw=0.8)
    ax.set(xlabel="along its first direction [mm]", ylabel="aside [mm]", xlim=(0, 400), ylim=(-6, 0.6))
    ax.set_title(f"Fig. 6: the object ball's path, {CURVED['v0']:g} m/s, cut {CURVED['cut']:g}°")
    ax.legend(loc="lower left")


def _bar_panel(ax, models, column, title, accuracy):
    shots = np.arange(1, 6)
    width = 0.8 / len(BARS)
    for k, (name, colour) in enumerate(BARS.items()):
        values = np.array(models[name]["error_percent"][column])
        places = shots + (k - (len(BARS) - 1) / 2) * width
        ax.bar(places, np.clip(values, -LIMIT, LIMIT), width * 0.92, color=colour)
        for x, value in zip(places, values, strict=True):
            if abs(value) > LIMIT:
                ax.text(x, LIMIT + 0.4, f"{value:.0f}", ha="center", va="bottom", fontsize=7.5, color="0.35")
    ax.axhline(0, color="0.3", lw=0.8)
    ax.set(xlim=(0.5, 5.5), ylim=(-LIMIT, LIMIT + 2), xticks=shots, xlabel="shot", ylabel="error [% of the measured]")
    if QUANTITIES[column] not in MEASURED_TO:
        ax.text(0.03, 0.93, "no test: the cut defined the shot, so models without friction give 0", transform=ax.transAxes, fontsize=8.5)
    ax.set_title(title + accuracy)
    ax.grid(axis="x", visible=False)


def paper(path, figures, shots, curves):
    """``paper.png``: Figs. 1, 4, 6, 7 and 8."""
    plt = pyplot()
    with plt.rc_context(STYLE):
        figure = plt.figure(figsize=(10.4, 13.4), layout="constrained")
        grid = figure.add_gridspec(4, 2, height_ratios=(1, 1, 1.05, 1.05), width_ratios=(1.08, 1))
        _spin_panel(figure.add_subplot(grid[:2, 0]), shots)
        _head_on_panel(figure.add_subplot(grid[0, 1]))
        _curve_panel(figure.add_subplot(grid[1, 1]), curves)
        titles = (
            ("v_c", "Fig. 7: cue ball's speed"), ("v_o", "Fig. 7: object ball's speed"), ("angle_c", "Fig. 8: cue ball's angle"),
            ("angle_o", "Fig. 8: object ball's angle (measured = cut)"),
        )  # fmt: skip
        for column, (quantity, title) in enumerate(titles):
            limit = MEASURED_TO.get(quantity)
            unit = "°" if quantity.startswith("angle") else " m/s"
            ax = figure.add_subplot(grid[2 + column // 2, column % 2])
            _bar_panel(ax, figures["models"], column, title, f" (camera: {limit:g}{unit})" if limit else "")
        names = [name + (" (the paper's equations)" if name == "reference" else "") for name in BARS]
        handles = [Patch(color=colour) for colour in BARS.values()]
        figure.legend(handles, names, loc="outside lower center", ncol=3, fontsize=9)
        save_figure(figure, path, dpi=110)


def _a14_panel(ax, a14):
    cuts = np.linspace(1, 85, 169)
    for name, (kind, v0) in A14_SHOTS.items():
        curves = a14_throw(kind, v0, cuts)
        (line,) = ax.plot(cuts, curves["closed form"], lw=1.4, label=name)
        ax.plot(a14[name]["cut"], a14[name]["printed"], "o", ms=4, color=line.get_color())
        ax.plot(cuts, curves["reference"], "--", lw=1.2, color=line.get_color())
    ax.plot([], [], "o", ms=4, color="0.4", label="TP A.14 as printed")
    ax.plot([], [], color="0.4", label="closed form, fast")
    ax.plot([], [], "--", color="0.4", label="reference (μ follows the slip)")
    ax.set(xlabel="cut [°]", ylabel="throw [°]", xlim=(0, 85), ylim=(0, 9))
    ax.set_title("Throw of a pool ball, Marlow's friction")
    ax.legend(loc="upper left", ncol=2)


def _domenech_panels(ax, below, found):
    cuts = np.linspace(0.5, 80, 60)
    ax.plot(found["cut"], found["measured"], "o", ms=4, color="0.55", label=f"measured ({found['n']} shots)")
    middle = [(b["from"] + b["to"]) / 2 for b in found["bins"]]
    for name, mu in list(found["laws"].items())[:3]:
        (line,) = ax.plot(cuts, domenech_throw(mu, cuts), label=name)
        below.plot(middle, [b[name] - b["measured"] for b in found["bins"]], "o-", ms=4, color=line.get_color(), label=name)
    ax.set(xlabel="cut [°]", ylabel="throw [°]", xlim=(0, 80), ylim=(0, 9))
    ax.set_title("Throw of 61 mm balls, rolling at 0.80 m/s (Doménech)")
    ax.legend(loc="upper left", ncol=2)
    below.axhline(0, color="0.3", lw=0.8)
    below.fill_between([0, 80], -found["scatter"], found["scatter"], color="0.92", label="scatter of the data, ± 1 rms")
    below.set(xlabel="cut [°]", ylabel="model − measured throw [°]", xlim=(0, 80), ylim=(-3.2, 2.6))
    below.set_title("... and what the models miss, means over 10°")
    below.legend(loc="upper left", ncol=2)


def _cushion_panel(ax, found):
    speed = np.array(found["incident"])
    ax.plot(speed, np.array(found["measured"]) / speed, "o", ms=4.5, color="0.45", label="measured")
    fine = np.linspace(0.2, 3.5, 100)
    for name, model in CUSHIONS.items():
        ax.plot(fine, [model(v) / v for v in fine], label=name + (" (fitted to these)" if name == "match" else ""))
    ax.set(xlabel="speed straight into the cushion, rolling [m/s]", ylabel="rebound / incident speed", xlim=(0, 3.6), ylim=(0.76, 1.06))
    ax.set_title("Cushion rebound (Mathavan 2010, Fig. 7a)")
    ax.legend(loc="upper right", ncol=2)


def data(path, figures):
    """``paper_data.png``: throw and cushion rebound against the other data."""
    plt = pyplot()
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(2, 2, figsize=(10.4, 8.0), layout="constrained")
        _a14_panel(axes[0, 0], figures["throw_a14"])
        _domenech_panels(axes[0, 1], axes[1, 1], figures["throw_domenech"])
        _cushion_panel(axes[1, 0], figures["cushion"])
        save_figure(figure, path, dpi=110)
