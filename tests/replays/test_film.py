"""Are films of replays what was played? Their pictures, their length, their colours, and what cannot be
written."""

import numpy as np
import pytest

import snooker_env as sn
from tests.refusals import refused

pytest.importorskip("pygame")
pytest.importorskip("imageio_ffmpeg")
SMALL = {"size": (320, 180), "fps": 10.0}


@pytest.fixture(scope="module")
def replay():
    env = sn.SnookerEnv(action="discrete")
    env.keep_history = True
    env.reset(seed=1)
    env.step(67)
    env.step(67)
    return sn.replay(env)


def test_the_pictures_show_the_motion_and_then_the_table(replay):
    pictures = list(replay.frames(**SMALL))
    moving = [len(np.arange(0.0, shot.duration, 0.1)) + 1 for shot in replay.shots]
    assert len(pictures) == sum(moving) + 2 * 8  # 0.8 s after each stroke
    assert all(picture.shape == (180, 320, 3) and picture.dtype == np.uint8 for picture in pictures)
    assert np.array_equal(pictures[moving[0]], pictures[moving[0] + 7]) and not np.array_equal(
        pictures[3], pictures[4]
    )
    fast = list(replay.frames(**SMALL, speed=4.0))
    assert len(fast) == sum(len(np.arange(0.0, shot.duration, 0.4)) + 1 for shot in replay.shots) + 2 * 8


@pytest.mark.parametrize("suffix", [".gif", ".mp4"])
def test_every_ball_keeps_its_colour(replay, tmp_path, suffix):
    """In a GIF too, which has 256 colours: small balls must not lose theirs to the cloth."""
    import imageio.v3 as imageio

    size = (1280, 720)
    file = replay.save(tmp_path / f"film{suffix}", size=size, fps=5.0)
    film, first = imageio.imread(file, index=0), next(replay.frames(size=size, fps=5.0))
    from snooker_env.physics.table import Table
    from snooker_env.render.table_picture import View

    view = View.of(Table.preset("match"), size=size)
    for place in replay.shots[0].at(0.0)[0]:
        x, y = np.rint(view(place)).astype(int)
        seen, drawn = (
            a[y - 1 : y + 2, x - 1 : x + 2, :3].astype(int).mean(axis=(0, 1)) for a in (film, first)
        )
        # a video halves the resolution of colours
        assert np.abs(seen - drawn).max() < 60, (place, seen, drawn)
    assert [p.name for p in tmp_path.iterdir()] == [file.name]


def test_what_no_film_can_be_is_refused(replay, tmp_path):
    refused(lambda: replay.save(tmp_path / "a.mp4", size=(321, 180)), "size", "(321, 180)", "both even")
    refused(lambda: replay.save(tmp_path / "a.gif", fps=0), "fps", "0", "must be")
    refused(lambda: replay.save(tmp_path / "a.gif", speed=-1), "speed", "-1", "must be")
    with pytest.raises(OSError, match="nowhere"):
        replay.save(tmp_path / "nowhere" / "a.mp4", **SMALL)
    assert list(tmp_path.iterdir()) == []
