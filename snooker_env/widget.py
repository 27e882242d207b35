"""How does a replay play in a notebook, synchronised to Python and back? As a widget of anywidget."""

from functools import cache
from typing import Any, Literal

from ._check import choice, number, truth
from ._install import missing
from .replays import replay
from .web import WEB, table_js

__all__ = ["replay_widget"]
SPINS = ("off", "cue", "all")  # the balls whose rotation is shown


def replay_widget(
    source: Any,
    *,
    speed: float = 1.0,
    playing: bool = False,
    paths: bool = True,
    ghosts: bool = True,
    labels: bool = False,
    spin: Literal["off", "cue", "all"] = "cue",
) -> Any:
    """Make a widget that plays a replay in a notebook: JupyterLab, VS Code, Colab or marimo.

    Its traits are synchronised in both directions: ``stroke`` (from 0; setting it alone goes to its
    beginning), ``time`` within it [s] (below 0 before the strike; not updated while it plays), and
    ``playing``.

    Parameters
    ----------
    source : Replay, Shot, sequence of Shot or Played, Position, or environment
        Anything that ``snooker_env.replay`` takes.
    speed : float
        Speed of the replay over that of the shot, in [0.1, 8].
    playing : bool
        Whether it starts at once.
    paths, ghosts, labels : bool
        Whether paths, balls at their impacts and letters on balls are shown at first.
    spin : {"off", "cue", "all"}
        The balls whose rotation is shown at first.

    Returns
    -------
    anywidget.AnyWidget
        The widget, with these traits and the replay as ``data``. ImportError without anywidget.

    Examples
    --------
    >>> import snooker_env as sn
    >>> from snooker_env.widget import replay_widget
    >>> shot = sn.simulate([(0.0, 0.0)], [(1.0, 0.5)], [(0.0, 0.0, 0.0)])
    >>> widget = replay_widget(shot)
    >>> widget.time = 0.5
    >>> widget.stroke, widget.playing
    (0, False)
    """
    options = {"speed": number("speed", speed, 0.1, 8.0), "spin": choice("spin", spin, SPINS)}
    shown = {"paths": paths, "ghosts": ghosts, "labels": labels}
    options |= {name: truth(name, value) for name, value in shown.items()}
    return _widget_class()(data=replay(source).to_dict(), options=options, playing=truth("playing", playing))


@cache
def _widget_class():
    """The class of widgets, made at the first call: anywidget is an optional dependency."""
    try:
        import anywidget
        import traitlets
    except ImportError as error:
        raise missing("widgets need anywidget", "notebook") from error

    class ReplayWidget(anywidget.AnyWidget):
        """A replay in a notebook, see ``replay_widget``."""

        _esm = module()
        data = traitlets.Dict(help="The replay as JSON types.").tag(sync=True)
        options = traitlets.Dict(help="What the player starts with.").tag(sync=True)
        stroke = traitlets.Int(0, help="Which stroke is shown, from 0.").tag(sync=True)
        time = traitlets.Float(0.0, help="Time within the stroke [s].").tag(sync=True)
        playing = traitlets.Bool(False, help="Whether it plays.").tag(sync=True)

        @traitlets.validate("stroke")
        def _known(self, proposal):
            last = len(self.data["strokes"]) - 1
            if not 0 <= proposal["value"] <= last:
                raise traitlets.TraitError(f"stroke = {proposal['value']}: must be in [0, {last}]")
            return proposal["value"]

    return ReplayWidget


def module() -> str:
    """The JavaScript of the widget: what draws and plays, and the function that a notebook's host calls."""
    return table_js() + (WEB / "widget.js").read_text("utf-8")
