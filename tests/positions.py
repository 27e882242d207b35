"""How does a test of an agent get tables, and the positions on them to try shots from?"""

from agents.features.lookahead import Position
from snooker_env.envs.vector import SnookerVectorEnv


def tables(n, seed=0, **options):
    env = SnookerVectorEnv(n, **options)
    env.reset(seed=seed)
    return env


def position(env):
    v = env.visits
    return Position(v.positions.copy(), v.on_table.copy(), v.game.copy())
