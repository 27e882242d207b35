"""What is the result of a simulated shot? ``Shot``, ``ShotBatch``: where balls end, events, any moment."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .._lib.check import array, refuse
from .._lib.jit import entry
from .._lib.types import Bools, Floats, Ints, Real, Vector
from ..physics import cloth, flight
from ..physics.events import Status
from ..physics.parameters import Physics
from ..physics.table import Table

if TYPE_CHECKING:
    from matplotlib.axes import Axes
else:  # matplotlib is loaded at its first use
    Axes = Any

EVENT = np.dtype([("time", np.float64), ("kind", np.int32), ("i", np.int32), ("j", np.int32)])
"""Data type of a logged event: ``time`` [s], ``kind`` (an ``EventKind``, which explains ``i``, ``j``)."""
EVENT_IN_SPACE = np.dtype([*EVENT.descr, ("z", np.float64)])
"""The same with the height of ball ``i`` above the bed [m]: of shots with ``Physics.flight`` that have their path."""


class SimulationError(RuntimeError):
    """A shot or an impact that could not be computed; the message says which, and what to try."""


HELD = "a ball may be held against another; try other physics or, with simulate(), more max_events"
WHY = {
    Status.TOO_MANY_EVENTS: f"did not come to rest in time: {HELD}",
    Status.IMPACT_UNSOLVED: "holds an impact that did not end: try another fidelity, or less extreme friction",
    Status.ASTRAY: "holds a ball that left the table through a cushion, or where the table is open",
}


@entry
def _states_at(segments, n_balls, times, phys, positions, velocities, spins):
    """Fill positions (m, n, 2) or (m, n, 3) [m], velocities [m/s] and spins (m, n, 3) [rad/s] at ``times`` (m,) [s].
    ``segments`` (k, cloth.SEGMENT) in order of time: each holds until the ball's next; of several at one time the last."""
    k = segments.shape[0]
    state = np.empty(k, np.int64)
    for s in range(k):
        state[s] = int(segments[s, cloth.SEGMENT_STATE])
    current = np.empty(n_balls, np.int64)
    for m in range(times.shape[0]):
        t = times[m]
        for s in range(k):  # the log is in order of time
            if segments[s, cloth.T0] > t:
                break
            current[int(segments[s, cloth.SEGMENT_BALL])] = s
        for i in range(n_balls):
            r, v, w = flight.evaluate(segments, state, current[i], t, phys)
            positions[m, i, 0], positions[m, i, 1] = r
            velocities[m, i, 0], velocities[m, i, 1] = v
            if positions.shape[2] == 3:
                positions[m, i, 2], velocities[m, i, 2] = flight.height(segments, state, current[i], t, phys)
            spins[m, i, 0], spins[m, i, 1], spins[m, i, 2] = w


@dataclass(frozen=True, eq=False)
class Shot:
    """One simulated shot, as ``simulate`` returns it; its arrays are new ones.

    Attributes
    ----------
    positions : float64 (n, 2)
        Centres of the balls at rest [m]; of a potted ball where it crossed the fall, or its flight ended.
    potted : int64 (n,)
        Pocket of each ball, an index of ``snooker_env.POCKETS``; -1 if it was not potted in this shot, -2 if it was
        forced off the table (only with ``Physics.flight``).
    on_table : bool (n,)
        True for the balls that are still in play.
    duration : float
        Time until everything is at rest, spin included [s]; with ``Physics.spin_decel`` 0, without spin.
    events : structured array (k,)
        Events in order: ``time`` [s], ``kind`` (an ``EventKind``), ``i`` and ``j`` (explained there); with
        ``Physics.flight`` also ``z``, the height of ball i [m].
    segments : float64 (s, columns)
        The paths in pieces, which ``at`` evaluates.
    physics, table
        The ``Physics`` and the ``Table`` of the shot; the table is None if it is not known.

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

    def __post_init__(self) -> None:
        if self.physics.flight and len(self.segments) and self.events.dtype == EVENT:
            events = np.empty(len(self.events), EVENT_IN_SPACE)
            for name in EVENT.names or ():
                events[name] = self.events[name]
            events["z"] = self.at(events["time"])[0][np.arange(len(events)), events["i"], 2]
            object.__setattr__(self, "events", events)

    def at(self, t: Real | Vector) -> tuple[Floats, Floats, Floats]:
        """Positions, velocities and spins of all balls at one time [s], or at m times.

        Returns float64 (n, 2) [m], (n, 2) [m/s] and (n, 3) [rad/s], or (m, n, ...); with ``Physics.flight`` places and
        velocities are (n, 3), the height of a ball's centre above its height on the bed last. An impact counts as over
        at its time. From ``duration`` on all is at rest (with ``spin_decel`` 0 a spin about the vertical
        stays). A potted ball lies in its place of ``positions`` from its pot on, a ball off the table where
        it was put; one in the air has its mean velocity from event to event. ValueError if a time is negative
        or not finite, or the shot has no path."""
        single = np.ndim(np.asarray(t)) == 0
        times = array("t", [t] if single else t, (-1,))
        if times.size and times.min() < 0:
            raise refuse("t", float(times.min()), "must not be negative")
        if not len(self.segments):
            allowed = "must be there: simulate() keeps them, environments with keep_history = True"
            raise refuse("shot.segments", "none", allowed)
        n, m = len(self.positions), len(times)
        space = 3 if self.physics.flight else 2
        out = np.zeros((m, n, space)), np.zeros((m, n, space)), np.zeros((m, n, 3))
        # the compiled type; an unpickled shot may be read-only
        segments = np.require(self.segments, np.float64, ["C", "W"])
        _states_at(segments, n, times, self.physics.pack(), *out)
        if self.physics.spin_decel > 0:
            out[2][times >= self.duration] = 0.0  # at exactly that time rounding may leave 1e-14 of a spin
        return (out[0][0], out[1][0], out[2][0]) if single else out

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draw the shot from above with matplotlib, on the axes ``ax`` or a new figure; returns the axes.

        Balls lie as before the shot; faint ones show them where they met another, and at rest. Paths have the balls' colours,
        striped where the ball slides. The cue ball's speeds are those at the start and just before its impacts; the cut is
        the angle between its direction and the line of centres. Baulk is left and black right: the horizontal axis is
        y [m], the vertical one x [m] downwards, so that your own marks are drawn by ``ax.plot(y, x)``. ValueError for a shot
        without a path or with more than 22 balls, ImportError without matplotlib."""
        from ..render.shot_diagram import draw_shot

        return draw_shot(self, ax)


@dataclass(frozen=True, eq=False)
class ShotBatch:
    """Many simulated shots: the attributes of ``Shot`` with a leading axis b.

    Attributes
    ----------
    positions, potted, on_table, duration
        float64 (b, n, 2) [m], int64 (b, n), bool (b, n) and float64 (b,) [s].
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
