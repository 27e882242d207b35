"""How does a test of an agent get tables?"""

from snooker_env import SnookerVectorEnv


def tables(n, seed=0, **options):
    env = SnookerVectorEnv(n, **options)
    env.reset(seed=seed)
    return env
