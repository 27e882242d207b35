"""Do the models follow the paper and the other data? Draws ``paper.png`` and ``paper_data.png`` from the
figures of ``python -m benchmarks.paper``."""

import numpy as np

import snooker_env as sn
from agents._lib import picture_style
from snooker_env.render.scene import outline

from .other_data import A14_SHOTS, CUSHIONS, a14_throw, domenech_throw
from .paper_shots import CURVED, MEASURED_TO, POT, SIDES, TOPS, R

BARS = {
    "inelastic pucks": "#b4bac4",
    "elastic, then cloth": picture_style.SKY,
    "inelastic, then cloth": picture_style.BLUE,
    "planar friction, then cloth": picture_style.AMBER,
    "reference": picture_style.ORANGE,
}
"""The models drawn, with their colours; ``reference`` is the paper's own equations."""
LIMIT = 22.0
"""Bars beyond this [%] are cut and carry their value."""


def _spin_panel(ax, shots):
    """Fig. 1: cue ball paths of one pot with different top and side."""
    from matplotlib.patches import Circle

    colours = dict(
        zip(
            TOPS,
            (
                picture_style.ORANGE,
                picture_style.AMBER,
                picture_style.GREY,
                picture_style.SKY,
                picture_style.BLUE,
            ),
            strict=True,
        )
    )
    marks = dict(zip(SIDES, "<o>", strict=True))
    table = sn.Table.preset("match")
    parts = outline(table)
    for nose in parts.noses:
        ax.plot(*np.asarray(nose).T, color=picture_style.INK, lw=2)
    for x, y, radius in table.falls:
        ax.add_patch(Circle((x, y), radius, color=picture_style.INK))
    for shot in shots:
        path, colour = np.array(shot["path"]), colours[shot["top"]]
        ax.plot(*path.T, color=colour, lw=1.4)
        ax.plot(*path[-1], marks[shot["side"]], color=colour, ms=7, mec=picture_style.INK, mew=0.7, zorder=4)
    for place, colour in ((POT["cue"], "white"), (POT["object"], "#c41218")):
        ax.add_patch(Circle(place, R, fc=colour, ec=picture_style.INK, lw=0.8, zorder=5))
    ax.annotate("cue ball", POT["cue"], xytext=(9, -3), textcoords="offset points", size=picture_style.SMALL)
    ax.annotate("red", POT["object"], xytext=(9, -3), textcoords="offset points", size=picture_style.SMALL)
    ax.set(aspect="equal", xlim=(-0.72, 0.97), ylim=(0.28, 1.86), xlabel="x [m]", ylabel="y [m]")
    ax.set_title(f"Fig. 1: one pot at {POT['speed']:g} m/s, by tip offset")
    tips = {t: f"{'top' if t > 0 else 'back'} {abs(t):g} R" if t else "centre" for t in TOPS[::-1]}
    handles = [ax.plot([], [], color=colours[t], label=label)[0] for t, label in tips.items()]
    names = {s: "no side" if s == 0 else f"{'right' if s > 0 else 'left'} {abs(s):g} R" for s in SIDES}
    handles += [
        ax.plot([], [], marks[s], color=picture_style.GREY, mec=picture_style.INK, label=names[s])[0]
        for s in SIDES
    ]
    ax.legend(handles=handles, loc="upper left", bbox_to_anchor=(0.0, 0.94))


def _head_on_panel(ax, found):
    speeds = np.array(found["v0"])
    labels = ("no friction, fast: (1+e)/2", "reference", "reference, physics match")
    for name, label, style in zip(
        ("fast", "reference", "reference, physics match"), labels, ("--", "-", "-."), strict=True
    ):
        ax.plot(speeds, np.array(found[name]) / speeds, style, label=label)
    ax.set(
        xlabel="speed of the rolling cue ball [m/s]", ylabel="speed ratio", ylim=(0.93, 1.0), xlim=(0, 2.05)
    )
    ax.set_title("Fig. 4: full hit, object ball / cue ball")
    ax.legend(loc="upper left")


def _curve_panel(ax, curves):
    for found in curves:
        path = np.array(found["path"]) * 1e3
        (line,) = ax.plot(
            *path.T, label=f"friction {found['mu_bb']:.2f}: {found['leaves_deg'] - found['rolls_deg']:.2f}°"
        )
        ax.plot(found["length"] * 1e3, found["aside"] * 1e3, "o", color=line.get_color())
    ax.plot([], [], "o", color=picture_style.GREY, label="slip ends")
    ax.axhline(0, color=picture_style.GREY, lw=0.8)
    ax.set(xlabel="along its first direction [mm]", ylabel="aside [mm]", xlim=(0, 400), ylim=(-6, 0.6))
    ax.set_title(f"Fig. 6: the object ball turns (cut {CURVED['cut']:g}°)")
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
                ax.text(
                    x,
                    LIMIT + 0.4,
                    f"{value:.0f}",
                    ha="center",
                    va="bottom",
                    size=picture_style.SMALL,
                    color=picture_style.QUIET,
                )
    ax.axhline(0, color=picture_style.INK, lw=0.8)
    ax.set(xlim=(0.5, 5.5), ylim=(-LIMIT, LIMIT + 3), xticks=shots, xlabel=f"shot (camera: {accuracy})")
    ax.set_title(title)
    ax.grid(axis="x", visible=False)


def paper(path, figures):
    """``paper.png``: Figs. 1, 4, 6, 7 and 8."""
    note = (
        "The figures of Mathavan, Jackson & Parkin (2014), computed anew. Fig. 1: every shot pots the red. Figs. 7 and 8: error of each\n"
        f"model on the five measured shots [% of the measured value]. Nearer to 0 is better; a bar beyond {LIMIT:g} % is cut and carries\n"
        "its value. Camera: the paper's own accuracy. The object ball's angle defined each shot, so it tests no model and is not shown."
    )
    titles = (
        ("v_c", "Fig. 7: cue ball's speed"),
        ("v_o", "Fig. 7: object ball's speed"),
        ("angle_c", "Fig. 8: cue ball's angle"),
    )
    with picture_style.drawing() as plt:
        from matplotlib.patches import Patch

        figure, _ = picture_style.page(
            plt,
            10.0,
            "The paper's figures, by its equations and by simpler models",
            note,
            foot="python -m benchmarks.paper, physics 'paper'",
        )
        upper, lower = figure.subfigures(2, 1, height_ratios=(1.25, 1))
        axes = upper.subplot_mosaic([["spin", "full"], ["spin", "curve"]], width_ratios=(1.18, 1))
        _spin_panel(axes["spin"], figures["spins"])
        _head_on_panel(axes["full"], figures["head_on"])
        _curve_panel(axes["curve"], figures["curved"])
        panels = lower.subplots(1, 3, sharey=True)
        for column, (ax, (quantity, title)) in enumerate(zip(panels, titles, strict=True)):
            unit = "°" if quantity.startswith("angle") else " m/s"
            _bar_panel(ax, figures["models"], column, title, f"{MEASURED_TO[quantity]:g}{unit}")
        panels[0].set_ylabel("error [%]")
        names = [name + (" (the paper's equations)" if name == "reference" else "") for name in BARS]
        lower.legend(
            [Patch(color=colour) for colour in BARS.values()],
            names,
            loc="outside lower center",
            ncol=3,
            fontsize=picture_style.TEXT,
        )
        picture_style.save(figure, path)


def _a14_panel(ax, a14):
    cuts = np.linspace(1, 85, 169)
    for name, (kind, v0) in A14_SHOTS.items():
        curves = a14_throw(kind, v0, cuts)
        (line,) = ax.plot(cuts, curves["closed form"], label=name)
        ax.plot(a14[name]["cut"], a14[name]["printed"], "o", color=line.get_color())
        ax.plot(cuts, curves["reference"], "--", lw=1.4, color=line.get_color())
    ax.plot([], [], "o", color=picture_style.GREY, label="TP A.14 as printed")
    ax.plot([], [], color=picture_style.GREY, label="closed form, fast")
    ax.plot([], [], "--", color=picture_style.GREY, label="reference")
    ax.set(xlabel="cut [°]", ylabel="throw [°]", xlim=(0, 85), ylim=(0, 9))
    ax.set_title("Throw of a pool ball, Marlow's friction law")
    ax.legend(loc="upper left", ncol=2)


def _domenech_panels(ax, below, found):
    cuts = np.linspace(0.5, 80, 60)
    ax.plot(
        found["cut"], found["measured"], "o", color=picture_style.GREY, label=f"measured ({found['n']} shots)"
    )
    middle = [(b["from"] + b["to"]) / 2 for b in found["bins"]]
    for name, mu in list(found["laws"].items())[:3]:
        (line,) = ax.plot(cuts, domenech_throw(mu, cuts), label=name)
        below.plot(
            middle, [b[name] - b["measured"] for b in found["bins"]], "o-", color=line.get_color(), label=name
        )
    ax.set(xlabel="cut [°]", ylabel="throw [°]", xlim=(0, 80), ylim=(0, 9))
    ax.set_title("Throw of 61 mm balls (Doménech)")
    ax.legend(loc="upper left", ncol=2)
    below.axhline(0, color=picture_style.INK, lw=0.8)
    below.fill_between(
        [0, 80], -found["scatter"], found["scatter"], color=picture_style.GRID, label="scatter, ± 1 rms"
    )
    below.set(xlabel="cut [°]", ylabel="model − measured [°]", xlim=(0, 80), ylim=(-3.2, 2.6))
    below.set_title("The same throw: model − measured, means of 10°")
    below.legend(loc="upper left", ncol=2)


def _cushion_panel(ax, found):
    speed = np.array(found["incident"])
    ax.plot(speed, np.array(found["measured"]) / speed, "o", color=picture_style.GREY, label="measured")
    fine = np.linspace(0.2, 3.5, 100)
    for name, model in CUSHIONS.items():
        ax.plot(
            fine, [model(v) / v for v in fine], label=name + (" (fitted to these)" if name == "match" else "")
        )
    ax.set(
        xlabel="speed into the cushion, rolling [m/s]",
        ylabel="rebound / incoming speed",
        xlim=(0, 3.6),
        ylim=(0.76, 1.09),
    )
    ax.set_title("Cushion rebound (Mathavan 2010, Fig. 7a)")
    ax.legend(loc="upper right", ncol=2)


def data(path, figures):
    """``paper_data.png``: throw and cushion rebound against the other data."""
    note = (
        "Throw: the angle by which friction turns the object ball off the line of centres. TP A.14 is a computed table; Doménech-Carbó\n"
        "(2023) measured 61 mm balls, the cue ball rolling at 0.80 m/s; the cushion data are of Mathavan et al. (2010), Fig. 7a."
    )
    with picture_style.drawing() as plt:
        figure, axes = picture_style.page(
            plt,
            8.2,
            "Throw and cushion rebound against other data",
            note,
            foot="python -m benchmarks.paper",
            rows=2,
            columns=2,
        )
        _a14_panel(axes[0, 0], figures["throw_a14"])
        _domenech_panels(axes[0, 1], axes[1, 1], figures["throw_domenech"])
        _cushion_panel(axes[1, 0], figures["cushion"])
        picture_style.save(figure, path)
