"""How far are simulated paths from measured ones? This compares many strikes of one shot at once with the samples of all balls."""

import numba
import numpy as np

from snooker_env import simulation
from snooker_env.physics import cloth, cue
from snooker_env.physics.columns import P_MU_S, P_R
from snooker_env.physics.events import EventKind
from snooker_env.physics.impact import contact
from snooker_env.physics.parameters import Physics
from snooker_env.physics.table import Table, TableLike

SPEED, AIM, SIDE, TOP, ELEVATION, START = range(6)
"""A strike: speed [m/s], direction [rad], offsets over R, elevation [rad], and its time on the track's clock [s]."""
_LOG = 100
_ROOM = 110
_CHUNK = 400
_FAST = contact.parse_fidelity("fast")
_BALL_BALL, _CUSHION = int(EventKind.BALL_BALL), int(EventKind.CUSHION)


@numba.njit(nogil=True, error_model="numpy")
def _strikes(strikes, phys, ratio, velocities, spins):
    for k in range(len(strikes)):
        s = strikes[k]
        v, w = cue.strike_ball(s[0], s[1], s[2], s[3], s[4], phys[P_R], phys[P_MU_S], ratio, 0.0)
        velocities[k, 0, 0], velocities[k, 0, 1] = v[0], v[1]
        spins[k, 0, 0], spins[k, 0, 1], spins[k, 0, 2] = w


@numba.njit(nogil=True, error_model="numpy")
def _differences(segments, n_segments, starts, times, offsets, xy, horizon, phys, out):
    """Fill ``out`` (b, samples, 2) with the vectors from each sample up to the horizon [s] to the simulated ball."""
    n_balls = len(offsets) - 1
    for c in range(len(segments)):
        rows, n = segments[c], n_segments[c]
        state = np.empty(n, np.int64)
        for s in range(n):
            state[s] = int(rows[s, cloth.SEGMENT_STATE])
        for b in range(n_balls):
            s, here = 0, -1
            for m in range(offsets[b], offsets[b + 1]):
                if times[m] > horizon:
                    break
                t = max(times[m] - starts[c], 0.0)
                while s < n and rows[s, cloth.T0] <= t:
                    if int(rows[s, cloth.SEGMENT_BALL]) == b:
                        here = s
                    s += 1
                r, _, _ = cloth.evaluate(rows, state, here, t, phys)
                out[c, m, 0], out[c, m, 1] = r[0] - xy[m, 0], r[1] - xy[m, 1]


@numba.njit(nogil=True, error_model="numpy")
def _places(rows, n, start, times, phys, out):
    """Fill ``out`` (times, balls, 2) with the places of the balls of one shot."""
    state = np.empty(n, np.int64)
    for s in range(n):
        state[s] = int(rows[s, cloth.SEGMENT_STATE])
    for b in range(out.shape[1]):
        s, here = 0, -1
        for m in range(len(times)):
            t = max(times[m] - start, 0.0)
            while s < n and rows[s, cloth.T0] <= t:
                if int(rows[s, cloth.SEGMENT_BALL]) == b:
                    here = s
                s += 1
            r, _, _ = cloth.evaluate(rows, state, here, t, phys)
            out[m, b, 0], out[m, b, 1] = r


class Judge:
    """The samples of one shot, and the engine that plays strikes for comparison."""

    def __init__(self, shot, physics, table: TableLike = "carom", fidelity="standard"):
        self.shot = shot
        self.times = np.concatenate([b.t for b in shot.balls])
        self.xy = np.concatenate([b.xy for b in shot.balls])
        self.offsets = np.cumsum([0, *(len(b.t) for b in shot.balls)])
        self.table, self.solver = Table.of(table), contact.parse_fidelity(fidelity)
        self.use(physics)
        self.evaluations = 0

    def use(self, physics):
        """Set the constants."""
        self.physics = Physics.of(physics)
        self.packed = self.physics.packed_for(self.solver)

    def run(self, strikes, max_events=100_000, fast=False):
        """Run strikes (b, 6) in the engine; ``fast``: with a looser tolerance of impacts."""
        b, n = len(strikes), len(self.shot.balls)
        r = np.repeat(self.shot.places[None], b, axis=0)
        v, w = np.zeros((b, n, 2)), np.zeros((b, n, 3))
        _strikes(strikes, self.packed, self.physics.end_mass_ratio, v, w)
        self.evaluations += b
        return simulation._run(
            (r, v, w, np.ones((b, n), bool)),
            self.physics,
            self.table,
            _FAST if fast else self.solver,
            max_events,
            simulation.log_space(b, _LOG, _ROOM),
        )

    def events_until(self, strikes, horizon):
        """The number of events of strikes (b, 6) up to the horizon [s], with a margin."""
        ran = self.run(strikes, fast=True)
        counted = np.arange(ran.event_time.shape[1]) < ran.n_events[:, None]
        return int((counted & (ran.event_time <= horizon)).sum(1).max()) + 8

    def squares(self, strikes, horizon=np.inf, **how):
        """Squared distances (b, samples) [m^2] of strikes (b, 6); 0 beyond the horizon."""
        found = self.differences(strikes, horizon, **how)
        return found[..., 0] ** 2 + found[..., 1] ** 2

    def differences(self, strikes, horizon=np.inf, max_events=100_000, fast=False):
        """Vectors from each sample to the simulated ball (b, samples, 2) [m]; 0 beyond the horizon."""
        strikes = np.ascontiguousarray(strikes)
        out = np.zeros((len(strikes), len(self.times), 2))
        for a in range(0, len(strikes), _CHUNK):
            part = strikes[a : a + _CHUNK]
            ran = self.run(part, max_events, fast)
            _differences(
                ran.segments,
                np.minimum(ran.n_segments, _ROOM),
                part[:, START],
                self.times,
                self.offsets,
                self.xy,
                horizon,
                self.packed,
                out[a : a + _CHUNK],
            )
        return out

    def places(self, strike, times):
        """Places of the balls at times of the track's clock: (times, balls, 2)."""
        ran = self.run(strike[None])
        found = np.empty((len(times), len(self.shot.balls), 2))
        _places(ran.segments[0], int(ran.n_segments[0]), strike[START], times, self.packed, found)
        return found
