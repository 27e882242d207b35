"""Are frames read, and figures of frames counted, as their words say?"""

import json

import numpy as np
import pytest

from agents.evaluation import calibrate
from agents.evaluation.calibrate import figures_of, frames_of, frames_played, main, tactics_of
from snooker_env.planning.learned.frame_features import HIDDEN, LIKELY, SIZE

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
    (frame,) = frames_played(rows)
    assert frame["breaks"] == [8.0, 5.0, 2.0] and frame["fouls"] == 1 and frame["strokes"] == 8
    assert frame["points"].tolist() == [2.0, 17.0]
    tactics = tactics_of([rows])
    assert tactics["break_off"][0] == 8.0
    assert tactics["easy"][:1] == pytest.approx([100.0 / 3]) and tactics["easy_no_pot"][:1] == [100.0]
    assert tactics["escapes"][0] == 100.0


def test_the_command_compares_frames_played_with_those_of_a_file(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(calibrate, "FRAME", {"cue": "real", "miss": "clear_path", "max_strokes": 6})
    file, out = tmp_path / "frames.txt", tmp_path / "figures.json"
    file.write_text(TEXT)
    assert main([str(file), "--scales", "1.5", "--frames", "3", "--budget", "30", "--json", str(out)]) == 0
    for wrong in (["--conditions", "wet"], ["--budget", "5"], ["--scales", "0"], ["--frames", "1"]):
        with pytest.raises(SystemExit):
            main([str(file), *wrong])
    assert "scale 1.5" in capsys.readouterr().out
    assert json.loads(out.read_text())["figures"]["scale 1.5"]["strokes"][0] <= 6.0
    with pytest.raises(SystemExit):
        main([str(tmp_path / "none.txt")])
