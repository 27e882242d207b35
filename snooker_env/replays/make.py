"""How does one make a replay? Of a shot, of several, of the strokes of an episode, or of the environment that plays it."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from .._check import refuse_what
from ..physics.table import TableLike
from ..simulation import Shot
from ..tasks.played import Played
from .replay import Replay

_ALLOWED = "must be a Shot, a list of shots or of strokes of env.history, a Replay, or an environment with keep_history = True"


def replay(source: Any, path: str | Path | None = None, *, title: str = "", players: Iterable[str] = (), table: TableLike = None) -> Replay:
    """A replay of what was played, written to a file if a ``path`` is given.

    Parameters
    ----------
    source : Shot, sequence of Shot or of strokes, environment, or Replay
        A ``Shot`` of ``sn.simulate``, or several in the order in which they were played. The strokes of an episode: ``env.history`` of
        ``SnookerEnv`` or a match, or the environment itself, wrapped or not, of which ``keep_history`` was set to True, or which has a
        render mode.
    path : str or Path, optional
        Where to write it, see ``Replay.save``: "break.html", ".json", ".mp4" or ".gif".
    title : str
        Shown above it.
    players : sequence of str
        Their names, two for a frame, one for a visit; left out: "Player 1", "Player 2", and "Player".
    table : str, Table or None
        What the shots were played on; None: the table that they know.

    Returns
    -------
    Replay

    Raises
    ------
    ValueError
        If there is nothing to show, or a shot without its path.

    Examples
    --------
    >>> import snooker_env as sn
    >>> env = sn.SnookerEnv(action="discrete")
    >>> env.keep_history = True
    >>> _ = env.reset(seed=1)
    >>> _ = env.step(67)
    >>> sn.replay(env, title="one stroke")
    Replay(1 strokes, 'one stroke')
    """
    made = source if isinstance(source, Replay) else Replay(_strokes(source), title=title, players=players, table=table)
    if path is not None:
        made.save(path)
    return made


def _strokes(source: Any) -> list[Shot | Played]:
    if isinstance(source, Shot | Played):
        return [source]
    if isinstance(source, list | tuple):
        return list(source)
    env = getattr(source, "unwrapped", source)
    if not hasattr(env, "history"):
        raise refuse_what("source", f"a {type(source).__name__}", _ALLOWED)
    if not env.keep_history:
        raise refuse_what("source", "an environment that keeps no history", "must have keep_history = True before it plays")
    if not env.history:
        raise refuse_what("source", "an environment without a stroke since its reset", "must have played at least one")
    return env.history
