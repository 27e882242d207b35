"""Does the picture of learning curves show what the runs kept, and is a wrong run refused?"""

import json
import re

import pytest
from matplotlib.figure import Figure

from agents import curves
from tests.pictures import unreadable


def evaluated(trained, ghost):
    """Part of a run's results: the points a visit of both."""
    points = {"trained": trained, "ghost_ball": ghost}
    return {"evaluation": {who: {"points_a_visit": x, "points_a_visit_se": 0.5} for who, x in points.items()}}


def keep(folder, **changes):
    """A run as train.py keeps it."""
    folder.mkdir()
    run = {"steps": 1000, "seconds": 700.0, "imitation": [{"states": 50, "seconds": 100.0, "loss": 1.0}]}
    run["curve"] = [{"steps": at, "points": points} for at, points in ((0, 2.0), (100, 0.0), (500, 3.5))]
    (folder / "results.json").write_text(json.dumps(run | evaluated(4.0, 5.0) | changes))
    return folder


@pytest.fixture
def drawn(monkeypatch):
    """The figures that are saved."""
    figures, save = [], Figure.savefig

    def kept(figure, *args, **more):
        figures.append(figure)
        save(figure, *args, **more)

    monkeypatch.setattr(Figure, "savefig", kept)
    return figures


def test_time_begins_with_imitation(tmp_path):
    run = curves.run_of(keep(tmp_path / "a"))
    assert run["minutes"] * 60 == pytest.approx([100, 160, 400])
    assert run["end"] == (1000, pytest.approx(700 / 60))
    alone = curves.run_of(keep(tmp_path / "b", imitation=[]))
    assert alone["minutes"] * 60 == pytest.approx([0, 70, 350])


def test_every_run_is_drawn(tmp_path, drawn, capsys):
    for name in ("a-0", "a-1", "b-0"):
        keep(tmp_path / name, steps=2000 if name == "b-0" else 1000)
    file = tmp_path / "new" / "c.png"
    assert curves.main([f"A={tmp_path}/a-?", str(tmp_path / "b-0"), "--out", str(file)]) == 0
    assert str(file) in capsys.readouterr().out and file.stat().st_size > 10_000
    assert len(drawn) == 1 and unreadable(drawn[0]) == []
    time, shots = drawn[0].axes
    lines = [line.get_xydata().tolist() for line in shots.get_lines() if line.get_linestyle() == "-"]
    assert [line for line in lines if len(line) == 2] == 3 * [[[0, 2.0], [500, 3.5]]]
    ends = [(bar[0].get_xdata()[0], bar[0].get_ydata()[0]) for bar in shots.containers]
    assert ends == [(1000, 4.0), (1000, 4.0), (2000, 4.0)]
    assert [bar[0].get_xdata()[0] for bar in time.containers] == 3 * [700 / 60]
    low, high = shots.containers[0][2][0].get_segments()[0][:, 1]
    assert (low, high) == pytest.approx((3.0, 5.0))  # two standard errors
    assert [text.get_text() for text in shots.get_legend().get_texts()] == ["A", "b-0"]
    assert [line.get_ydata()[0] for line in time.get_lines() if line.get_linestyle() == ":"] == [5.0]


def test_what_is_below_the_scale_lies_on_its_edge(tmp_path, drawn):
    keep(tmp_path / "a", **evaluated(0.02, 5.0))
    assert curves.main([str(tmp_path / "a"), "--out", str(tmp_path / "c.png")]) == 0
    assert drawn[0].axes[1].containers[0][0].get_ydata()[0] == 0.1


@pytest.mark.parametrize(
    ("files", "arguments", "message"),
    [
        ({}, "ghost_ball", "run = 'ghost_ball': must be the folder of a finished run"),
        ({}, "nowhere", "agent = 'nowhere'"),
        ({"a": {}}, "{}/a --out x.txt", "out = '.txt': must be one of"),
        ({"a": {}}, "x={}/a x={}/a", "must have another label each"),
        ({"a": {}}, "{}/a --out {}/a/results.json/c.png", "out = .* must be a file that can be written"),
        ({"a": {}, "b": evaluated(4.0, 5.1)}, "{0}/a {0}/b", "ghost_ball's score differs"),
        ({"a": evaluated(None, 5.0)}, "{}/a", "must be what today's train.py writes"),
        ({"a": {"curve": None}}, "{}/a", "must be what today's train.py writes"),
        ({"a": {"evaluation": {}}}, "{}/a", "must be what today's train.py writes"),
    ],
)
def test_wrong_input(tmp_path, refused, files, arguments, message):
    for name, changes in files.items():
        keep(tmp_path / name, **changes)
    words = arguments.replace("{}", "{0}").format(tmp_path).split()
    assert re.search(message, refused(curves.main, *words))
