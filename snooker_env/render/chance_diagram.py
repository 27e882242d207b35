"""How did the chance to win change over a frame? Both players' shares over its strokes."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from .._check import array, refuse, refuse_what
from .._types import Vector
from .sketch import WIDTH, pyplot, rgb

if TYPE_CHECKING:
    from matplotlib.axes import Axes

HEIGHT = 2.6  # height of a new figure [inches]


def win_chance(
    chances: Vector | None,
    ax: "Axes | None" = None,
    *,
    players: Sequence[str] = ("Player 1", "Player 2"),
    title: str = "",
) -> "Axes":
    """Draw how likely each player of a frame was to win, stroke by stroke.

    Parameters
    ----------
    chances : array_like, float (n + 1,)
        The chance of the first player in [0, 1]: before the first of n strokes, and after each, as
        ``Replay.win_chance`` of a replay that was made with a judge.
    ax : matplotlib.axes.Axes, optional
        Axes to draw on. None makes a new figure.
    players : sequence of str
        The names of both.
    title : str
        Title of the diagram.

    Returns
    -------
    matplotlib.axes.Axes
        The axes of the diagram: strokes played to the right, the chance upwards. ValueError if there is no chance,
        one is outside [0, 1], or there are not two names; ImportError without matplotlib.

    Examples
    --------
    >>> from snooker_env.render.diagrams import win_chance
    >>> ax = win_chance([0.5, 0.4, 0.7, 1.0], players=("Ada", "Grace"))
    >>> ax.get_ylabel(), [text.get_text() for text in ax.get_legend().get_texts()]
    ('chance to win', ['Ada', 'Grace'])
    """
    if chances is None:
        raise refuse("chances", None, "must be numbers: a replay has them if it was made with a judge")
    values = array("chances", chances, (-1,))
    if not len(values):
        raise refuse("chances", [], "must hold at least one")
    for k in np.flatnonzero((values < 0.0) | (values > 1.0))[:1].tolist():
        raise refuse(f"chances[{k}]", float(values[k]), "must be in [0, 1]")
    if isinstance(players, str) or len(players) != 2:
        raise refuse_what("players", repr(players), "must be two names")
    plt = pyplot()
    drawn = ax or plt.figure(figsize=(WIDTH, HEIGHT), layout="constrained").add_subplot()
    edges = np.arange(len(values) + 1) - 0.5
    parts = (np.zeros(len(values)), values, np.ones(len(values)))
    for k, (name, colour) in enumerate(zip(players, ("first", "other"), strict=True)):
        style: dict[str, Any] = {"fill": True, "color": rgb(colour), "label": name, "gid": colour}
        drawn.stairs(parts[k + 1], edges, baseline=parts[k], **style)
    drawn.axhline(0.5, color="white", linewidth=0.8, linestyle=(0, (2, 3)))
    drawn.set(xlim=(edges[0], edges[-1]), ylim=(0.0, 1.0), xlabel="strokes played", ylabel="chance to win")
    drawn.set_yticks([0.0, 0.25, 0.5, 0.75, 1.0], ["0 %", "25 %", "50 %", "75 %", "100 %"])
    drawn.xaxis.set_major_locator(plt.MaxNLocator(integer=True))
    drawn.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, frameon=False)
    drawn.set_title(title, loc="left")
    return drawn
