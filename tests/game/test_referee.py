"""Does the referee judge one stroke by each rule of the book? A test or a row of a table for each rule."""

import pytest

from snooker_env.game.balls import (
    BLACK,
    BLUE,
    BROWN,
    COLOURS_MASK,
    CUE,
    GREEN,
    PINK,
    REDS_MASK,
    YELLOW,
    BallOn,
    ids_of,
    mask_of,
)
from snooker_env.game.referee import FULL_TABLE, Situation, Stroke, judge
from snooker_env.game.ruling import AUTO, Foul, Outcome, VisitEnd

COLOURS = range(YELLOW, BLACK + 1)
MASKS = ("first", "potted", "off", "touching", "moved")


def rule(ball_on="RED", on_table=None, *, free_ball=False, lead=0, **seen):
    """Judge a stroke; masks are given as a ball or a list of balls."""
    on = BallOn[ball_on]
    if on_table is None:
        on_table = range(1, 22) if on <= BallOn.RED else range(14 + on, 22)
    for name in MASKS:
        if name in seen:
            seen[name] = mask_of([seen[name]] if isinstance(seen[name], int) else seen[name])
    return judge(
        Situation(on_table=mask_of(on_table), ball_on=on, free_ball=free_ball, lead=lead), Stroke(**seen)
    )


def assert_fair(verdict, points, ball_on, stays):
    assert (verdict.fouls, verdict.penalty) == (Foul(0), 0)
    assert (verdict.points, verdict.ball_on, verdict.stays) == (points, BallOn[ball_on], stays)


def assert_foul(verdict, fouls, penalty, ball_on="RED"):
    assert (verdict.fouls, verdict.penalty, verdict.points) == (fouls, penalty, 0)
    assert (verdict.ball_on, verdict.stays, verdict.visit_end) == (BallOn[ball_on], False, VisitEnd.FOUL)


# Fair strokes: points, the colours that return, the next ball on


@pytest.mark.parametrize(("potted", "points"), [([], 0), ([1], 1), ([1, 2], 2), ([3, 4, 5, 6], 4)])
def test_reds_count_one_each(potted, points):
    verdict = rule(first=1, potted=potted)
    assert_fair(verdict, points, "ANY_COLOUR" if points else "RED", points > 0)
    assert verdict.on_table == FULL_TABLE & ~mask_of(potted)
    assert verdict.visit_end == (VisitEnd.CONTINUES if points else VisitEnd.MISS)


@pytest.mark.parametrize("ball", COLOURS)
def test_the_nominated_colour_scores_its_value_and_returns(ball):
    verdict = rule("ANY_COLOUR", first=ball, potted=ball, nominated=ball)
    assert_fair(verdict, ball - 14, "RED", True)
    assert verdict.respotted == 1 << ball and verdict.on_table == FULL_TABLE


@pytest.mark.parametrize("ball", COLOURS)
def test_after_the_last_red_any_colour_returns_and_the_sequence_begins(ball):
    verdict = rule("ANY_COLOUR", COLOURS, first=ball, potted=ball, nominated=ball)
    assert_fair(verdict, ball - 14, "YELLOW", True)
    assert verdict.on_table == COLOURS_MASK


def test_the_choice_after_the_last_red_is_the_strikers_only():
    assert_fair(rule(on_table=[15, *COLOURS], first=15, potted=15), 1, "ANY_COLOUR", True)
    assert_fair(rule("ANY_COLOUR", COLOURS, first=BLACK, nominated=BLACK), 0, "YELLOW", False)
    assert_foul(rule(on_table=[15, *COLOURS], first=15, potted=[CUE, 15]), Foul.CUE_POTTED, 4, "YELLOW")


@pytest.mark.parametrize("ball", range(YELLOW, BLACK))
def test_the_sequence_of_colours(ball):
    verdict = rule(BallOn(ball - 14).name, first=ball, potted=ball)
    assert_fair(verdict, ball - 14, BallOn(ball - 13).name, True)
    assert verdict.respotted == 0 and verdict.on_table == mask_of(range(ball + 1, 22))


# First impact


@pytest.mark.parametrize(
    ("ball", "penalty"), [(YELLOW, 4), (GREEN, 4), (BROWN, 4), (BLUE, 5), (PINK, 6), (BLACK, 7)]
)
def test_a_colour_struck_instead_of_a_red(ball, penalty):
    assert_foul(rule(first=ball), Foul.WRONG_FIRST, penalty)


@pytest.mark.parametrize(
    ("ball_on", "nominated", "penalty"),
    [
        ("RED", AUTO, 4),
        ("ANY_COLOUR", YELLOW, 4),
        ("ANY_COLOUR", PINK, 6),
        ("BROWN", AUTO, 4),
        ("BLUE", AUTO, 5),
        ("PINK", AUTO, 6),
    ],
)
def test_nothing_struck_costs_the_ball_on(ball_on, nominated, penalty):
    after = "RED" if ball_on in ("RED", "ANY_COLOUR") else ball_on
    assert_foul(rule(ball_on, nominated=nominated), Foul.NO_CONTACT, penalty, after)


@pytest.mark.parametrize(
    ("nominated", "first", "penalty"),
    [(BLACK, PINK, 7), (YELLOW, BLACK, 7), (YELLOW, 1, 4), (GREEN, YELLOW, 4), (BLUE, 1, 5)],
)
def test_another_ball_than_the_nominated_colour(nominated, first, penalty):
    assert_foul(rule("ANY_COLOUR", first=first, nominated=nominated), Foul.WRONG_FIRST, penalty)


@pytest.mark.parametrize(
    ("ball_on", "first", "penalty"),
    [
        ("RED", [1, 2], 0),
        ("RED", [1, BLACK], 7),
        ("RED", [1, YELLOW], 4),
        ("ANY_COLOUR", [PINK, BLACK], 7),
        ("YELLOW", [YELLOW, BLUE], 5),
    ],
)
def test_balls_struck_at_the_same_time(ball_on, first, penalty):
    assert rule(ball_on, first=first, nominated=PINK if ball_on == "ANY_COLOUR" else AUTO).penalty == penalty


# Balls down, balls off, the cue ball


@pytest.mark.parametrize(
    ("ball_on", "potted", "penalty", "left"),
    [
        ("RED", [BLUE], 5, FULL_TABLE),
        ("RED", [1, PINK], 6, FULL_TABLE & ~2),
        ("RED", [1, YELLOW, BLACK], 7, FULL_TABLE & ~2),
        ("YELLOW", [YELLOW, GREEN], 4, COLOURS_MASK),
        ("PINK", [BLACK], 7, 1 << PINK | 1 << BLACK),
    ],
)
def test_a_ball_not_on_in_a_pocket(ball_on, potted, penalty, left):
    verdict = rule(ball_on, first=1 if ball_on == "RED" else 14 + BallOn[ball_on], potted=potted)
    assert_foul(verdict, Foul.WRONG_POT, penalty, ball_on)
    assert verdict.respotted == mask_of(potted) & COLOURS_MASK and verdict.on_table == left


def test_only_the_nominated_colour_may_be_potted():
    assert_foul(rule("ANY_COLOUR", first=BLUE, potted=[BLUE, BLACK], nominated=BLUE), Foul.WRONG_POT, 7)
    verdict = rule("ANY_COLOUR", first=BLUE, potted=[BLUE, 4], nominated=BLUE)
    assert_foul(verdict, Foul.WRONG_POT, 5)
    assert verdict.on_table == FULL_TABLE & ~(1 << 4)


@pytest.mark.parametrize(
    ("ball_on", "ball", "penalty"), [("RED", 1, 4), ("ANY_COLOUR", PINK, 6), ("BLUE", BLUE, 5)]
)
@pytest.mark.parametrize(("where", "foul"), [("potted", Foul.CUE_POTTED), ("off", Foul.CUE_OFF)])
def test_the_cue_ball_lost(ball_on, ball, penalty, where, foul):
    verdict = rule(ball_on, first=ball, **{where: CUE})
    assert_foul(verdict, foul, penalty, "RED" if ball_on == "ANY_COLOUR" else ball_on)
    assert verdict.in_hand


@pytest.mark.parametrize(("ball", "penalty"), [(1, 4), (YELLOW, 4), (BLUE, 5), (BLACK, 7)])
def test_a_ball_forced_off_the_table(ball, penalty):
    verdict = rule(first=1, off=ball)
    assert_foul(verdict, Foul.BALL_OFF, penalty)
    assert verdict.on_table == (FULL_TABLE if ball >= YELLOW else FULL_TABLE & ~(1 << ball))
    assert not verdict.in_hand


def test_the_ball_on_forced_off_in_the_sequence_returns():
    verdict = rule("BLUE", first=BLUE, off=BLUE)
    assert_foul(verdict, Foul.BALL_OFF, 5, "BLUE")
    assert verdict.respotted == 1 << BLUE


def test_the_highest_penalty_counts():
    verdict = rule(first=GREEN, potted=[CUE, BLACK], off=PINK)
    assert_foul(verdict, Foul.WRONG_FIRST | Foul.WRONG_POT | Foul.CUE_POTTED | Foul.BALL_OFF, 7)
    assert verdict.respotted == mask_of([BLACK, PINK])


# How the cue ball was played


@pytest.mark.parametrize(
    ("field", "foul"),
    [(name, Foul[name.upper()]) for name in ("jump", "double_hit", "outside_d", "feet", "out_of_turn")],
)
@pytest.mark.parametrize(("ball_on", "ball", "penalty"), [("RED", 1, 4), ("PINK", PINK, 6)])
def test_how_it_was_played_costs_the_ball_on(field, foul, ball_on, ball, penalty):
    assert_foul(rule(ball_on, first=ball, potted=ball, **{field: True}), foul, penalty, ball_on)


def test_a_push_costs_the_ball_concerned():
    assert_foul(rule(first=1, push=True), Foul.PUSH, 4)
    assert_foul(rule(first=BLACK, push=True), Foul.PUSH | Foul.WRONG_FIRST, 7)
    assert_foul(rule(first=1, touching=PINK, moved=PINK), Foul.PUSH, 6)
    # free to meet the black, but not to push it
    assert_foul(rule(touching=1, first=BLACK, push=True), Foul.PUSH, 7)


def test_seven_points_whatever_is_on():
    assert_foul(rule(first=1, potted=1, seven=True), Foul.SEVEN, 7)


# Touching ball


def test_a_touching_ball_on_counts_as_struck():
    assert_fair(rule(touching=1), 0, "RED", False)
    assert_fair(rule(touching=1, first=BLACK), 0, "RED", False)  # it is free to meet any ball afterwards
    assert_fair(rule("BLUE", touching=BLUE), 0, "BLUE", False)
    assert_foul(rule(touching=1, moved=1), Foul.PUSH | Foul.NO_CONTACT, 4)


def test_a_touching_ball_not_on_counts_for_nothing():
    assert_fair(rule(touching=BLACK, first=1), 0, "RED", False)
    assert_foul(rule(touching=BLACK), Foul.NO_CONTACT, 4)


def test_a_touching_colour_must_be_the_one_declared():
    assert_fair(rule("ANY_COLOUR", touching=BLUE, nominated=BLUE), 0, "RED", False)
    assert_fair(rule("ANY_COLOUR", touching=BLUE, first=PINK, potted=PINK, nominated=PINK), 6, "RED", True)
    assert_foul(rule("ANY_COLOUR", touching=BLUE, nominated=PINK), Foul.NO_CONTACT, 6)


# Nomination left to the referee


@pytest.mark.parametrize("ball", COLOURS)
def test_the_colour_first_struck_is_the_nominated_one(ball):
    verdict = rule("ANY_COLOUR", first=ball, potted=ball)
    assert_fair(verdict, ball - 14, "RED", True)
    assert verdict.nominated == ball


@pytest.mark.parametrize(
    ("first", "foul"), [([], Foul.NO_CONTACT), ([4], Foul.WRONG_FIRST), ([4, 5], Foul.WRONG_FIRST)]
)
@pytest.mark.parametrize("nominated", [AUTO, 0])
def test_no_colour_nominated_and_a_foul_is_seven(first, foul, nominated):
    assert_foul(rule("ANY_COLOUR", first=first, nominated=nominated), foul | Foul.NO_NOMINATION, 7)


def test_auto_takes_the_highest_of_several_and_else_a_touching_one():
    assert rule("ANY_COLOUR", first=[YELLOW, GREEN]).nominated == GREEN
    assert rule("ANY_COLOUR", first=[YELLOW, GREEN]).penalty == 4
    assert_fair(rule("ANY_COLOUR", touching=BLUE), 0, "RED", False)
    assert rule("ANY_COLOUR", touching=BLUE, first=PINK).nominated == PINK


def test_auto_takes_a_free_ball_only_when_one_was_played():
    assert rule(free_ball=True, first=BLUE).nominated == BLUE
    assert rule(free_ball=True, first=1, touching=BLUE).nominated == 0
    assert_fair(rule(free_ball=True, first=1, potted=1), 1, "ANY_COLOUR", True)
    assert_foul(rule(free_ball=True, first=BLUE, nominated=0), Foul.WRONG_FIRST, 5)


# Free ball


@pytest.mark.parametrize(
    ("potted", "points", "left", "respotted"),
    [
        ([BLUE], 1, 15, [BLUE]),
        ([1], 1, 14, []),
        ([BLUE, 1], 2, 14, [BLUE]),
        ([BLUE, 1, 2], 3, 13, [BLUE]),
        ([], 0, 15, []),
    ],
)
def test_a_free_ball_as_a_red(potted, points, left, respotted):
    verdict = rule(free_ball=True, nominated=BLUE, first=BLUE, potted=potted)
    assert_fair(verdict, points, "ANY_COLOUR" if points else "RED", points > 0)
    assert len(ids_of(verdict.on_table & REDS_MASK)) == left and verdict.respotted == mask_of(respotted)


@pytest.mark.parametrize(
    ("potted", "points", "after", "respotted"),
    [([GREEN], 2, "YELLOW", [GREEN]), ([YELLOW], 2, "GREEN", []), ([GREEN, YELLOW], 2, "GREEN", [GREEN])],
)
def test_a_free_ball_as_a_colour_scores_once(potted, points, after, respotted):
    verdict = rule("YELLOW", free_ball=True, nominated=GREEN, first=GREEN, potted=potted)
    assert_fair(verdict, points, after, True)
    assert verdict.respotted == mask_of(respotted)


@pytest.mark.parametrize(
    ("seen", "foul", "penalty"),
    [
        ({"first": 1}, Foul.WRONG_FIRST, 4),
        ({"first": [1, BLACK]}, None, 0),
        ({"first": [BLACK, BLUE]}, Foul.WRONG_FIRST, 5),
        ({"first": PINK}, Foul.WRONG_FIRST, 6),
        ({"first": BLACK, "potted": [BLACK, PINK]}, Foul.WRONG_POT, 6),
        ({"first": BLACK, "potted": CUE}, Foul.CUE_POTTED, 4),
        ({"first": BLACK, "off": BLACK}, Foul.BALL_OFF, 4),
        ({}, Foul.NO_CONTACT, 4),
        ({"touching": BLACK}, None, 0),
    ],
)
def test_a_free_ball_takes_the_place_and_value_of_a_red(seen, foul, penalty):
    verdict = rule(free_ball=True, nominated=BLACK, **seen)
    assert (verdict.fouls, verdict.penalty) == (foul or Foul(0), penalty)


def test_no_snooker_behind_the_free_ball_but_with_pink_and_black():
    behind = {"free_ball": True, "snookered": True, "behind_free_ball": True}
    assert_foul(rule(nominated=BLACK, first=BLACK, **behind), Foul.BEHIND_FREE_BALL, 4)
    assert_foul(rule("BLUE", nominated=BLACK, first=BLACK, **behind), Foul.BEHIND_FREE_BALL, 5, "BLUE")
    assert_fair(rule("PINK", nominated=BLACK, first=BLACK, **behind), 0, "PINK", False)
    assert_fair(rule(nominated=0, first=1, **behind), 0, "RED", False)


@pytest.mark.parametrize(("potted", "points"), [(BLUE, 1), (1, 1), ([BLUE, 1], 2)])
def test_a_snooker_behind_the_free_ball_is_fair_after_a_stroke_that_scores(potted, points):
    """S3 R12(b)(ii): "after a non-scoring stroke"."""
    behind = {
        "free_ball": True,
        "snookered": True,
        "behind_free_ball": True,
        "first": BLUE,
        "nominated": BLUE,
    }
    assert_fair(rule(potted=potted, **behind), points, "ANY_COLOUR", True)
    verdict = rule(potted=[BLUE, CUE], **behind)  # a foul scores nothing
    assert verdict.fouls & Foul.BEHIND_FREE_BALL and verdict.penalty == 4


def test_a_free_ball_only_after_a_foul_that_leaves_a_snooker():
    assert rule(snookered=True).free_ball
    assert not rule(snookered=False).free_ball
    assert not rule(first=1, snookered=True).free_ball
    assert not rule("BLACK", snookered=True, lead=20).free_ball


# The end


@pytest.mark.parametrize(
    ("lead", "seen", "outcome", "end"),
    [
        (2, {"first": BLACK, "potted": BLACK}, Outcome.STRIKER_WINS, VisitEnd.CLEARANCE),
        (-20, {"first": BLACK, "potted": BLACK}, Outcome.OPPONENT_WINS, VisitEnd.CLEARANCE),
        (-7, {"first": BLACK, "potted": BLACK}, Outcome.RESPOTTED_BLACK, VisitEnd.CLEARANCE),
        (0, {"first": BLACK, "potted": BLACK}, Outcome.STRIKER_WINS, VisitEnd.CLEARANCE),
        (0, {}, Outcome.OPPONENT_WINS, VisitEnd.FOUL),
        (5, {"first": BLACK, "potted": CUE}, Outcome.OPPONENT_WINS, VisitEnd.FOUL),
        (20, {"first": BLACK, "potted": [CUE, BLACK]}, Outcome.STRIKER_WINS, VisitEnd.FOUL),
        (7, {}, Outcome.RESPOTTED_BLACK, VisitEnd.FOUL),
        (7, {"first": BLACK}, Outcome.PLAYING, VisitEnd.MISS),
    ],
)
def test_the_last_black(lead, seen, outcome, end):
    verdict = rule("BLACK", lead=lead, **seen)
    assert (verdict.outcome, verdict.visit_end) == (outcome, end)
    assert verdict.over == (outcome in (Outcome.STRIKER_WINS, Outcome.OPPONENT_WINS))
    if outcome == Outcome.RESPOTTED_BLACK:
        assert (verdict.stays, verdict.in_hand, verdict.ball_on) == (None, True, BallOn.BLACK)
        assert verdict.respotted == verdict.on_table == 1 << BLACK
    elif verdict.over:
        assert (verdict.ball_on, verdict.on_table, verdict.respotted) == (BallOn.NOTHING, 0, 0)


def test_a_foul_on_an_earlier_colour_does_not_end_the_frame():
    assert rule("PINK", first=PINK, potted=[PINK, BLACK]).outcome == Outcome.PLAYING


def test_a_practice_table_without_colours_ends_with_its_last_red():
    assert rule(on_table=[1], first=1, potted=1).visit_end == VisitEnd.CLEARANCE
    assert_fair(rule(on_table=[1, 2], first=1, potted=1), 1, "RED", True)
