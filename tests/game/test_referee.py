"""Does the referee judge what neither cases nor oracle bring about, and refuse what can never be?"""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from snooker_env.game import balls, layouts
from snooker_env.game.apply_ruling import settle_table
from snooker_env.game.balls import BLACK, BLUE, COLOURS_MASK, PINK, YELLOW, BallOn, balls_on, ids_of, mask_of
from snooker_env.game.fouls import RULE_FLAGS, Flag, Foul, Outcome, VisitEnd
from snooker_env.game.frame import Frame
from snooker_env.game.referee import FULL_TABLE, Situation, Stroke, judge
from snooker_env.game.rule_sets import RULES
from snooker_env.game.snookered import is_snookered
from tests.refusals import refuse_each

MASKS = ("first", "potted", "off", "touching", "moved")


def rule(ball_on="RED", on_table=None, *, free_ball=False, lead=0, **seen):
    """Judge a stroke; masks are given as a ball or a list of balls."""
    on = BallOn[ball_on]
    if on_table is None:
        on_table = range(1, 22) if on <= BallOn.RED else range(14 + on, 22)
    for name in MASKS:
        if name in seen:
            seen[name] = mask_of([seen[name]] if isinstance(seen[name], int) else seen[name])
    situation = Situation(on_table=mask_of(on_table), ball_on=on, free_ball=free_ball, lead=lead)
    return judge(situation, Stroke(**seen))


def assert_fair(verdict, points, ball_on, stays):
    assert (verdict.fouls, verdict.penalty) == (Foul(0), 0)
    assert (verdict.points, verdict.ball_on, verdict.stays) == (points, BallOn[ball_on], stays)


def assert_foul(verdict, fouls, penalty, ball_on="RED"):
    assert (verdict.fouls, verdict.penalty, verdict.points) == (fouls, penalty, 0)
    assert (verdict.ball_on, verdict.stays, verdict.visit_end) == (BallOn[ball_on], False, VisitEnd.FOUL)


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


def test_what_auto_nominates():
    assert rule("ANY_COLOUR", first=[YELLOW, balls.GREEN]).nominated == balls.GREEN
    assert rule("ANY_COLOUR", first=[YELLOW, balls.GREEN]).penalty == 4
    assert_fair(rule("ANY_COLOUR", touching=BLUE), 0, "RED", False)
    assert rule("ANY_COLOUR", touching=BLUE, first=PINK).nominated == PINK
    assert rule(free_ball=True, first=BLUE).nominated == BLUE
    assert rule("YELLOW", free_ball=True, first=YELLOW).nominated == 0  # the ball on itself is no free ball
    assert rule(free_ball=True, first=1, touching=BLUE).nominated == 0
    assert_fair(rule(free_ball=True, first=1, potted=1), 1, "ANY_COLOUR", True)
    assert_foul(rule(free_ball=True, first=BLUE, nominated=0), Foul.WRONG_FIRST, 5)


@st.composite
def strokes(draw):
    on_table = draw(st.integers(0, FULL_TABLE)) & ~1
    possible = [
        on
        for on in BallOn
        if on >= 0 and balls_on(on, on_table) and not (on > 1 and on_table & balls.REDS_MASK)
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
    seen = {"first": first, "touching": touching, "moved": moved, "potted": potted}
    return situation, Stroke(**seen, off=draw(some) & ~potted, **flags)


@settings(max_examples=200, deadline=None)
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
    assert not verdict.on_table & balls.REDS_MASK & (stroke.potted | stroke.off)
    if verdict.fouls and verdict.outcome == Outcome.PLAYING:
        assert verdict.on_table & COLOURS_MASK == (situation.on_table & COLOURS_MASK)
        assert verdict.ball_on == balls.next_on(verdict.on_table)
    assert verdict.over == (verdict.ball_on == BallOn.NOTHING)
    assert bool(verdict.stays) == (verdict.points > 0 and verdict.outcome == Outcome.PLAYING)
    if (stroke.potted | stroke.off) & 1:
        assert verdict.in_hand and verdict.fouls
    assert (verdict.visit_end == VisitEnd.FOUL) == bool(verdict.fouls)


def test_a_table_is_settled_as_the_referee_says():
    """Balls gone, colours back; the table says what is snookered, and must be that of the situation."""
    rng = np.random.default_rng(0)
    for _ in range(50):
        positions, on_table = layouts.layout("random:5", rng)
        there = mask_of(np.flatnonzero(on_table))
        situation = Situation(on_table=there, ball_on=BallOn(int(rng.integers(0, 2))))
        balls = [0, *range(1, 6), *range(YELLOW, 22)]
        potted = mask_of(rng.choice(balls, int(rng.integers(0, 3)), replace=False))
        stroke = Stroke(first=1 << int(rng.choice(balls[1:])), potted=potted)
        verdict, placed, left = settle_table(positions, on_table, situation, stroke)
        assert replace(verdict, free_ball=False) == replace(judge(situation, stroke), free_ball=False)
        assert mask_of(np.flatnonzero(left)) & ~1 == verdict.on_table
        on = mask_of(ids_of(balls_on(verdict.ball_on, verdict.on_table)))
        hidden = not left[0] or is_snookered(placed, left, on)[0]
        assert not verdict.free_ball or (verdict.fouls and hidden)
    with pytest.raises(ValueError, match="on_table"):
        settle_table(positions, ~on_table, situation, stroke)


# Wrong input

IMPOSSIBLE = """
Situation(on_table=-1) | on_table | -1 | must
Situation(on_table=1 << 22) | on_table | 4194304 | must
Situation(on_table=COLOURS_MASK) | ball_on | red | must
Situation(ball_on=BallOn.YELLOW) | ball_on | yellow | must be 'red' or
Situation(ball_on=?) | ball_on | ? | must be an integer in [0, 7] | BallOn.NOTHING; 8
Situation(ball_on=BallOn.ANY_COLOUR, free_ball=True) | free_ball | True | must
Situation(lead=0.5) | lead | 0.5 | must
Stroke(first=1) | first | 1 | must name object balls only
Stroke(first=?) | first | ? | must be an integer in [0, | 1 << 22; np.float64(2)
Stroke(touching=1) | touching | 1 | must name object balls only
Stroke(moved=2) | moved | (1,) | must
Stroke(potted=2, off=2) | off | (1,) | must
Stroke(nominated=?) | nominated | ? | must | 1; 22; None
judge(at(FULL_TABLE & ~2), Stroke(first=2)) | first | red 1 | must
judge(at(FULL_TABLE & ~2), Stroke(potted=2)) | potted | red 1 | must
judge(at(), Stroke(nominated=BLUE)) | nominated | blue | must be none
judge(at((1 << YELLOW) + (1 << BLACK), BallOn.YELLOW, True), Stroke(nominated=YELLOW)) | nominated | yellow | must be one of ['black']
judge(at(2 + (1 << BLACK), BallOn.ANY_COLOUR), Stroke(nominated=BLUE)) | nominated | blue | must be one of ['black']
Frame(striker=?) | striker | ? | must | 2
Frame(scores=[0, 0]) | scores | [0, 0] | must be a tuple of two
Frame(scores=(0, -1)) | scores | -1 | must be an integer in [0,
Frame(phase=?) | phase | ? | must | 'end'
Frame(miss=?) | miss | ? | must | 'on'
Frame(winner=?) | winner | ? | must | 0
Frame(on_table=?) | on_table | ? | must | -1
Frame(ball_on=BallOn.YELLOW) | ball_on | yellow | must be 'red' or
Frame(failures=?) | failures | ? | must | -1; True
Frame(break_points=?) | break_points | ? | must | 156
Frame(in_hand=?) | in_hand | ? | must | 1
Frame(saved=?) | saved | ? | must | 3
Frame.from_dict(dict(PLAIN, more=1)) | frame | more | must
Frame.from_dict([]) | frame | [] | must
Frame.from_dict(dict(PLAIN, ball_on=9)) | frame.ball_on | 9 | must
"""


def test_impossible_situations_strokes_and_frames_are_refused():
    def at(on_table=FULL_TABLE, ball_on=BallOn.RED, free_ball=False):
        return Situation(on_table=on_table, ball_on=ball_on, free_ball=free_ball)

    refuse_each(IMPOSSIBLE, globals() | {"PLAIN": Frame.start().to_dict(), "at": at})
