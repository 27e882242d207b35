"""Do frames of every game go on as their rules say? What six-red and the Shoot Out change; random strokes."""

import json
from collections import Counter
from itertools import product

import numpy as np
import pytest

from snooker_env.game.balls import COLOURS_MASK, balls_on, ids_of, mask_of
from snooker_env.game.frame import MISS_RULES, Frame, frame_of, write_frame
from snooker_env.game.frame_columns import COLUMNS, Layouts
from snooker_env.game.referee import Stroke
from snooker_env.game.rule_sets import RULES

LAYOUT = tuple((0.01 * i, -0.5) for i in range(22)), (True,) * 22


def stroke_at(frame, rng):
    """A stroke that can be played: often a pot, often nothing at all."""
    on = ids_of(balls_on(frame.ball_on, frame.on_table))
    ball = int(rng.choice(on if rng.random() < 0.7 else ids_of(frame.on_table)))
    potted = mask_of([ball]) if rng.random() < 0.5 else int(rng.random() < 0.1)
    seen = {"snookered": bool(rng.random() < 0.3), "no_cushion": bool(rng.random() < 0.1)}
    if rng.random() < 0.4:
        return Stroke(**seen)
    behind = seen["snookered"] and bool(rng.random() < 0.3)
    return Stroke(first=1 << ball, potted=potted, behind_free_ball=behind, **seen)


def acted(frame, rng, to_play, met):
    """The frame after what its players do next, at random."""
    if frame.phase == "choice":
        what = str(rng.choice(frame.choices))
        met[what] += 1
        return frame.choose(what)
    if frame.phase == "lot":
        return frame.draw(int(rng.integers(2)))
    if frame.may_claim and rng.random() < 0.2:
        met["claimed"] += 1
        return frame.claim()
    if rng.random() < 0.002:
        met["conceded"] += 1
        return frame.concede(frame.striker)
    clear, full, attempt = (bool(x) for x in rng.random(3) < [0.5, 0.1, 0.4])
    times = {"time_to_play": to_play, "duration": int(rng.integers(1_000, 12_000))}
    how = {"clear_path": clear, "full_ball_path": full, "attempt": attempt}
    layout = None if frame.miss == "off" else LAYOUT
    after, verdict = frame.play(stroke_at(frame, rng), layout=layout, **how, **times)
    gained = [now - before for now, before in zip(after.scores, frame.scores, strict=True)]
    assert gained == [verdict.points, verdict.penalty][:: 1 if frame.striker == 0 else -1]
    met["late"] += bool(verdict.fouls & verdict.fouls.LATE)
    met["cushion"] += bool(verdict.fouls & verdict.fouls.NO_CUSHION)
    met["missed"] += after.miss_called
    return after


OFTEN = [("snooker", "clear_path"), ("snooker", "attempt"), ("six_red", "off"), ("shoot_out", "off")]


@pytest.mark.parametrize(
    ("rules", "miss"),
    [
        pytest.param(*pair, marks=[] if pair in OFTEN else pytest.mark.slow)
        for pair in product(RULES, MISS_RULES)
    ],
)
def test_whatever_is_played_the_frame_is_possible_and_a_table_keeps_it(rules, miss):
    if rules == "shoot_out" and miss != "off":
        with pytest.raises(ValueError, match="no miss is called"):
            Frame.start(rules=rules, miss=miss)
        return
    rng, met = np.random.default_rng(5), Counter()
    row, layouts = np.zeros(COLUMNS, np.int64), Layouts(np.zeros((1, 22, 2)), np.zeros((1, 22), np.bool_))
    for game in range(40):
        few = COLOURS_MASK | 0b110 if game % 2 else None
        frame = Frame.start(breaker=game % 2, miss=miss, rules=rules, on_table=few)
        to_play = int(rng.choice([4_000, 9_000, 12_000, 16_000]))
        for _ in range(400):
            assert Frame.from_dict(json.loads(json.dumps(frame.to_dict()))) == frame
            write_frame(frame, 7, row, layouts, 0)
            assert frame_of(row, miss, layouts, 0, rules) == frame
            if frame.phase == "over":
                break
            frame = acted(frame, rng, to_play, met)
        met["ended"] += frame.phase == "over"
    assert met["ended"] > 10 and met["claimed"]
    assert bool(met["late"] and met["cushion"]) == (rules == "shoot_out")
    assert (met["missed"] > 0) == (miss != "off") == (met["replace"] > 0)
    assert bool(met["play"]) == (rules != "shoot_out")


def test_six_reds_are_the_first_places_of_the_triangle():
    assert ids_of(Frame.start(rules="six_red").on_table) == (*range(1, 7), *range(16, 22))
    assert Frame.start(rules="six_red").available == 6 * 8 + 27


MISSED = Stroke()


def test_six_red_not_anywhere_when_snookers_are_required():
    frame = Frame.start(rules="six_red", miss="clear_path", on_table=COLOURS_MASK | 2)
    for _ in range(4):
        frame = frame.play(MISSED, clear_path=True, full_ball_path=False)[0].choose("replace")
    fifth, _ = frame.play(MISSED, clear_path=True)
    assert fifth.scores == (0, 20) and fifth.choices[-1] == "anywhere"
    few = Frame.from_dict(fifth.to_dict() | {"scores": [0, 36]})
    assert few.available == 35 and few.choices == ("play", "play_again")


def test_any_number_of_misses_with_part_of_a_ball_to_be_seen_until_the_scores_decide():
    """S3 R14 limits full balls alone: penalties add up until no miss is called for the scores."""
    frame, calls = Frame.start(miss="clear_path"), 0
    while True:
        frame, _ = frame.play(MISSED, clear_path=True)
        if not frame.miss_called:
            break
        calls, frame = calls + 1, frame.choose("replace")
    assert calls == 36 and frame.scores == (0, 148) and frame.available == 147  # 4 points each
