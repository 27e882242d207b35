"""What is kept of an episode? Its strokes one by one, if a history is kept, and always the last shot."""

from .._check import truth
from ..simulation import Shot
from ..tasks.played import Played
from ..tasks.stroke import ShotBuffers
from ..tasks.tables import Tables


class Record:
    """The strokes of one table. ``full``: all of them since the reset, with their paths; otherwise only the
    agent's last ``Shot``."""

    buffers: ShotBuffers
    """Work space in which the strokes are played."""
    strokes: list[Played]
    """The strokes since the reset, of both players; empty unless ``full``."""
    last_shot: Shot | None
    """The agent's last shot; with ``full``, that of either player."""

    def __init__(self, *, full: bool, last_shot: Shot | None = None):
        self.full = full
        self.buffers = ShotBuffers(1, path=full)
        self.strokes, self.last_shot = [], last_shot
        self._before, self._seen = 0, False
        self._ended: tuple[list[Played], int] = [], 0

    def begin_episode(self) -> None:
        """Begin a new episode and forget the last one, except for strokes that have not been rendered yet.

        Some vector environments reset within a step, before they render.
        """
        self._ended = ([], 0) if self._seen else (self.strokes, len(self.strokes) - self._before)
        self.strokes, self.last_shot, self._before, self._seen = [], None, 0, False

    def begin_step(self) -> None:
        """Begin a new step: the strokes to come are the recent ones."""
        self._before, self._ended, self._seen = len(self.strokes), ([], 0), False

    def recent(self) -> list[tuple[list[Played], int]]:
        """Episodes, and how many of their last strokes belong to the last step or reset; called when they are
        rendered."""
        self._seen = True
        return [self._ended, (self.strokes, len(self.strokes) - self._before)]

    def saw(self, tables: Tables, k: int, buffers: ShotBuffers, j: int, own: bool) -> None:
        """Record shot j of the buffers, just played on table k; ``own``: by the agent."""
        if self.full:
            played = tables.played(k, buffers, j)
            self.strokes.append(played)
            self.last_shot = played.shot
        elif own:
            self.last_shot = buffers.shot(j, tables.rules)


class HasHistory:
    """The ``Record`` of an environment with one table, as properties."""

    _record: Record
    render_mode: str | None

    @property
    def last_shot(self) -> Shot | None:
        """The agent's last ``Shot``; if a history is kept, that of either player, with its path. None before
        the first."""
        return self._record.last_shot

    @property
    def history(self) -> list[Played]:
        """The strokes of both players since the last reset, a list of ``Played``; empty unless
        ``keep_history``."""
        return list(self._record.strokes)

    @property
    def keep_history(self) -> bool:
        """Whether ``history`` is kept, with the path of every stroke, a bool.

        It is always kept with a render mode, otherwise from when this is set to True. Setting it to False
        forgets the strokes so far.
        """
        return self._record.full

    @keep_history.setter
    def keep_history(self, value: bool) -> None:
        full = truth("keep_history", value) or self.render_mode is not None
        if full != self._record.full:
            self._record = Record(full=full, last_shot=self._record.last_shot)


class Recent:
    """The strokes of many tables in their last step or reset: one list for each table."""

    def __init__(self, tables: Tables):
        self.tables = tables
        self.begin()

    def begin(self) -> None:
        """Begin a step or a reset."""
        self.strokes: list[list[Played]] = [[] for _ in range(self.tables.n)]

    def saw(self, k: int, buffers: ShotBuffers, j: int, own: bool) -> None:
        """Record shot j of the buffers, just played on table k."""
        self.strokes[k].append(self.tables.played(k, buffers, j))
