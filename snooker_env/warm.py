"""How is compiling paid for in advance? ``warmup`` runs everything once that a shot or a step needs."""

from .simulation import collide_balls, collide_cushion, simulate


def warmup():
    """Compile everything that a shot or a step of ``Snooker-v0`` needs, of one table or of many, or load it from the cache.

    Call it in the parent before worker processes start: otherwise each of them compiles everything by itself.
    """
    from .envs.snooker import SnookerEnv  # not at the top: this module is part of the light import

    for task in ("visit", "frame"):
        env = SnookerEnv(task=task, aim="target", noise="club", placement=True)
        env.reset(seed=0)
        env.step([0.0] * 6)
    simulate([(0.0, 0.0)], [(1.0, 0.0)], [(0.0, 0.0, 0.0)]).at(0.1)
    collide_balls((1, 0, 0), (0, 0, 0), (0, 0, 0), (0, 0, 0), (1, 0, 0))
    collide_cushion((1, 0, 0), (0, 0, 0), (1, 0, 0))
