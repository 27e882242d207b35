"""Has the package alone, as in a wheel, its best player, without PyTorch and Stable-Baselines3?"""

from tests.processes import copy_of_package, python

ALONE = """if True:
    import importlib.abc, sys

    class Barred(importlib.abc.MetaPathFinder):
        def find_spec(self, name, path=None, target=None):
            if name.partition(".")[0] in "agents commands torch stable_baselines3 sb3_contrib yaml".split():
                raise ModuleNotFoundError(f"No module named {name!r}", name=name)

    sys.meta_path.insert(0, Barred())
    import numpy as np, snooker_env as sn
    from snooker_env.benchmark import play_visits

    assert sn.__file__.startswith(sys.argv[1]), sn.__file__
    position = sn.Position(cue=(0.1, 0.3), reds=[(0.4, 1.2)], black=(0.0, 1.4605))
    print(sn.players())
    print(sn.advise(position, agent="planner", samples=20, visits=2, n=1))
    env = sn.SnookerEnv(task="frame", opponent="planner", noise="professional")
    env.reset(seed=0)
    replies, over = 0, False
    while not replies and not over:
        _, _, over, _, info = env.step([-0.5, 0.0, 0.0, 0.5])
        replies += info["opponent_strokes"]
    print(replies > 0, play_visits("planner_30", 2).points.sum() > 0)
"""


def test_the_planner_plays_in_the_package_alone(tmp_path):
    copy_of_package(tmp_path)
    code = f"import sys; sys.argv[1:] = [{str(tmp_path)!r}]\n{ALONE}"
    out = python(code, at=tmp_path)[0].strip().splitlines()
    assert out[0] == "['random', 'ghost_ball', 'best_pot', 'search', 'planner']" and "m/s" in "".join(out)
    assert out[-1] == "True True"
