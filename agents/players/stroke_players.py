"""How do players search over continuous strokes? By a rule of thumb, for the pot alone, or with a learned value and policy.

``planner`` plays with the weights that were trained under the table's execution noise, as far as there are such:

* "planner" judges by the learned value and looks at the strokes that the learned policy proposes;
* "planner_value" judges by the value and looks at evenly spread strokes, "planner_policy" the other way round: what is each worth?
* "lookahead" does neither, and "search" is "lookahead" with 2,000 simulated shots;
* "best_pot" plays the likeliest pot without regard to what follows.

A name may end in a number of simulated shots a decision and in a model: planner_500, planner@runs/ppo_value-0, planner_60@ppo_value_club.
"""

import re
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from snooker_env.checks import refuse
from snooker_env.planning import Positions, StrokeSearch
from snooker_env.tasks import LEVELS

BUDGET = 120
"""Simulated shots of a decision where the name says nothing."""
NAMES = ("best_pot", "lookahead", "planner", "planner_value", "planner_policy")
LEARNED = "ppo_value"
"""The pre-trained model of a professional's errors; those of another level have its name after it."""
_FORM = re.compile(r"(best_pot|lookahead|planner_value|planner_policy|planner)(?:_(\d{1,7}))?(?:@(.+))?")


def is_stroke_player(name):
    """Whether ``stroke_player`` knows that name."""
    return _FORM.fullmatch(name) is not None


def by_noise(name):
    """Whether that is a planner that names no model: it plays the pre-trained one of the noise that it meets."""
    form = _FORM.fullmatch(name)
    return form is not None and form[1].startswith("planner") and form[3] is None


def stroke_player(name, seed=0):
    """The player of that name. Raises ValueError if its model or its budget is unfit."""
    form = _FORM.fullmatch(name)
    if form is None:
        raise refuse("agent", name, f"must be {', '.join(NAMES)}, with _SHOTS and @MODEL after it if you wish")
    kind, budget, model = form.groups()
    if model is not None and not kind.startswith("planner"):
        raise refuse("agent", name, f"must not name a model: {kind} has learned nothing")
    if model is not None:
        _trained(model)
    return StrokePlayer(kind, int(budget) if budget else BUDGET, model, seed)


class StrokePlayer:
    """A player that plays the best stroke of a ``StrokeSearch``.

    Parameters
    ----------
    kind : str
        One of ``NAMES``.
    budget : int
        Simulated shots a decision, at least 8.
    model : str or policy, optional
        The model with value and policy: a pre-trained one, its .zip or a run's folder, or the policy. Default: by the noise of the tables.
    seed : int
        Of the proposals and noise samples.

    Examples
    --------
    >>> from agents.players.stroke_players import stroke_player
    >>> stroke_player("lookahead_60").budget
    60
    """

    options = {"aim": "absolute"}  # noqa: RUF012 - a player's options are read, never changed

    def __init__(self, kind, budget=BUDGET, model=None, seed=0):
        self.kind, self.budget, self.model = kind, budget, model
        self._seed, self._decisions, self._first = seed, 0, 0
        self._tables: Any = None
        self.search: Any = None
        """The ``StrokeSearch`` on the present tables; None before the first decision."""
        StrokeSearch({}, budget)  # checks the budget

    def tables_of(self, first, total):
        """Its tables are a part of ``total``, from ``first`` on: each gets the same seeds in any part."""
        self._first = first

    def act(self, tables, observations, going):
        """The best stroke of each running table: float32 (n, 4)."""
        actions = np.zeros((len(going), 4), np.float32)
        actions[going] = self._ranked(tables, going).actions()[:, 0]
        return actions

    def rank(self, tables, observations, going):
        """The strokes of each running table that met most noise samples, best first, with their scores [points]."""
        ranked = self._ranked(tables, going)
        last = np.minimum((ranked.samples == ranked.samples.max(axis=1, keepdims=True)).sum(axis=1), 10)
        return [(actions[:m], scores[:m]) for actions, scores, m in zip(ranked.actions(), ranked.scores, last.tolist(), strict=True)]

    def _ranked(self, tables, going):
        if self._tables is not tables:
            self._tables, self.search = tables, self._new_search(tables)
        # each table and decision its own: what is drawn on one says nothing of another
        seeds = np.random.SeedSequence([self._seed, self._decisions]).generate_state(self._first + len(going))[self._first :][going]
        self._decisions += 1
        return self.search.rank(Positions.of(tables)[going], seeds)

    def _new_search(self, tables):
        search = StrokeSearch(tables, self.budget, pots_only=self.kind == "best_pot")
        if self.kind.startswith("planner"):
            from snooker_env.planning.learned.policy_proposals import PolicyProposals

            from ..learning.value_network import value_of

            model = self.model or model_for(search.noise)
            policy = _trained(model) if isinstance(model, str) else model
            if self.kind != "planner_policy":
                search.value = value_of(policy.position_value, search.spread, search.planner.threads)
            if self.kind != "planner_value":
                search.propose = PolicyProposals(policy.fused)
        return search


def model_for(noise):
    """The pre-trained model for an execution noise: that of its own level, else that of the level with the nearest error of direction."""
    from ..learning.models import pretrained

    own = {level: LEARNED if level == "professional" else f"{LEARNED}_{level}" for level in LEVELS}
    there = {level: name for level, name in own.items() if name in pretrained()}
    if not there:
        raise refuse("agent", "planner", f"must name a model (planner@MODEL): there is no {LEARNED} in agents/pretrained")
    wanted = np.log(noise.direction_deg() + 1e-3)
    return there[min(there, key=lambda level: abs(np.log(LEVELS[level].direction_deg() + 1e-3) - wanted))]


@cache
def _trained(model):
    """The policy of a model, with its value of positions. Raises ValueError if it has none."""
    from ..learning.models import PRETRAINED, load_trained, pretrained

    path = PRETRAINED / f"{model}.zip" if model in pretrained() else Path(model)
    if not path.exists():
        raise refuse("agent", f"planner@{model}", f"must name a model: {', '.join(pretrained())}, a .zip or a run's folder")
    policy = load_trained(path, "agent").policy
    if not hasattr(policy, "position_value"):
        raise refuse("agent", f"planner@{model}", f"must be a model of {LEARNED}: this one holds no value of positions")
    return policy
