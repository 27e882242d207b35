"""How near to the limits do the extremes come? Draws ``stability.png`` from the figures of
``python -m benchmarks.stability``."""

import re

import numpy as np

from commands import picture_style

from .. import fuzz
from .._common import invariants

LEAST_SHOWN = 1e-9
FROM, FAILS = 1e-6, 1.0
"""The scale of the colours: shares of what is allowed."""
GROUPS = (
    (r"mu_s \S+, mu_bb \S+", "mu_s 0 to 1, mu_bb 0 to 1"),
    (r"cushion: mu_s \S+, mu_c \S+", "cushion: mu_s 0 to 1, mu_c 0 to 1"),
    (r"(.*), gap \S+", r"\1"),
    (r"... at a cushion, 5,000 rad/s", "cushion: spins of 5,000 rad/s"),
    (r"... at a cushion", "cushion: speeds 1e-9 to 50 m/s"),
    (r"(e_b, e_c) = [01]", r"\1 = 0 and 1"),
    (r"(e_b|mu_bb|mu_c) = [01]", r"\1 = 0 and 1"),
    (r"(mu_s) = .*", r"\1 = 0.001 to 1"),
    (r"(mu_r) = .*", r"\1 = 0.001 and 1"),
)
"""Extremes that share a line, by their names; of several the worst figure is shown."""
SAYS = {
    "unsolved": "not\nsolved",
    "energy": "energy\ngained",
    "momentum": "momen-\ntum",
    "parting": "still\nclosing",
    "mirror": "mirror\nimage",
    "lost": "not\nended",
    "events": "number\nof events",
    "overlap": "balls\noverlap",
    "in cushion": "in the\ncushion",
    "rest": "speed\nat rest",
    "log": "log not\ncorrect",
    "jump": "path\njumps",
    "energy at impact": "energy,\nimpact",
    "energy between": "energy,\nbetween",
    "energy of all": "energy,\nall",
}


def draw(path, figures):
    """Four charts: margins of impacts and shots, the paper's scheme, the fuzz, growth of rounding."""
    note = (
        "Each extreme is played and its invariants are checked. In the tables: the worst violation as a share of what is allowed.\n"
        "Above 1 it fails; empty cells are below one millionth or never violated."
    )
    failed = figures["failed"]
    result = "all invariants hold" if not failed else f"FAILED: {len(failed)} invariants"
    foot = f"python -m benchmarks.stability: {result}"
    impacts, shots = (grouped(figures[what], figures["allowed"][what]) for what in ("impacts", "shots"))
    with picture_style.drawing() as plt:
        figure, _ = picture_style.page(
            plt, 14.0, "How near impacts and shots at the extremes come to breaking a law", note, foot=foot
        )
        upper, middle, lower = figure.subfigures(3, 1, height_ratios=(3.9, 4.9, 3.7))
        left, right = upper.subplots(1, 2, width_ratios=(1, 1.05))
        _margins(left, impacts, "Impacts")
        _scheme(right, figures["euler"])
        whole = middle.subplots()
        shown = _margins(whole, shots, "Shots")
        picture_style.colour_bar(middle, shown, whole, "share of what is allowed", (1e-6, 1e-4, 1e-2, 1))
        left, right = lower.subplots(1, 2, width_ratios=(1.5, 1))
        _fuzz(left, figures["fuzz"])
        _rounding(right, figures["symmetry"])
        picture_style.save(figure, path)


def share(figure, limit):
    """A figure over what is allowed; where nothing is allowed, 10 and more for any."""
    if limit == 0:
        return 0.0 if figure <= 0 else 10.0 * figure
    return max(figure / limit, 0.0)


def grouped(results, limits):
    """{line: {invariant: the worst share of what is allowed}}."""
    lines: dict[str, dict[str, float]] = {}
    for name, row in results.items():
        line = name
        for pattern, text in GROUPS:
            if re.fullmatch(pattern, name):
                line = re.sub(pattern, text, name)
                break
        shares = lines.setdefault(line, dict.fromkeys(limits, 0.0))
        for what, limit in limits.items():
            shares[what] = max(shares[what], share(row[what], limit))
    return lines


def _margins(axes, lines, title):
    """A table in colour: extremes down, invariants across."""
    from matplotlib.colors import ListedColormap, LogNorm

    columns = list(next(iter(lines.values())))
    values = np.array([list(row.values()) for row in lines.values()])
    blues = picture_style.colours_of("Blues", np.linspace(0.08, 0.75, 255))
    shown = axes.imshow(
        np.where(values >= FROM, values, np.nan),
        norm=LogNorm(FROM, FAILS),
        aspect="auto",
        cmap=ListedColormap(blues).with_extremes(over=picture_style.ORANGE),
    )
    for k, row in enumerate(values):
        for c, x in enumerate(row):
            if x >= FROM:
                text = f"{x:.2f}" if x >= 0.01 else f"$10^{{{np.log10(x):.0f}}}$"
                axes.text(
                    c,
                    k,
                    text,
                    ha="center",
                    va="center",
                    size=picture_style.SMALL,
                    color="white" if x > 0.05 else picture_style.INK,
                )
    for edge in np.arange(0.5, len(values) - 1):
        axes.axhline(edge, color=picture_style.PAGE, lw=1)
    for edge in np.arange(0.5, len(columns) - 1):
        axes.axvline(edge, color=picture_style.PAGE, lw=1)
    axes.set_xticks(range(len(columns)), [SAYS[name] for name in columns])
    axes.set_yticks(range(len(lines)), list(lines))
    axes.tick_params(length=0, labelcolor=picture_style.INK)
    axes.grid(False)
    axes.spines[:].set_visible(False)
    axes.set_title(title)
    return shown


def _scheme(axes, euler):
    """Error and energy gained against N."""
    n = np.array([int(steps) for steps in euler])
    for key, label, mark in (
        ("error_worst", "worst error / speed", "o-"),
        ("error_median", "median error / speed", "o:"),
        ("gain e 1", "energy gained, e = 1", "s-"),
        ("gain e 0.89", "energy gained, e = 0.89", "^-"),
    ):
        y = np.array([row[key] for row in euler.values()])
        axes.plot(n[y > 0], y[y > 0], mark, label=label)
    picture_style.log_axis(axes.xaxis, decades=2)
    picture_style.log_axis(axes.yaxis)
    axes.set(xlabel="steps N", title="The paper's scheme, euler:N (200 impacts)")
    axes.legend(loc="lower left")


def _rounding(axes, symmetry):
    """Deviation against contacts."""
    contacts, turned = np.array(symmetry["contacts"]), np.array(symmetry["turned"])
    good = turned > 0
    axes.plot(
        contacts[good] + np.linspace(-0.3, 0.3, good.sum()),
        turned[good],
        ".",
        alpha=0.6,
        mew=0,
        label="a shot turned by 1 rad",
    )
    at = np.arange(0, contacts.max() + 1)
    fit = np.exp(np.polyval(np.polyfit(contacts[good], np.log(turned[good]), 1), at))
    axes.plot(
        at, fit, color=picture_style.INK, lw=1.2, label=f"times {symmetry['factor a contact']:.1f} a contact"
    )
    picture_style.log_axis(axes.yaxis, decades=2)
    axes.set(
        xlabel="ball-ball contacts in the shot",
        ylabel="deviation at rest [m]",
        title="How rounding errors grow",
    )
    axes.set_ylim(turned[good].min() / 30, turned.max() * 3)
    axes.legend(loc="lower right")


def _fuzz(axes, found):
    """Worst of each invariant by fidelity, over what is allowed."""
    if not found:
        axes.set_axis_off()
        return
    fidelities = [
        f
        for f in ("fast", "standard", "reference", "euler:100", "euler:400", "euler:1000")
        if f in found["worst"]
    ]
    # those of its run
    names = [
        n for n in invariants.NAMES if n in found["worst"][fidelities[0]] and n in SAYS and n != "account"
    ]
    for k, fidelity in enumerate(fidelities):
        limits: dict[str, float] = dict(zip(invariants.NAMES, fuzz.allowed(fidelity), strict=True))
        ratio = [max(found["worst"][fidelity][name] / limits[name], LEAST_SHOWN) for name in names]
        axes.plot(
            np.arange(len(names)) + 0.12 * (k - (len(fidelities) - 1) / 2), ratio, "o", ms=4.5, label=fidelity
        )
    axes.axhline(1.0, color=picture_style.ORANGE, lw=1.4)
    picture_style.log_axis(axes.yaxis, decades=2)
    axes.set_ylim(LEAST_SHOWN / 3, 2e3)
    axes.set_xticks(range(len(names)), [SAYS[name] for name in names])
    axes.tick_params(axis="x", length=0)
    axes.set(ylabel="share of what is allowed", title=f"{found['shots']:,} random shots: the worst of each")
    axes.legend(ncols=3, loc="upper center", handletextpad=0.1, columnspacing=0.8)
