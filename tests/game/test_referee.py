"""Does the referee judge what neither cases nor oracle bring about, and refuse what can never be?"""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from snooker_env.game.balls import (
    ALL_MASK,
    BLACK,
    BLUE,
    COLOURS_MASK,
    CUE,
    GREEN,
    PINK,
    REDS_MASK,
    YELLOW,
    BallOn,
    balls_on,
    ids_of,
    mask_of,
    next_on,
)
from snooker_env.game.referee import FULL_TABLE, Situation, Stroke, judge
from snooker_env.game.rule_sets import RULES
from snooker_env.game.ruling import RULE_FLAGS, Flag, Foul, Outcome, VisitEnd

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


# First impact


# Balls down, balls off, the cue ball


def test_only_the_nominated_colour_may_be_potted():
    assert_foul(rule("ANY_COLOUR", first=BLUE, potted=[BLUE, BLACK], nominated=BLUE), Foul.WRONG_POT, 7)
    verdict = rule("ANY_COLOUR", first=BLUE, potted=[BLUE, 4], nominated=BLUE)
    assert_foul(verdict, Foul.WRONG_POT, 5)
    assert verdict.on_table == FULL_TABLE & ~(1 << 4)


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


# How the cue ball was played


@pytest.mark.parametrize(
    ("field", "foul"),
    [(name, Foul[name.upper()]) for name in ("jump", "double_hit", "outside_d", "feet", "out_of_turn")],
)
@pytest.mark.parametrize(("ball_on", "ball", "penalty"), [("RED", 1, 4), ("PINK", PINK, 6)])
def test_how_it_was_played_costs_the_ball_on(field, foul, ball_on, ball, penalty):
    assert_foul(rule(ball_on, first=ball, potted=ball, **{field: True}), foul, penalty, ball_on)


def test_penalties_of_a_push_and_of_seven_points():
    assert_foul(rule(first=1, push=True), Foul.PUSH, 4)
    assert_foul(rule(first=BLACK, push=True), Foul.PUSH | Foul.WRONG_FIRST, 7)
    assert_foul(rule(first=1, touching=PINK, moved=PINK), Foul.PUSH, 6)
    # free to meet the black, but not to push it
    assert_foul(rule(touching=1, first=BLACK, push=True), Foul.PUSH, 7)
    assert_foul(rule(first=1, potted=1, seven=True), Foul.SEVEN, 7)


# Touching ball


# Nomination left to the referee


def test_a_touching_ball_that_is_moved_is_not_struck_and_a_free_ball_costs_what_is_on():
    assert_foul(rule(touching=1, moved=1), Foul.PUSH | Foul.NO_CONTACT, 4)
    free = {"free_ball": True, "nominated": BLACK}
    assert_foul(rule(**free, first=[BLACK, BLUE]), Foul.WRONG_FIRST, 5)
    assert_foul(rule(**free, first=BLACK, off=BLACK), Foul.BALL_OFF, 4)


def test_what_auto_nominates():
    assert rule("ANY_COLOUR", first=[YELLOW, GREEN]).nominated == GREEN
    assert rule("ANY_COLOUR", first=[YELLOW, GREEN]).penalty == 4
    assert_fair(rule("ANY_COLOUR", touching=BLUE), 0, "RED", False)
    assert rule("ANY_COLOUR", touching=BLUE, first=PINK).nominated == PINK
    assert rule(free_ball=True, first=BLUE).nominated == BLUE
    assert rule("YELLOW", free_ball=True, first=YELLOW).nominated == 0  # the ball on itself is no free ball
    assert rule(free_ball=True, first=1, touching=BLUE).nominated == 0
    assert_fair(rule(free_ball=True, first=1, potted=1), 1, "ANY_COLOUR", True)
    assert_foul(rule(free_ball=True, first=BLUE, nominated=0), Foul.WRONG_FIRST, 5)


# Free ball


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
        (-7, {"first": BLACK, "potted": BLACK}, Outcome.RESPOTTED_BLACK, VisitEnd.CLEARANCE),
        (5, {"first": BLACK, "potted": CUE}, Outcome.OPPONENT_WINS, VisitEnd.FOUL),
        (7, {"first": BLACK}, Outcome.PLAYING, VisitEnd.MISS),
    ],
)
def test_how_a_visit_ends_on_the_last_black(lead, seen, outcome, end):
    verdict = rule("BLACK", lead=lead, **seen)
    assert (verdict.outcome, verdict.visit_end) == (outcome, end)
    assert verdict.over == (outcome in (Outcome.STRIKER_WINS, Outcome.OPPONENT_WINS))
    if outcome == Outcome.RESPOTTED_BLACK:
        assert (verdict.stays, verdict.in_hand, verdict.ball_on) == (None, True, BallOn.BLACK)
        assert verdict.respotted == verdict.on_table == 1 << BLACK
    elif verdict.over:
        assert (verdict.ball_on, verdict.on_table, verdict.respotted) == (BallOn.NOTHING, 0, 0)


def test_what_ends_a_frame_or_a_practice_table():
    assert rule("PINK", first=PINK, potted=[PINK, BLACK]).outcome == Outcome.PLAYING
    assert rule(on_table=[1], first=1, potted=1).visit_end == VisitEnd.CLEARANCE
    assert_fair(rule(on_table=[1, 2], first=1, potted=1), 1, "RED", True)


@st.composite
def strokes(draw):
    on_table = draw(st.integers(0, FULL_TABLE)) & ~1
    possible = [
        on for on in BallOn if on >= 0 and balls_on(on, on_table) and not (on > 1 and on_table & REDS_MASK)
    ]
    assume(possible)
    ball_on = draw(st.sampled_from(possible))
    some = st.sets(st.sampled_from([0, *ids_of(on_table)]), max_size=4).map(mask_of)
    first, touching, potted = draw(some) & ~1, draw(some) & ~1, draw(some)
    flags = {flag.name.lower(): draw(st.integers(0, 9)) == 0 for flag in Flag if flag not in RULE_FLAGS}
    moved = touching & draw(some)
    free_ball = ball_on != BallOn.ANY_COLOUR and draw(st.booleans())
    rules, lead = draw(st.sampled_from(RULES)), draw(st.integers(-10, 10))
    situation = Situation(on_table=on_table, ball_on=ball_on, free_ball=free_ball, lead=lead, rules=rules)
    return situation, Stroke(
        first=first, touching=touching, moved=moved, potted=potted, off=draw(some) & ~potted, **flags
    )


@settings(max_examples=400, deadline=None)
@given(strokes())
def test_invariants(case):
    situation, stroke = case
    verdict = judge(situation, stroke)
    assert verdict == judge(situation, stroke)
    assert verdict.penalty in ((4, 5, 6, 7) if verdict.fouls else (0,))
    assert not (verdict.points and verdict.fouls) and 0 <= verdict.points <= 16
    assert verdict.respotted & ~COLOURS_MASK == 0 and verdict.respotted & ~verdict.on_table == 0
    gone = situation.on_table & ~verdict.on_table
    assert gone & ~(stroke.potted | stroke.off) == 0 or verdict.over
    assert not verdict.on_table & REDS_MASK & (stroke.potted | stroke.off)
    if verdict.fouls and verdict.outcome == Outcome.PLAYING:
        assert verdict.on_table & COLOURS_MASK == (situation.on_table & COLOURS_MASK)
        assert verdict.ball_on == next_on(verdict.on_table)
    assert verdict.over == (verdict.ball_on == BallOn.NOTHING)
    assert bool(verdict.stays) == (verdict.points > 0 and verdict.outcome == Outcome.PLAYING)
    if (stroke.potted | stroke.off) & 1:
        assert verdict.in_hand and verdict.fouls
    assert (verdict.visit_end == VisitEnd.FOUL) == bool(verdict.fouls)


# Wrong input


@pytest.mark.parametrize(
    "fields",
    [
        {"on_table": -1},
        {"on_table": ALL_MASK + 1},
        {"ball_on": BallOn.NOTHING},
        {"ball_on": BallOn.YELLOW},
        {"ball_on": 8},
        {"on_table": COLOURS_MASK},
        {"ball_on": BallOn.ANY_COLOUR, "free_ball": True},
        {"lead": 0.5},
    ],
)
def test_impossible_situations_are_refused(fields):
    with pytest.raises(ValueError, match=" = "):
        Situation(**fields)


@pytest.mark.parametrize(
    "fields",
    [
        {"first": 1},
        {"first": 1 << 22},
        {"first": np.float64(2)},
        {"touching": 1},
        {"moved": 2},
        {"potted": 2, "off": 2},
        {"nominated": 1},
        {"nominated": 22},
        {"nominated": None},
    ],
)
def test_impossible_strokes_are_refused(fields):
    with pytest.raises(ValueError, match=" = "):
        Stroke(**fields)


@pytest.mark.parametrize(
    ("situation", "stroke", "field"),
    [
        ({"on_table": FULL_TABLE & ~2}, {"first": 2}, "first"),
        ({"on_table": FULL_TABLE & ~2}, {"potted": 2}, "potted"),
        ({}, {"nominated": BLUE}, "nominated"),
        (
            {"on_table": 1 << YELLOW | 1 << BLACK, "ball_on": BallOn.YELLOW, "free_ball": True},
            {"nominated": YELLOW},
            "nominated",
        ),
        ({"on_table": 2 | 1 << BLACK, "ball_on": BallOn.ANY_COLOUR}, {"nominated": BLUE}, "nominated"),
    ],
)
def test_what_cannot_belong_together_is_refused(situation, stroke, field):
    with pytest.raises(ValueError, match=field):
        judge(Situation(**situation), Stroke(**stroke))
