"""What are choices worth by the search's rule of thumb? A task of imitation: each is simulated once."""

import numpy as np

from snooker_env.planning import Planner, Positions, prospects_of

from .self_play import of_choices, once


def play(shared, args, threads):
    """The task. ``shared``: "run" (an id), "options", "spread", "ahead"; ``args``: of ``self_play.choices``."""
    planner = once(("worths", shared["run"], threads), lambda: Planner(shared["options"], threads=threads))
    points, goes_on, left, _ = planner.play(Positions(*args["at"]), args["rows"], args["picks"], args["keys"])
    ahead = prospects_of(left, shared["spread"], threads=planner.threads)[0]
    return {"worth": points + shared["ahead"] * goes_on * ahead}


def worths(where, shared, at, rows, picks, keys):
    """The task for all positions: float64 (k,)."""
    slices = where.map(f"{__name__}:play", shared, of_choices(at, rows, picks, keys))
    return np.concatenate([one["worth"] for one in slices])
