"""How does a test ask what shot an action means? The action is played, and the record of the cue is read."""

from math import degrees

import numpy as np

from snooker_env import SnookerEnv
from snooker_env.game.balls import BallOn
from snooker_env.tasks.visit import BALL_ON


def shot(actions, a, positions, on_table, on, physics="paper"):
    """(speed, side, top, aim of the cue, elevation) of the action ``a`` of ``Actions``, with a free cue; a red is on."""
    elevation = degrees(actions.steepest) if actions.elevation else False
    env = SnookerEnv(aim=actions.aim, elevation=elevation, physics=physics)
    env.reset(seed=0)
    env.tables.positions[0], env.tables.on_table[0] = positions, on_table
    env.tables.game[0, BALL_ON] = BallOn.RED
    assert actions.aim == "absolute" or env.tables.on(0) == on
    env.keep_history = True
    env.step(np.asarray(a)[: env.action_space.shape[0]])
    return tuple(env.history[-1].cue.values())
