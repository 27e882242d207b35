"""How is a replay made? From shots, the strokes of an episode, or the environment that played it."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from .._check import refuse_what
from ..physics.table import Table, TableLike
from ..planning import Position
from ..simulation import Shot, simulate
from ..tasks.played import Played
from .document import Replay

_ALLOWED = (
    "must be a Shot, a list of shots or of strokes of env.history, a Position, a Replay, or an environment "
    "that keeps its history"
)


def replay(
    source: Any,
    path: str | Path | None = None,
    *,
    title: str = "",
    players: Iterable[str] = (),
    table: TableLike = None,
) -> Replay:
    """Make a replay of what was played, and write it to a file if ``path`` is given.

    Parameters
    ----------
    source : Shot, Played, sequence of Shot or Played, Position, Replay, or environment
        * A ``Shot`` of ``sn.simulate``, or several in the order in which they were played.
        * The strokes of an episode: ``env.history`` of ``SnookerEnv`` or of a match; or the environment
          itself, wrapped or not, if it has a render mode or its ``keep_history`` was set to True.
        * A ``Position`` is shown as it stands.
        * A ``Replay`` is copied, with the other arguments applied.
    path : str or Path, optional
        A file that ends in ``.html``, ``.json``, ``.mp4`` or ``.gif``, see ``Replay.save``.
    title, players, table
        As in ``Replay``.

    Returns
    -------
    Replay
        ValueError if there is nothing to show, a shot has no path, or an argument is invalid; OSError if the
        file cannot be written.

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
    strokes: Any
    if isinstance(source, Replay):
        strokes, title, players = source.strokes, title or source.title, players or source.players
        table = table or source.table
    else:
        strokes = _strokes(source, table)
    made = Replay(strokes, title=title, players=players, table=table)
    if path is not None:
        made.save(path)
    return made


def _still(position: Position, table: TableLike) -> Shot:
    """The shot in which nothing moves."""
    places, on_table, _ = position.arrays()
    nothing, table = np.zeros((len(places), 3)), Table.of("match" if table is None else table)
    return simulate(places, nothing[:, :2], nothing, table, on_table=on_table)


def _strokes(source: Any, table: TableLike) -> list[Shot | Played]:
    if isinstance(source, Shot | Played):
        return [source]
    if isinstance(source, list | tuple):
        return list(source)
    if isinstance(source, Position):
        return [_still(source, table)]
    env = getattr(source, "unwrapped", source)
    if not hasattr(env, "history"):
        raise refuse_what("source", f"a {type(source).__name__}", _ALLOWED)
    if not env.keep_history:
        words = "must have env.unwrapped.keep_history = True set before it plays, or be wrapped in "
        raise refuse_what("source", "an environment that keeps no history", f"{words}sn.RecordReplay")
    if not env.history:
        what = "an environment without a stroke since its reset"
        raise refuse_what("source", what, "must have played at least one")
    return env.history
