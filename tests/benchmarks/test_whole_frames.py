"""Do fifty whole frames end by the rules, with every point and ball accounted for, and can the checks of that fail?"""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks import frames
from snooker_env.game.balls import BLACK, PINK
from snooker_env.tasks.frame_table import FrameTable
from snooker_env.tasks.opponents import GhostBall
from snooker_env.tasks.stroke import shooter_of


@pytest.mark.parametrize(("kind", "miss", "count"), [("random", "off", 30), ("random", "clear_path", 10), ("ghost_ball", "off", 10)])
def test_whole_frames_end_by_the_rules_with_every_point_and_ball_accounted_for(kind, miss, count):
    tallies = [frames.play_frame(seed, kind, miss) for seed in range(count)]
    ends = {t.ending for t in tallies}
    assert ends <= {"black potted", "foul on the black", "re-spotted black", "third miss"}
    assert ("third miss" in ends) == (miss == "clear_path")
    assert sum(t.fouls for t in tallies) > 0 and all(t.strokes >= 3 for t in tallies)


class Spoiled(GhostBall):
    """A player at whose tenth stroke something goes wrong."""

    def __init__(self, how):
        self.how, self.n = how, 0

    def play(self, table, observe, rng, path):
        played = super().play(table, observe, rng, path)
        self.n += 1
        if self.n == 10:
            self.how(table)
        return played


def _points(table):
    table.frame = replace(table.frame, scores=(table.frame.scores[0] + 1, table.frame.scores[1]))


def _lost(table):
    table.on_table[BLACK] = False


def _doubled(table):
    table.positions[BLACK] = table.positions[PINK]


@pytest.mark.parametrize("how", [_points, _lost, _doubled])
def test_the_checks_of_whole_frames_can_fail(how, monkeypatch):
    monkeypatch.setitem(frames.PLAYERS, "ghost_ball", Spoiled(how))
    with pytest.raises((AssertionError, ValueError)):
        frames.play_frame(3, "ghost_ball", "off")


def test_a_replay_that_differs_is_noticed():
    table = FrameTable(shooter_of("target", False, True, True, "none", "paper", "match", "standard"))
    rng = np.random.default_rng(0)
    table.start(*frames.break_off(rng), breaker=0, in_hand=True)
    text = frames.as_json(table, rng)
    frames.turn(table, frames.PLAYERS["random"], rng)
    want = frames.as_json(table, rng)
    fresh = lambda: FrameTable(table.shooter)  # noqa: E731
    frames.check_replay(text, [want], frames.PLAYERS["random"], fresh)
    with pytest.raises(AssertionError, match="played on otherwise"):
        frames.check_replay(text, [want.replace("0.", "0.1", 1)], frames.PLAYERS["random"], fresh)
