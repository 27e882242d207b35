"""Can a chart be read? Sizes of its text on a page, texts that overlap or are cut off, its title."""

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text

from snooker_env.physics.table import Table
from snooker_env.render.table_picture import SIZE, View

README = 880
"""Pixels of a page's width."""
LEAST = 10.5
"""Pixels from line to line of the smallest text: 9 and more from the top of a capital to the foot of a g."""


def to_pixels(points, table="match", *, size=SIZE):
    """Columns and rows [pixels] of points (..., 2) [m] in a picture of ``rgb_array`` of that size."""
    return View.of(Table.of(table), size)(points)


def size_of(table, height):
    """(width, height) of a picture that the table and its score bar fill."""
    tall, wide = np.diff(table.bounds, axis=1)[:, 0] + 2 * (0.155 + 0.012)
    return 2 * round(wide / tall * (height - height / 15) / 2), height


@contextmanager
def saved_figures() -> Iterator[list[Figure]]:
    """The figures that would be saved within; nothing is written into their files, which takes long."""
    figures: list[Figure] = []
    save = Figure.savefig
    Figure.savefig = lambda self, *_, **__: figures.append(self)
    try:
        yield figures
    finally:
        Figure.savefig = save


def texts(figure):
    """(text, its corners (4, 2) in pixels) of all that is written, in the order of drawing."""
    renderer = figure.canvas.get_renderer()
    found = []
    for text in figure.findobj(Text):
        if text.get_visible() and text.get_text().strip() and _is_drawn(text, figure):
            turned = text.get_rotation()
            text.set_rotation(0.0)
            width, height = text.get_window_extent(renderer).size
            text.set_rotation(turned)
            box = text.get_window_extent(renderer)
            middle, (c, s) = (box.p0 + box.p1) / 2, (np.cos(np.radians(turned)), np.sin(np.radians(turned)))
            half = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (width / 2, height / 2)
            found.append((text, middle + half @ np.array([(c, s), (-s, c)])))
    return found


def _is_drawn(text, figure):
    """Ticks outside the limits have labels that are not drawn."""
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            for minor in (False, True):
                labels = axis.get_ticklabels(minor=minor)
                if text in labels:
                    place = (axis.get_minorticklocs() if minor else axis.get_majorticklocs())[
                        labels.index(text)
                    ]
                    low, high = sorted(axis.get_view_interval())
                    return axes.axison and axes.get_visible() and axis.get_visible() and low <= place <= high
    return text.axes is None or text.axes.get_visible()


def overlap(a, b, room=1.0):
    """Do two rectangles (4, 2), each ``room`` pixels smaller all around, overlap? By the axes of both."""
    for edges in (a, b):
        for k in (0, 1):
            way = edges[k + 1] - edges[k]
            length = np.hypot(*way)
            if length < 1e-9:
                return False
            p, q = a @ way / length, b @ way / length
            if min(p.max(), q.max()) - max(p.min(), q.min()) <= 2 * room:
                return False
    return True


def unreadable(figure):
    """What is wrong with a figure: a list of sentences, empty if nothing is."""
    figure.set_dpi(100)
    FigureCanvasAgg(figure).draw()  # whoever closed it has taken its canvas
    width, height = figure.get_size_inches() * figure.dpi
    scale = README / width
    wrong, found = [], texts(figure)
    for text, corners in found:
        size = text.get_fontsize() * figure.dpi / 72 * scale
        if size < LEAST:
            wrong.append(f"{text.get_text()!r} is {size:.1f} pixels high at {README} pixels")
        (left, low), (right, high) = corners.min(axis=0), corners.max(axis=0)
        if left < -1 or low < -1 or right > width + 1 or high > height + 1:
            wrong.append(f"{text.get_text()!r} is cut off")
    for k, (one, a) in enumerate(found):
        for other, b in found[:k]:
            if overlap(a, b):
                wrong.append(f"{other.get_text()!r} and {one.get_text()!r} overlap")
    panels = max((text.get_fontsize() for text, _ in found if text not in figure.texts), default=0.0)
    if not any(text in figure.texts and text.get_fontsize() > panels for text, _ in found):
        wrong.append("has no title: a text of the page, larger than all of its panels")
    return wrong
