"""Are frames read, and figures of frames counted, as their words say?"""

import numpy as np
import pytest

from agents import calibrate
from agents.calibrate import figures_of, frames_of, group_frames, tactics_of
from snooker_env.planning.learned.frame_features import HIDDEN, LIKELY, SIZE
from snooker_env.planning.worth import Chance
from tests.pictures import saved_figures, unreadable

TEXT = """# frames
M 20 30
24 1 F4 60/8 F5/10:00
/120/5:25
M 0 0
7/9 F4/2:00
"""


def test_a_file_of_frames_is_read():
    frames = frames_of(TEXT)
    assert [one["breaks"] for one in frames] == [[24, 1, 60, 8], [120], [7, 9]]
    assert [one["fouls"] for one in frames] == [2, 0, 1]
    assert frames[0]["points"].tolist() == [89.0, 13.0] and frames[0]["strokes"] == 24.0
    assert np.isnan(frames[2]["strokes"])
    figures = figures_of(frames)
    assert figures["visits"][0] == pytest.approx(7 / 3) and figures["break"][0] == pytest.approx(229 / 7)
    assert figures["frames_50"][0] == pytest.approx(200 / 3) and figures["breaks_100"][0] == pytest.approx(
        100 / 7
    )
    assert figures["winner"][0] == pytest.approx((89 + 120 + 13) / 3)
    for wrong in ("1 2 3", "a b/3/1:00", "M x"):
        with pytest.raises(ValueError, match="must hold lines"):
            frames_of(wrong)
    with pytest.raises(ValueError, match="two frames"):
        frames_of("# none")


def rows_of(strokes):
    """Rows of one frame: (striker, swing, likeliest pot, hidden) each."""
    striker, swing, likely, hidden = map(np.array, zip(*strokes, strict=True))
    seen, n = np.zeros((len(striker), SIZE + 1), np.float32), len(striker)
    seen[:, LIKELY], seen[:, HIDDEN] = likely, hidden
    after = np.append(np.arange(1, n), -1)
    same = np.append(np.where(striker[1:] == striker[:-1], 1, -1), 0)
    return {
        "frame": np.zeros(n, int),
        "striker": striker,
        "swing": swing.astype(float),
        "seen": seen,
        "next": after,
        "same": same,
    }


def test_breaks_of_frames_played_are_counted():
    first = [(0, 0, 0, 0), (1, 1, 0.95, 0), (1, 7, 0.9, 0), (1, 0, 0.3, 0)]
    rows = rows_of([*first, (0, -4, 0, 1), (1, 5, 0.99, 0), (1, 0, 0.2, 0), (0, 2, 0.5, 0)])
    (frame,) = group_frames(rows)
    assert frame["breaks"] == [8.0, 5.0, 2.0] and frame["fouls"] == 1 and frame["strokes"] == 8
    assert frame["points"].tolist() == [2.0, 17.0]
    tactics = tactics_of([rows])
    assert tactics["break_off"][0] == 8.0
    assert tactics["easy"][:1] == pytest.approx([100.0 / 3]) and tactics["easy_no_pot"][:1] == [100.0]
    assert tactics["escapes"][0] == 100.0


def test_the_chance_to_win_is_compared_with_who_won(monkeypatch, tmp_path):
    """A worth without a network is the value, the last entry of what is seen; a frame that nobody won does not count."""
    monkeypatch.setattr(calibrate, "learned_worth", lambda: (None, Chance(80.0, 0.0, 0.0, 0.0, -0.5)))
    n = 400
    seen = np.zeros((n, SIZE + 1), np.float32)
    seen[:, -1] = 1.0  # 40 points
    seen[:, -2] = np.log(4.0)  # four times the errors: half the width
    lead = np.where(np.arange(n) % 2 == 0, 0.0, -80.0)  # expected to win by 40, to lose by 40
    won, decided = np.arange(n) % 4 != 1, np.arange(n) < 200
    rows = {"seen": seen, "lead": lead, "left": np.full(n, 100.0), "won": won, "decided": decided}
    rows |= {"last": np.zeros(n, np.bool_), "frame": np.arange(n) // 4}
    table, error, stages, tenths = calibrate.chances_of([rows])
    high = 1.0 / (1.0 + np.exp(-1.0))
    assert table[:5] == pytest.approx(np.array([[1.0 - high, 0.5]] * 5))
    assert table[5:] == pytest.approx(np.array([[high, 1.0]] * 5))
    assert error == pytest.approx(0.5 * (0.5 - (1.0 - high)) + 0.5 * (1.0 - high))
    ((words, strokes, frames, said, share, _),) = stages  # the player ahead: at level the striker
    assert (words, strokes, frames) == ("more than 75 points on the table", 200, 50)
    assert said == pytest.approx(high) and share == 0.75
    assert calibrate.chances_of([rows | {"decided": np.zeros(n, bool)}]) is None
    with saved_figures() as figures:
        calibrate.draw(tenths, 40, tmp_path / "c.png")
    assert len(figures) == 1 and unreadable(figures[0]) == []
    assert [row[:4] for row in tenths] == [
        (100, 50, pytest.approx(1.0 - high), 0.5),
        (100, 50, pytest.approx(high), 1.0),
    ]
    drawn = figures[0].axes[0].get_lines()[1].get_xydata()
    assert drawn == pytest.approx(100.0 * np.array([row[2:4] for row in tenths]))
