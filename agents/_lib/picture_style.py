"""How are the charts of this repository drawn? With one page, typeface, set of sizes and palette for all figures
of matplotlib.

A chart is ``WIDTH`` inches wide, or 880 pixels in a README, where one inch is 100 pixels. The smallest text,
``SMALL`` points, is then 11 pixels high (7.6 on a page 600 pixels wide). The page is opaque and almost white, so
that a chart looks the same on light and dark backgrounds. ``tests/pictures.py`` checks the sizes, overlaps and
margins of every chart.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import snooker_env.render

from .files import save_figure

WIDTH = 8.8
"""Width of every chart [inches]."""
DPI = 200
"""Pixels per inch in the file: twice those in a README, for sharp screens."""
SMALL, TEXT, PANEL, TITLE = 8.0, 9.0, 10.0, 13.0
"""Sizes of text [points]: smallest, normal, title of a panel, title of the chart."""
PAGE, PANEL_GROUND, INK, QUIET, GRID = "#f4f5f7", "#ffffff", "#1c2230", "#596273", "#e2e5ea"
BLUE, ORANGE, GREEN, PURPLE, SKY, AMBER, GREY = (
    "#0072b2",
    "#d55e00",
    "#00805d",
    "#a64d84",
    "#56b4e9",
    "#e69f00",
    "#8a93a3",
)
"""After Okabe and Ito: colour-blind readers can distinguish them."""
SERIES = (BLUE, ORANGE, GREEN, PURPLE, AMBER, SKY, GREY)
FAMILY = "Inter of snooker_env"

_FONTS = Path(snooker_env.render.__file__).parent / "fonts"
_SIDES = (
    {"xytext": (0, -8), "ha": "center", "va": "top"},
    {"xytext": (8, 0), "ha": "left", "va": "center"},
    {"xytext": (-8, 0), "ha": "right", "va": "center"},
    {"xytext": (0, 8), "ha": "center", "va": "bottom"},
)
_EDGE = 0.14  # around everything on the page [inches]


@cache
def _typeface():
    """Register the typeface of snooker_env. Returns its name."""
    from matplotlib.font_manager import FontEntry, fontManager

    for name, weight in (("Inter-Medium.otf", 400), ("Inter-Bold.otf", 700)):
        entry = FontEntry(str(_FONTS / name), 0, FAMILY, "normal", "normal", weight, "normal", "scalable")
        fontManager.ttflist.insert(0, entry)
    return FAMILY


def _settings() -> Any:
    from cycler import cycler

    return {
        "font.family": [_typeface(), "DejaVu Sans"],
        "font.size": TEXT,
        "mathtext.fontset": "custom",
        **{f"mathtext.{style}": _typeface() for style in ("rm", "it", "bf", "sf", "tt", "cal", "bfit")},
        "figure.facecolor": PAGE,
        "savefig.facecolor": PAGE,
        "axes.facecolor": PANEL_GROUND,
        "text.color": INK,
        "axes.edgecolor": GREY,
        "axes.linewidth": 0.8,
        "axes.labelcolor": INK,
        "axes.labelsize": TEXT,
        "axes.titlesize": PANEL,
        "axes.titleweight": "bold",
        "axes.titlelocation": "left",
        "axes.titlepad": 7.0,
        "axes.titlecolor": INK,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.grid": True,
        "axes.axisbelow": True,
        "grid.color": GRID,
        "grid.linewidth": 0.8,
        "axes.prop_cycle": cycler(color=SERIES),
        "axes.formatter.use_mathtext": True,
        "xtick.labelsize": SMALL,
        "ytick.labelsize": SMALL,
        "xtick.color": GREY,
        "ytick.color": GREY,
        "xtick.labelcolor": QUIET,
        "ytick.labelcolor": QUIET,
        "xtick.major.width": 0.8,
        "ytick.major.width": 0.8,
        "xtick.minor.visible": False,
        "legend.frameon": False,
        "legend.fontsize": SMALL,
        "legend.handlelength": 1.6,
        "legend.columnspacing": 1.4,
        "legend.borderaxespad": 0.4,
        "lines.linewidth": 1.8,
        "lines.markersize": 5.0,
        "lines.solid_capstyle": "round",
        "errorbar.capsize": 0.0,
        "figure.dpi": DPI,
        "savefig.dpi": DPI,
    }


@contextmanager
def drawing() -> Iterator[Any]:
    """A context with ``matplotlib.pyplot`` in this style, drawing into files."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    with plt.rc_context(_settings()):
        yield plt


def page(
    plt: Any, height: float, title: str, note: str = "", *, foot: str = "", **grid: Any
) -> tuple[Any, Any]:
    """Make a figure with its title, a note on how to read it, its source at the foot, and room for panels between.

    ``height`` in inches; ``grid``: of ``Figure.subplots`` (rows, columns, ratios). Returns the figure and its
    axes, None without ``grid``.
    """
    figure = plt.figure(figsize=(WIDTH, height), layout="constrained")
    line = 1.42 / 72  # height of a text of one point [inches]
    top = _EDGE
    for text, size, weight, colour in ((title, TITLE, "bold", INK), (note, TEXT, "normal", QUIET)):
        if text:
            figure.text(
                _EDGE / WIDTH,
                1 - top / height,
                text,
                size=size,
                weight=weight,
                color=colour,
                va="top",
                linespacing=1.3,
            )
            top += size * line * (text.count("\n") + 1) + 0.02
    bottom = _EDGE
    if foot:
        figure.text(
            _EDGE / WIDTH, bottom / height, foot, size=SMALL, color=QUIET, va="bottom", linespacing=1.3
        )
        bottom += SMALL * line * (foot.count("\n") + 1) + 0.05
    top += 0.08
    figure.get_layout_engine().set(
        rect=(_EDGE / WIDTH, bottom / height, 1 - 2 * _EDGE / WIDTH, 1 - (top + bottom) / height),
        w_pad=0.12,
        h_pad=0.12,
        wspace=0.05,
        hspace=0.05,
    )
    if not grid:
        return figure, None
    rows, columns = grid.pop("rows", 1), grid.pop("columns", 1)
    return figure, figure.subplots(rows, columns, **grid)


def number(value: float, _position: int | None = None) -> str:
    """Format a number for an axis: 0.001, 0.5, 20, 1,000; smaller or larger numbers as powers of ten."""
    from math import floor, log10

    if value == 0:
        return "0"
    power = floor(log10(abs(value)) + 1e-9)
    if -3 <= power <= 6:
        return f"{value:,.{max(0, 1 - power)}f}".rstrip("0").rstrip(".") if power < 1 else f"{value:,.0f}"
    factor = value / 10.0**power
    return f"$10^{{{power}}}$" if abs(factor - 1) < 1e-6 else f"${factor:.3g} \\times 10^{{{power}}}$"


def log_axis(axis: Any, *, subs: tuple[float, ...] = (1.0,), decades: int = 1) -> None:
    """Make an axis (``axes.xaxis``) logarithmic, with plain numbers at ``subs`` times each power of ten, or
    at every ``decades``-th."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

    getattr(axis.axes, f"set_{axis.axis_name}scale")("log")
    axis.set_major_locator(LogLocator(base=10.0**decades, subs=subs, numticks=30))
    axis.set_major_formatter(FuncFormatter(number))
    axis.set_minor_locator(NullLocator())


def colour_bar(figure: Any, shown: Any, axes: Any, label: str, ticks: Any = None, **more: Any) -> Any:
    """A colour bar with its label and plain numbers."""
    bar = figure.colorbar(shown, ax=axes, **{"shrink": 0.9, "aspect": 28, "pad": 0.015} | more)
    bar.outline.set_visible(False)
    if ticks is not None:
        bar.set_ticks(ticks, labels=[number(tick) for tick in ticks])
    bar.ax.minorticks_off()
    bar.set_label(label, size=SMALL, color=QUIET)
    return bar


def label_points(figure: Any, labels: list[tuple[Any, tuple[float, float], str, dict[str, Any]]]) -> None:
    """Write labels beside points, each without covering other text: below, otherwise right, left or above.

    ``labels`` holds for each label its Axes, the point (x, y), the text, and keywords of ``Axes.annotate``.
    """
    from matplotlib.text import Text

    figure.canvas.draw()  # this computes the layout
    figure.set_layout_engine("none")
    renderer = figure.canvas.get_renderer()
    placed = [
        text.get_window_extent(renderer)
        for text in figure.findobj(Text)
        if text.get_visible() and text.get_text()
    ]
    for axes, point, text, how in labels:
        for k, side in enumerate((*_SIDES, _SIDES[0])):  # below if no side is free
            note = axes.annotate(text, point, textcoords="offset points", size=SMALL, **side, **how)
            box = note.get_window_extent(renderer)
            if k == len(_SIDES) or not any(box.overlaps(other) for other in placed):
                break
            note.remove()
        placed.append(box)


def save(figure: Any, file: Path) -> None:
    """Write a chart in the format of the file's suffix, completely or not at all."""
    save_figure(figure, file, dpi=DPI)
