"""Where does the energy of a break go? Draws ``rack.png`` from the figures of
``python -m benchmarks.rack``."""

import numpy as np

from commands import picture_style

from .breaks import apex_break
from .compliant import R

MODELS = {
    "Hertz": ("compliant balls (Hertz)", picture_style.BLUE),
    "sequence": ("in sequence (this engine)", picture_style.ORANGE),
    "simultaneous": ("simultaneous, rigid", picture_style.GREEN),
    "Hertz, q = 1/2": ("Hertz, q = 1/2", picture_style.SKY),
    "linear": ("linear springs", picture_style.PURPLE),
}
"""Name -> what the chart says, colour."""
MOST = 0.3
"""A ball with this share of the energy, or more, has the darkest colour."""


def _rack(ax, name, velocities, shares):
    """The rack, each ball coloured by its share of the energy, arrows as long as its speed."""
    from matplotlib.patches import Circle

    r, (title, colour) = apex_break(5.0, 0.0)[0], MODELS[name]
    shades = picture_style.colours_of(
        "Blues", np.clip(0.05 + 0.8 * np.sqrt(np.array(shares) / MOST), 0.0, 0.85)
    )
    arrow = {"arrowstyle": "-|>", "color": colour, "lw": 1.5, "shrinkA": 0, "shrinkB": 0}
    for i, (place, v, part) in enumerate(zip(r, np.array(velocities), shares, strict=True)):
        ax.add_patch(Circle(place, R, facecolor=shades[i], edgecolor=picture_style.QUIET, lw=0.7))
        if part >= 0.02:
            white = part > 0.07
            ax.text(
                *place,
                f"{100 * part:.0f}",
                ha="center",
                va="center",
                size=picture_style.SMALL,
                weight="bold",
                color="white" if white else picture_style.INK,
            )
        speed = np.hypot(*v)
        if speed > 0.25:
            start = place + v / speed * R
            ax.annotate("", start + 0.045 * v, start, arrowprops=arrow)
    ax.set(xlim=(-0.22, 0.22), ylim=(r[0, 1] - 0.19, r[15, 1] + 0.17), aspect="equal", xticks=[], yticks=[])
    ax.spines[:].set_visible(False)
    ax.grid(False)
    ax.set_title(f"{title[0].upper()}{title[1:]}", color=colour)
    ax.set_xlabel(
        f"{100 * (1 - sum(shares)):.0f} % of the energy is lost",
        size=picture_style.SMALL,
        color=picture_style.QUIET,
    )


def _gaps(axes, found):
    """Loose racks: the two corner balls' shares, one panel a model."""
    place = np.arange(len(found))
    for ax, model in zip(axes, ("hertz", "sequence"), strict=True):
        title, colour = MODELS["Hertz" if model == "hertz" else model]
        for side, shift, marker in ((0, -0.13, "o"), (1, 0.13, "s")):
            mean, sd = (np.array([100 * row[key][side] for row in found]) for key in (model, model + "_sd"))
            ax.errorbar(
                place + shift,
                mean,
                sd,
                fmt=marker,
                color=colour,
                mfc=colour if side == 0 else "white",
                elinewidth=1.4,
                ms=6,
                label=("left" if side == 0 else "right") + " corner ball",
            )
        ax.set_xticks(place, [picture_style.number(row["gap"] * 1e6) for row in found])
        ax.set(xlabel="mean gap between the balls [µm]", ylim=(0, 40), title=f"Loose racks: {title}")
        ax.legend(loc="upper right", ncols=2)
    axes[0].set_ylabel("share of the energy [%]")


def _whole(axes, distances):
    """Whole shots: how far from the rack the reds come to rest."""
    for ax, (kind, title) in zip(
        axes, (("apex, touching", "Cue ball into the apex"), ("break-off", "Break-off")), strict=True
    ):
        for name in ("Hertz, q = 1/2", "linear", "simultaneous", "Hertz", "sequence"):
            label, colour = MODELS[name]
            x = np.sort(distances[f"{kind}; {name}"])
            ax.step(
                x,
                np.arange(1, len(x) + 1) / len(x),
                where="post",
                color=colour,
                label=label,
                lw=2.4 if name == "sequence" else 1.5,
            )
        ax.set(
            xlabel="reds' mean distance from the rack, at rest [m]",
            ylim=(0, 1),
            title=f"Whole shots: {title}",
        )
    axes[0].set_ylabel("share of shots below")
    axes[1].legend(loc="lower right")


def picture(file, figures):
    """The head-on break by three models; loose racks; whole shots."""
    note = (
        "The cue ball meets a rack of 15 touching reds at 5 m/s on its axis. Numbers: share of the cue ball's energy 10 ms later [%],\n"
        "if 2 or more; arrows: velocities. Loose racks: 5 m/s, 0.1 R off the axis; mean and standard deviation over random racks."
    )
    foot = f"python -m benchmarks.rack, physics {figures['physics']!r}"
    with picture_style.drawing() as plt:
        fig, _ = picture_style.page(plt, 11.6, "A break by three rules for balls that touch", note, foot=foot)
        upper, middle, lower = fig.subfigures(3, 1, height_ratios=(3.9, 3.0, 3.0))
        for ax, name in zip(upper.subplots(1, 3), ("Hertz", "sequence", "simultaneous"), strict=True):
            after = figures["after"][name]
            _rack(ax, name, after["velocities"], after["shares"])
        _gaps(middle.subplots(1, 2, sharey=True), figures["gaps"])
        _whole(lower.subplots(1, 2, sharey=True), figures["distances"])
        picture_style.save(fig, file)
    print(file)
