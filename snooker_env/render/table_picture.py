"""How is a table drawn from above? Its fixed parts as an array, with numpy alone. Each part is a signed distance [m],
negative inside. Edges cover parts of pixels, so they are smooth at every size."""

from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple, TypeAlias

import numpy as np

from .._lib.check import integer, refuse
from .._lib.types import Bytes, Floats
from ..geometry import COLOUR_SPOTS
from ..physics.table import Table
from .palette import PALETTE
from .scene import BAULK_LINE, CUSHION, D_ARC, RAIL, extent, has_lines, outline

Size: TypeAlias = tuple[int, int]
SIZE = (1920, 1080)  # default width and height of a picture [pixels]

MARGIN = 0.012  # floor shown around the rails [m]
_BAR = 1 / 15  # part of the height for the score bar
_LEAST, _MOST = 100, 8192


class View(NamedTuple):
    """A picture of a table."""

    width: int
    height: int
    bar: int  # rows of the score bar, at the bottom
    scale: float  # pixels per metre
    x: float  # column of the origin
    y: float  # row of the origin

    @classmethod
    def of(cls, table: Table, size: Size = SIZE) -> "View":
        """As large as fits into ``size``, (width, height)."""
        low, high = extent(table).T
        (tall, wide), (middle_x, middle_y) = high - low + 2 * (RAIL + MARGIN), (low + high) / 2
        width, height = check_size(size)
        bar = round(_BAR * min(height, width * SIZE[1] / SIZE[0]))
        scale = min((height - bar) / tall, width / wide)
        x, y = width / 2 - scale * middle_y, (height - bar) / 2 - scale * middle_x
        return cls(width, height, bar, float(scale), float(x), float(y))

    def __call__(self, points: Floats) -> Floats:
        """Column and row of points (..., 2) [m]."""
        points = np.asarray(points, dtype=np.float64)
        return np.stack([self.x + self.scale * points[..., 1], self.y + self.scale * points[..., 0]], axis=-1)


def check_size(size: Sequence[int], field: str = "size") -> Size:
    """(width, height) of pictures; ValueError unless they are two valid integers."""
    if isinstance(size, str) or not hasattr(size, "__len__") or len(size) != 2:
        raise refuse(field, size, "must be (width, height)")
    return integer(f"{field}[0]", size[0], _LEAST, _MOST), integer(f"{field}[1]", size[1], _LEAST, _MOST)


LAMPS = 4  # number of lamps over a table, in a row along its length
LAMP_HEIGHT = 0.95  # height of the lamps above the cloth [m]

_RIM = 0.020  # width of a pocket's leather [m]
_ROUND = 0.085  # radius of the table's corners [m]
_INK = {name: np.array(rgb, dtype=np.float32) for name, rgb in PALETTE.items()}


def lamps(table: Table) -> Floats:
    """Places of the lamps over the table: (``LAMPS``, 2) [m]."""
    (low_x, high_x), (low_y, high_y) = extent(table)
    parts = (np.arange(LAMPS) + 0.5) / LAMPS
    return np.stack([np.full(LAMPS, (low_x + high_x) / 2), low_y + (high_y - low_y) * parts], axis=1)


@lru_cache(maxsize=8)
def table_picture(table: Table, view: View) -> Bytes:
    """The picture of a table without balls, read-only. The rows of the score bar show the floor."""
    canvas, parts = _Canvas(view, table), outline(table)
    canvas.image[:] = _INK["floor"]
    _bed(canvas, table)
    if has_lines(table):
        _marks(canvas)
    _pockets(canvas, table, parts)
    for polygon, nose in zip(parts.cushions, parts.noses, strict=True):
        _cushion(canvas, polygon, nose)
    if parts.cushions:
        _wood(canvas, table, parts)
    image = np.rint(np.clip(canvas.image, 0, 255)).astype(np.uint8)
    image.setflags(write=False)
    return image


class _Canvas:
    """An unfinished picture, float32 (height, width, 3), and its pixels' coordinates on the table [m]."""

    def __init__(self, view, table):
        self.view, self.extent = view, extent(table)
        self.image = np.empty((view.height, view.width, 3), np.float32)
        self.x = ((np.arange(view.height, dtype=np.float32) + 0.5 - view.y) / view.scale)[:, None]
        self.y = ((np.arange(view.width, dtype=np.float32) + 0.5 - view.x) / view.scale)[None, :]
        self.middle = self.extent.mean(axis=1).tolist()
        self.half = (np.diff(self.extent, axis=1)[:, 0] / 2).tolist()
        self.random = np.random.default_rng(1)

    def around(self, points, margin):
        """The rows and columns within ``margin`` [m] of some points: the picture there, x, y."""
        rows, columns = _near(self.x, self.y, np.min(points, axis=0), np.max(points, axis=0), margin)
        return self.image[rows, columns], self.x[rows], self.y[:, columns]

    def cover(self, distance):
        """The part of each pixel that is inside, 0 to 1."""
        return np.clip(0.5 - distance * self.view.scale, 0.0, 1.0)

    def box(self, x, y, extra, radius=0.0):
        """Distance to the bed, enlarged by ``extra``, with round corners."""
        each = zip((x, y), self.middle, self.half, strict=True)
        across, along = (np.abs(axis - m) - (h + extra - radius) for axis, m, h in each)
        outside = np.hypot(np.maximum(across, 0), np.maximum(along, 0))
        return outside + np.minimum(np.maximum(across, along), 0) - radius

    def grain(self, rows, columns, fine, run):
        """Noise, mean 0, deviation about 1, correlated over ``fine`` pixels across and ``run`` along."""
        across, along = int(rows / fine) + 2, int(columns / run) + 3
        noise = self.random.standard_normal((across, along)).astype(np.float32)
        at, part = np.divmod(np.arange(columns) / run, 1.0)
        at, part = at.astype(int), smooth(part).astype(np.float32)
        return (noise[:, at] * (1 - part) + noise[:, at + 1] * part)[(np.arange(rows) / fine).astype(int)]


def _paint(image, colour, alpha):
    """Blend a colour (3,) or a picture over a picture."""
    alpha = alpha[..., None]
    image += alpha * (colour - image)


def smooth(t: Floats) -> Floats:
    """A smooth step from 0 at t = 0 to 1 at t = 1."""
    t = np.clip(t, 0.0, 1.0)
    return t * t * (3 - 2 * t)


def _bed(canvas, table):
    """The cloth: its nap runs along the table, and the lamps' light fades a little towards the ends."""
    above = canvas.view.height - canvas.view.bar
    image, x, y = canvas.image[:above], canvas.x[:above], canvas.y
    rows, columns = image.shape[:2]
    pixels = canvas.view.scale / 480  # of a picture of 1080 rows
    nap = 0.011 * canvas.grain(rows, columns, 1.0, max(1.5, 3.0 * pixels))
    nap = nap + 0.0055 * canvas.grain(rows, columns, max(1, 5 * pixels), 60 * pixels + 2)
    across, along = ((axis - m) / h for axis, m, h in zip((x, y), canvas.middle, canvas.half, strict=True))
    light = 1.035 - 0.075 * along**2 - 0.055 * across**2
    cloth = (np.clip(light, 0.8, 1.1) * (1 + nap))[..., None] * _INK["cloth"]
    if len(table.noses):
        _paint(image, cloth, canvas.cover(canvas.box(x, y, CUSHION + 0.02)))
    else:
        image[:] = cloth


def _marks(canvas):
    """The baulk line, the D and the spots."""
    half = max(0.0017, 0.55 / canvas.view.scale)
    for points in (BAULK_LINE, D_ARC):
        image, x, y = canvas.around(points, 2 * half)
        _paint(image, _INK["line"], 0.88 * canvas.cover(to_line(x, y, points, 3 * half) - half))
    for spot in COLOUR_SPOTS:
        image, x, y = canvas.around([spot], 0.02)
        far = np.hypot(x - spot[0], y - spot[1]) - max(0.0048, 1.2 / canvas.view.scale)
        _paint(image, _INK["line"], 0.9 * canvas.cover(far))


def _pockets(canvas, table, parts):
    """The holes: cloth bends down over the slate's edge in front, leather goes down into the dark behind."""
    for (cx, cy, radius), throat in zip(table.falls.tolist(), parts.throats.tolist(), strict=True):
        image, x, y = canvas.around([(cx, cy), throat[:2]], max(radius, throat[4]) + 0.03)
        fall = np.hypot(x - cx, y - cy) - radius
        _paint(image, 0.55 * _INK["cloth_edge"], 0.85 * smooth(1 - fall / 0.011))
        deep = smooth(-fall / 0.014)[..., None]
        _paint(image, 0.30 * _INK["cloth_edge"] * (1 - deep) + _INK["hole"] * deep, canvas.cover(fall))
        back = _capsule(x, y, throat)
        depth = smooth(-back / 0.022)[..., None]
        inside = 0.55 * _INK["leather"] * (1 - depth) + _INK["hole"] * depth
        behind = smooth((canvas.box(x, y, CUSHION) + 0.014) / 0.022)
        _paint(image, inside, canvas.cover(back) * behind)


def _capsule(x, y, throat):
    """Distance to a throat: a thick line with a round end, from its mouth to its fall."""
    x0, y0, x1, y1, half = throat
    return _to_segment(x - x0, y - y0, x1 - x0, y1 - y0) ** 0.5 - half


def _to_segment(px, py, dx, dy):
    """Squared distance to the segment from 0 to (dx, dy)."""
    part = np.clip((px * dx + py * dy) / max(dx * dx + dy * dy, 1e-12), 0, 1)
    return (px - part * dx) ** 2 + (py - part * dy) ** 2


def _cushion(canvas, polygon, nose):
    """One cushion and its shadow on the bed: bright along the nose, darker towards the wood."""
    reach = 0.055
    image, x, y = canvas.around(nose, reach + 0.05)
    to_nose = to_line(x, y, nose, reach + 0.03)
    inside = _inside(x, y, polygon)
    outer = np.where(inside, -to_nose, to_nose)  # the nose is the only visible edge of a cushion
    within = canvas.cover(canvas.box(x, y, CUSHION + 0.02))  # a nose may go on beyond the frame
    shadow = 0.50 * np.exp(-np.maximum(outer, 0) / 0.013) * (outer > 0) * (outer < reach)
    image *= (1 - shadow * within)[..., None]
    t = np.clip(to_nose / (CUSHION + 0.004), 0, 1)
    top = _INK["cushion"] * (1.16 - 0.42 * t)[..., None]
    edge = np.exp(-(((to_nose - 0.0035) / 0.0035) ** 2))[..., None]
    top += edge * (_INK["nose"] - top) * 0.85
    grain = canvas.grain(*image.shape[:2], 1.0, 2.0)
    _paint(image, top * (1 + 0.012 * grain)[..., None], canvas.cover(outer) * within)


def _near(x, y, a, b, reach):
    """The rows and columns within ``reach`` of the rectangle with two corners a and b."""
    each = zip((x.ravel(), y.ravel()), a, b, strict=True)
    return tuple(slice(*np.searchsorted(axis, (min(p, q) - reach, max(p, q) + reach))) for axis, p, q in each)


def to_line(x: Floats, y: Floats, points: Floats, reach: float) -> Floats:
    """Distance of pixels, rows ``x`` (h, 1) and columns ``y`` (1, w), to a polyline, where it is less than ``reach``."""
    squared = np.full((len(x), y.shape[1]), reach**2, np.float32)
    for a, b in zip(points[:-1].tolist(), points[1:].tolist(), strict=True):
        rows, columns = _near(x, y, a, b, reach)
        far = _to_segment(x[rows] - a[0], y[:, columns] - a[1], b[0] - a[0], b[1] - a[1])
        np.minimum(squared[rows, columns], far, out=squared[rows, columns])
    return np.sqrt(squared)


def _inside(x, y, polygon):
    """The pixels whose centres are in a polygon: from them a ray in -x crosses an odd number of edges."""
    odd = np.zeros((len(x), y.shape[1]), bool)
    for a, b in zip(polygon.tolist(), np.roll(polygon, -1, axis=0).tolist(), strict=True):
        (ax, ay), (bx, by) = (a, b) if a[1] < b[1] else (b, a)
        columns = slice(*np.searchsorted(y.ravel(), (ay, by)))
        if columns.stop > columns.start:
            odd[:, columns] ^= x > ax + (bx - ax) * (y[:, columns] - ay) / (by - ay)
    return odd


def _wood(canvas, table, parts):
    """The frame: polished wood with its grain along each rail, and the leather of the pockets in it."""
    image, x, y = canvas.around(canvas.extent.T, RAIL + 0.1)
    edge = canvas.box(x, y, RAIL, _ROUND)
    inner = canvas.box(x, y, CUSHION)
    image *= (1 - 0.55 * np.exp(-edge / 0.02) * (edge > 0))[..., None]  # its shadow on the floor
    rows, columns = image.shape[:2]
    pixels = max(canvas.view.scale / 480, 0.4)
    along, across = (
        canvas.grain(*size, 1.3 * pixels, 150 * pixels) + 0.8 * canvas.grain(*size, 4 * pixels, 320 * pixels)
        for size in ((rows, columns), (columns, rows))
    )
    ends = np.abs(y - canvas.middle[1]) - canvas.half[1] > np.abs(x - canvas.middle[0]) - canvas.half[0]
    deep = -edge  # from the outer edge [m]
    shade = 0.40 + 0.64 * smooth(deep / 0.012) + 0.34 * np.exp(-(((deep - 0.020) / 0.009) ** 2))
    shade -= 0.06 * smooth((deep - 0.03) / 0.05)
    shade += 0.24 * np.exp(-(((inner - 0.012) / 0.003) ** 2)) - 0.45 * smooth(1 - inner / 0.007)
    lamps_y = lamps(table)[:, 1].tolist()
    gloss = sum(np.exp(-(((y - lamp) / 0.34) ** 2)) for lamp in lamps_y)
    shade *= 1 + 0.055 * np.where(ends, across.T, along) + 0.07 * (gloss - 0.5)
    wood = np.ones(image.shape[:2], np.float32) * canvas.cover(edge) * (1 - canvas.cover(inner))
    leather = np.full(image.shape[:2], 1.0, np.float32)  # distance to the nearest pocket's hole
    for throat in parts.throats.tolist():
        around = _near(x, y, throat[:2], throat[2:4], throat[4] + 0.06)
        leather[around] = np.minimum(leather[around], _capsule(x[around[0]], y[:, around[1]], throat))
    wood *= 1 - canvas.cover(leather)
    shade *= 1 - 0.55 * np.exp(-np.maximum(leather - _RIM, 0) / 0.006)  # the leather's shadow on the wood
    _paint(image, _INK["wood"] * shade[..., None], wood)
    for throat in parts.throats.tolist():
        _leather(canvas, image, x, y, throat)


def _leather(canvas, image, x, y, throat):
    """A pocket's leather: round, bright along its ridge, cut off square where its ends lie over cushions."""
    x0, y0, x1, y1, half = throat
    around = _near(x, y, (x0, y0), (x1, y1), half + 0.06)
    image, x, y = image[around], x[around[0]], y[:, around[1]]
    fall, mouth = np.array([x1, y1]), np.array([x0, y0])
    way = (mouth - fall) / np.hypot(*(mouth - fall))
    each, outside = np.maximum(np.abs(way), 1e-9), np.abs(fall - canvas.middle) - canvas.half - CUSHION
    end = np.max((outside + each[::-1] * (half + _RIM) + 0.007) / each)  # both edges are over cushions
    hole, cut = _capsule(x, y, throat), (x - x1) * way[0] + (y - y1) * way[1] - end
    t = hole / _RIM
    shade = 0.45 + 0.85 * np.sqrt(np.clip(1 - (2 * t - 1) ** 2, 0, 1)) - 0.35 * smooth(1 + cut / 0.004)
    ridge = 0.6 * np.exp(-(((t - 0.42) / 0.16) ** 2))[..., None]
    skin = _INK["leather"] * shade[..., None] + (_INK["leather_edge"] - _INK["leather"]) * ridge
    frame = canvas.cover(canvas.box(x, y, RAIL, _ROUND) + 0.004) * canvas.cover(cut)
    _paint(image, skin, canvas.cover(hole - _RIM) * (1 - canvas.cover(hole + 0.0015)) * frame)
