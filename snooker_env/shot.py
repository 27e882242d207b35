"""What does a simulated shot tell? ``Shot`` and ``ShotBatch``: where the balls came to rest, what happened, and every moment between."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._check import array, refuse
from ._types import Bools, Floats, Ints, Real, Vector
from .physics import trajectory
from .physics.parameters import Physics
from .physics.table import Table

EVENT = np.dtype([("time", np.float64), ("kind", np.int32), ("i", np.int32), ("j", np.int32)])
"""One logged event; ``kind`` is an ``EventKind``."""


class SimulationError(RuntimeError):
    """A shot or an impact that could not be computed. The message names it, its last event and what to try."""


@dataclass(frozen=True, eq=False)
class Shot:
    """One simulated shot. All arrays are fresh and the caller's own.

    Attributes
    ----------
    positions : float64 (n, 2)
        Centres at rest [m]; of a potted ball where its centre crossed the fall, or where its flight over the pocket ended.
    potted : int64 (n,)
        The pocket of each ball, an index of ``snooker_env.POCKETS``; -1 if it was not potted in this shot.
    on_table : bool (n,)
        Which balls are still in play.
    duration : float
        Time [s] until everything is at rest, spin included. With ``Physics.spin_decel`` 0, which ends no spin: until no ball moves
        across the table.
    events : structured array (k,)
        The log: ``time`` [s], ``kind`` (an ``EventKind``), ``i`` and ``j`` (see there), in order.
    segments : float64 (s, columns)
        The paths, for ``at``.
    physics : Physics
        The world it was played in.
    table : Table, or None
        The table it was played on, if that is known.

    Examples
    --------
    >>> import snooker_env as sn
    >>> shot = sn.simulate([(0.0, 0.0), (0.0, 0.5)], [(0.0, 1.0), (0.0, 0.0)], [(0.0, 0.0, 0.0)] * 2)
    >>> [sn.EventKind(kind).name for kind in shot.events["kind"][:2]]
    ['ROLL', 'BALL_BALL']
    >>> bool(shot.positions[1, 1] > 0.5), shot.potted.tolist()
    (True, [-1, -1])
    """

    positions: Floats
    potted: Ints
    on_table: Bools
    duration: float
    events: NDArray[np.void]
    segments: Floats = field(repr=False)
    physics: Physics = field(repr=False)
    table: Table | None = field(default=None, repr=False)

    def at(self, t: Real | Vector) -> tuple[Floats, Floats, Floats]:
        """Where the balls are at a time, how fast they move and how they spin.

        At the time of an impact: just after it. From ``duration`` on, however late, everything is at rest: the positions are ``positions``,
        velocities and spins zero (with ``spin_decel`` 0 a spin about the vertical stays as it is). A potted ball lies still in its place of
        ``positions``, without spin, from its pot on; one that was not on the table lies where it was given. A ball in the air over a pocket
        has the mean velocity from event to event.

        Parameters
        ----------
        t : float or array_like, float (m,)
            Times from the start of the shot [s], finite and not negative.

        Returns
        -------
        positions : float64 (n, 2) or (m, n, 2)
            [m]
        velocities : float64 (n, 2) or (m, n, 2)
            [m/s]
        spins : float64 (n, 3) or (m, n, 3)
            [rad/s]

        Raises
        ------
        ValueError
            If a time is negative or not finite.

        Examples
        --------
        >>> import snooker_env as sn
        >>> shot = sn.simulate([(0.0, 0.0)], [(1.0, 0.0)], [(0.0, 0.0, 0.0)])
        >>> shot.at(0.1)[0].shape, shot.at([0.1, 0.2])[0].shape
        ((1, 2), (2, 1, 2))
        """
        single = np.ndim(np.asarray(t)) == 0
        times = array("t", [t] if single else t, (-1,))
        if times.size and times.min() < 0:
            raise refuse("t", float(times.min()), "must not be negative")
        n, m = len(self.positions), len(times)
        out = np.zeros((m, n, 2)), np.zeros((m, n, 2)), np.zeros((m, n, 3))
        segments = np.require(self.segments, np.float64, ["C", "W"])  # as compiled for; a shot that came from elsewhere may be read-only
        trajectory.states_at(segments, n, times, self.physics.pack(), *out)
        if self.physics.spin_decel > 0:
            out[2][times >= self.duration] = 0.0  # rounding may leave 1e-14 of a spin at the very time at which it ends
        return (out[0][0], out[1][0], out[2][0]) if single else out

    def plot(self, ax: Any = None, **options: Any) -> Any:
        """Draw the shot with matplotlib.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where; None: in a figure of its own.
        **options
            Of ``snooker_env.render.diagrams.plot``, which says what is drawn.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        ValueError
            If the shot has no path, or an option is wrong.
        ImportError
            Without matplotlib.
        """
        from .render.diagrams import plot

        return plot(self, ax, **options)


@dataclass(frozen=True, eq=False)
class ShotBatch:
    """Many simulated shots: the attributes of ``Shot`` with a leading axis b.

    Attributes
    ----------
    positions : float64 (b, n, 2)
        Centres at rest [m], as in ``Shot``.
    potted : int64 (b, n)
        Pockets, -1 if not potted.
    on_table : bool (b, n)
        Which balls are still in play.
    duration : float64 (b,)
        Times until everything is at rest [s].
    event_count : int64 (b,)
        How many events each shot had.
    events : list of structured arrays, or None
        The log of each shot, if it was asked for.
    """

    positions: Floats
    potted: Ints
    on_table: Bools
    duration: Floats
    event_count: Ints
    events: list[NDArray[np.void]] | None = None
