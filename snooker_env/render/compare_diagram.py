"""How are two ways to play a stroke compared? By diagrams of the same part of the table, side by side."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from .._check import refuse, refuse_what
from ..physics.table import Table
from ..simulation import Shot
from .shot_diagram import View, area, plot, region_of
from .sketch import CAPTIONS, WIDTH, pyplot, rgb

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_GAP = 0.015  # between two diagrams, as a part of the figure's width


def compare(
    shots: Sequence[Shot],
    labels: Sequence[str] = (),
    axes: "Sequence[Axes] | None" = None,
    *,
    cues: Sequence[Mapping[str, float] | None] | None = None,
    view: View = "shot",
    **options: Any,
) -> "tuple[Axes, ...]":
    """Draw shots side by side, each as ``plot`` does, with the same part of the table.

    Parameters
    ----------
    shots : sequence of Shot
        The shots, all on the same table; else ValueError.
    labels : sequence of str
        A title for each shot, or () for none.
    axes : sequence of matplotlib.axes.Axes, optional
        Axes for each shot; None makes a new figure.
    cues : sequence of mapping or None, optional
        How each cue ball was struck, as ``cue`` in ``plot``.
    view, **options
        As in ``plot``; "shot": as much of the table as all shots need.

    Returns
    -------
    tuple of matplotlib.axes.Axes
        The axes of the diagrams.

    Examples
    --------
    >>> import snooker_env as sn
    >>> from snooker_env.render.diagrams import compare
    >>> struck = [sn.strike(speed=2.0, aim=1.5708, top=top) for top in (-0.3, 0.3)]
    >>> balls, still = [(0.0, 0.5), (0.02, 1.2)], (0.0, 0.0, 0.0)
    >>> shots = [sn.simulate(balls, [v[:2], (0.0, 0.0)], [w, still]) for v, w in struck]
    >>> len(compare(shots, ["screw", "follow"]))
    2
    """
    shots = list(shots)
    if not shots:
        raise refuse("shots", shots, "must hold at least one shot")
    for field, values in (("labels", labels), ("axes", axes), ("cues", cues)):
        if values is not None and len(values) not in ({0, len(shots)} if field == "labels" else {len(shots)}):
            raise refuse_what(field, f"{len(values)} of them", f"must be {len(shots)}, one for each shot")
    table = shots[0].table
    for k, shot in enumerate(shots):
        if shot.table is not table:
            raise refuse_what(f"shots[{k}].table", "another table", "must be that of shots[0]")
    points = np.concatenate([area(shot) for shot in shots])
    region = region_of(view, points, Table.of(None) if table is None else table)
    caption = options.pop("caption", "full" if len(shots) == 1 else "short")
    if axes is None:
        n = len(shots)
        wide = (1.0 - (n - 1) * _GAP) / n
        high = wide * (region.height / region.width + CAPTIONS.get(caption, 0.0))
        figure = pyplot().figure(figsize=(WIDTH, WIDTH * high), facecolor=rgb("floor"))
        axes = [figure.add_axes((k * (wide + _GAP), 0.0, wide, 1.0)) for k in range(n)]
    over: Any = options | {"view": np.array(region).reshape(2, 2), "caption": caption}
    each = zip(shots, axes, labels or [""] * len(shots), cues or [None] * len(shots), strict=True)
    return tuple(plot(shot, ax, cue=cue, title=title, **over) for shot, ax, title, cue in each)
