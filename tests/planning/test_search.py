"""Does the search play as the table would, within its budget, and rank by the scores of its docstring?"""

import numpy as np
import pytest

from snooker_env.benchmark import count_shots
from snooker_env.game.balls import SPOTS
from snooker_env.game.frame_columns import FREE_BALL
from snooker_env.planning import (
    RULE_OF_THUMB,
    Planner,
    Position,
    Positions,
    Search,
    Strokes,
    VisitJudge,
    at_pots,
    clear_paths,
    pots,
    prospects_of,
)
from snooker_env.planning.judges import FOUL, LEFT, schedule
from snooker_env.planning.search import PRIOR
from snooker_env.planning.sobol import normal_points
from snooker_env.tasks.noise import Noise
from snooker_env.tasks.options import Options
from tests.positions import tables

OPTIONS = {"noise": "club", "fidelity": "fast"}
LOUD = {"aim_deg": 0.3, "speed_rel": 0.05, "speed_abs": 0.05, "offset_mm": 5.0, "elevation_deg": 2.0}
"""Its tip errors are a fifth of R: many leave the disc."""


def some(n=6, layout="random:6", seed=2):
    return Positions.of(tables(n, layout=layout, seed=seed))


def search(budget=30, options=OPTIONS, propose=at_pots, **more):
    return Search(VisitJudge(options, **{"threads": 1} | more), budget, propose)


def told(ranked):
    """What a ranking of one position tells."""
    return ranked.strokes.values, ranked.scores, ranked.samples, ranked.kinds


def same(one, other):
    """Whether two rankings of positions are equal."""
    return all(
        np.array_equal(a, b)
        for mine, theirs in zip(one, other, strict=True)
        for a, b in zip(told(mine), told(theirs), strict=True)
    )


def first(ranked):
    """The best strokes (n, 5) of rankings."""
    return np.stack([one.strokes.values[0] for one in ranked])


def by_place(at):
    """A made-up value [points]: how far up the table the cue ball is, and how many balls there are."""
    return 5.0 + 2.0 * at.positions[:, 0, 1] + 0.1 * at.on_table.sum(axis=1)


def random_strokes(m, rng):
    """Strokes (m, 5) over the whole tip disc, in all directions: with side and draw, mirrored in pairs."""
    far, way = 0.49 * np.sqrt(rng.random(m)), rng.uniform(-np.pi, np.pi, m)
    speed, aim = rng.uniform(0.8, 5.0, m), rng.uniform(-np.pi, np.pi, m)
    strokes = np.stack([speed, far * np.cos(way), far * np.sin(way), aim, np.zeros(m)], 1)
    mirrored = strokes[: m // 2] * [1, -1, 1, -1, 1] + [0, 0, 0, np.pi, 0]
    return np.concatenate([strokes[: m - m // 2], mirrored])


EACH = {"offset_mm": 6.0}, {"elevation_deg": 4.0}, {"aim_deg": 2.0}, {"speed_abs": 0.1, "speed_rel": 0.03}


@pytest.mark.parametrize("noise", ["professional", LOUD, *EACH], ids=str)
def test_strokes_under_errors_are_those_of_the_table_under_the_same_errors(noise):
    """The table draws its errors from a key's stream; given the same five numbers, the search plays the same
    shot, squirt and all.

    Both are exact but for rounding, which a break of the pack may magnify; a wrong sign or factor of any
    error moves most of the balls.
    """
    at, rng, m = some(20), np.random.default_rng(1), 300
    rows, keys, strokes = rng.integers(0, 20, m), np.arange(1000, 1000 + m), random_strokes(m, rng)
    options = {"noise": noise, "fidelity": "fast", "aim": "absolute"}
    errors = Noise.of(noise).errors_of(np.stack([keys, np.zeros(m, int)], 1).astype(np.uint64))
    kept = strokes.copy(), errors.copy()
    actions = Strokes(strokes).actions(Options(aim="absolute"), at[rows])
    planner = Planner(options, threads=1)
    played = planner.play_strokes(at, rows, strokes, errors=errors)
    table = planner.play(at, rows, actions, keys)
    apart = np.abs(played.afterstates.positions - table.afterstates.positions).max(axis=(1, 2))
    assert np.median(apart) < 1e-9 and (apart < 1e-4).mean() > 0.99
    alike = apart < 1e-4
    assert np.array_equal(played.points[alike], table.points[alike])
    assert np.array_equal(played.goes_on[alike], table.goes_on[alike])
    assert np.array_equal(strokes, kept[0]) and np.array_equal(errors, kept[1])
    exact = Planner(options, noise="none", threads=1).play(at, rows, actions).afterstates.positions
    # the errors do matter
    assert (np.abs(exact - table.afterstates.positions).max(axis=(1, 2)) > 1e-3).mean() > 0.3


def test_no_budget_is_exceeded_nor_left_unused():
    for budget in range(VisitJudge.least, 2501, 7):
        (looks,), rounds = schedule(budget)
        total = looks + sum(many * each for many, each in rounds)
        assert 0.8 * budget < total <= budget, budget
        assert all(each >= 1 for _, each in rounds)
        strokes = [looks, *(many for many, _ in rounds)]
        assert strokes == sorted(strokes, reverse=True), budget  # each round keeps some of the one before
        assert bool(rounds) == (budget >= 30)


@pytest.mark.parametrize("budget", [8, 29, 120, 333])
@pytest.mark.parametrize("noise", ["club", "none"])
def test_as_many_strokes_are_played_as_the_schedule_says(budget, noise):
    at = some(2)
    tool = search(budget, {"noise": noise, "fidelity": "fast"})
    before = count_shots()
    ranked = tool.rank(at, [1, 2])
    played = count_shots() - before
    (looks,), rounds = schedule(budget)
    total = looks + sum(many * each for many, each in rounds)
    if noise == "none":
        looks, rounds, total = budget, (), budget
    assert played == 2 * total
    met = np.zeros(looks, int)
    for many, each in rounds:
        met[:many] += each
    for one in ranked:
        assert len(one.strokes) == len(one.scores) == looks and np.array_equal(one.samples, met)


def gains_by_hand(tool, at, strokes, errors, value):
    """Points and value of what is left for each stroke of one position under each error: (m, s)."""
    m, s = len(strokes), len(errors)
    rows, strokes, errors = np.zeros(m * s, int), np.repeat(strokes, s, axis=0), np.tile(errors, (m, 1))
    out = tool.judge.planner.play_strokes(at, rows, strokes, errors=errors)
    left = [value(out.afterstates[[i]])[0] if on else 0.0 for i, on in enumerate(out.goes_on)]
    return (out.points + left).reshape(m, s)


@pytest.mark.parametrize("budget", [30])
@pytest.mark.parametrize("value", [by_place, None])
def test_the_ranking_recomputed(budget, value):
    """Sequential halving in plain Python, by score = (2 look + sum) / (2 + samples), look = chance x gain."""
    at, seeds = some(4), [3, 2**32 - 1, 0, 17]
    tool = search(budget, value=value)
    worth = value or (lambda left: prospects_of(left, tool.judge.spread, RULE_OF_THUMB)[0])
    ranked = tool.rank(at, seeds)
    (looks,), rounds = schedule(budget)
    total = sum(each for _, each in rounds)
    for k, seed in enumerate(seeds):
        here = at[k : k + 1]
        strokes, chances = (one[0] for one in at_pots(tool.judge, here, looks, [seed]))
        look = chances * gains_by_hand(tool, here, strokes, np.zeros((1, 5)), worth)[:, 0]
        gains = gains_by_hand(
            tool, here, strokes, tool.judge.noise.errors_from(normal_points(total, seed)), worth
        )
        order, score, done, met = sorted(range(looks), key=lambda i: -look[i]), list(look), 0, [0] * looks
        for many, each in rounds:
            done += each
            for i in order[:many]:
                score[i], met[i] = (PRIOR * look[i] + gains[i, :done].sum()) / (PRIOR + done), done
            order[:many] = sorted(order[:many], key=lambda i: -score[i])
        assert np.array_equal(ranked[k].strokes.values, strokes[order])
        assert ranked[k].samples.tolist() == [met[i] for i in order]
        assert ranked[k].scores == pytest.approx([score[i] for i in order], rel=1e-9, abs=1e-9)
    assert PRIOR == 1.0 and max(one.scores.max() for one in ranked) > 3.0


def test_a_decision_is_the_same_alone_or_among_many_on_any_number_of_threads():
    """Pots, balls that are seen, escapes, in visits and in frames: the position and its seed alone decide."""
    parts = [some(5), some(4, layout="break_off"), some(9, layout="snookered", seed=3)]
    env = tables(3, task="frame", layout="random:5", noise="club")
    env.tables.game[1, FREE_BALL] = True
    parts.append(Positions.of(env).as_visits())
    names = "positions", "on_table", "game"
    at = Positions(*(np.concatenate([getattr(one, name) for one in parts]) for name in names))
    seeds = np.arange(len(at)) + 70
    seen = pots(at).ball[:, 0] >= 0
    assert (~seen & clear_paths(at)).sum() > 0 and (~seen & ~clear_paths(at)).sum() > 0
    assert seen.any()
    order = np.random.default_rng(0).permutation(np.tile(np.arange(len(at)), 4))
    whole = search(60, threads=2).rank(at[order], seeds[order])
    for k in range(len(at)):
        alone = search(60).rank(at[[k]], seeds[[k]])
        assert all(same(alone, [whole[mine]]) for mine in np.flatnonzero(order == k))


@pytest.mark.parametrize(("noise", "budget"), [("none", 30), ("professional", 120)])
def test_a_fair_stroke_is_found_where_the_balls_on_are_hidden(noise, budget):
    at = some(50, layout="snookered", seed=9)
    assert clear_paths(at).mean() < 0.5
    ranked = search(budget, {"noise": noise, "fidelity": "fast"}).rank(at, np.arange(50))
    played = Planner({"fidelity": "fast"}, threads=1).play_strokes(at, np.arange(50), first(ranked))
    assert (played.penalty == 0).mean() >= 0.98


def test_without_a_pot_fouls_and_what_is_left_count():
    """Recomputed for one look: points, less penalty and cost of a foul, less what the opponent is left."""
    at = some(6, layout="snookered", seed=3)
    at = at[np.flatnonzero(pots(at).ball[:, 0] < 0)]
    tool = search(40, {"noise": "none", "fidelity": "fast"})
    ranked = tool.rank(at, np.arange(len(at)))
    strokes = Strokes.join([one.strokes for one in ranked]).values
    played = tool.judge.planner.play_strokes(at, np.repeat(np.arange(len(at)), 40), strokes)
    left, fouls = played.afterstates, played.penalty > 0
    usual = {"on": None, "over": False, "points": 0, "in_hand": False, "table": None}
    theirs = [Position(**vars(one) | usual | {"cue": one.cue or tuple(SPOTS[0].tolist())}) for one in left]
    gains = played.points - played.penalty - FOUL * fouls
    whose = [mine if on else other for mine, other, on in zip(left, theirs, played.goes_on, strict=True)]
    gains += np.where(played.goes_on, 1.0, -LEFT) * tool.judge.value(Positions.of(whose))
    scores = np.concatenate([one.scores for one in ranked])
    assert scores == pytest.approx(gains, abs=1e-6) and fouls.any() and not fouls.all()


def test_generators_that_have_strokes_share_the_looks():
    at, calls = some(3), []

    def soft(judge, here, m, scrambles):
        calls.append(len(here))
        made = at_pots(judge, here, m, scrambles)
        made.strokes[..., 0] = 1.0
        made.chances[1] = 0.0
        return made

    tool = search(60, {"noise": "none", "fidelity": "fast"}, propose=(at_pots, soft))
    ranked = tool.rank(at, [1, 2, 3])
    usual = search(60, {"noise": "none", "fidelity": "fast"}).rank(at, [1, 2, 3])
    assert [int((one.strokes.speed == 1.0).sum()) for one in ranked] == [30, 0, 30] and calls == [3]
    assert [int(one.kinds.sum()) for one in ranked] == [30, 0, 30] and same(ranked[1:2], usual[1:2])
    assert not np.array_equal(ranked[0].scores, usual[0].scores)
