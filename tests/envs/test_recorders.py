"""Do the recorders of Gymnasium and Stable-Baselines3, as they are, get the motion of the strokes?"""

from itertools import pairwise

import gymnasium
import numpy as np
import pytest
from gymnasium.wrappers import RecordVideo
from gymnasium.wrappers.vector import RecordVideo as VectorRecordVideo

import snooker_env as sn
from snooker_env.envs.pictures import PictureSource
from snooker_env.render.scene import LEAD
from tests.envs.one_by_one import native
from tests.tables import begun

pytest.importorskip("pygame")
moviepy = pytest.importorskip("moviepy")
SMALL = {"render_mode": "rgb_array", "action": "discrete", "render_size": (160, 100)}
ALL = {"episode_trigger": lambda k: True, "disable_logger": True}


def pictures_of(seconds):
    """How many pictures a shot has: the cue's, one every 1/30 s, its end, and half a second of the table after it."""
    return round(30 * LEAD) + len(np.arange(0.0, seconds, 1 / 30)) + 1 + 15


def made(**options):
    return gymnasium.make("Snooker-v0", **SMALL, **options)


def alone():
    """The same table without a recorder."""
    return begun(sn.SnookerEnv(action="discrete"))


def filmed(tables, folder):
    """The recorder of Stable-Baselines3 on tables that have begun."""
    vec_env = pytest.importorskip("stable_baselines3.common.vec_env")
    tables = tables or vec_env.DummyVecEnv([made])
    env = vec_env.VecVideoRecorder(tables, str(folder), lambda step: step == 0, video_length=10**6)
    env.seed(1)
    env.reset()
    return env


def test_record_video_of_gymnasium_films_each_stroke(tmp_path):
    env = RecordVideo(made(), str(tmp_path / "films"), **ALL)
    env.reset(seed=1)
    assert len(env.recorded_frames) == 1
    expected = 1
    for _ in range(2):
        info = env.step(67)[4]
        expected += pictures_of(info["seconds"]) + 1  # and the table after it, colours respotted
        assert len(env.recorded_frames) == expected
    moving = env.recorded_frames[20:49]
    assert all(not np.array_equal(a, b) for a, b in pairwise(moving))  # the cue ball runs
    assert all(frame.shape == (100, 160, 3) for frame in env.recorded_frames)
    env.close()
    film = next((tmp_path / "films").glob("*.mp4"))
    with moviepy.VideoFileClip(str(film)) as clip:
        assert clip.duration == pytest.approx(expected / 30, abs=0.1)


def test_the_opponents_strokes_are_filmed_too(tmp_path):
    env = RecordVideo(made(task="frame", opponent="random"), str(tmp_path / "films"), **ALL)
    env.reset(seed=2)
    before = len(env.recorded_frames)
    env.step(67)
    history = env.unwrapped.history
    played = [p.shot.duration for p in history]
    assert {p.player for p in history} == {0, 1}
    assert len(env.recorded_frames) == sum(map(pictures_of, played)) + 2 and before >= 1
    env.close()


def test_vector_record_video_films_all_tables_at_once(tmp_path):
    envs = VectorRecordVideo(native(2, **SMALL), str(tmp_path / "films"), video_length=10**6, **ALL)
    envs.reset(seed=1)
    info = envs.step(np.array([67, 67]))[4]
    assert len(envs.recorded_frames) == 1 + pictures_of(max(info["seconds"])) + 1
    assert envs.recorded_frames[0].shape[0] * envs.recorded_frames[0].shape[1] == 2 * 100 * 160
    envs.close()


def test_the_recorder_of_stable_baselines_films_each_stroke(tmp_path):
    env = filmed(pytest.importorskip("snooker_env.sb3").SnookerVecEnv(1, **SMALL), tmp_path)
    seconds = alone().step(67)[4]["seconds"]
    env.step(np.array([67]))
    assert len(env.recorded_frames) == 1 + pictures_of(seconds) + 1
    env.close()


def test_a_film_that_breaks_off_leaves_no_picture_behind():
    source = PictureSource()

    class Recorder:
        recorded_frames, asked = (), 0

        def _capture_frame(self):
            self.asked += 1
            if self.asked == 3:
                raise KeyboardInterrupt
            return source.picture(lambda: iter("abcd"), lambda: "still")

    with pytest.raises(KeyboardInterrupt):
        Recorder()._capture_frame()
    assert source.picture(lambda: iter(""), lambda: "still") == "still"


def test_the_stroke_that_ends_an_episode_is_filmed_where_the_reset_is_inside_the_step(tmp_path):
    env, single, expected, ended = filmed(None, tmp_path), alone(), 1, False
    while not ended:
        _, _, ended, _, info = single.step(67)
        assert env.step(np.array([67]))[2][0] == ended
        expected += pictures_of(info["seconds"]) + 1
        assert len(env.recorded_frames) == expected
    env.close()
