"""What do the breaks look like? Draws ``rack.png`` from the figures of ``python -m benchmarks.rack``."""

import numpy as np

from .._common.command import pyplot, save_figure
from .breaks import apex_break
from .compliant import R


def picture(file, states, figures, samples):
    """The head-on break by three models; loose racks; whole shots."""
    plt = pyplot()
    from matplotlib.patches import Circle

    fig, axes = plt.subplots(2, 3, figsize=(13, 9.2), layout="constrained")
    r = apex_break(5.0, 0.0)[0]
    colours = {"Hertz": "C0", "Hertz, q = 1/2": "C4", "linear": "C2", "sequence": "C3", "simultaneous": "C1"}
    for ax, name in zip(axes[0], ("Hertz", "sequence", "simultaneous"), strict=True):
        v, x = states[name]
        for i in range(16):
            shade = plt.get_cmap("Reds")(min(1.0, 0.04 + 3.0 * x[i])) if i else "white"
            ax.add_patch(Circle(r[i], R, facecolor=shade, edgecolor="0.25", lw=0.8))
            ax.text(*r[i], f"{100 * x[i]:.1f}" if x[i] < 0.0995 else f"{100 * x[i]:.0f}", ha="center", va="center", fontsize=8,
                    color="white" if i and x[i] > 0.12 else "black")  # fmt: skip
            if np.hypot(*v[i]) > 0.1:
                start = r[i] + v[i] / np.hypot(*v[i]) * R
                ax.annotate("", start + 0.045 * v[i], start, arrowprops={"arrowstyle": "-|>", "color": colours[name], "lw": 1.3})
        ax.set(xlim=(-0.235, 0.235), ylim=(r[0, 1] - 0.19, r[15, 1] + 0.18), aspect="equal", xticks=[], yticks=[])
        what = {"Hertz": "compliant (Hertz)"}.get(name, name)
        ax.set_title(f"{what}: energy of each ball [%], {100 * (1 - x.sum()):.0f} % lost", fontsize=10, color=colours[name])
    ax = axes[1, 0]
    found = figures["gaps"]
    place = np.arange(len(found))
    for model, shift in (("hertz", -0.08), ("sequence", 0.08)):
        for side, marker in ((0, "<"), (1, ">")):
            mean = [100 * row[model][side] for row in found]
            sd = [100 * row[model + "_sd"][side] for row in found]
            name = "Hertz" if model == "hertz" else model
            ax.errorbar(place + shift + 0.05 * side, mean, sd, fmt=marker, color=colours[name], capsize=2, ms=6,
                        label=f"{name}, {'left' if side == 0 else 'right'} corner ball")  # fmt: skip
    ax.set_xticks(place, [f"{row['gap'] * 1e6:g}" for row in found])
    ax.set(xlabel="mean gap of the rack [um]", ylabel="share of the energy [%], mean and deviation over racks", ylim=(0, 45))
    ax.set_title("loose racks, 5 m/s, 0.1 R off the axis", fontsize=10)
    ax.legend(fontsize=8, ncols=2, loc="upper right")
    for ax, kind in zip(axes[1, 1:], ("apex, touching", "break-off"), strict=True):
        for name, colour in colours.items():
            x = np.sort(samples[kind, name])
            ax.step(x, np.arange(1, len(x) + 1) / len(x), where="post", color=colour, label=name, lw=1.8 if name == "sequence" else 1.2)
        ax.set(xlabel="reds' mean distance from the rack's centre, at rest [m]", ylabel="share of shots below", ylim=(0, 1))
        ax.set_title({"apex, touching": "whole shots: apex of a touching rack"}.get(kind, f"whole shots: {kind}"), fontsize=10)
        ax.legend(fontsize=8)
    save_figure(fig, file, dpi=110)
    print(file)
