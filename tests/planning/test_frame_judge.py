"""Does the search of frames play safe where that is best, within its budget, the same for one position or many?"""

import numpy as np
import pytest

from snooker_env.benchmark import count_shots
from snooker_env.game import frame_columns as columns
from snooker_env.game.balls import touching_balls as touching_kernel
from snooker_env.planning import FrameJudge, Position, Positions, Search, at_pots, prospects_of
from snooker_env.planning.judges import BUDGET, KEPT, PLANS, SURE_OF
from snooker_env.planning.proposals import EDGE, safeties
from snooker_env.planning.trials import turn_to_striker
from snooker_env.planning.worth import NARROWEST, WIDEST, Chance, apply_decision, decide, lead_of, left_of
from snooker_env.planning.worth import SPREAD as MIDDLE
from snooker_env.players.weights import learned_worth
from snooker_env.tasks import LEVELS
from snooker_env.tasks.threads import Threads
from snooker_env.tasks.windows import MOST_EDGES, open_windows
from tests.kernels import from_python
from tests.planning.test_trials import GAME, frames_in_play, play, positions_of, random_strokes

OPTIONS = GAME | {"noise": "club", "cue": "real"}
windows_of, touching_balls = from_python(open_windows), from_python(touching_kernel)
SPREAD = LEVELS["club"].spread()


def by_rule(at):
    """A worth: the rule of thumb of the visit."""
    return prospects_of(at, SPREAD)[0]


def frame_of(position, scores=(0, 0)):
    """A position of a frame, from one of a visit."""
    at = Positions.of(position)
    game = np.zeros((len(at), columns.COLUMNS), np.int64)
    game[:, : columns.VISIT_COLUMNS] = at.game
    masks = (at.on_table[:, 1:] << np.arange(1, 22)).sum(axis=1)
    game[:, columns.ON_TABLE] = game[:, columns.RACK] = masks
    game[:, columns.WINNER] = -1
    game[:, columns.SCORE_0], game[:, columns.SCORE_1] = scores
    return Positions(at.positions, at.on_table, game)


def judge(options=OPTIONS, worth=by_rule, **more):
    return FrameJudge(options, worth, **more)


def most(plan):
    """Shots that a plan takes at most."""
    return sum(plan.looks) + sum(many * each for many, each in plan.rounds)


def test_a_pot_that_is_easy_is_played_and_hard_positions_get_more_shots():
    easy = frame_of(Position(cue=(0.3, 1.3), reds=[(0.6, 1.6)], black=(0.0, 1.4605), on="red"))
    before = count_shots()
    (tried,) = Search(judge()).rank(easy, [3])
    assert tried.kinds[0] == 0 and count_shots() - before <= most(PLANS[0])
    hard = positions_of(frames_in_play(6, OPTIONS, strokes=0))  # before the break-off
    before = count_shots()
    for tried in Search(judge()).rank(hard, np.arange(6)):
        assert tried.kinds[0] in (1, 2) and (np.diff(tried.samples) <= 0).all()
    assert 1.5 * BUDGET < (count_shots() - before) / 6 <= most(PLANS[1])


def test_the_score_is_what_the_stroke_brings_and_leaves():
    """Without errors, the best stroke's points are those of the trial it was: recomputed one by one."""
    at = positions_of(frames_in_play(8, OPTIONS, strokes=4, seed=21))
    at = at[np.flatnonzero(~at.over)]
    one = judge(OPTIONS | {"noise": "none"})
    for k, tried in enumerate(Search(one).rank(at, np.arange(len(at)))):
        after = one.outcomes(at, np.full(3, k), tried.strokes.values[:3], np.zeros((3, 5)))
        for j in range(3):
            row = after.game[j]
            points = float(lead_of(after[[j]])[0] - lead_of(at[[k]])[0])
            if not row[columns.OVER]:
                mine = row[columns.STRIKER] == 0
                left = turn_to_striker(after[[j]])
                worth = (
                    decide(by_rule, left)[1][0] if row[columns.PHASE] == columns.CHOICE else by_rule(left)[0]
                )
                points += worth if mine else -worth
            assert tried.points[j] == pytest.approx(points, abs=1e-9)


LAW = Chance(1.0, 0.2, 0.3, 2.0)


def test_with_a_law_of_chances_a_lead_is_kept_and_a_deficit_gambled_away():
    level, open_table = np.zeros(5), np.zeros(5, np.bool_)
    worths = np.array([-60.0, -5.0, 0.0, 5.0, 60.0])
    few, many = (LAW(level, worths, np.full(5, left), open_table, MIDDLE) for left in (13.0, 140.0))
    assert many[2] == 0.5 and (np.diff(few) > 0).all() and few[3] > many[3] and few[0] < many[0]
    assert np.allclose(few + few[::-1], 1.0)
    now, ten, left = np.array([-60.0, -50.0, -48.0, 0.0, 51.0]), np.full(5, 10.0), np.full(5, 49.0)
    wide = 1.0 + 0.2 * 49.0
    # fouls alone help the first two, to whom 4 of their 10 points are of use
    logits = [-2.0 - 0.3 * 11.0 + 4.0 / wide, -2.3 + 4.0 / wide, -38.0 / wide, 10.0 / wide, 2.6 + 10.0 / wide]
    said = LAW(now, ten, left, open_table, MIDDLE)
    assert said == pytest.approx(1.0 / (1.0 + np.exp(-np.array(logits))), rel=1e-12)
    # all that is left would make it level, and a lot and the black decide: half of the chance, and the leader's half
    edge, worth = np.array([-49.0, 49.0]), np.array([40.0, -40.0])
    half = 0.5 / (1.0 + np.exp(9.0 / wide))
    halves = LAW(edge, worth, np.full(2, 49.0), open_table[:2], MIDDLE)
    assert halves == pytest.approx([half, 1.0 - half], rel=1e-12)
    errs = LAW._replace(errors=-0.5)
    twice = LAW(2.0 * now[2:4], 2.0 * ten[2:4], left[2:4], open_table[2:4], MIDDLE)
    assert errs(now, ten, left, open_table, 4.0 * MIDDLE)[3] == pytest.approx(twice[1], rel=1e-12)
    assert np.array_equal(  # none larger was learned from, and none smaller
        errs(now, ten, left, open_table, 1.0), errs(now, ten, left, open_table, WIDEST)
    )
    assert np.array_equal(errs(now, ten, left, open_table, 0.0), errs(now, ten, left, open_table, NARROWEST))
    at = positions_of(frames_in_play(8, OPTIONS, strokes=4, seed=21))
    at = at[np.flatnonzero(~at.over)]
    every = np.arange(len(at))
    far, sign = at.copy(), np.where(every % 2, 1, -1)
    # one of both needs snookers, whatever the stroke does
    far.game[:, columns.SCORE_0] += np.maximum(sign, 0) * 200
    far.game[:, columns.SCORE_1] += np.maximum(-sign, 0) * 200
    for tried, ahead in zip(Search(judge(chance=LAW)).rank(far, every), sign > 0, strict=True):
        assert (tried.scores > 0.99).all() if ahead else (tried.scores < 0.01).all()


def test_with_the_black_alone_the_rules_say_who_wins():
    """More than 7 ahead is won, 7 may become level and then a lot decides, less is won by the next points."""
    now = np.arange(-9.0, 10.0)
    seven, alone = np.full(len(now), 7.0), np.ones(len(now), np.bool_)
    for worth, black in ((3.5, 0.75), (-3.5, 0.25), (7.5, 0.98), (-9.0, 0.02)):
        said = LAW(now, np.full(len(now), worth), seven, alone, MIDDLE)
        wanted = np.where(np.abs(now) < 7.0, black, now > 0.0)
        wanted[now == 7.0], wanted[now == -7.0] = 0.5 + 0.5 * black, 0.5 * black
        assert said == pytest.approx(wanted, abs=1e-12)
        other = LAW(-now, np.full(len(now), -worth), seven, alone, MIDDLE)
        assert said + other == pytest.approx(1.0, abs=1e-12)
    two, none = np.full(3, 13.0), np.zeros(3, np.bool_)
    fitted = learned_worth()[1]
    behind = fitted(np.array([-12.0, -13.0, -14.0]), np.full(3, 12.0), two, none, MIDDLE)
    # to win, to be level at best (half of what follows), to need fouls
    assert behind[0] == 0.5 and 0.25 > behind[1] > behind[2] > 0.0
    ahead = fitted(np.array([12.0, 13.0, 14.0]), np.full(3, -12.0), two, none, MIDDLE)
    assert ahead + behind == pytest.approx(1.0, abs=1e-12)


def test_the_time_that_is_left_bounds_what_may_be_scored():
    """In the Shoot Out: one stroke more, and 20 points ahead."""
    open_table = Position(cue=(0.3, 0.4), reds=[(0.6, 1.0), (-0.3, 0.2)], black=(0.0, 1.4605), on="red")
    at = frame_of(open_table, scores=(30, 10))
    game = OPTIONS | {"game": "shoot_out", "miss": "off"}
    one = judge(game, chance=LAW)
    early, (now, worth) = at.copy(), (lead_of(at), np.zeros(1))
    at.game[:, columns.CLOCK] = 600_000 - 1
    assert one.chances(now, worth, early)[0] < 0.99 < one.chances(now, worth, at)[0]
    assert one.chances(-now, worth, at)[0] < 0.01


def test_safeties_meet_a_ball_on_first_and_every_other_one_thinly():
    free = {"noise": "none", "cue": "free"}  # under a raised cue an aim is turned back by the swerve
    at = positions_of(frames_in_play(10, OPTIONS | free, strokes=6, seed=31))
    at = at[np.flatnonzero(~at.over & ~at.in_hand)]
    one = judge(OPTIONS | free)
    made, met, tried, near = safeties(one, at.as_visits(), 64, np.arange(len(at))), 0, 0, []
    assert (made.strokes[..., 0] >= 0.45).all() and (made.strokes[..., 0] <= 6.0).all()
    assert (np.hypot(made.strokes[..., 1], made.strokes[..., 2]) <= 0.5).all()
    for k in np.flatnonzero(made.chances.any(axis=1)):
        windows = np.empty((MOST_EDGES, 3))
        places, present = at.positions[k], at.on_table[k]
        touching, on = touching_balls(places, present), int(at.as_visits().balls_on[k] @ (1 << np.arange(22)))
        edges = windows[: windows_of(places, present, on, touching, windows), :2].reshape(-1)
        off = np.abs((made.strokes[k, 1::2, 3, None] - edges + np.pi) % (2.0 * np.pi) - np.pi).min(axis=1)
        assert (off <= EDGE + 1e-9).all()
        near.append(off)
        after = one.outcomes(at, np.full(64, k), made.strokes[k], np.zeros((64, 5)))
        met += (after.game[:, columns.SCORE_1] == at.game[k, columns.SCORE_1]).sum()
        tried += 64
    assert tried > 300 and met > 0.7 * tried  # balls in the way of the ball's curve and in-offs are fouls
    assert np.mean(np.concatenate(near) < 0.25 * EDGE) > 0.4  # half of them are within a quarter


def test_after_a_foul_all_choices_are_compared():
    either_way = lambda some: by_rule(some) - 12.0  # noqa: E731 - also worths below 0
    tables = frames_in_play(60, OPTIONS, strokes=0, seed=41)
    play(tables, random_strokes(60, np.random.default_rng(2)), Threads(1))
    at = positions_of(tables)
    at = at[np.flatnonzero(at.choice & at.miss_called)]
    assert len(at) > 10
    best, values = decide(either_way, at)
    for k in range(len(at)):
        one = at[[k]]
        options = {
            columns.PLAY: either_way(apply_decision(one, columns.PLAY))[0],
            columns.PLAY_AGAIN: -either_way(apply_decision(one, columns.PLAY_AGAIN))[0],
            columns.REPLACE: -either_way(apply_decision(one, columns.REPLACE))[0],
        }
        assert values[k] == pytest.approx(max(options.values())) and options[int(best[k])] == pytest.approx(
            values[k]
        )
    assert len(set(best.tolist())) > 1, "one choice is always the best here"
    replaced = apply_decision(at, columns.REPLACE)
    assert np.array_equal(replaced.positions, at.saved.positions)
    assert np.array_equal(lead_of(replaced), -lead_of(at))


def test_who_leads_by_more_than_is_left_plays_on():
    tables = frames_in_play(60, OPTIONS, strokes=0, seed=41)
    play(tables, random_strokes(60, np.random.default_rng(2)), Threads(1))
    at = positions_of(tables)
    at = at[np.flatnonzero(at.choice)]
    bad = lambda some: np.full(len(some), -100.0)  # noqa: E731 - each player wants the other to play
    for lead, sent_back in (0.0, True), (1.0, False):
        at.game[:, columns.SCORE_0] = at.game[:, columns.SCORE_1] + left_of(at) + lead
        assert np.all((decide(bad, at)[0] != columns.PLAY) == sent_back), lead


def test_a_lot_decides_who_begins_at_the_black_that_makes_it_level():
    at = frame_of(Position(cue=(0.377, 1.327), black=(0.0, 1.4605), on="black"), (53, 60))
    one = judge(OPTIONS | {"noise": "none"}, lambda some: np.full(len(some), 5.0), chance=LAW)
    (tried,) = Search(one).rank(at, [0])
    assert tried.kinds[0] == 0 and tried.scores[0] == 0.5 and tried.points[0] == 7.0


def test_safeties_that_promise_most_are_looked_at():
    at = frame_of(Position(cue=(0.0, -1.2), reds=[(0.5, 1.65), (-0.5, 1.65)], on="red"))
    asked = []

    def softest(some, rows, strokes, samples):
        asked.append((len(rows), samples))
        return -strokes[:, 0]

    plain, choosy = judge(), judge(foresee=softest)
    speeds = [one.propose((at_pots,), at, np.zeros(1, np.int64), PLANS[1]).strokes for one in (plain, choosy)]
    safe = slice(PLANS[1].looks[0], PLANS[1].looks[0] + round(KEPT * PLANS[1].looks[1]))
    assert speeds[1][0, safe, 0].max() < np.median(speeds[0][0, safe, 0])
    assert [samples for _, samples in asked] == [1, SURE_OF] and asked[0][0] > 2 * asked[1][0]


def test_many_positions_are_judged_as_each_alone():
    at = positions_of(frames_in_play(12, OPTIONS, strokes=5, seed=11))
    at = at[np.flatnonzero(~at.over)]
    keys = np.arange(len(at)) + 70
    together = Search(judge()).rank(at, keys)
    for k in range(len(at)):
        (alone,) = Search(judge()).rank(at[[k]], keys[[k]])
        assert np.array_equal(together[k].strokes.values, alone.strokes.values)
        assert all(map(np.array_equal, together[k][1:], alone[1:]))
