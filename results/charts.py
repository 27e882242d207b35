"""The charts of benchmarks that take long or that need data from elsewhere, drawn from the figures that ``physics/`` keeps:
``stability.png``, ``pockets.png`` and ``speed.png``.

Each file of figures names the command, and the commit where it is not this version's, that measured them.
"""

import json
import re
from pathlib import Path

import numpy as np

from agents._lib import picture_style as style
from agents._lib import provenance

FIGURES = Path(__file__).resolve().parent / "physics"
COLOURS = (style.BLUE, style.ORANGE, style.GREEN, style.PURPLE)

FROM = 1e-6
"""The smallest share of what is allowed that the table of ``stability.png`` shows."""
LEAST = 1e-9
GROUPS = (
    (r"(.*), gap \S+", r"\1"),
    (r"(e_b, e_c) = [01]", r"restitution (\1) 0 and 1"),
    (r"mu_bb = [01]", "friction of balls 0 and 1"),
    (r"mu_c = [01]", "friction of cushions 0 and 1"),
    (r"mu_s = .*", "sliding friction 0.001 to 1"),
    (r"mu_r = .*", "rolling friction 0.001 and 1"),
    (r"spin_decel = 0", "side spin never fades"),
    (r"one shot of 60 s and more", "one shot of 60 s or more"),
)
"""Extremes that share a row of the table, by their names; a row shows the worst figure of its extremes."""
WORDS = {
    "lost": "does not\nend",
    "events": "number\nof events",
    "energy": "energy\ngained",
    "momentum": "momen-\ntum",
    "parting": "balls still\nclosing",
    "overlap": "balls\noverlap",
    "in cushion": "ball in a\ncushion",
    "rest": "speed\nat rest",
    "log": "log not\ncorrect",
    "jump": "path\njumps",
    "energy at impact": "energy,\nimpacts",
    "energy between": "energy,\nbetween",
    "energy of all": "energy,\nwhole shot",
}
FIDELITIES = ("fast", "standard", "reference", "euler:100", "euler:400", "euler:1000")


def read(name):
    """The kept figures of a chart."""
    return json.loads((FIGURES / f"{name}.json").read_text(encoding="utf-8"))


def draw_stability(folder):
    """Margins of extreme and of random shots, the paper's scheme, how rounding errors grow."""
    figures = read("stability")
    fuzz, worst = (
        figures["fuzz"],
        max(
            figures["impacts"][name][what] / limit
            for name in figures["impacts"]
            for what, limit in figures["allowed"]["impacts"].items()
            if limit
        ),
    )
    lost = len(fuzz["failures"])
    note = (
        "Each shot must keep the laws of mechanics within a small allowance for rounding. Shown: its worst violation as a share\n"
        "of its own allowance. 1 would be a failure; none occurred. Empty cells are below one millionth."
    )
    if lost:
        note += f"\n{lost} of the {fuzz['shots']:,} random shots could not be computed: they raised an error instead of a result."
    foot = (
        f"python -m benchmarks.stability --fuzz {fuzz['shots']}. Single impacts at the same extremes stay below"
        f" {style.number(10 ** np.ceil(np.log10(worst)))} of what is allowed."
    )
    with style.drawing() as plt:
        figure, _ = style.page(plt, 12.2, "How near extreme shots come to breaking a law", note, foot=foot)
        upper, middle, lower = figure.subfigures(3, 1, height_ratios=(4.9, 3.3, 3.5))
        axes = upper.subplots()
        shown = _margins(axes, figures["shots"], figures["allowed"]["shots"])
        style.colour_bar(upper, shown, axes, "share of what is allowed", (1e-6, 1e-4, 1e-2, 1))
        _fuzz(middle.subplots(), fuzz)
        left, right = lower.subplots(1, 2)
        _scheme(left, figures["euler"])
        _rounding(right, figures["symmetry"])
        style.save(figure, folder / "stability.png")


def _margins(axes, results, limits):
    """A table in colour: extremes down, laws across."""
    from matplotlib import colormaps
    from matplotlib.colors import ListedColormap, LogNorm

    lines: dict[str, list[float]] = {}
    for name, row in results.items():
        line = next((re.sub(p, text, name) for p, text in GROUPS if re.fullmatch(p, name)), name)
        shares = [
            max(row[what] / limit if limit else 10.0 * row[what], 0.0) for what, limit in limits.items()
        ]
        lines[line] = np.maximum(lines.get(line, 0.0), shares)
    values = np.array(list(lines.values()))
    blues = ListedColormap(colormaps["Blues"](np.linspace(0.08, 0.75, 255))).with_extremes(over=style.ORANGE)
    shown = axes.imshow(
        np.where(values >= FROM, values, np.nan), norm=LogNorm(FROM, 1.0), aspect="auto", cmap=blues
    )
    for k, c in np.argwhere(values >= FROM):
        x = values[k, c]
        text = f"{x:.2g}" if x >= 0.01 else f"$10^{{{np.log10(x):.0f}}}$"
        colour = "white" if x > 0.05 else style.INK
        axes.text(c, k, text, ha="center", va="center", size=style.SMALL, color=colour)
    for edge in np.arange(0.5, len(values) - 1):
        axes.axhline(edge, color=style.PAGE, lw=1)
    for edge in np.arange(0.5, len(limits) - 1):
        axes.axvline(edge, color=style.PAGE, lw=1)
    axes.set_xticks(range(len(limits)), [WORDS[name] for name in limits])
    axes.set_yticks(range(len(lines)), [line[0].upper() + line[1:] for line in lines])
    axes.tick_params(length=0, labelcolor=style.INK)
    axes.grid(False)
    axes.spines[:].set_visible(False)
    axes.set_title(f"{len(results)} kinds of extreme shots")
    return shown


def _fuzz(axes, found):
    """The worst share of each law, by fidelity."""
    names = [name for name in WORDS if name in found["share"]["standard"]]
    for k, fidelity in enumerate(FIDELITIES):
        share = [max(found["share"][fidelity][name], LEAST) for name in names]
        places = np.arange(len(names)) + 0.1 * (k - (len(FIDELITIES) - 1) / 2)
        axes.plot(places, share, "o", ms=4.5, label=fidelity)
    axes.axhline(1.0, color=style.ORANGE, lw=1.4)
    axes.annotate(
        "failure", (len(names) - 0.5, 1.0), (0, 3), textcoords="offset points", ha="right", size=style.SMALL
    )
    style.log_axis(axes.yaxis, decades=2)
    axes.set(ylim=(LEAST / 3, 300), xlim=(-0.5, len(names) - 0.5))
    axes.set_xticks(range(len(names)), [WORDS[name] for name in names])
    axes.tick_params(axis="x", length=0)
    axes.set(
        ylabel="share of what is allowed", title=f"{found['shots']:,} random shots (bottom row: no violation)"
    )
    axes.legend(ncols=6, loc="upper left", handletextpad=0.1, columnspacing=0.8)


def _scheme(axes, euler):
    """Error and energy gained against N."""
    n = np.array([int(steps) for steps in euler])
    for key, label, mark in (
        ("error_worst", "largest error / speed", "o-"),
        ("error_median", "median error / speed", "o:"),
        ("gain e 1", "energy gained, restitution 1", "s-"),
        ("gain e 0.89", "energy gained, restitution 0.89", "^-"),
    ):
        y = np.array([row[key] for row in euler.values()])
        axes.plot(n[y > 0], y[y > 0], mark, label=label)
    style.log_axis(axes.xaxis, decades=2)
    style.log_axis(axes.yaxis)
    axes.set(xlabel="steps N of an impact", title="The paper's scheme, euler:N, 200 impacts", ylim=(1e-6, 10))
    axes.legend(loc="lower left")


def _rounding(axes, symmetry):
    """Deviation against contacts."""
    contacts, turned = np.array(symmetry["contacts"]), np.array(symmetry["turned"])
    good = turned > 0
    x = contacts[good] + np.linspace(-0.3, 0.3, good.sum())
    axes.plot(x, turned[good], ".", alpha=0.6, mew=0, label="one shot, turned by 1 rad")
    at = np.arange(0, contacts.max() + 1)
    fit = np.exp(np.polyval(np.polyfit(contacts[good], np.log(turned[good]), 1), at))
    label = f"grows {symmetry['factor a contact']:.1f} times a contact"
    axes.plot(at, fit, color=style.INK, lw=1.2, label=label)
    style.log_axis(axes.yaxis, decades=2)
    axes.set(
        xlabel="contacts of two balls in the shot",
        ylabel="deviation at rest [m]",
        title="How rounding errors grow",
    )
    axes.set_ylim(turned[good].min() / 100, turned.max() * 3)
    axes.legend(loc="lower right")


def draw_pockets(folder):
    """Windows of three pockets, what drops along the rail, pool pockets beside published sizes."""
    figures = read("pockets")
    note = (
        "Window: how far off the middle of a pocket a rolling ball may pass and still drop, by its speed 0.3 m before the pocket and\n"
        "the angle between its path and the pocket's axis (degrees beside the lines). Dotted: if a ball dropped as soon as its centre\n"
        "crossed the edge, instead of falling."
    )
    with style.drawing() as plt:
        title, foot = "How wide the pockets are", figures["command"]
        figure, _ = style.page(plt, 8.6, title, note, foot=foot)
        upper, lower = figure.subfigures(2, 1, height_ratios=(1, 1.35))
        rows = figures["windows"]
        for axes, (table, pocket) in zip(
            upper.subplots(1, 3), (("match", "corner"), ("tight", "corner"), ("match", "middle")), strict=True
        ):
            here = [row for row in rows if (row["table"], row["pocket"]) == (table, pocket)]
            _windows(axes, figures["speeds"], here, f"{pocket} pocket, {table!r}".capitalize())
        left, right = lower.subplots(1, 2, width_ratios=(1, 1.3))
        _rail(left, figures["rail"])
        _pool(right, figures["pool"])
        style.save(figure, folder / "pockets.png")


def _windows(axes, speeds, rows, title):
    """Windows against the speed, one colour an angle."""
    for row, colour in zip(rows, COLOURS, strict=False):
        axes.plot(speeds, row["after"], "o-", color=colour, ms=4)
        axes.plot(speeds, row["before"], ":", color=colour)
        how = {"va": "center", "color": colour, "size": style.TEXT, "weight": "bold"}
        axes.annotate(
            f"{row['angle']}°", (speeds[-1], row["after"][-1]), (6, 0), textcoords="offset points", **how
        )
    axes.set(xlabel="speed [m/s]", ylabel="window [mm]", ylim=(0, 95), xlim=(0, 11), title=title)


def _rail(axes, rail):
    """Which balls drop that roll along the rail."""
    offs = rail["offs"]
    for y, off in enumerate(offs):
        for x, drops in enumerate(rail["drops"][str(off)]):
            mark, colour = ("o", style.BLUE) if drops else ("x", style.ORANGE)
            if drops is not None:
                axes.plot(x, y, mark, color=colour, ms=7, mew=2.0)
    axes.set_xticks(range(len(rail["speeds"])), [f"{v:g}" for v in rail["speeds"]])
    axes.set_yticks(
        range(len(offs)), ["touching it" if off == 0 else f"{1e3 * off:g} mm off it" for off in offs]
    )
    axes.set(xlabel="speed [m/s]", ylim=(len(offs) - 0.1, -0.6), xlim=(-0.6, len(rail["speeds"]) - 0.4))
    axes.set_title(f"Along the rail, {rail['run']:g} m from a corner ('match')")
    axes.tick_params(length=0)
    for mark, colour, label in (("o", style.BLUE, "drops"), ("x", style.ORANGE, "does not drop")):
        axes.plot([], [], mark, color=colour, ms=7, mew=2.0, label=label)
    axes.legend(loc="lower center", ncols=2, handletextpad=0.2)


def _pool(axes, pool):
    """Target sizes of pool pockets, beside Alciatore's."""
    for kind, colour in zip(("corner", "side"), COLOURS, strict=False):
        sizes = pool[kind]
        axes.plot(
            sizes["angles"],
            sizes["published"],
            color=colour,
            lw=5,
            alpha=0.3,
            label=f"{kind}, published (sliding ball)",
        )
        axes.plot(sizes["angles"], sizes["slow"], "o-", color=colour, label=f"{kind}, 0.5 m/s, rolling")
        axes.plot(sizes["angles"], sizes["fast"], "s--", color=colour, label=f"{kind}, 6 m/s, rolling")
    corner = pool["corner"]
    k = int(np.argmax(corner["slow"]))
    words = (
        "At 30° a rolling ball that meets\na facing keeps its roll and still\ndrops. One that slides gets\n"
        f"{corner['sliding'][k]:.2f} inches, as published."
    )
    axes.annotate(
        words,
        (corner["angles"][k] + 6.5, corner["slow"][k] + 0.2),
        size=style.SMALL,
        va="top",
        color=style.QUIET,
    )
    axes.set(
        xlabel="angle off the pocket's axis [degrees]",
        ylabel="target size [inches]",
        ylim=(0, 4.3),
        xlim=(-2, 66),
    )
    axes.set_title("Pool pockets, beside Alciatore's TP 3.5 and 3.6")
    axes.legend(loc="lower left")


def draw_speed(folder):
    """How the time of a shot grows."""
    figures = read("speed")
    found = figures["growth"]
    foot = f"{figures['command']}; {provenance.line(figures)}"
    note = "Fidelity standard. Kernel: the compiled engine alone. simulate_batch: with its checks of the input and its result objects."
    with style.drawing() as plt:
        figure, ((by_balls, by_event), (by_batch, by_thread)) = style.page(
            plt, 7.6, "How the time of a simulated shot grows", note, foot=foot, rows=2, columns=2
        )
        balls = [row["balls"] for row in found["balls"]]
        median, low, high = np.array([row["us"] for row in found["balls"]]).T
        by_balls.fill_between(balls, low, high, alpha=0.18, lw=0, label="5 % to 95 % of the shots")
        by_balls.plot(balls, median, "o-", label="median")
        by_balls.set(xlabel="balls on the table", ylabel="time of a shot [µs]", ylim=(0, 1.35 * high.max()))
        by_balls.set(title="With the balls on the table", xticks=[2, 4, 6, 8, 11, 15, 22])
        for kind, of in found["events"].items():
            events, us = np.array(of["events"]), np.array(of["us"])
            groups = np.array_split(np.argsort(events, kind="stable"), 10)
            middles = np.array([(np.median(events[g]), np.median(us[g])) for g in groups])
            (line,) = by_event.plot(*middles.T, "o-", label=f"{kind}: medians", zorder=3)
            by_event.scatter(np.maximum(events, 1), us, s=4, alpha=0.25, color=line.get_color(), lw=0)
        by_event.set(
            xlabel="events in the shot", ylabel="time of a shot [µs]", title="With the events in a shot"
        )
        rows = found["threads"]
        for name in ("kernel", "simulate_batch"):
            by_batch.plot(
                *np.array([(r["shots"], r[f"{name} us"]) for r in found["batch"]]).T, "o-", label=name
            )
            by_thread.plot(
                *np.array([(r["threads"], 1e6 / r[f"{name} us"]) for r in rows]).T, "o-", label=name
            )
        by_batch.set(
            xlabel="shots in a batch",
            ylabel="time of a shot [µs]",
            title="With the batch (22 balls, 1 thread)",
        )
        threads, once = [r["threads"] for r in rows], 1e6 / rows[0]["kernel us"]
        by_thread.plot(
            threads, [once * t for t in threads], ":", color=style.GREY, label="kernel times the threads"
        )
        by_thread.set(xlabel="threads", ylabel="shots a second", ylim=(0, None), xticks=threads)
        by_thread.set_title(f"With the threads (22 balls, {rows[0]['shots']:,} shots)")
        by_thread.yaxis.set_major_formatter(style.number)
        style.log_axis(by_event.xaxis)
        style.log_axis(by_event.yaxis)
        style.log_axis(by_batch.xaxis, decades=2)
        by_batch.set_ylim(0, None)
        for axes, place in zip(
            (by_balls, by_event, by_batch, by_thread),
            ("upper left",) * 2 + ("upper right", "lower left"),
            strict=True,
        ):
            axes.legend(loc=place)
        style.save(figure, folder / "speed.png")


def make(folder):
    """Draw them all."""
    for draw in (draw_stability, draw_pockets, draw_speed):
        draw(folder)
        print(folder / f"{draw.__name__.removeprefix('draw_')}.png", flush=True)
