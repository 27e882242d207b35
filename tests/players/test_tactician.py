"""Does the tactician play whole frames, decide what can be decided, and depend on nothing but position and seed?"""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game import frame_columns as columns
from snooker_env.planning import Position
from snooker_env.planning.worth import apply_decision, last_of, lead_of, left_of
from snooker_env.players import FRAMES
from snooker_env.players.search_player import Tactician
from snooker_env.tasks.declarations import CONCEDES, OTHER_BEGINS, SAYS_NOTHING
from tests.planning.test_frame_judge import frame_of
from tests.planning.test_trials import GAME, frames_in_play, positions_of

OPTIONS = GAME | {"noise": "club", "cue": "real", "says": ["decision"]}
PINK_BALL = Position(cue=(0.1, 0.3), pink=(0.0, 0.7), black=(0.0, 1.4605), on="pink")


def test_it_takes_a_budget_and_no_model():
    assert sn.player("tactician").name == "tactician" and sn.player("tactician_500").budget == 500
    with pytest.raises(ValueError, match="budget"):
        sn.player("tactician_10")
    with pytest.raises(ValueError, match="must not name a model"):
        sn.player("tactician@mine")


def test_a_third_miss_loses_the_frame_whatever_the_lead():
    position = Position(cue=(0.0, 0.0), reds=[(0.5, 0.5)], black=(0.0, 1.4605), on="red")
    ahead = frame_of(position, scores=(60, 5))
    ahead.game[:, columns.WARNED], ahead.game[:, columns.FAILURES] = 1, 2
    judge = sn.player("tactician_30").at(OPTIONS | {"noise": "none"}).judge
    away = np.array([[2.0, 0.0, 0.0, -2.4, 0.0]])
    (chance, points), *_ = judge.gains(ahead, np.array([0]), away, np.zeros((1, 5))).tolist()
    assert chance == 0.0 and points == -4.0 - 15.0
    ahead.game[:, columns.WARNED] = 0
    (chance, _), *_ = judge.gains(ahead, np.array([0]), away, np.zeros((1, 5))).tolist()
    assert chance > 0.5


def test_the_lot_is_decided_by_the_worth_of_the_black():
    far = frame_of(Position(cue=(0.1, -1.1), black=(0.0, 1.4605), on="black", in_hand=True))
    far.game[:, columns.PHASE], far.game[:, columns.RESPOTTED_BLACK] = columns.LOT, 1
    silent = sn.player("tactician_30").at(OPTIONS).play(far, [3])
    assert silent.declare.tolist() == [SAYS_NOTHING]
    silent.actions(sn.Options(**OPTIONS | FRAMES), far)  # an environment without lots reads it
    told = OPTIONS | {"says": ["decision", "lot"]}
    said = sn.player("tactician_30").at(told).play(far, [3]).declare.tolist()
    worth = sn.player("tactician_30").at(told).judge.worth(far)
    assert (said[0] == OTHER_BEGINS) == bool(worth[0] < 0.0)


def test_a_lost_frame_is_conceded_only_where_it_may_be():
    lost = frame_of(PINK_BALL, scores=(0, 90))
    alive = frame_of(PINK_BALL, scores=(80, 90))
    each = (True, lost, CONCEDES), (False, lost, SAYS_NOTHING), (True, alive, SAYS_NOTHING)
    for says, at, wanted in each:
        player = sn.player("tactician_30").at(OPTIONS | {"says": ["decision"] + ["concede"] * says})
        assert player.play(at, [1]).declare.tolist() == [wanted]


def test_the_chance_to_win_is_that_of_the_lead_to_come():
    """By the law, of the lead and the worth: of frames in play, one by one as all at once, which are left as they are."""
    player = sn.player("tactician_30").at(OPTIONS)
    at = positions_of(frames_in_play(12, OPTIONS, strokes=6, seed=11))
    before = at.copy()
    chances = player.chance_to_win(at)
    assert chances.shape == (12,) and len(set(chances.tolist())) > 6
    assert ((chances >= 0) & (chances <= 1)).all()
    going = np.flatnonzero(~at.over)
    law, worth = player.judge.chance, player.judge.worth
    some = at[going]
    wanted = law(lead_of(some), worth(some), left_of(some), last_of(some), player.judge.spread.core)
    np.testing.assert_allclose(chances[going], wanted, rtol=0, atol=1e-6)
    for k in range(12):
        assert player.chance_to_win(at[[k]])[0] == pytest.approx(chances[k], abs=1e-6)
    for name in ("positions", "on_table", "game"):
        assert np.array_equal(getattr(at, name), getattr(before, name))
    level = [frame_of(PINK_BALL, scores=(60 + lead, 60)) for lead in (-90, -8, 0, 8, 90)]
    leads = [player.chance_to_win(one)[0] for one in level]
    assert leads == sorted(leads) and leads[0] < 0.01 and leads[-1] > 0.99
    assert sn.player("tactician_500").at(OPTIONS).chance_to_win(at).tolist() == chances.tolist()


EASY_BLACK = Position(cue=(0.377, 1.327), black=(0.0, 1.4605), on="black")
HARD_BLACK = Position(cue=(-0.8, -1.6), black=(0.0, 1.4605), on="black")


def test_what_the_rules_decide_is_certain():
    """With the black alone, and more than its 7 points between the players; by advice, too."""
    player = sn.player("tactician_30").at(OPTIONS)
    for black in (EASY_BLACK, HARD_BLACK):
        for scores, chance in (((52, 60), 0.0), ((60, 52), 1.0)):
            assert player.chance_to_win(frame_of(black, scores)).tolist() == [chance]
            (one, *_) = sn.advise(black, scores=scores, n=1, samples=30, visits=2, options={"cue": "real"})
            assert one.win == chance and f"win chance {100 * chance:.0f} %" in one.words
        assert 0.0 < player.chance_to_win(frame_of(black, (53, 60)))[0] <= 0.5
        assert 0.5 <= player.chance_to_win(frame_of(black, (60, 53)))[0] < 1.0
        near = [player.chance_to_win(frame_of(black, (60 + lead, 60)))[0] for lead in (-6, -1, 0, 1, 6)]
        assert len(set(near)) == 1  # the next points decide, whoever leads


def test_what_time_decides_is_certain():
    """The Shoot Out: time for one stroke, which brings at most 7 points, by a foul to the other."""
    rules = {"task": "frame", "game": "shoot_out", "noise": "club", "opponent": "none"}
    env, player = sn.SnookerEnv(**rules), sn.player("tactician_30")
    two = Position(cue=(0.3, 1.0), pink=(0.0, 0.885), black=(0.0, 1.4605), on="pink")
    hard = Position(cue=(0.0, -1.7), black=(-0.5, 1.7))

    def chance(position, scores, clock):
        env.reset(options={"position": position})
        state = env.get_state()
        state["frame"] |= {"scores": list(scores), "clock": clock}
        env.set_state(state)
        return player.at(env).chance_to_win(sn.Positions.of(env))[0]

    assert [chance(two, scores, 590_000) for scores in ((50, 62), (50, 58), (58, 50))] == [0.0, 0.0, 1.0]
    assert 0.0 < chance(two, (50, 51), 590_000) <= chance(two, (51, 50), 590_000) < 1.0
    assert chance(two, (50, 62), 300_000) > 0.0 and chance(two, (58, 50), 300_000) < 1.0
    assert 0.0 < chance(hard, (50, 51), 590_000) < 0.5 < chance(hard, (51, 50), 590_000) < 1.0


def test_who_needs_snookers_plays_for_them():
    """14 behind with pink and black left: the pink, however easy, would lose the frame."""
    at = frame_of(PINK_BALL, scores=(60, 74))
    for name in ("tactician", "stroke_value"):
        player = sn.player(name).at(OPTIONS | {"noise": "professional", "miss": "clear_path"})
        tried = player.search.rank(at[np.zeros(10, int)], np.arange(10))
        assert all(one.kinds[0] > 0 for one in tried), name
        level = frame_of(at[0], scores=(60, 60))
        assert player.search.rank(level, [0])[0].kinds[0] == 0
    advice = sn.advise(at, n=40, samples=20, visits=2, options={"cue": "real", "miss": "clear_path"})
    assert advice[0].kind == "safety" and sum(one.kind == "safety" for one in advice) > 2


def test_a_called_miss_is_worth_no_more_than_the_best_stroke_and_its_penalty():
    """The best is missed half of the time; one that always is would leave the other nothing."""
    judge = sn.player("tactician_30").at(OPTIONS).judge
    parts = np.zeros((1, 3, 7))
    parts[0, 0, :2] = 0.5, 6.0
    parts[0, 1] = 0.3, 5.0, 0.5, 0.45, 40.0, -0.02, -2.0  # as often missed, for 4 points
    parts[0, 2, 2:] = 1.0, 0.9, 60.0, -0.04, -4.0  # on purpose
    chances, points = judge._play_again(parts)[0].T
    best = (0.3 - 0.02) / 0.5, (5.0 - 2.0) / 0.5  # the second, played until no miss is called
    assert (chances[1], points[1]) == pytest.approx(best)
    assert (chances[2], points[2]) == pytest.approx((best[0] - 0.04, best[1] - 4.0))
    assert (chances[0], points[0]) == (0.5, 6.0)


def test_a_frame_that_is_over_is_won_or_lost():
    over = frame_of(PINK_BALL, scores=(10, 90))
    over.game[:, columns.PHASE], over.game[:, columns.OVER] = columns.FINISHED, 1
    for winner, chance in ((0, 1.0), (1, 0.0)):  # the other conceded although ahead, or did not
        over.game[:, columns.WINNER] = winner
        assert sn.player("tactician_30").at(OPTIONS).chance_to_win(over).tolist() == [chance]


def test_the_chance_after_a_foul_is_that_of_the_best_decision():
    player = sn.player("tactician_30").at(OPTIONS)
    # whoever plays from the lower half is worth 20 points more than the other
    player.judge.worth = lambda at: np.where(at.positions[:, 0, 1] < 1.5, 20.0, -20.0)
    easy = Position(cue=(0.3, 1.0), reds=[(0.6, 1.4)], black=(0.0, 1.4605), on="red")
    at = frame_of(easy, scores=(4, 0))
    at.game[:, columns.PHASE] = columns.CHOICE
    both = columns.PLAY, columns.PLAY_AGAIN
    play, again = (player.chance_to_win(apply_decision(at, what))[0] for what in both)
    assert player.chance_to_win(at)[0] == play > 0.6 > 1.0 - again
    hard = Position(cue=(0.0, 1.70), reds=[(0.0, -1.70)], black=(0.0, 1.4605), blue=(0.0, 1.63), on="red")
    snookered = frame_of(hard, scores=(4, 0))
    snookered.game[:, columns.PHASE] = columns.CHOICE
    play, again = (player.chance_to_win(apply_decision(snookered, what))[0] for what in (0, 1))
    assert player.chance_to_win(snookered)[0] == pytest.approx(1.0 - again, abs=1e-12)
    assert 1.0 - again > 0.6 > play


def test_nobody_wins_a_visit_and_a_player_without_a_law_says_nothing():
    player = sn.player("tactician_30")
    with pytest.raises(ValueError, match="must be bound first"):
        player.chance_to_win(frame_of(PINK_BALL))
    with pytest.raises(ValueError, match="positions = those of visits: must be of frames"):
        player.at(OPTIONS).chance_to_win(PINK_BALL)
    with pytest.raises(ValueError, match="law of the chance"):
        Tactician(30, (None, None)).at(OPTIONS).chance_to_win(frame_of(PINK_BALL))
