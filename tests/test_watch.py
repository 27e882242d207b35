"""Does ``python -m snooker_env.watch`` show the visit that the protocol plays, as a page, as data and as films?"""

import json
import sys

import numpy as np
import pytest

from snooker_env import player, watch
from snooker_env.benchmark import HELD_OUT_SEED, play_visits
from snooker_env.render.scene import LEAD

SHORT = ["--agent", "ghost_ball", "--noise", "club"]


@pytest.mark.parametrize("name", ["ghost_ball"])
def test_the_visit_is_the_one_that_the_protocol_plays(name):
    seed = HELD_OUT_SEED + 3
    env, _, _ = watch.find_episode(watch.parser().parse_args(["--agent", name, "--seed", str(seed)]))
    strokes = play_visits(player(name), 1, first_seed=seed, threads=1, noise="professional", cue="real")
    assert [p.points for p in env.history] == strokes.points.tolist()
    cue = np.array([p.positions[0] for p in env.history if p.on_table[0]])
    assert np.array_equal(cue, strokes.cue[~np.isnan(strokes.cue[:, 0])])


def test_a_page_and_data_are_written_and_the_play_is_reported(tmp_path, capsys):
    assert watch.main([*SHORT, "--out", str(tmp_path / "visit.json")]) == 0
    said = capsys.readouterr().out
    data = json.loads((tmp_path / "visit.json").read_text())
    assert all(stroke["words"] in said for stroke in data["strokes"]) and data["players"] == ["ghost_ball"]
    assert data["win_chance"] is None
    assert watch.main([*SHORT, "--out", str(tmp_path / "new" / "visit.html")]) == 0
    assert "<html" in (tmp_path / "new" / "visit.html").read_text("utf-8")


@pytest.mark.parametrize("module", ["imageio_ffmpeg", "pygame"])
def test_what_a_film_needs_is_said_before_anything_is_played(tmp_path, monkeypatch, capsys, module):
    monkeypatch.setitem(sys.modules, module, None)
    monkeypatch.setattr(watch, "play_episode", None)
    assert watch.main([*SHORT, "--out", str(tmp_path / "visit.mp4")]) == 1
    out, err = capsys.readouterr()
    assert out == "" and err.startswith("snooker_env.watch: films need pygame-ce and ffmpeg; install it")
    assert "render" in err


def test_films_last_as_long_as_the_play(tmp_path):
    pytest.importorskip("pygame")
    moviepy = pytest.importorskip("moviepy")
    file = tmp_path / "visit.gif"
    args = watch.parser().parse_args([*SHORT, "--out", str(file)])
    env, _, _ = watch.find_episode(args)
    watch.main([*SHORT, "--out", str(file), "--speed", "2"])
    seconds = sum((LEAD + p.shot.duration) / 2 + 0.8 for p in env.history)
    with moviepy.VideoFileClip(str(file)) as clip:
        assert clip.size == [640, 360] and clip.duration == pytest.approx(seconds, abs=0.3 * len(env.history))


def test_the_longest_visit_is_shown_where_none_is_long_enough(tmp_path, capsys):
    seeds, out = range(HELD_OUT_SEED, HELD_OUT_SEED + 6), tmp_path / "visit.json"
    options = {"layout": "held_out", "noise": "club", "cue": "real"}
    points = [watch.play_episode(player("ghost_ball"), seed, **options).points for seed in seeds]
    assert 0 < max(points) > points[0]
    assert watch.main([*SHORT, "--at-least", "140", "--tries", "6", "--out", str(out)]) == 0
    said = capsys.readouterr().out
    assert f"table {seeds[int(np.argmax(points))]}, " in said
    assert f"ghost_ball: {max(points)} points in " in said
    assert "No visit reached 140 points in 6 tries; this is the best one." in said and out.is_file()


def test_a_whole_frame_is_played_by_both(tmp_path, capsys):
    out = tmp_path / "frame.json"
    assert watch.main(["--frame", *SHORT, "--opponent", "random", "--out", str(out)]) == 0
    data, said = json.loads(out.read_text()), capsys.readouterr().out
    assert data["players"] == ["ghost_ball", "random"]
    assert {stroke["player"] for stroke in data["strokes"]} == {0, 1}
    first, other = data["strokes"][-1]["score"]
    assert f"ghost_ball {first} - {other} random in {len(data['strokes'])} strokes" in said
    assert len(data["win_chance"]) == len(data["strokes"]) + 1
    assert data["win_chance"][-1] == float(first > other)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ("--opponent random", "without --frame"),
        ("--frame --at-least 5", "with --frame"),
        ("--frame --opponent nobody", "opponent"),
        ("--agent nobody", "player = 'nobody'"),
        ("--out a.exe", "must end in .html, .json, .mp4, .gif"),
        ("--out a.html --speed 2", "a film"),
        ("--tries 0", "tries"),
        ("--out a.gif --speed 0", "speed"),
        ("--layout nowhere", "layout"),
        ("--noise loud", "noise"),
        ("--options aim=target", "options = {'aim': 'target'}: must be left out"),
        ("--options aim", "options = 'aim': must be KEY=VALUE"),
    ],
)
def test_wrong_arguments_are_named(wrong, words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as stop:
        watch.main(["--agent", "ghost_ball", *wrong.split()])
    assert stop.value.code == 2 and words in capsys.readouterr().err.splitlines()[-1]
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (KeyboardInterrupt(), 130, "interrupted"),
        (OSError(28, "No space left on device"), 1, "the output cannot be written: No space left on device"),
        (ImportError("films need ffmpeg"), 1, "films need ffmpeg"),
    ],
)
def test_what_stops_it_from_outside_is_one_line(error, code, words, monkeypatch, capsys):
    def stop(*_, **__):
        raise error

    monkeypatch.setattr(watch, "replay", stop)
    assert watch.main(SHORT) == code
    assert capsys.readouterr().err == f"snooker_env.watch: {words}\n"


def test_a_folder_is_refused_before_anything_is_played(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(watch, "play_episode", None)
    (folder := tmp_path / "visit.html").mkdir()
    with pytest.raises(SystemExit):
        watch.main([*SHORT, "--out", str(folder)])
    assert "must be a file, not a folder" in capsys.readouterr().err
