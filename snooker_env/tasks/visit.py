"""How is a stroke of a visit played, on one table or on thousands? Every step of it as a kernel over tables, and the state they work on.

A step is: ``_address`` (action, noise, strike), ``engine.run_batch`` (the shot), ``_conclude`` (what was seen, the referee, reward,
observation), and for tables that start anew ``layouts.deal_tables`` and ``_begin``. The single environment calls them with one table, the
vector environment with slices of many: so both play the same, bit for bit. Each table draws from its own stream (``game.philox``).
"""

from dataclasses import dataclass

import numpy as np

from .._jit import entry, kernel
from ..game.apply_ruling import settle_visit
from ..game.balls import CUE, N_BALLS, balls_on_kernel, bits, next_on_kernel
from ..game.in_hand import nearest_place
from ..game.layouts import Plan, deal_tables
from ..game.philox import stream_of
from ..game.pots import POT_COLUMNS
from ..game.ruling import VISIT
from ..geometry import BALL_RADIUS
from ..physics import cloth, cue, engine
from ..physics.engine import Status
from ..physics.impact.polynomial import WORK
from ..simulation import EVENT, MAX_EVENTS, Shot, SimulationError
from . import discrete_actions
from .box_actions import A_DISCRETE, A_END_MASS, A_MAX_OFFSET, A_PLACEMENT, place_of, shot_of, tip_on_disc
from .noise import executed
from .observations import SIZE, observe_into
from .rewards import REWARDS, reward_of
from .stroke import Shooter, first_struck, touching_balls

# Columns of the game's state. STEPS counts the strokes of the visit, for a limit on them.
(BALL_ON, IN_HAND, POINTS, OVER, STEPS) = range(5)

REALS = ("points", "break", "seconds")
COUNTS = ("penalty", "pots", "fouls", "ball_on", "first_ball", "events")
"""What the info of a step says in floats and in integers; and "foul", whether ``fouls`` is not 0."""

NEVER = 2**62
"""A limit of strokes that is none."""

# Columns of what is kept of a shot before it is played: the five numbers after the strike, and the speed that was intended.
(VX, VY, WX, WY, WZ, SPEED) = range(6)

_OK = int(Status.OK)
_WHY = {
    Status.TOO_MANY_EVENTS: f"did not come to rest within {MAX_EVENTS} events: a ball may be held against another; try other physics",
    Status.IMPACT_UNSOLVED: "holds an impact that did not end: try another fidelity, or less extreme friction",
}


@entry(what="the strokes of the environment", seconds=3, uses=(discrete_actions.chosen,))
def _address(actions, waiting, positions, on_table, game, streams, options, noise, phys, fidelity, n_steps, r, v, w, here, shots):
    """Carry the actions (m, k) out up to the strike; tables ``waiting`` for a new layout play no shot."""
    found = np.empty((discrete_actions.POTS if options[A_DISCRETE] else 1, POT_COLUMNS))
    motion, phase, work = np.empty((2, cloth.COLUMNS)), np.empty(2, np.int64), np.empty(WORK)
    for k in range(actions.shape[0]):
        a, p, on = actions[k], positions[k], on_table[k]
        if waiting[k]:
            here[k, :] = False
            continue
        if game[k, IN_HAND] and options[A_PLACEMENT]:
            x, y = place_of(a, options)
            on[CUE] = False
            x, y, free = nearest_place(p, on, x, y, BALL_RADIUS)
            on[CUE] = True
            if free:
                p[CUE, 0], p[CUE, 1] = x, y
        mask = balls_on_kernel(game[k, BALL_ON], bits(on))
        if options[A_DISCRETE]:
            intended = discrete_actions.chosen(
                int(a[0]), p, on, mask, phys, options[A_END_MASS], fidelity, n_steps, found, motion, phase, work
            )
        else:
            intended = shot_of(a, p, on, mask, options, found)
        speed, side, top, aim, elevation = executed(*intended, noise, streams[k])
        side, top = tip_on_disc(side, top, options[A_MAX_OFFSET])
        shot = shots[k]
        (shot[VX], shot[VY], _), (shot[WX], shot[WY], shot[WZ]) = cue.struck(
            speed, aim, side, top, elevation, BALL_RADIUS, options[A_END_MASS]
        )
        shot[SPEED] = intended[0]
        for i in range(N_BALLS):
            r[k, i, 0], r[k, i, 1], here[k, i] = p[i, 0], p[i, 1], on[i]
            v[k, i, 0] = v[k, i, 1] = w[k, i, 0] = w[k, i, 1] = w[k, i, 2] = 0.0
        v[k, CUE, 0], v[k, CUE, 1] = shot[VX], shot[VY]
        w[k, CUE, 0], w[k, CUE, 1], w[k, CUE, 2] = shot[WX], shot[WY], shot[WZ]


@entry(what="the referee of visits", seconds=4)
def _conclude(waiting, positions, on_table, game, r, potted, status, duration, event_time, event_what, n_events, shots, reward, limit,
              observations, rewards, terminated, truncated, reals, counts):  # fmt: skip
    """Judge the shots that came to rest and put their tables in order; write everything that a step returns."""
    for k in range(status.shape[0]):
        if waiting[k]:
            rewards[k], terminated[k], truncated[k] = 0.0, False, False
            continue
        if status[k] != _OK:
            continue
        p, on, state = positions[k], on_table[k], game[k]
        touching = touching_balls(p, on)
        first, moved = first_struck(event_time[k], event_what[k], n_events[k], touching, shots[k, SPEED])
        down = 0
        for i in range(N_BALLS):
            if potted[k, i] >= 0:
                down |= 1 << i
            p[i, 0], p[i, 1] = r[k, i, 0], r[k, i, 1]
        ball_on = state[BALL_ON]
        verdict = settle_visit(p, on, ball_on, state[POINTS], first, touching, moved, down, BALL_RADIUS)
        state[BALL_ON], state[IN_HAND] = verdict.ball_on, verdict.in_hand
        state[POINTS] += verdict.points
        state[STEPS] += 1
        state[OVER] = verdict.visit_end != VISIT.CONTINUES
        rewards[k] = reward_of(reward, verdict.points, verdict.penalty)
        terminated[k], truncated[k] = state[OVER], state[STEPS] >= limit
        mask = bits(on)
        observe_into(observations[k], p, on, state[BALL_ON], balls_on_kernel(state[BALL_ON], mask), state[IN_HAND], state[POINTS])
        reals[k, 0], reals[k, 1], reals[k, 2] = verdict.points, state[POINTS], duration[k]
        pots, lowest = 0, -1
        for i in range(N_BALLS - 1, 0, -1):
            pots += (down >> i) & 1
            lowest = i if (first >> i) & 1 else lowest
        counts[k, 0], counts[k, 1], counts[k, 2] = verdict.penalty, pots, verdict.fouls
        counts[k, 3], counts[k, 4], counts[k, 5] = ball_on, lowest, n_events[k]


@kernel
def _copy(row, to):
    for c in range(len(row)):
        to[c] = row[c]


@entry(what="the start of a visit", seconds=1)
def _begin(wanted, others, in_hand, positions, on_table, game, observations, reals, counts, last_observations, last_reals, last_counts):
    """Start a visit on the tables ``wanted``, dealt before, and write what a reset returns; on the ``others`` too if that is set.

    If there is room in the ``last_`` arrays, they get what the rows of the wanted tables held before.
    """
    for k in range(wanted.shape[0]):
        if not (wanted[k] or others):
            continue
        mask, state = bits(on_table[k]), game[k]
        if wanted[k]:
            if last_observations.shape[0]:
                _copy(observations[k], last_observations[k])
                _copy(reals[k], last_reals[k])
                _copy(counts[k], last_counts[k])
            state[BALL_ON], state[IN_HAND] = next_on_kernel(mask), in_hand
            state[POINTS] = state[OVER] = state[STEPS] = 0
        on = balls_on_kernel(state[BALL_ON], mask)
        observe_into(observations[k], positions[k], on_table[k], state[BALL_ON], on, state[IN_HAND], state[POINTS])
        reals[k, 0], reals[k, 1], reals[k, 2] = 0.0, state[POINTS], 0.0
        for c in range(len(COUNTS)):
            counts[k, c] = 0
        counts[k, 3], counts[k, 4] = state[BALL_ON], -1


class Returned:
    """What a step or a reset of n tables returns, in fresh arrays; ``last`` only if one step both ends visits and starts new ones."""

    def __init__(self, n, *, last=False):
        self.observations = np.zeros((n, SIZE), np.float32)
        self.rewards = np.zeros(n)
        self.terminated, self.truncated = np.zeros(n, np.bool_), np.zeros(n, np.bool_)
        self.reals, self.counts = np.zeros((n, len(REALS))), np.zeros((n, len(COUNTS)), np.int64)
        m = n if last else 0
        self.last_observations = np.zeros((m, SIZE), np.float32)
        self.last_reals, self.last_counts = np.zeros((m, len(REALS))), np.zeros((m, len(COUNTS)), np.int64)

    def info(self, k):
        """The info of table k alone, as Python numbers."""
        info = dict(zip(REALS, self.reals[k].tolist(), strict=True)) | dict(zip(COUNTS, self.counts[k].tolist(), strict=True))
        return info | {"foul": info["fouls"] != 0}


class Work:
    """Work space for up to m shots at once, each with a log of ``log`` events and, if wanted, its path."""

    def __init__(self, m, log=512, *, path=False):
        self.log = log
        self.r, self.v, self.w = np.zeros((m, N_BALLS, 2)), np.zeros((m, N_BALLS, 2)), np.zeros((m, N_BALLS, 3))
        self.here, self.potted = np.zeros((m, N_BALLS), np.bool_), np.zeros((m, N_BALLS), np.int64)
        self.shots = np.zeros((m, 6))
        self.event_time, self.event_what = np.zeros((m, log)), np.zeros((m, log, 3), np.int32)
        self.segments = np.zeros((m, 2 * log + N_BALLS + 2 if path else 0, cloth.COLUMNS + 2))
        self.status, self.n_events, self.n_segments = (np.zeros(m, np.int64) for _ in range(3))
        self.duration = np.zeros(m)
        self.enlarged = None
        """Where the last shot is that needed more room."""

    def again(self, k, log):
        """Work space for shot k alone with a log of that length: struck as before, ``r`` and ``here`` to be filled in."""
        one = Work(1, log, path=self.segments.shape[1] > 0)
        one.shots[0] = shot = self.shots[k]
        one.v[0, CUE], one.w[0, CUE] = shot[[VX, VY]], shot[[WX, WY, WZ]]
        return one

    def shot(self, k, physics):
        """Shot k as a ``Shot``."""
        n = self.n_events[k]
        events = np.zeros(n, EVENT)
        events["time"] = self.event_time[k, :n]
        for c, name in enumerate(("kind", "i", "j")):
            events[name] = self.event_what[k, :n, c]
        segments = self.segments[k, : self.n_segments[k]].copy()
        return Shot(self.r[k].copy(), self.potted[k].copy(), self.here[k].copy(), float(self.duration[k]), events, segments, physics)


@dataclass(frozen=True)
class Rules:
    """How visits are played: the same on every table."""

    shooter: Shooter
    plan: Plan
    reward: str
    limit: int = NEVER
    """Strokes after which a visit is truncated."""


class Visits:
    """n tables, each in the middle of its own visit."""

    def __init__(self, rules: Rules, n):
        self.rules, self.n = rules, n
        self.positions, self.on_table = np.zeros((n, N_BALLS, 2)), np.zeros((n, N_BALLS), np.bool_)
        self.game = np.zeros((n, 5), np.int64)
        self.game[:, BALL_ON], self.game[:, OVER] = -1, True
        self.streams = np.zeros((n, 2), np.uint64)
        shooter = rules.shooter
        self._options, self._noise = shooter.actions.pack(), shooter.noise.pack(BALL_RADIUS)
        self._phys, self._reward = shooter.physics.pack(), REWARDS.index(rules.reward)

    def seed(self, k, rng):
        """Give table k a new stream, its key drawn from a numpy Generator."""
        self.streams[k] = stream_of(rng)

    def get_state(self, k):
        """Table k as JSON types: the parts of a ``state.State`` but "rng"."""
        ball_on, in_hand, points, over, _ = self.game[k].tolist()
        return {
            "positions": self.positions[k].tolist(), "on_table": self.on_table[k].tolist(), "ball_on": ball_on, "in_hand": bool(in_hand),
            "points": points, "over": bool(over), "stream": self.streams[k].tolist(),
        }  # fmt: skip

    def set_state(self, k, state):
        """Take over a sound ``state.State`` on table k; its strokes are counted from 0."""
        self.positions[k], self.on_table[k] = state.positions, state.on_table
        self.game[k] = state.ball_on, state.in_hand, state.points, state.over, 0
        self.streams[k] = np.array(state.stream, np.uint64)

    def action_masks(self):
        """Which choices there are on each table: bool (n, discrete_actions.SIZE)."""
        out = np.empty((self.n, discrete_actions.SIZE), np.bool_)
        discrete_actions.masks(self.positions, self.on_table, self.game[:, BALL_ON].copy(), out)
        return out

    def play(self, actions, waiting, out, work, start=0, *, same_step=False):
        """One step of the m tables from ``start`` on: actions (m, k) float64 that were checked, results into ``out``.

        ``waiting`` (m,) bool: tables that begin a new visit instead of playing; ``same_step``: those whose visit ends begin a new one at
        once. Raises SimulationError if a shot cannot be computed: its balls are left as they lay, other tables may have been played.
        """
        here = slice(start, start + len(actions))
        r, v, w, on, shots = (a[: len(actions)] for a in (work.r, work.v, work.w, work.here, work.shots))
        positions, on_table, game, streams = (a[here] for a in (self.positions, self.on_table, self.game, self.streams))
        fidelity, n_steps = self.rules.shooter.fidelity
        _address(
            actions, waiting, positions, on_table, game, streams, self._options, self._noise, self._phys, fidelity, n_steps, r, v, w, on,
            shots,
        )  # fmt: skip
        m, work.enlarged = len(actions), None
        self._run(work, m)
        self._finish(work, waiting, here, out, m)
        if np.any(work.status[:m]):
            self._mend(work, waiting, here, out, m)
        wanted = out.terminated[here] | out.truncated[here] if same_step else waiting
        self.begin(wanted, out, start)

    def _run(self, work, m):
        shooter = self.rules.shooter
        table, (fidelity, n_steps) = shooter.table, shooter.fidelity
        engine.run_batch(
            work.r, work.v, work.w, work.here, work.potted, self._phys, table.noses, table.jaws, table.falls, fidelity, n_steps, MAX_EVENTS,
            work.event_time, work.event_what, work.segments, work.status, work.n_events, work.n_segments, work.duration, 0, m,
        )  # fmt: skip

    def _finish(self, work, waiting, here, out, m):
        _conclude(
            waiting, self.positions[here], self.on_table[here], self.game[here], work.r, work.potted, work.status[:m], work.duration,
            work.event_time, work.event_what, work.n_events, work.shots, self._reward, self.rules.limit, out.observations[here],
            out.rewards[here], out.terminated[here], out.truncated[here], out.reals[here], out.counts[here],
        )  # fmt: skip

    def _mend(self, work, waiting, here, out, m):
        """The shots that did not end: play those again whose log was full, with more room; the others are errors."""
        for k in np.flatnonzero(work.status[:m]).tolist():
            at = slice(here.start + k, here.start + k + 1)
            one, status = work, work.status[k]
            while status == Status.LOG_FULL:
                one = work.again(k, 4 * one.log)
                one.r[:], one.here[:] = self.positions[at], self.on_table[at]
                self._run(one, 1)
                status = one.status[0]
            if status != Status.OK:
                raise SimulationError(f"the shot on table {at.start} {_WHY[Status(status)]}")
            self._finish(one, waiting[k : k + 1], at, out, 1)
            work.enlarged = one

    def begin(self, wanted, out, start=0, *, others=False):
        """New visits on the tables from ``start`` on that are ``wanted``, with what a reset returns; ``others``: observe the rest too."""
        here = slice(start, start + len(wanted))
        dealt = bool(wanted.any())
        positions, on_table, game = self.positions[here], self.on_table[here], self.game[here]
        if dealt:
            deal_tables(wanted, self.rules.plan.code, self.rules.plan.tables, self.streams[here], positions, on_table)
        if dealt or others:
            _begin(
                wanted, others, self.rules.plan.in_hand, positions, on_table, game, out.observations[here], out.reals[here],
                out.counts[here], out.last_observations[here], out.last_reals[here], out.last_counts[here],
            )  # fmt: skip
