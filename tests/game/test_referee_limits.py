"""What can never be, whatever happens on a table, and what does the referee refuse to judge?"""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from snooker_env.game.balls import (
    ALL_MASK,
    BLACK,
    BLUE,
    COLOURS_MASK,
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
from snooker_env.game.ruling import RULE_FLAGS, Flag, Outcome, VisitEnd


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
