"""Do fifty whole frames end by the rules, with every point and ball, and can the checks of that fail?"""

import pytest

from benchmarks import frames


@pytest.mark.parametrize(
    ("kind", "miss", "count"),
    [("random", "off", 30), ("random", "clear_path", 10), ("ghost_ball", "off", 10)],
)
def test_whole_frames_end_by_the_rules_with_every_point_and_ball_accounted_for(kind, miss, count):
    tallies = [frames.play_frame(seed, kind, miss) for seed in range(count)]
    ends = {t.ending for t in tallies}
    assert ends <= {"black potted", "foul on the black", "re-spotted black", "third miss"}
    assert ("third miss" in ends) == (miss == "clear_path")
    assert sum(t.fouls for t in tallies) > 0 and all(t.strokes >= 3 for t in tallies)


def test_a_replay_that_differs_is_noticed():
    table = frames.FrameTable("off")
    table.start(0)
    text = table.as_json()
    table.turn("random")
    want = table.as_json()
    frames.check_replay(text, [want], "random", "off")
    with pytest.raises(AssertionError, match="played on otherwise"):
        frames.check_replay(text, [want.replace("0.", "0.1", 1)], "random", "off")
