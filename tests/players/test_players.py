"""Is every player a function of positions and a seed, in visits and in frames?"""

import pickle
from itertools import product
from typing import ClassVar

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.benchmark import count_shots
from snooker_env.planning import Positions
from snooker_env.players import VISITS, ChoicePlayer, SeenPlayer, Strokes, decision_seeds
from snooker_env.players.degenerate import MODULE
from tests.positions import tables
from tests.processes import copy_of_package, python
from tests.refusals import refuse_each
from tests.tables import begun

SEARCHING = ("best_pot_30", "search_30", "planner_30", "tactician_30")
NAMES = ("random", "ghost_ball", "stroke_value", "strokes", "ppo_value", f"{MODULE}softest_away", *SEARCHING)


def of_visits(n, layout="random:6", seed=5):
    return Positions.of(tables(n, seed, layout=layout, threads=1))


def of_frames(n, steps=6):
    """Positions of frames in all phases: after fouls, with free balls, in hand."""
    options = {"task": "frame", "opponent": "ghost_ball", "noise": "club", "says": ["decision"]}
    env, rng = tables(n, 3, threads=1, **options), np.random.default_rng(0)
    for _ in range(steps):
        env.step(rng.uniform(-1, 1, env.action_space.shape).astype(np.float32))
    return Positions.of(env)


def same(one, other):
    names = ("values", "place", "nominate", "decision", "declare")
    return all(np.array_equal(getattr(one, n), getattr(other, n), equal_nan=True) for n in names)


@pytest.mark.parametrize(
    ("name", "where"),
    [
        pytest.param(name, where, marks=[pytest.mark.slow] * ("ppo" in name and where != "frames"))
        for name, where in product(NAMES, ("visits", "break_off", "frames"))
    ],
)
def test_every_player_is_a_function_of_a_position_and_a_seed(name, where):
    """However many are asked for, in whatever order, on whatever copy; what it ranks first it plays; positions stay."""
    if name.startswith("ppo_"):
        pytest.importorskip("sb3_contrib")
    at = of_frames(6) if where == "frames" else of_visits(6) if where == "visits" else of_visits(2, where)
    at = at[~at.over]
    rules = {"noise": "professional"} | ({"task": "frame", "says": ["decision"]} if where == "frames" else {})
    player, seeds, kept = sn.player(name).at(rules), np.arange(len(at)) % 3, at.copy()
    before = count_shots()
    together = player.play(at, seeds)
    assert name in SEARCHING or count_shots() == before
    assert all(np.array_equal(getattr(at, part), getattr(kept, part)) for part in ("positions", "game"))
    order = np.random.default_rng(1).permutation(len(at))
    assert same(player.play(at[order], seeds[order]), together[order])
    one = sn.player(name).at(rules)
    for k in range(len(at)):
        assert same(one.play(at[k : k + 1], seeds[k : k + 1]), together[k : k + 1])
    assert same(pickle.loads(pickle.dumps(player)).play(at, seeds), together)
    assert len(player.play(at[[]], [])) == 0
    if where == "visits" and name in ("random", *SEARCHING):
        assert not np.array_equal(player.play(at, seeds + 100).values, together.values)
    for k, ranked in enumerate(player.rank(at, seeds) if hasattr(player, "rank") else ()):
        assert np.array_equal(ranked.strokes.values[0], together.values[k])
        assert np.array_equal(ranked.strokes.place[0], together.place[k], equal_nan=True)
        assert ranked.scores is None or len(ranked.scores) == len(ranked.strokes)


def test_a_player_is_bound_before_it_is_asked():
    with pytest.raises(ValueError, match="must be bound first"):
        sn.player("search").play(of_visits(1), [0])
    player = sn.player("search_30").at({"noise": "none"})
    with pytest.raises(ValueError, match="seeds"):
        player.play(of_visits(2), [0])


class Soft:
    """Sees observations: aims by them, so that a wrong row shows."""

    options: ClassVar = {"aim": "absolute", "observation": "flat"}

    def act(self, observations, masks, seeds):
        assert masks is None and len(observations) == len(seeds)
        return np.stack([np.full(len(seeds), -0.5), *(0.1 * observations[:, :2].T), observations[:, 5]], 1)


class First:
    """Chooses the last available choice."""

    options: ClassVar = {"action": "discrete"}

    def act(self, observations, masks, seeds):
        return np.array([np.flatnonzero(row)[-1] for row in masks])


@pytest.mark.parametrize("seen", [Soft, First])
def test_what_sees_observations_plays_as_in_the_environment(seen):
    """The adapter's strokes and the environment's own reading of the same actions lead to the same balls."""
    n = 6
    tables = sn.SnookerVectorEnv(n, layout="random:6", threads=1, **seen.options)
    observations, _ = tables.reset(seed=5)
    at = Positions.of(tables)
    masks = tables.action_masks() if seen is First else None
    tables.step(seen().act(observations, masks, np.arange(n)))
    strokes = SeenPlayer(seen()).at({}).play(at, np.arange(n))
    other = begun(sn.SnookerVectorEnv(n, layout="random:6", threads=1, **VISITS), 5)
    other.step(strokes.actions(other.options, at))
    assert np.allclose(other.tables.positions, tables.tables.positions, atol=1e-6)


def test_seeds_of_decisions_depend_on_the_table_and_the_decision_alone():
    many = decision_seeds(7, np.arange(1000), 3)
    assert np.array_equal(decision_seeds(7, np.arange(400, 500), 3), many[400:500])
    assert len(set(many.tolist())) == 1000
    assert not np.array_equal(decision_seeds(7, np.arange(1000), 4), many) and many.min() >= 0
    assert many.max() < 2**32
    assert np.array_equal(decision_seeds(7, np.arange(3), np.array([3, 4, 5]))[:1], many[:1])


WRONG = """
sn.player("nobody") | player | 'nobody' | must be one of 'random'
sn.player("search_7") | player | 'search_7' | must end in a number of simulated shots from 8
sn.player("search@none") | player | 'search@none' | has learned nothing
sn.player("planner@nothing") | player | 'planner@nothing' | policy and value
sn.player("math:sqrt") | player | 'math:sqrt' | must be
sn.player(7) | player | int | must be a player
sn.player("") | player | '' | must be one of
sn.SnookerEnv(task="frame", opponent="planner_0") | opponent | 'planner_0' | must end in a number of simulated shots from 8
Strokes(STILL, nominate=[99]) | nominate[0] | 99 | must be one of
Strokes(STILL, nominate=[16.7]) | nominate[0] | 16.7 | must be one of
Strokes(STILL, decision=[9]) | decision[0] | 9 | must be one of
Strokes(STILL, declare=[-4]) | declare[0] | -4 | must be one of
Strokes(STILL, place=[(5.0, 5.0)]) | place[0] | [5.0, 5.0] | must be on the table
Strokes(STILL, place=[(0.1, np.nan)]) | place[0] | [0.1, nan] | must be on the table
"""


def test_what_is_no_player_and_no_code_is_refused():
    still = np.array([[2.0, 0.0, 0.0, 1.5, 0.0]])
    refuse_each(WRONG, {"sn": sn, "np": np, "Strokes": Strokes, "STILL": still})


# Without agents, PyTorch and Stable-Baselines3, as in a wheel

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
    names = "'random', 'ghost_ball', 'best_pot', 'search', 'planner', 'tactician', 'stroke_value', 'strokes'"
    assert out[0] == f"[{names}]" and "m/s" in "".join(out)
    assert out[-1] == "True True"


def test_a_player_of_choices_says_what_its_scores_lack():
    class Short(ChoicePlayer):
        def scores(self, at, seeds):
            return np.zeros((len(at), 5))

    class Missing(ChoicePlayer):
        pass

    at = sn.Position(cue=(0.0, 0.9), black=(0.4, 1.3))
    wrong = r"Short\.scores = array of shape \(1, 5\): must have shape \(1, 540\)"
    with pytest.raises(ValueError, match=wrong):
        Short().at({}).play(at, [1])
    with pytest.raises(NotImplementedError, match=r"Missing must have scores\(at, seeds\)"):
        Missing().at({}).rank(at, [1])


def test_ghost_ball_strikes_no_more_softly_than_anybody_can():
    """A red 0.3 mm away, where all but a stun shot would go in-off: as found in frames of ``examples.self_play``."""
    reds = [(-0.82954, 0.06201), (-0.77107, 0.03743)]
    position = sn.Position(cue=(-0.86, 0.0189), reds=reds, black=(0.0, 1.4605))
    strokes = sn.player("ghost_ball").at({}).play(sn.Positions.of([position] * 20), range(20))
    assert strokes.values[:, 0].tolist() == [0.2] * 20
