"""Does a worth of frames see of a position what its words say?"""

from math import asin, log

import numpy as np
import pytest

from snooker_env.game import frame_columns as columns
from snooker_env.geometry import BALL_RADIUS
from snooker_env.planning import Position
from snooker_env.planning.learned.frame_features import (
    HIDDEN,
    NARROWEST,
    NEAREST,
    RED_ENTRIES,
    SIZE,
    WIDEST,
    frame_features,
    read_errors,
)
from snooker_env.planning.learned.value_features import SIZE as VISIT_SIZE
from snooker_env.tasks.noise import Spread
from tests.planning.test_frame_judge import frame_of

COLOURS = VISIT_SIZE + NEAREST * RED_ENTRIES
SHARED = COLOURS + 6
MIDDLE = Spread(1e-3)


def seen(at, spread=MIDDLE):
    return frame_features(at, spread)[0].astype(float)


def test_one_ball_is_seen_whole_in_one_window():
    row = seen(frame_of(Position(cue=(0.2, 0.0), reds=[(0.2, 0.5)], black=(0.0, 1.4605), on="red")))
    assert len(row) == SIZE
    first, second = row[VISIT_SIZE:][:RED_ENTRIES], row[VISIT_SIZE:][RED_ENTRIES : 2 * RED_ENTRIES]
    assert first == pytest.approx([1.0, 0.0, 0.5, 1.0, 0.5], abs=1e-6) and not second.any()
    window = 2.0 * asin(2.0 * BALL_RADIUS / 0.5)
    assert row[SHARED + 3 : SHARED + 6] == pytest.approx([0.25, window, window], rel=1e-5)
    assert row[HIDDEN] == 0.0 and row[SHARED + 10 : SHARED + 12] == pytest.approx([0.5, 1.0])
    assert row[SHARED + 16] == pytest.approx((8 + 7) ** 0.5 / 12.0)


def test_a_ball_in_the_way_hides_and_half_a_ball_is_half_seen():
    hidden = seen(frame_of(Position(cue=(0.0, 0.0), reds=[(0.6, 0.0)], blue=(0.2, 0.0), on="red")))
    assert hidden[HIDDEN] == 1.0 and hidden[SHARED + 4] == 0.0 and hidden[VISIT_SIZE + 3] == 0.0
    # the edge of what the blue covers runs through the middle of the red: the cue ball passes it by its own width
    beside = 2.0 * BALL_RADIUS
    half = seen(frame_of(Position(cue=(0.0, 0.0), reds=[(0.0, 1.0)], blue=(beside, 0.5), on="red")))
    edge = asin(beside / np.hypot(beside, 0.5)) - asin(beside / np.hypot(beside, 0.5))
    assert edge == 0.0 and half[VISIT_SIZE + 3] == pytest.approx(0.5, abs=0.01)


def test_the_three_nearest_reds_come_in_order_and_the_table_is_read_mirrored():
    reds = [(0.5, 0.9), (0.1, 0.2), (-0.4, 0.6), (0.3, -0.2)]
    at = frame_of(Position(cue=(0.2, 0.1), reds=reds, black=(0.0, 1.4605), on="red"))
    row = seen(at)
    far = sorted(np.hypot(x - 0.2, y - 0.1) for x, y in reds)[:3]
    assert row[VISIT_SIZE + 4 : COLOURS : RED_ENTRIES] == pytest.approx(far, rel=1e-6)
    mirror = [(-x, y) for x, y in reds]
    mirrored = seen(frame_of(Position(cue=(-0.2, 0.1), reds=mirror, black=(0.0, 1.4605), on="red")))
    assert mirrored[VISIT_SIZE:] == pytest.approx(row[VISIT_SIZE:], abs=1e-5)


def test_the_state_of_the_frame_and_the_size_of_the_errors_are_told():
    at = frame_of(Position(cue=(0.2, 0.0), reds=[(0.2, 0.5)], black=(0.0, 1.4605), on="red"))
    plain = seen(at)
    for column, entry in ((columns.IN_HAND, 0), (columns.FREE_BALL, 1), (columns.RESPOTTED_BLACK, 2)):
        changed = at.copy()
        changed.game[:, column] = 1
        assert plain[SHARED + entry] == 0.0 and seen(changed)[SHARED + entry] == 1.0
    for core, shown in ((1e-3, 1e-3), (1e-5, NARROWEST), (0.1, WIDEST)):
        spread = Spread(core)
        assert seen(at, spread)[SHARED + 17] == pytest.approx(log(shown / 1.2e-3), rel=1e-5)
        assert read_errors(frame_features(at, spread)) == pytest.approx([shown], rel=1e-5)
