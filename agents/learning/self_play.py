"""How is a round of self-play simulated, here or by many workers? In slices, by the weights of the learner.

The learner draws all random numbers, and no position's results depend on those beside it (``dense_layers``):
a training does not depend on the number of workers, nor on one that dies and whose slice is computed again.
"""

from copy import copy
from functools import wraps
from itertools import pairwise

import numpy as np

from snooker_env import Options
from snooker_env.benchmark import simulated
from snooker_env.planning import Planner, Positions, StrokeSearch, prospects_of
from snooker_env.planning.learned.value_features import SIZE, value_features

SLICE = 64
"""Positions of a slice."""
_MADE = 4
"""Searches, planners and networks that a process keeps."""
_made = {}


def positions_given(at):
    """``Positions`` of visits as a tuple of arrays, with the constants of their tables or None."""
    return at.positions, at.on_table, at.game, None, at.conditions


def policy_for(model, where):
    """The policy for slices: itself in this process, for another its weights and how to build it."""
    if where.here:
        return model.policy
    weights = {name: one.numpy() for name, one in model.policy.state_dict().items()}
    return {"recipe": model.recipe, "env_options": model.env_options, "weights": weights}


def counted(task):
    """The task, whose result also has "simulated" (1,): the shots that it has simulated."""

    @wraps(task)
    def run(shared, args, threads):
        before = simulated()
        made = task(shared, args, threads)
        return made | {"simulated": np.array([simulated() - before])}

    return run


@counted
def strokes(shared, args, threads):
    """The task: the best stroke of each position under fresh noise samples, and where play goes on.

    ``shared``: "run" (an id), "options", "budget", "fresh", "value" (or None), "policy" (or None, see
    ``policy_for``). ``args``: "at" (arrays of m positions), "seeds" (m,), "explored" bool (m,), "pick"
    (m,), "errors" (m, fresh + 1, 5). Returns "seen" (m, SIZE) and "after" (m, fresh, SIZE) float16, "points"
    and "goes_on" (m, fresh), "follows" (m,), and where play goes on: "positions", "on_table", "game".
    """
    at, fresh, every = Positions(*args["at"]), shared["fresh"], np.arange(len(args["seeds"]))
    # the original keeps its value, the rule of thumb, and its proposals
    search = copy(search_of(shared, threads))
    if shared["value"] is not None:
        search.value = shared["value"]
    if shared["policy"] is not None:
        search.propose = _proposals(shared)
    m = len(every)
    ranked = search.rank(at, args["seeds"])
    rows = np.concatenate([np.repeat(every, fresh), every])
    best, picked = ranked.strokes[:, 0], ranked.strokes[every, args["pick"]]
    tried = np.concatenate([np.repeat(best, fresh, axis=0), picked])
    errors = np.concatenate([args["errors"][:, :fresh].reshape(-1, 5), args["errors"][:, fresh]])
    out = search.outcomes(at, rows, tried, errors)
    features = lambda some: value_features(some, search.spread, search.planner.threads)  # noqa: E731
    goes_on = out.goes_on[: m * fresh]
    after = np.zeros((m * fresh, SIZE), np.float16)
    after[goes_on] = features(out.afterstates[np.flatnonzero(goes_on)])
    played = np.where(args["explored"], m * fresh + every, fresh * every)
    left = out.afterstates[played]
    made = {"seen": features(at).astype(np.float16), "after": after.reshape(m, fresh, SIZE)}
    made |= {"points": out.points[: m * fresh].reshape(m, fresh), "goes_on": goes_on.reshape(m, fresh)}
    made |= {"follows": out.goes_on[played], "positions": left.positions}
    return made | {"on_table": left.on_table, "game": left.game}


@counted
def choices(shared, args, threads):
    """The task: discrete choices' points and the value of what they leave, each simulated once.

    ``args``: "at" (arrays of m positions), "rows", "picks" and "keys" (k,). Returns "gains", float32 (k,).
    """
    options = Options(action="discrete", **shared["options"])
    planner = once(("planner", shared["run"], threads), lambda: Planner(options, threads=threads))
    played = planner.play(Positions(*args["at"]), args["rows"], args["picks"], args["keys"])
    gains, on = played.points.astype(np.float32), np.flatnonzero(played.goes_on)
    gains[on] += shared["value"](played.afterstates[on])
    return {"gains": gains}


@counted
def trials(shared, args, threads):
    """The task: what choices are worth by the search's rule of thumb, each simulated once, "worth" (k,).

    ``shared``: "run" (an id), "options", "spread" and "ahead"; ``args``: as of ``choices``.
    """
    planner = once(("worths", shared["run"], threads), lambda: Planner(shared["options"], threads=threads))
    points, goes_on, left, _ = planner.play(Positions(*args["at"]), args["rows"], args["picks"], args["keys"])
    ahead = prospects_of(left, shared["spread"], threads=planner.threads)[0]
    return {"worth": points + shared["ahead"] * goes_on * ahead}


def in_slices(n):
    """Slices of n positions."""
    return [slice(k, min(n, k + SLICE)) for k in range(0, n, SLICE)]


def judged(where, shared, at, rows, picks, keys, task="choices", of="gains"):
    """What a task says of choices in the sorted ``rows`` (k,): ``choices`` "gains", ``trials`` "worth"; and the
    shots simulated for it."""
    many, cut = [], in_slices(len(at))
    ends = np.searchsorted(rows, [0, *(one.stop for one in cut)]).tolist()
    for one, (first, end) in zip(cut, pairwise(ends), strict=True):
        its = {"picks": picks[first:end], "keys": keys[first:end]}
        many.append({"at": positions_given(at[one]), "rows": rows[first:end] - one.start, **its})
    made = where.map(f"{__name__}:{task}", shared, many)
    return np.concatenate([one[of] for one in made]), sum(int(one["simulated"][0]) for one in made)


def search_of(shared, threads):
    """The ``StrokeSearch`` of a training, made once in a process."""
    key = "search", shared["run"], threads
    return once(key, lambda: StrokeSearch(shared["options"], shared["budget"], threads=threads))


def once(key, make):
    """What ``make`` returns, kept for the next time; the oldest of more than ``_MADE`` goes."""
    if key not in _made:
        while len(_made) >= _MADE:
            del _made[next(iter(_made))]
        _made[key] = make()
    return _made[key]


def _proposals(shared):
    """The proposals of the policy that came."""
    from snooker_env.planning.learned.policy_proposals import PolicyProposals

    policy = shared["policy"]
    if not isinstance(policy, dict):
        return PolicyProposals(policy.fused)
    import torch

    made = {name: policy[name] for name in ("recipe", "env_options")}
    network = once(("network", shared["run"]), lambda: _network(**made))
    network.load_state_dict({name: torch.from_numpy(one.copy()) for name, one in policy["weights"].items()})
    return PolicyProposals(network.fused)


def _network(recipe, env_options):
    """The untrained network of a recipe."""
    from snooker_env import SnookerVectorEnv

    from ..features.observed import space_of
    from .hyperparameters import Recipe

    tables = SnookerVectorEnv(1, **env_options)
    made = Recipe.of(recipe, env_kwargs=env_options)
    return made.new_network(space_of(), tables.single_action_space)
