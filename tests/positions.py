"""How does a test of an agent get tables?"""

from snooker_env import SnookerVectorEnv
from snooker_env.planning import prospects_of
from tests.tables import begun


def tables(n, seed=0, **options):
    return begun(SnookerVectorEnv(n, **options), seed)


def chances_by_width(at, spread):
    """Chances of the pots, widest first, with the loss of 0.01 a metre of a stroke's score: (n, 16)."""
    return prospects_of(at, spread, (25.0, 0.15, 0.05, 0.01), most=16)[1]
