"""What does an environment of one table show, keep and save? Balls, strokes, pictures and states."""

from typing import Any

import numpy as np

from .._lib.check import truth
from .._lib.types import Bools, Floats
from ..game.balls import BallOn
from ..game.frame import Frame
from ..game.frame_columns import BALL_ON, IN_HAND, POINTS
from ..physics.parameters import Physics
from ..simulation.shot import Shot
from ..tasks.frames import Frames
from ..tasks.options import Options
from ..tasks.played import Played
from ..tasks.stroke import ShotBuffers
from ..tasks.tables import Tables
from .arguments import Start, begin_at
from .pictures import Picture, Pictures


class Record:
    """The strokes of one table since the reset: ``full``, all with paths; else the agent's last ``Shot``."""

    def __init__(self, *, full: bool, last_shot: Shot | None = None):
        self.full = full
        self.buffers = ShotBuffers(1, path=full)  # work space in which the strokes are played
        self.strokes: list[Played] = []  # of both players; empty unless ``full``
        self.last_shot: Shot | None = last_shot  # the agent's; with ``full``, that of either player


class OneTable:
    """An environment with one table: ``SnookerEnv``, and ``MatchEnv`` with two players."""

    options: Options
    tables: Tables  # the one table: ``tasks.tables.Tables``
    np_random: np.random.Generator
    render_mode: str | None
    _np_random_seed: int | None
    _pictures: Pictures
    _record: Record
    _keyed: bool  # has the table's stream a key?

    @property
    def positions(self) -> Floats:
        """Centres of the balls [m], float64 (22, 2), a copy: the cue ball, 15 reds, yellow to black."""
        return self.tables.positions[0].copy()

    @property
    def on_table(self) -> Bools:
        """Which balls are on the table, bool (22,); a copy."""
        return self.tables.on_table[0].copy()

    @property
    def ball_on(self) -> BallOn:
        """What must be struck first, a ``BallOn``."""
        return BallOn(self.tables.game[0, BALL_ON])

    @property
    def on(self) -> int:
        """The balls that may be struck first, as an int with bit i set for ball i."""
        return self.tables.on(0)

    @property
    def in_hand(self) -> bool:
        """Whether the cue ball is in hand, a bool."""
        return bool(self.tables.game[0, IN_HAND])

    @property
    def points(self) -> int:
        """Points of the visit so far, an int; in a frame those of the striker's break."""
        return int(self.tables.game[0, POINTS])

    @property
    def over(self) -> bool:
        """Whether there is no stroke to play: the episode has ended, was stopped, or has not begun."""
        return bool(self.tables.are_over()[0])

    @property
    def frame(self) -> Frame | None:
        """The current ``snooker_env.game.frame.Frame``; None in a visit."""
        return self.tables.frame(0) if isinstance(self.tables, Frames) else None

    @property
    def physics(self) -> Physics:
        """The physical constants of this episode's table, a ``Physics``."""
        return self.tables.physics_of(0)

    # strokes

    @property
    def last_shot(self) -> Shot | None:
        """The agent's last ``Shot``, None before the first; with a history that of either player."""
        return self._record.last_shot

    @property
    def history(self) -> list[Played]:
        """Both players' ``Played`` strokes since the last reset, a list; empty unless ``keep_history``."""
        return list(self._record.strokes)

    @property
    def keep_history(self) -> bool:
        """Whether ``history`` is kept, with all paths; always with a render mode. False forgets it."""
        return self._record.full

    @keep_history.setter
    def keep_history(self, value: bool) -> None:
        full = truth("keep_history", value) or self.render_mode is not None
        if full != self._record.full:
            self._record = Record(full=full, last_shot=self._record.last_shot)

    def _watch(self, k: int, buffers: ShotBuffers, j: int, mine: bool) -> None:
        """Record shot j of the buffers, just played on table k; ``mine``: by the agent."""
        record = self._record
        if record.full:
            record.strokes.append(self.tables.record(k, buffers, j))
            record.last_shot = record.strokes[-1].shot
        elif mine:
            record.last_shot = self.tables.shot(k, buffers, j)

    def render(self) -> Picture:
        """Return a ``Picture``, with the paths of the last shot."""
        return self._pictures.render(self.tables, 0, self._record.strokes)

    def _show(self, *, played: bool = False) -> None:
        self._pictures.show(self.tables, self._record.strokes, played=played)

    def close(self) -> None:
        """Close the window, if there is one."""
        self._pictures.close()

    # states

    def get_state(self) -> dict[str, Any]:
        """Return everything between two shots as JSON types, see docs/environment/specification.md."""
        return self.tables.get_state(0) | {"rng": self.np_random.bit_generator.state}

    def set_state(self, state: dict[str, Any]) -> None:
        """Restore a result of ``get_state``; ValueError if it is invalid: then nothing has changed."""
        self._begin_at(self.tables.check_state(state, self.np_random), seeded=False)
        self._begin()

    def _begin(self) -> None:
        """A new episode begins on the table."""
        self._record.strokes, self._record.last_shot = [], None

    def _begin_at(self, start: Start | None, *, seeded: bool) -> None:
        if begin_at(start, self.tables, 0, self.np_random, seeded=seeded, keyed=self._keyed):
            self._np_random_seed = -1  # Gymnasium's number for "not from a seed"
        self._keyed = True
