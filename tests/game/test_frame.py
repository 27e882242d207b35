"""Does a frame go on as the rules say, to the last black, and survive being written down?"""

from dataclasses import replace

import pytest

from snooker_env.game.balls import BLACK, BLUE, COLOURS_MASK, PINK, BallOn, balls_on, ids_of
from snooker_env.game.frame import Frame, points_available
from snooker_env.game.referee import FULL_TABLE, Stroke

MISSED = Stroke()
PATHS = {"clear_path": True, "full_ball_path": True}


def pot(ball, **more):
    return Stroke(first=1 << ball, potted=1 << ball, **more)


def hit(ball, **more):
    return Stroke(first=1 << ball, **more)


def played(frame, *strokes):
    for stroke in strokes:
        frame, _ = frame.play(stroke)
    return frame


def last(ball_on, scores=(0, 0), **more):
    """A frame on a late colour."""
    on_table = COLOURS_MASK & ~((1 << (14 + ball_on)) - 1)
    return Frame(on_table=on_table, ball_on=ball_on, scores=scores, in_hand=False, **more)


def test_play_takes_the_free_ball_play_again_voids_it_and_neither_is_taken_back():
    foul = played(Frame.start(), Stroke(snookered=True))
    assert foul.free_ball
    mine, theirs = foul.choose("play"), foul.choose("play_again")
    assert (mine.striker, mine.free_ball, theirs.striker, theirs.free_ball) == (1, True, 0, False)
    assert played(mine, pot(BLACK, nominated=BLACK)).scores == (0, 5)
    assert played(theirs, pot(1)).scores == (1, 4)
    foul = played(Frame.start(), MISSED)
    with pytest.raises(ValueError, match="choice"):
        foul.play(MISSED)
    with pytest.raises(ValueError, match="stroke"):
        foul.choose("play_again").choose("play")
    with pytest.raises(ValueError, match="replace"):
        foul.choose("replace")


def test_replacing_restores_table_and_free_ball_and_keeps_the_penalty():
    frame = played(Frame.start(miss="clear_path"), pot(1))
    foul, _ = frame.play(Stroke(first=4, potted=4, nominated=BLUE), **PATHS, layout=((0.1, 0.2), (0.3, 0.4)))
    assert foul.choices == ("play", "play_again", "replace") and foul.on_table == frame.on_table & ~4
    again = foul.choose("replace")
    assert (again.striker, again.on_table, again.scores) == (0, frame.on_table, (1, 5))
    assert again.ball_on == BallOn.ANY_COLOUR and again.saved.layout == ((0.1, 0.2), (0.3, 0.4))
    assert played(again, pot(PINK)).scores == (7, 5)  # another colour may be nominated
    frame = Frame(free_ball=True, miss="clear_path")
    assert frame.play(Stroke(nominated=BLUE), **PATHS)[0].choose("replace").free_ball


@pytest.mark.parametrize(
    ("on_table", "ball_on", "worth"),
    [
        (FULL_TABLE, BallOn.RED, 8),  # the free ball as a red, and a black
        (COLOURS_MASK | 2, BallOn.RED, 8),
        # any colour as the yellow, which comes back: the yellow is still on
        (COLOURS_MASK, BallOn.YELLOW, 2),
        (1 << PINK | 1 << BLACK, BallOn.PINK, 6),
        (1 << BLACK, BallOn.BLACK, 0),  # there is no other ball to nominate
    ],
)
def test_a_free_ball_adds_to_the_points_available(on_table, ball_on, worth):
    """As many as the referee gives for the best of all breaks, whichever ball they begin with."""
    plain, free = (Frame(on_table=on_table, ball_on=ball_on, free_ball=given) for given in (False, True))
    assert free.available == plain.available + worth == points_available(on_table, ball_on, free_ball=True)
    best = 0
    for ball in (ids_of(balls_on(ball_on, on_table))[0], *ids_of(on_table & COLOURS_MASK)):
        after, verdict = free.play(pot(ball))
        best = max(best, verdict.points + (0 if after.phase == "over" else after.available))
    assert free.available == best


def test_what_only_the_striker_may_play_is_not_there_for_the_other_player():
    """A colour after a red is the striker's, and so is a free ball."""
    colour = Frame(on_table=COLOURS_MASK | 2, ball_on=BallOn.ANY_COLOUR, striker=1, scores=(0, 36))
    assert colour.available == 42 and colour.needs_snookers(0)
    assert not replace(colour, scores=(0, 35)).needs_snookers(0)
    assert not replace(colour, scores=(42, 0)).needs_snookers(1)
    assert replace(colour, scores=(43, 0)).needs_snookers(1)
    free = replace(colour, ball_on=BallOn.RED, free_ball=True)
    assert free.needs_snookers(0) and not replace(free, scores=(43, 0)).needs_snookers(1)


@pytest.mark.parametrize("first", [0, 1])
def test_a_respotted_black_is_decided_by_the_next_score_or_foul(first):
    lot = played(last(BallOn.BLACK, (50, 57)), pot(BLACK))
    assert lot.respotted_black and lot.in_hand
    frame = lot.draw(first)
    assert frame.striker == first and frame.on_table == 1 << BLACK
    assert played(frame, pot(BLACK)).winner == first
    assert played(frame, MISSED).winner == 1 - first
    assert played(frame, hit(BLACK), pot(BLACK)).winner == 1 - first
    with pytest.raises(ValueError, match="phase"):
        frame.draw(0)
