"""What is the result of a simulated shot? ``Shot`` and ``ShotBatch``: final positions, the log of events, and
the state at any time."""

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
"""Data type of one logged event: ``time`` [s], ``kind`` (an ``EventKind``), ``i`` and ``j`` (explained
there)."""


class SimulationError(RuntimeError):
    """A shot or an impact that could not be computed.

    The message names the shot or the impact, its last event, and what to try.
    """


@dataclass(frozen=True, eq=False)
class Shot:
    """One simulated shot, as ``simulate`` returns it.

    The arrays are new ones; changing them changes nothing else.

    Attributes
    ----------
    positions : float64 (n, 2)
        Centres of the balls at rest [m]. For a potted ball: where its centre crossed the fall, or where its
        flight over the pocket ended.
    potted : int64 (n,)
        Pocket of each ball, an index of ``snooker_env.POCKETS``; -1 if it was not potted in this shot.
    on_table : bool (n,)
        True for the balls that are still in play.
    duration : float
        Time until everything is at rest, spin included [s]. With ``Physics.spin_decel`` 0, spin never ends:
        then the time until no ball moves across the table.
    events : structured array (k,)
        Log of the events in order of time: ``time`` [s], ``kind`` (an ``EventKind``), ``i`` and ``j``
        (explained there).
    segments : float64 (s, columns)
        The paths in pieces, which ``at`` evaluates.
    physics : Physics
        The constants of the shot.
    table : Table, or None
        The table of the shot, if it is known.

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
        """Positions, velocities and spins of all balls at one time, or at many.

        At the time of an impact, the state is that just after it. From ``duration`` on everything is at rest:
        the positions are ``positions``, velocities and spins are zero (with ``spin_decel`` 0 a spin about the
        vertical stays as it is). A potted ball lies still in its place of ``positions`` from its pot on; a
        ball that was not on the table stays where it was given. A ball in the air over a pocket has its mean
        velocity from event to event.

        Parameters
        ----------
        t : float or array_like, float (m,)
            Times from the start of the shot [s], finite and not negative.

        Returns
        -------
        positions : float64 (n, 2) or (m, n, 2)
            Centres of the balls [m].
        velocities : float64 (n, 2) or (m, n, 2)
            Velocities [m/s].
        spins : float64 (n, 3) or (m, n, 3)
            Angular velocities [rad/s].

        Raises
        ------
        ValueError
            If a time is negative or not finite, or if the shot has no path.

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
        check_path(self)
        n, m = len(self.positions), len(times)
        out = np.zeros((m, n, 2)), np.zeros((m, n, 2)), np.zeros((m, n, 3))
        # the compiled type; an unpickled shot may be read-only
        segments = np.require(self.segments, np.float64, ["C", "W"])
        trajectory.states_at(segments, n, times, self.physics.pack(), *out)
        if self.physics.spin_decel > 0:
            out[2][times >= self.duration] = 0.0  # at exactly that time rounding may leave 1e-14 of a spin
        return (out[0][0], out[1][0], out[2][0]) if single else out

    def plot(self, ax: Any = None, **options: Any) -> Any:
        """Draw the shot with matplotlib.

        ``ax``: axes to draw on; None makes a new figure. ``**options``: options of
        ``snooker_env.render.diagrams.plot``, where the diagram is explained. Returns the axes with the
        diagram. ValueError if the shot has no path, or an option is wrong. ImportError if matplotlib is not
        installed.
        """
        from .render.diagrams import plot

        return plot(self, ax, **options)


def check_path(shot: Shot) -> None:
    """Raise ValueError unless the shot has its path."""
    if not len(shot.segments):
        raise refuse(
            "shot.segments",
            "none",
            "must be there: simulate() keeps them, environments with keep_history = True",
        )


@dataclass(frozen=True, eq=False)
class ShotBatch:
    """Many simulated shots: the attributes of ``Shot`` with a leading axis b.

    Attributes
    ----------
    positions : float64 (b, n, 2)
        Centres of the balls at rest [m], as in ``Shot``.
    potted : int64 (b, n)
        Pocket of each ball, an index of ``snooker_env.POCKETS``; -1 if it was not potted.
    on_table : bool (b, n)
        True for the balls that are still in play.
    duration : float64 (b,)
        Time until everything is at rest [s].
    event_count : int64 (b,)
        Number of events of each shot.
    events : list of structured arrays, or None
        Log of each shot, with ``simulate_batch(..., events=True)``; else None.

    Examples
    --------
    >>> import numpy as np
    >>> import snooker_env as sn
    >>> speeds = np.array([1.0, 2.0, 3.0])
    >>> velocities = np.stack([0 * speeds, speeds], axis=1)[:, None]
    >>> batch = sn.simulate_batch(np.zeros((3, 1, 2)), velocities, np.zeros((3, 1, 3)))
    >>> batch.positions.shape, batch.potted[:, 0].tolist()
    ((3, 1, 2), [-1, -1, -1])
    """

    positions: Floats
    potted: Ints
    on_table: Bools
    duration: Floats
    event_count: Ints
    events: list[NDArray[np.void]] | None = None
