"""How do value, policy and planner make each other stronger? Expert iteration (Anthony, Tian & Barber 2017).

Visits are played by the planner, which judges strokes by the value and takes its proposals from the policy; at
first by the rule of thumb. The value learns by a backup from every position (``value_learning``), and the
policy the values of choices, each simulated once and judged by the value (``judged_choices``). Simulations,
two thirds of the time, are played in slices by ``where``: this process or a cluster.

PPO then improves the policy further, with the value as reward-to-go: ``judge_rewards``.
"""

import time
import uuid
from typing import Any

import numpy as np

from snooker_env import SnookerVectorEnv
from snooker_env.planning import Positions, StrokeSearch, spread_of

from ..cluster.job import Here
from .hyperparameters import SHOT_OPTIONS
from .imitation import round_of
from .judged_choices import JudgedChoices
from .self_play import in_slices, policy_for, positions_given
from .value_learning import ValueLearning
from .value_network import value_of

BUDGET = 60
"""Simulated shots of a decision in training."""
FRESH = 4
"""Fresh noise samples of the best stroke for a target."""
EXPLORED, AMONG = 0.2, 12
"""Share of exploratory strokes, each one of the best ``AMONG``."""
_EACH = ("random:12", "random:9", "random:6", "random:3", "line_up")
STARTS = (("", 0.6), *((name, 0.06) for name in _EACH), ("colours", 0.1))
"""Layouts in which visits begin, and their shares; "" is the layout of the training tables."""
POOL = 4096
"""Positions in which visits begin, of all layouts."""
HAND, EVEN = 6_144, 30_720
"""Positions judged by the rule of thumb, and with even proposals; at most an eighth and a fifth of all."""
_ALL = ("positions", "on_table", "game", "conditions")
"""What positions of visits hold; constants of their tables only if these are drawn."""


class Starts:
    """Positions in which visits begin, drawn from several layouts."""

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


class ExpertIteration:
    """Expert iteration in ``states`` positions; it has the interface of ``imitation.Imitation``.

    ``before``: of ``get_state``, with the model restored: the result equals that of an uninterrupted run, bit for
    bit. ``where``: who plays the slices, ``Here`` or a ``Cluster``; the result does not depend on it.
    """

    def __init__(self, model, venv, states, seed, threads, before=None, where=None):
        tables = venv.unwrapped.tables
        options = {name: getattr(tables.options, name) for name in SHOT_OPTIONS}
        self.states, self._n, self._rng = states, venv.num_envs, np.random.default_rng((seed, 19))
        self._model, self._where = model, where or Here(threads)
        self._sent = {"run": uuid.uuid4().hex, "options": options, "budget": BUDGET, "fresh": FRESH}
        self._sent |= {"value": None, "policy": None}  # the rule of thumb, even proposals
        search = StrokeSearch(options, BUDGET)
        self._looks = search.strokes_tried
        self._starts = Starts(seed, tables.options.layout, options)
        self._value = ValueLearning(model.policy.position_value, search.spread, self._n, self._rng)
        self._choices = JudgedChoices(model.policy, options, threads, self._n, self._rng, self._where)
        self.done, self.curve, self._seconds, self._shots = 0, [], 0.0, 0
        if before is None:
            venv.seed(seed)
        venv.reset()  # the tables wait for PPO; of a resumed run this takes the state that they were given
        if before is None:
            self._at = self._starts.draw(self._n, self._rng)
        else:
            self._rng.bit_generator.state = before["rng"]
            self._at = Positions(*before["at"])
            self._value.set_state(before["value"])
            self._choices.set_state(before["choices"])
            self.done, self.curve, self._seconds = (before[name] for name in ("done", "curve", "seconds"))
            self._shots = before["shots"]
        self._began = time.perf_counter()

    @property
    def seconds(self):
        """Duration so far [s]."""
        return self._seconds + time.perf_counter() - self._began

    def get_state(self):
        """The state, beside the model and the process's random generators; most of it are positions."""
        made = {name: getattr(self, name) for name in ("done", "curve", "seconds")}
        made |= {"rng": self._rng.bit_generator.state, "at": positions_given(self._at), "shots": self._shots}
        return made | {"value": self._value.get_state(), "choices": self._choices.get_state()}

    def round(self):
        """Play a stroke from every position and learn; each twentieth of all is an entry of ``curve``."""
        hand, even = min(HAND, self.states // 8), min(EVEN, self.states // 5)
        remaining = 1.0 - self.done / self.states
        learned = self.done > hand
        if learned:
            self._sent["value"] = self._value.value()
            self._choices.round(self._at, self._sent["value"], remaining)
        if self.done >= even:
            self._sent["policy"] = policy_for(self._model, self._where)
        self._play()
        self.done += self._n
        if self.done > hand:
            self._value.fit(remaining)
        if self.done * 20 // self.states > len(self.curve):
            so_far = {"states": self.done, "simulated_shots": self._shots + self._choices.shots}
            self.curve.append({**so_far, "seconds": round(self.seconds, 1), **self._figures()})

    def _figures(self):
        """Mean losses of the last gradient steps, and the points that the value expects; None before any."""
        both = {"loss": self._choices.losses, "value_loss": self._value.losses}
        figures = {name: round(float(np.mean(one)), 3) if one else None for name, one in both.items()}
        value = self._value.mean_target
        return figures | {"value": None if value is None else round(value, 2)}

    @property
    def figures(self):
        """The same and the number of the round, in words."""
        words = {"loss": "loss {:.1f}", "value_loss": "value loss {:.2f}", "value": "{:.1f} points expected"}
        known = {name: value for name, value in self._figures().items() if value is not None}
        known_words = [words[name].format(value) for name, value in known.items()]
        return ", ".join([round_of(self.done, self.states, self._n), *known_words])

    def _play(self):
        """Choose a stroke for each position, keep what its samples lead to, and go on with one of them."""
        n, rng, at = self._n, self._rng, self._at
        seeds, explored = rng.integers(2**32, size=n), rng.random(n) < EXPLORED
        pick = rng.integers(min(AMONG, self._looks), size=n)
        errors = rng.standard_normal((n * (FRESH + 1), 5))
        errors = np.concatenate([errors[: n * FRESH].reshape(n, FRESH, 5), errors[n * FRESH :, None]], axis=1)
        drawn = {"seeds": seeds, "explored": explored, "pick": pick, "errors": errors}
        slices = [
            {"at": positions_given(at[k]), **{name: one[k] for name, one in drawn.items()}}
            for k in in_slices(n)
        ]
        played = self._where.map("agents.learning.self_play:strokes", self._sent, slices)
        made = {name: np.concatenate([one[name] for one in played]) for name in played[0]}
        self._shots += int(made["simulated"].sum())
        follows = made["follows"]
        self._value.add(made["seen"], made["after"], made["points"], made["goes_on"], follows & ~explored)
        # a visit keeps its table
        self._at = Positions(made["positions"], made["on_table"], made["game"], None, at.conditions)
        ended = np.flatnonzero(~follows)
        if len(ended):
            fresh = self._starts.draw(len(ended), rng)
            for name in _ALL:
                if getattr(fresh, name) is not None:
                    getattr(self._at, name)[ended] = getattr(fresh, name)
        self._at.game[:, 2] = 0  # points of the visit so far: no break may exceed what a table allows


def judge_rewards(venv, policy, threads):
    """Let the tables add the learned value of the afterstate to rewards: reward-to-go for gamma = 0."""
    rules = venv.unwrapped.tables.options.rules
    venv.judge = value_of(policy.position_value, spread_of(rules.noise, rules.physics), threads)
