"""Where does a ball stop, and how likely? A heat map, with the areas of 50 and 90 % of the points."""

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from .._check import array, number, refuse, refuse_what
from .._types import Floats, Vectors
from ..geometry import BALL_RADIUS
from ..physics.table import Table, TableLike
from .outline import extent
from .shot_diagram import Placed, View, places_of, region_of
from .sketch import Sketch, halo, is_closed, rgb

if TYPE_CHECKING:
    from matplotlib.axes import Axes

HEAT = (255, 176, 46)  # colour of the map
CELL = 0.01  # size of the cells of the map [m]
_REACH = 3.0  # a Gaussian kernel is cut off at this many bandwidths


def bandwidth_of(points: Floats) -> float:
    """The bandwidth [m] by Scott's rule: standard deviation times m^(-1/6), at least 1 cm and at most 15 cm."""
    spread = float(np.sqrt(points.var(axis=0).mean()))
    return float(np.clip(spread * len(points) ** (-1 / 6), 0.01, 0.15))


def density_of(points: Floats, low: Floats, high: Floats, bandwidth: float) -> tuple[Floats, Floats]:
    """A density (nx, ny) [1/m^2] with Gaussian kernels from corner ``low`` to ``high``, and its cells' size [m]."""
    # tails beyond the corners are folded back: the sum is the share of points inside
    n = np.maximum(1, np.round((high - low) / CELL).astype(int))
    size = (high - low) / n
    counts, _, _ = np.histogram2d(*points.T, bins=n.tolist(), range=[(low[0], high[0]), (low[1], high[1])])
    values = counts / (len(points) * size.prod())
    for axis in range(2):
        half = int(min(np.ceil(_REACH * bandwidth / size[axis]), n[axis]))
        bell = np.exp(-0.5 * (np.arange(-half, half + 1) * size[axis] / bandwidth) ** 2)
        wide = np.pad(values, [(half, half) if k == axis else (0, 0) for k in range(2)], mode="symmetric")
        values = np.apply_along_axis(partial(np.convolve, v=bell / bell.sum(), mode="valid"), axis, wide)
    return values, size


def level_of(values: Floats, share: float) -> float:
    """The density above which a share of the total lies."""
    ranked = np.sort(values.ravel())[::-1]
    return float(ranked[min(np.searchsorted(np.cumsum(ranked), share * ranked.sum()), len(ranked) - 1)])


def density(
    points: Vectors,
    ax: "Axes | None" = None,
    *,
    table: TableLike = "match",
    position: Placed | Vectors | None = None,
    shares: Sequence[float] = (0.5, 0.9),
    bandwidth: float | None = None,
    view: View = "table",
    title: str = "",
) -> "Axes":
    """Draw the distribution of the places where a ball stops, as a heat map.

    Lines surround the densest areas that hold given shares of the points, and a cross marks their mean.

    Parameters
    ----------
    points : array_like, float (m, 2)
        Final positions [m], as of ``advice.destinations(...).cue``; rows of NaN (the ball left the table) are
        left out, and the share of the others is written beside the cross.
    ax : matplotlib.axes.Axes, optional
        Axes to draw on; a diagram that is already there keeps its table. None makes a new figure.
    table : str, Table or None
        As in ``snooker_env.simulate``.
    position : Position, or array_like, float (n, 2), optional
        Balls to draw on the table [m].
    shares : sequence of float
        Shares of the points, each in (0, 1), around which lines are drawn.
    bandwidth : float, optional
        Standard deviation of the Gaussian kernels [m], in [0.0001, 1]; None: Scott's rule.
    view, title
        As in ``plot``; "shot": as much of the table as the points need.

    Returns
    -------
    matplotlib.axes.Axes
        The axes of the diagram.

    Examples
    --------
    >>> import numpy as np
    >>> from snooker_env.render.diagrams import density
    >>> ax = density(np.random.default_rng(0).normal((0.2, 0.9), 0.1, (500, 2)))
    >>> [text.get_text() for text in ax.texts]
    ['50 %', '90 %']
    """
    raw = array("points", points, (-1, 2), None)
    on_table = ~np.isnan(raw).all(axis=1)
    sound = array("points", raw[on_table], (-1, 2))
    if not len(sound):
        raise refuse_what("points", f"{len(raw)} rows, none of them a place", "must hold at least one")
    lines = [number(f"shares[{k}]", share, 0, 1, open_low=True) for k, share in enumerate(shares)]
    if any(share >= 1 for share in lines):
        raise refuse("shares", list(shares), "must each be below 1")
    wide = bandwidth_of(sound) if bandwidth is None else number("bandwidth", bandwidth, 1e-4, 1.0)
    table = Table.of(table)
    sketch = Sketch(table, table.ball_radius or BALL_RADIUS, region_of(view, sound, table), ax)
    sketch.title(title)
    if position is not None:
        r, here = places_of(position)
        for ball in np.flatnonzero(here).tolist():
            sketch.ball(ball, r[ball])
    _draw_cloud(sketch, sound, wide, lines)
    sketch.mark(sound.mean(axis=0), "+", "text", 9.0, 8.0, mew=2.0, mec=rgb("text"), gid="mean")
    if not on_table.all():
        sketch.label(sound.mean(axis=0), f"stops on the table in {100 * on_table.mean():.0f} %")
    return sketch.ax


def _draw_cloud(sketch, points, bandwidth, shares):
    """The map, more opaque where it is denser, and a line around each share."""
    from matplotlib.image import AxesImage

    bounds = extent(sketch.table)
    reach = 4.5 * bandwidth + 0.02
    low, high = points.min(axis=0) - reach, points.max(axis=0) + reach
    if is_closed(sketch.table):  # except in the jaws of a pocket no ball's centre is nearer to a cushion
        low, high = np.maximum(low, bounds[:, 0] + sketch.R), np.minimum(high, bounds[:, 1] - sketch.R)
    values, size = density_of(points.clip(low, high), low, high, bandwidth)
    strength = values / values.max()
    picture, ink = np.empty((*values.shape, 4)), np.array(rgb(HEAT)[:3])
    picture[..., :3] = ink + (1 - ink) * 0.55 * strength[..., None] ** 3
    picture[..., 3] = 0.95 * (1 - np.exp(-5 * strength))
    style: dict[str, Any] = {"origin": "upper", "interpolation": "bilinear", "zorder": 3.0}
    image = AxesImage(sketch.ax, extent=(low[1], high[1], high[0], low[0]), **style)
    image.set(data=picture, gid="density")
    sketch.ax.add_image(image)
    ys, xs = (low[k] + size[k] * (np.arange(values.shape[k]) + 0.5) for k in (1, 0))
    for share in sorted(shares):
        level = level_of(values, share)
        if values.min() < level < values.max():
            style = {"colors": [rgb("text")], "linewidths": 1.3 if share <= 0.5 else 0.9, "zorder": 3.6}
            lines = sketch.ax.contour(ys, xs, values, levels=[level], **style)
            lines.set_gid(f"share-{share:g}")
            lines.set_path_effects(halo(2.6, 0.6))
            _label(sketch, lines, share, outer=share == max(shares))


def _label(sketch, lines, share, *, outer):
    """The share of a line, written at its rightmost point; for a line inside another, at its leftmost."""
    ring = max(lines.get_paths()[0].to_polygons(closed_only=False), key=len, default=None)
    if ring is not None and len(ring):
        y, x = ring[np.argmax(ring[:, 0]) if outer else np.argmin(ring[:, 0])]
        away, side = (0.4, "left") if outer else (-0.4, "right")
        y += away * sketch.font / sketch.points_per_metre
        style = {"zorder": 8.5, "gid": "share", "path_effects": halo(2.0, 0.8), "ha": side}
        sketch.text(y, x, f"{100 * share:g} %", size=0.9, **style)
