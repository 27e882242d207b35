"""How does a replay play in a notebook? As a widget of anywidget: the same module as in the page, and its time from Python and back.

In JupyterLab, notebooks of VS Code, Colab and marimo. What ``sn.replay`` returns shows itself without this, but in a frame that Python does
not reach.
"""

from functools import cache
from pathlib import Path
from typing import Any, Literal

from ._check import choice, number, truth
from .replays import replay
from .replays.document import WEB

__all__ = ["replay_widget"]

SPINS = ("off", "cue", "all")
"""Which balls show that they turn."""
_HOST = Path(WEB) / "widget.js"
"""What a notebook's host calls: it mounts a player on the element that it is given."""


def replay_widget(
    source: Any, *, speed: float = 1.0, playing: bool = False, paths: bool = True, ghosts: bool = True, labels: bool = False,
    spin: Literal["off", "cue", "all"] = "cue",
) -> Any:  # fmt: skip
    """A widget that plays a replay in a notebook.

    Its traits go both ways: ``stroke`` (from 0) and ``time`` within it [s], below 0 before the strike, and ``playing``. While it plays,
    ``time`` stands still: it is told when the play stops and whenever a viewer moves it. Setting ``stroke`` alone goes to its beginning.

    Parameters
    ----------
    source : Replay, Shot, sequence of Shot or of strokes, or environment
        Whatever ``snooker_env.replay`` takes.
    speed : float
        How fast it plays, in [0.1, 8]; 1 is as fast as the shot.
    playing : bool
        Whether it starts at once.
    paths, ghosts, labels : bool
        Whether paths, balls at their impacts and letters on balls are shown at first.
    spin : {"off", "cue", "all"}
        Whose turning is shown at first.

    Returns
    -------
    anywidget.AnyWidget
        With the traits ``stroke``, ``time``, ``playing``, and the replay as ``data``.

    Raises
    ------
    ValueError
        If there is nothing to show, or an argument is wrong.
    ImportError
        Without anywidget.

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
    options |= {name: truth(name, value) for name, value in (("paths", paths), ("ghosts", ghosts), ("labels", labels))}
    return _widget_class()(data=replay(source).to_dict(), options=options, playing=truth("playing", playing))


@cache
def _widget_class():
    """The class of widgets, made when it is first wanted: anywidget is an extra."""
    try:
        import anywidget
        import traitlets
    except ImportError as error:
        raise ImportError('widgets need anywidget; install it, in a clone of snooker_env, with: pip install -e ".[notebook]"') from error

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
    """The JavaScript of the widget: the module that draws and plays, and what a notebook's host calls."""
    return (Path(WEB) / "table.js").read_text("utf-8") + "\n" + _HOST.read_text("utf-8")
