"""How do value, policy and planner improve each other? By expert iteration (Anthony, Tian & Barber 2017).

The planner plays visits. It judges strokes by the value (at first by a rule of thumb) and takes its proposals from the
policy. The value learns from a backup at every position (``value_learning``). The policy learns the values of choices,
each simulated once and judged by the value (``judged_choices``).

PPO then improves the policy further, with the value as reward-to-go: ``judge_rewards``.
"""

from typing import Any

import numpy as np

from snooker_env import SnookerVectorEnv
from snooker_env.benchmark import count_shots
from snooker_env.planning import Positions, Search, VisitJudge
from snooker_env.planning.learned.stroke_policy import PolicyProposals
from snooker_env.planning.learned.value_features import SIZE, value_features

from .hyperparameters import SHOT_OPTIONS
from .judged_choices import JudgedChoices
from .loop import Part
from .value_learning import ValueLearning
from .value_network import value_of

BUDGET = 60
"""Simulated shots per decision in training."""
FRESH = 4
"""Fresh noise samples of the best stroke for a target."""
EXPLORED, AMONG = 0.2, 12
"""Share of exploratory strokes, drawn from the best ``AMONG``."""
_EACH = ("random:12", "random:9", "random:6", "random:3", "line_up")
STARTS = (("", 0.6), *((name, 0.06) for name in _EACH), ("colours", 0.1))
"""Layouts of the starting positions of visits, with their shares; "" is the layout of the training tables."""
POOL = 4096
"""Number of starting positions over all layouts."""
HAND, EVEN = 6_144, 30_720
"""Positions judged by the rule of thumb, and positions with even proposals; at most an eighth and a fifth of all."""
_ALL = ("positions", "on_table", "game", "conditions")
"""Fields of positions in visits; the constants of their tables only if these are drawn."""


class Starts:
    """Starting positions of visits, drawn from several layouts."""

    def __init__(self, seed, layout, options):
        self._pools = []
        for k, (name, share) in enumerate(STARTS):
            n = int(POOL * share)
            tables = SnookerVectorEnv(n, layout=name or layout, **options)
            tables.reset(seed=np.random.SeedSequence([seed, k]).generate_state(n).tolist())
            self._pools.append(Positions.of(tables))
            tables.close()

    def draw(self, n, rng):
        """n positions."""
        which = rng.choice(len(STARTS), n, p=[share for _, share in STARTS])
        rows = (rng.random(n) * [len(self._pools[k]) for k in which]).astype(np.int64)
        parts = [self._pools[k][row : row + 1] for k, row in zip(which.tolist(), rows.tolist(), strict=True)]
        names = ("positions", "on_table", "game") if parts[0].conditions is None else _ALL
        joined: Any = {name: np.concatenate([getattr(one, name) for one in parts]) for name in names}
        return Positions(**joined)


class ExpertIteration(Part):
    """Expert iteration over ``total`` positions. ``before`` comes from ``get_state``, with the model of that time.

    No result depends on the number of ``threads``.
    """

    what, unit, now = "expert iteration", "positions", "this round of positions"
    _at: Positions

    def __init__(self, model, venv, total, seed, threads, before=None):
        self._model, self._venv, self.total, self._seed, self._threads = model, venv, total, seed, threads
        self._n, self._before = venv.num_envs, before
        self._done, self.curve, self._spent, self._shots = (
            (before[name] for name in ("done", "curve", "seconds", "shots")) if before else (0, [], 0.0, 0)
        )

    @property
    def done(self):
        return self._done

    @property
    def shots(self):
        """Shots simulated so far."""
        return self._shots + self._choices.shots

    def begin(self):
        n, threads, before, venv = self._n, self._threads, self._before, self._venv
        rng = self._rng = np.random.default_rng((self._seed, 19))
        tables = venv.unwrapped.tables
        options = {name: getattr(tables.options, name) for name in SHOT_OPTIONS}
        self._judge = VisitJudge(options, threads=threads)  # judged by the rule of thumb
        self._search = Search(self._judge, BUDGET)  # even proposals
        self._starts = Starts(self._seed, tables.options.layout, options)
        self._value = ValueLearning(self._model.policy.position_value, self._judge.spread, n, rng)
        self._choices = JudgedChoices(self._model.policy, options, threads, n, rng)
        if before is None:
            venv.seed(self._seed)
        venv.reset()  # the tables wait for PPO; in a resumed run this applies their given state
        if before is None:
            self._at = self._starts.draw(n, rng)
        else:
            rng.bit_generator.state = before["rng"]
            self._at = Positions(*before["at"])
            self._value.set_state(before["value"])
            self._choices.set_state(before["choices"])

    def get_state(self):
        """The state without the model and the process's random generators; most of it consists of positions."""
        made = {name: getattr(self, name) for name in ("done", "curve", "seconds")} | {"shots": self._shots}
        if self.done >= self.total:
            return made
        at = self._at
        made |= {"rng": self._rng.bit_generator.state}
        made |= {"at": (at.positions, at.on_table, at.game, None, at.conditions)}
        return made | {"value": self._value.get_state(), "choices": self._choices.get_state()}

    def round(self):
        """Play a stroke from every position and learn. Each twentieth of the run adds an entry to ``curve``."""
        hand, even = min(HAND, self.total // 8), min(EVEN, self.total // 5)
        remaining = 1.0 - self.done / self.total
        if self.done > hand:
            self._judge.value = self._value.value()
            self._choices.round(self._at, self._judge.value, remaining)
        if self.done >= even:
            self._search.propose = (PolicyProposals(self._model.policy.fused),)
        self._play()
        self._done += self._n
        if self.done > hand:
            self._value.fit(remaining)
        if self.done * 20 // self.total > len(self.curve):
            so_far = {"states": self.done, "simulated_shots": self.shots}
            self.curve.append({**so_far, "seconds": round(self.seconds, 1), **self._figures()})

    def _figures(self):
        """Mean losses of the last gradient steps, and the points that the value expects; None before the first."""
        both = {"loss": self._choices.losses, "value_loss": self._value.losses}
        figures = {name: round(float(np.mean(one)), 3) if one else None for name, one in both.items()}
        value = self._value.mean_target
        return figures | {"value": None if value is None else round(value, 2)}

    @property
    def figures(self):
        """The losses and the number of the round, in words."""
        words = {"loss": "loss {:.1f}", "value_loss": "value loss {:.2f}", "value": "{:.1f} points expected"}
        known = {name: value for name, value in self._figures().items() if value is not None}
        known_words = [words[name].format(value) for name, value in known.items()]
        rounds = f"round {-(-self.done // self._n):,} of {-(-self.total // self._n):,}"
        return ", ".join([rounds, *known_words])

    def _play(self):
        """Choose a stroke for each position, keep the results of its samples, and continue from one of them."""
        n, rng, at, every = self._n, self._rng, self._at, np.arange(self._n)
        seeds, explored = rng.integers(2**32, size=n), rng.random(n) < EXPLORED
        before = count_shots()
        tried = [one.strokes.values[:AMONG] for one in self._search.rank(at, seeds)]
        pick = rng.integers(min(map(len, tried)), size=n)
        errors = self._judge.noise.draw_errors(rng, n * (FRESH + 1))
        strokes = [np.repeat([one[0] for one in tried], FRESH, axis=0)]
        strokes.append(np.array([one[k] for one, k in zip(tried, pick.tolist(), strict=True)]))
        rows = np.concatenate([np.repeat(every, FRESH), every])
        out = self._judge.planner.play_strokes(at, rows, np.concatenate(strokes), errors=errors)
        self._shots += count_shots() - before
        goes_on = out.goes_on[: n * FRESH]
        after = np.zeros((n * FRESH, SIZE), np.float16)
        after[goes_on] = self._features(out.afterstates[np.flatnonzero(goes_on)])
        played = np.where(explored, n * FRESH + every, FRESH * every)
        follows, left = out.goes_on[played], out.afterstates[played]
        points, goes_on = out.points[: n * FRESH].reshape(n, FRESH), goes_on.reshape(n, FRESH)
        seen = self._features(at).astype(np.float16)
        self._value.add(seen, after.reshape(n, FRESH, SIZE), points, goes_on, follows & ~explored)
        # a visit keeps its table
        self._at = Positions(left.positions, left.on_table, left.game, None, at.conditions)
        ended = np.flatnonzero(~follows)
        if len(ended):
            fresh = self._starts.draw(len(ended), rng)
            for name in _ALL:
                if getattr(fresh, name) is not None:
                    getattr(self._at, name)[ended] = getattr(fresh, name)
        self._at.game[:, 2] = (
            0  # points of the visit so far, because no break may exceed the maximum of the table
        )

    def _features(self, at):
        return value_features(at, self._judge.spread, self._threads)


def judge_rewards(venv, policy, threads):
    """Let the tables add the learned value of the afterstate to rewards, as reward-to-go for gamma = 0."""
    rules = venv.unwrapped.tables.options.rules
    venv.judge = value_of(policy.position_value, rules.noise.spread(rules.physics), threads)
