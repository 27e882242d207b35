"""How is a table drawn with matplotlib? By a ``Sketch``: a point (x, y) [m] is at ``ax.plot(y, x)``."""

from types import ModuleType
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .._install import missing
from .._types import Floats, Place, Vector, Vectors
from ..game.balls import N_BALLS
from ..physics.table import Table
from .outline import BAULK_LINE, CUSHION, D_ARC, RAIL, SPOT_MARKS, extent, is_marked, outline
from .palette import COLOURS, LETTERS, PALE, PALETTE, Colour

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WIDTH = 8.3  # width of a new figure [inches]: 830 pixels, the width of a README
PATH_WIDTH, OUTLINE = 2.16, 1.6  # of a path [points], 3 pixels at 100 dpi; by how much its outline is wider
TABLE = "snooker-table"  # the gid of the parts that a sketch draws once on its axes
CAPTIONS = {"full": 0.118, "short": 0.2, "none": 0.0}
"""Height of the strip of text over the picture's width: for wide axes, axes of half the width, and none."""

_MARGIN = 0.02  # floor shown around the rails [m]


def pyplot() -> ModuleType:
    """``matplotlib.pyplot``, or an ImportError with the command that installs it."""
    try:
        from matplotlib import pyplot as plt
    except ImportError as error:
        raise missing("diagrams need matplotlib", "plot") from error
    return plt


def halo(width: float, alpha: float) -> list[Any]:
    """The ``path_effects`` of words and lines with a dark outline, ``width`` [points] wide."""
    from matplotlib.patheffects import withStroke

    return [withStroke(linewidth=width, foreground=rgb("path_edge", alpha))]


class Region(NamedTuple):
    """The part of a table that a picture shows [m]."""

    low_x: float
    high_x: float
    low_y: float
    high_y: float

    @property
    def width(self) -> float:
        """Width of the picture, along y [m]."""
        return self.high_y - self.low_y

    @property
    def height(self) -> float:
        """Height of the picture, along x [m]."""
        return self.high_x - self.low_x

    @classmethod
    def of_table(cls, table: Table) -> "Region":
        """All of a table, with its rails."""
        (low_x, high_x), (low_y, high_y) = extent(table)
        rim = RAIL + _MARGIN if is_closed(table) else 0.0
        return cls(low_x - rim, high_x + rim, low_y - rim, high_y + rim)

    @classmethod
    def around(cls, points: Floats, table: Table) -> "Region":
        """Around points (m, 2) [m]: at least 1 m wide, width / height in 1.35 to 2.1, inside ``of_table``."""
        low, high = points.min(axis=0) - 0.18, points.max(axis=0) + 0.18
        width = max(high[1] - low[1], 1.0, 1.35 * (high[0] - low[0]))
        size = np.array([max(high[0] - low[0], width / 2.1), width])
        start = (low + high) / 2 - size / 2
        if is_closed(table):
            least, most = np.array(cls.of_table(table)).reshape(2, 2).T
            size = np.minimum(size, most - least)
            start = np.clip((low + high) / 2 - size / 2, least, most - size)
        return cls(*np.stack([start, start + size], axis=1).ravel().tolist())


def is_closed(table: Table) -> bool:
    """Whether there is a cushion on each side: then a wooden frame, otherwise cloth fills the picture."""
    return bool(np.isfinite(table.bounds).all())


def rgb(colour: Colour, alpha: float = 1.0) -> tuple[float, float, float, float]:
    """A colour of the palette by name, or three numbers up to 255, in matplotlib's form."""
    red, green, blue = (PALETTE[colour] if isinstance(colour, str) else colour)[:3]
    return red / 255, green / 255, blue / 255, alpha


def flip(points: ArrayLike | Vector | Vectors) -> Floats:
    """Points (..., 2) in the order for matplotlib: y to the right, x down."""
    return np.asarray(points, np.float64)[..., ::-1]


class Sketch:
    """Axes with a table on them; ``ax`` None makes a new figure, one with a sketch stays as it is."""

    def __init__(self, table: Table, R: float, region: Region, ax: "Axes | None" = None, *, strip: float = 0):
        plt = pyplot()
        self.table: Table = table
        self.R: float = R
        depth = strip * region.width
        size = (WIDTH, WIDTH * (region.height + depth) / region.width)
        axes = ax or plt.figure(figsize=size, facecolor=rgb("floor")).add_axes((0.0, 0.0, 1.0, 1.0))
        self.ax: Axes = axes
        self.fresh: bool = not any(artist.get_gid() == TABLE for artist in axes.get_children())
        if self.fresh:
            self.region: Region = region
            self.depth: float = depth
            axes.set(xlim=region[2:], ylim=(region.high_x + depth, region.low_x), aspect="equal")
            axes.set(xticks=[], yticks=[], facecolor=rgb("floor"))
            axes.spines[:].set_visible(False)
            self._draw_table()
        else:
            (low_y, high_y), (bottom, low_x) = axes.get_xlim(), axes.get_ylim()
            self.region, self.depth = Region(low_x, bottom, low_y, high_y), 0.0
        room, w = axes.get_window_extent(), self.region
        pixels = min(room.width / w.width, room.height / (w.height + self.depth))
        self.points_per_metre: float = 72 / axes.figure.dpi * pixels
        self.font: float = float(np.clip(9.0 * self.points_per_metre * w.width / (72 * WIDTH), 7.5, 11.0))
        self._taken: list[tuple[float, float, float, float]] = []
        self._busy: list[Floats] = []

    # the table

    def _draw_table(self):
        from matplotlib.patches import Circle, FancyBboxPatch, Polygon, Rectangle

        ax, parts, w = self.ax, outline(self.table), self.region
        (low_x, high_x), (low_y, high_y) = extent(self.table)
        scale = 72 * WIDTH / w.width  # points per metre, about, for the widths of lines

        def add(patch, level, clip=None):
            patch.set(zorder=level, gid=TABLE)
            ax.add_patch(patch)
            if clip is not None:
                patch.set_clip_path(clip)

        def box(extra):
            corner = low_y - extra, low_x - extra
            return corner, high_y - low_y + 2 * extra, high_x - low_x + 2 * extra

        def rail(extra, radius, colour, level):
            style = f"round,pad=0,rounding_size={radius}"
            add(FancyBboxPatch(*box(extra), boxstyle=style, fc=rgb(colour), ec="none"), level)

        if is_closed(self.table):
            rail(RAIL, 0.09, "wood_edge", 0.0)
            rail(RAIL - 0.010, 0.08, "wood", 0.05)
            rail(RAIL - 0.022, 0.07, [min(255, round(1.13 * part)) for part in PALETTE["wood"]], 0.06)
            add(Rectangle(*box(CUSHION + 0.008), fc=rgb("wood_edge"), ec="none"), 0.1)
            rims = (0.014, "leather_edge", 0.15), (0.011, "leather", 0.16), (0.0, "hole", 0.2)
            for rim, colour, level in rims:
                for x0, y0, x1, y1, half in parts.throats:
                    along = np.array([x1 - x0, y1 - y0]) / np.hypot(x1 - x0, y1 - y0)
                    across = (half + rim) * np.array([-along[1], along[0]])
                    a, b = np.array([x0, y0]), np.array([x1, y1])
                    corners = flip([a + across, b + across, b - across, a - across])
                    add(Polygon(corners, fc=rgb(colour), ec="none"), level)
                    add(Circle((y1, x1), half + rim, fc=rgb(colour), ec="none"), level)
            left, top = max(low_y - CUSHION, w.low_y), max(low_x - CUSHION, w.low_x)
            right, bottom = min(high_y + CUSHION, w.high_y), min(high_x + CUSHION, w.high_x)
        else:  # cloth fills the picture
            left, top, right, bottom = w.low_y, w.low_x, w.high_y, w.high_x
        add(Rectangle((left, top), right - left, bottom - top, fc=rgb("cloth"), ec="none"), 0.3)
        # clips what is drawn on it
        cloth = Rectangle((left, top), right - left, bottom - top, transform=ax.transData)
        for x, y, radius in parts.falls:
            add(Circle((y, x), radius + 0.006, fc=rgb("cloth_edge"), ec="none"), 0.4, cloth)
            add(Circle((y, x), radius, fc=rgb("hole"), ec="none"), 0.45, cloth)
        if is_marked(self.table):
            for line in (BAULK_LINE, D_ARC):
                ax.plot(*flip(line).T, color=rgb("line"), lw=0.0045 * scale, zorder=0.5, gid=TABLE)
            for x, y in SPOT_MARKS:
                add(Circle((y, x), 0.007, fc=rgb("line"), ec="none"), 0.5)
        for nose in parts.noses:
            style = {"color": rgb("shadow", 0.28), "lw": 0.03 * scale, "zorder": 0.55, "gid": TABLE}
            ax.plot(*flip(nose).T, **style)[0].set_clip_path(cloth)
        for polygon, nose in zip(parts.cushions, parts.noses, strict=True):
            add(Polygon(flip(polygon), fc=rgb("cushion"), ec="none"), 0.6, cloth)
            style = {"color": rgb("nose"), "lw": 0.005 * scale, "zorder": 0.65, "gid": TABLE}
            ax.plot(*flip(nose).T, **style, solid_capstyle="butt")
        if self.depth:
            add(Rectangle((w.low_y, w.high_x), w.width, self.depth, fc=rgb("bar"), ec="none"), 9.0)
            ax.plot([w.low_y, w.high_y], [w.high_x] * 2, color=rgb("bar_edge"), lw=1.0, zorder=9.1, gid=TABLE)

    # things on the table

    def disc(self, middle: Place | Floats, radius: float, **style: Any) -> None:
        """A disc; ``middle``: (y, x) [m]."""
        from matplotlib.patches import Circle

        y, x = middle
        self.ax.add_patch(Circle((y, x), radius, **style))

    def ball(self, ball: int, place: Vector, *, label: bool = False) -> None:
        """A ball at rest, with a highlight; ``label``: with its letter."""
        (y, x), R, colour, disc = flip(place), self.R, COLOURS[ball % N_BALLS], self.disc
        style = {"lw": 0.4, "zorder": 7.0, "gid": f"ball-{ball}"}
        disc((y + 0.25 * R, x + 0.3 * R), 1.08 * R, fc=rgb("shadow", 0.4), ec="none", zorder=6.9)
        disc((y, x), R, fc=rgb(0.92 * colour), ec=rgb(0.5 * colour), **style)
        for k in range(1, 13):
            away = 0.029 * k * R
            style = {"fc": (1, 1, 1, 0.022), "ec": "none", "zorder": 7.0 + 0.005 * k}
            disc((y - away, x - away), R * (1 - 0.065 * k), **style)
        disc((y - 0.36 * R, x - 0.40 * R), 0.17 * R, fc=rgb("lamp", 0.85), ec="none", zorder=7.1)
        self.keep_clear(np.asarray(place)[None], 2 * R)
        if label:
            dark = colour @ [0.30, 0.59, 0.11] < 130
            how = {"color": "white" if dark else "black", "size": max(5.0, 1.15 * R * self.points_per_metre)}
            how |= {"weight": "bold", "ha": "center", "va": "center_baseline", "zorder": 7.2}
            self.ax.text(y, x, LETTERS[ball % N_BALLS], **how)

    def ghost(
        self, ball: int, place: Vector, alpha: float = 0.4, *, radius: float | None = None, level: float = 6.0
    ) -> None:
        """A faded ball with a rim, for a moment of the shot or its end; ``radius``: another size [m]."""
        rim = rgb(PALE[ball % N_BALLS], min(1.0, alpha + 0.45))
        size, gid = (self.R, f"ghost-{ball}") if radius is None else (radius, "sign")
        style = {"fc": rgb(COLOURS[ball % N_BALLS], alpha), "ec": rim, "lw": 0.9, "zorder": level, "gid": gid}
        self.disc(flip(place), size, **style)
        self.keep_clear(np.asarray(place)[None], 2 * size)

    def line(
        self, points: Floats, colour: Colour, *, level: float = 5.0, width: float = PATH_WIDTH, **style: Any
    ) -> None:
        """A line (m, 2) [m] with a dark outline."""
        under = {"color": rgb("path_edge", 0.85), "lw": width + OUTLINE, "zorder": level - 0.5}
        over = {"color": rgb(colour), "lw": width, "zorder": level, "gid": "path"}
        for each in ({"gid": "outline", **under}, over | style):
            self.ax.plot(*flip(points).T, **{"solid_capstyle": "round", **each})
        self.keep_clear(points, 0.0)

    def arrow(self, place: Floats, direction: Floats, colour: Colour) -> None:
        """An arrowhead at a place, pointing along a unit vector."""
        from matplotlib.patches import Polygon

        head = np.array([(5.0, 0.0), (-3.5, 3.2), (-1.7, 0.0), (-3.5, -3.2)])  # [points]
        turned = head / self.points_per_metre @ np.array([direction, [-direction[1], direction[0]]])
        style = {"fc": rgb(colour), "ec": rgb("path_edge"), "lw": 0.8, "zorder": 5.6, "gid": "arrow"}
        self.ax.add_patch(Polygon(flip(place + turned), **style))

    def mark(
        self, place: Vector, marker: str, colour: Colour, size: float = 6.0, level: float = 8.0, **more: Any
    ) -> None:
        """A small sign at a place."""
        style = {"mfc": rgb(colour), "mec": rgb("path_edge"), "mew": 0.9, "ls": "none", "zorder": level}
        self.ax.plot(*flip(place), marker=marker, ms=size, **style | more)

    # words

    def keep_clear(self, points: Floats, size: float) -> None:
        """Keep labels away from points (m, 2), each ``size`` wide [m], and from the line through them."""
        if len(points) > 1:
            steps = np.maximum(1, np.ceil(np.hypot(*np.diff(points, axis=0).T) / 0.02).astype(int))
            lines = zip(points[:-1], points[1:], steps, strict=True)
            points = np.concatenate([np.linspace(a, b, n) for a, b, n in lines])
        self._busy.append(np.column_stack([points, np.full(len(points), size)]))

    def text(
        self, y: float, x: float, words: str, colour: Colour = "text", size: float = 1, **how: Any
    ) -> None:
        """Text at a place of the picture; ``size`` in units of the usual font."""
        style = {"color": rgb(colour), "size": self.font * size, "zorder": 9.5, "va": "center"}
        self.ax.text(y, x, words, **style | how)

    def rows(self, n: int) -> list[float]:
        """The x of n lines of text in the strip under the picture [m]."""
        return [self.region.high_x + self.depth * (k + 0.62) / (n + 0.24) for k in range(n)]

    def title(self, words: str) -> None:
        """Write a title at the top left."""
        if words:
            w, line = self.region, 1.5 * self.font / self.points_per_metre
            within = w.low_x < extent(self.table)[0, 0] - CUSHION  # on the rail, else on the cloth
            # right of the pocket
            y = w.low_y + (0.055 * w.width if w.low_y < extent(self.table)[1, 0] - CUSHION else 0.5 * line)
            x = w.low_x + (0.072 if within else 0.7 * line)
            self.text(y, x, words, weight="bold", size=1.1, gid="title", path_effects=halo(2.2, 0.85))
            self._taken.append((w.low_y, w.low_y + 0.66 * line * len(words), w.low_x, w.low_x + 1.3 * line))

    def label(self, place: Vector, words: str) -> bool:
        """Write text near a place where it covers least, with a line to it; False if there is no room."""
        high = 1.25 * self.font / self.points_per_metre
        wide = (0.66 * len(words) + 0.6) * self.font / self.points_per_metre
        y, x = flip(place)
        busy = np.concatenate(self._busy) if self._busy else np.empty((0, 3))
        best, least = None, np.inf
        for far in (1.6, 2.3, 3.2, 4.4):
            for angle in np.arange(0, 2 * np.pi, np.pi / 8):
                cy = y + np.cos(angle) * (wide / 2 + 0.45 * far * high)
                cx = x + np.sin(angle) * 0.8 * far * high
                box = cy - wide / 2, cy + wide / 2, cx - high / 2, cx + high / 2
                cost = self._cost(box, busy) + 0.4 * far
                if cost < least:
                    best, least = (cy, cx, box), cost
        if best is None or least > 60:
            return False
        cy, cx, box = best
        self._taken.append(box)
        near = np.clip(y, box[0], box[1]), np.clip(x, box[2], box[3])
        if np.hypot(near[0] - y, near[1] - x) > 0.7 * high:
            self.ax.plot([y, near[0]], [x, near[1]], color=rgb("text", 0.7), lw=0.7, zorder=8.4, gid="leader")
        style = {"zorder": 8.6, "ha": "center", "weight": "bold", "gid": "label"}
        self.text(cy, cx, words, path_effects=halo(2.4, 0.9), **style)
        return True

    def _cost(self, box, busy):
        """The cost of a label in that box: how much it would cover."""
        left, right, top, bottom = box
        w, (x, y, size) = self.region, busy.T
        out = left < w.low_y or right > w.high_y or top < w.low_x or bottom > w.high_x
        half = size / 2
        inside = (y > left - half) & (y < right + half) & (x > top - half) & (x < bottom + half)
        weight = float((inside * np.where(size > 0, 6.0, 1.0)).sum())
        over = sum(a < right and left < b and c < bottom and top < d for a, b, c, d in self._taken)
        return weight + 100.0 * over + 1000.0 * out
