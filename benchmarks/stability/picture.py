"""What do the extremes look like? Draws ``stability.png`` from the figures of ``python -m benchmarks.stability``."""

import numpy as np

from .. import fuzz
from .._common import invariants as invariants
from .._common.command import pyplot, save_figure
from .impacts import IMPACT_LIMITS
from .shots import SHOT_LIMITS
from .symmetry import growth

LEAST_SHOWN = 1e-9


def draw(path, impacts, shots, euler, symmetry, found):
    """Four pictures: margins, the paper's scheme, growth of rounding, the fuzz."""
    plt = pyplot()

    figure, axes = plt.subplots(2, 2, figsize=(16, 16), width_ratios=(1.25, 1), height_ratios=(1.6, 1), layout="constrained")
    margins(axes[0, 0], impacts, shots)
    scheme(axes[0, 1], euler)
    chaos(axes[1, 1], *symmetry)
    invariants_of_fuzz(axes[1, 0], found)
    save_figure(figure, path, dpi=90)


def margins(axis, impacts, shots):
    """Worst figure over what is allowed, of every extreme and invariant."""
    rows = [
        (name, limits, figures)
        for results, limits in ((impacts, IMPACT_LIMITS), (shots, SHOT_LIMITS))
        for name, (_, figures) in results.items()
    ]
    columns = list(dict.fromkeys([*IMPACT_LIMITS, *SHOT_LIMITS]))
    values = np.full((len(rows), len(columns)), np.nan)
    for k, (_, limits, figures) in enumerate(rows):
        for name, limit in limits.items():
            x = figures[name]
            ratio = (x + 0.1) / 0.2 * 10 if limit == 0 and x > 0 else 0.0 if limit == 0 else x / limit
            values[k, columns.index(name)] = np.log10(max(ratio, LEAST_SHOWN))
    shown = axis.imshow(values, aspect="auto", cmap="RdYlGn_r", vmin=-6, vmax=2)
    axis.set_xticks(range(len(columns)), columns, rotation=35, ha="right", fontsize=8)
    axis.set_yticks(range(len(rows)), [name for name, _, _ in rows], fontsize=7)
    axis.set_title("worst figure over what is allowed, log10 (red above 0: fails; white: does not apply)", fontsize=10)
    axis.figure.colorbar(shown, ax=axis, shrink=0.7)


def scheme(axis, euler):
    """Error and energy gained against N."""
    n = np.array(list(euler))
    for key, label, mark in (
        ("error_worst", "worst error / incoming speed", "o-"),
        ("error_median", "median error", "o:"),
        ("gain e 1", "energy gained, e = 1", "s-"),
        ("gain e 0.89", "energy gained, e = 0.89", "^-"),
    ):
        y = np.array([row[key] for row in euler.values()])
        axis.loglog(n[y > 0], y[y > 0], mark, label=label)
    axis.axhline(1.0, color="grey", lw=0.8)
    axis.set_xlabel("steps N of the paper's scheme (eq. 14)")
    axis.set_title("Where does euler:N break? 200 impacts", fontsize=10)
    axis.legend(fontsize=8)


def chaos(axis, contacts, mirror, turned):
    """Deviation against contacts."""
    axis.semilogy(contacts + np.linspace(-0.3, 0.3, len(contacts)), np.maximum(turned, 1e-17), ".", alpha=0.6, label="turned by 1 rad")
    at = np.arange(0, contacts.max() + 1)
    good = turned > 0
    axis.semilogy(
        at,
        np.exp(np.polyval(np.polyfit(contacts[good], np.log(turned[good]), 1), at)),
        "k-",
        lw=1,
        label=f"x {growth(contacts, turned):.1f} a contact",
    )
    axis.set_xlabel("ball-ball contacts of the shot")
    axis.set_ylabel("deviation of the places at rest [m]")
    axis.set_title(f"How rounding grows (mirrored shots: {mirror.max():.1g} m)", fontsize=10)
    axis.legend(fontsize=8)


def invariants_of_fuzz(axis, found):
    """Worst of each invariant by fidelity, over what is allowed."""
    if not found:
        axis.set_axis_off()
        return
    names = [n for n in invariants.NAMES if n not in ("finite", "clock", "account")]
    for k, fidelity in enumerate(sorted(found.worst)):
        pick = [invariants.NAMES.index(n) for n in names]
        ratio = np.maximum((found.worst[fidelity] / np.maximum(fuzz.allowed(fidelity), 1e-300))[pick], LEAST_SHOWN)
        axis.semilogy(np.arange(len(names)) + 0.1 * (k - 3), ratio, "o", label=fidelity)
    axis.axhline(1.0, color="red", lw=1)
    axis.set_xticks(range(len(names)), names, rotation=30, ha="right", fontsize=8)
    axis.set_ylabel("worst figure over what is allowed")
    axis.set_title(f"{found.shots:,} random shots: the worst of each invariant (at the bottom: never violated at all)", fontsize=10)
    axis.legend(fontsize=7, ncols=6, loc="lower center", bbox_to_anchor=(0.5, 0.08))
