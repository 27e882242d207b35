"""Can every chart of the repository be read at README width, and is every picture's command written down?"""

import importlib
import importlib.util
import json

import matplotlib as mpl
import pytest

from agents.evaluation import destinations, learning_curves
from benchmarks import layouts_picture, pictures
from commands import picture_style
from tests.docs.pages import commands
from tests.pictures import saved_figures, unreadable
from tests.processes import ROOT

mpl.use("Agg")
REDRAWN = ("paper", "pockets", "rack", "scene", "speed", "stability", "tradeoff")
"""Benchmarks whose figures are kept in benchmarks/figures."""
FOLDERS = ("benchmarks/pictures", "agents/pictures", "docs/pictures")
PICTURES = (".png", ".jpg", ".gif", ".svg")


def read(figures, least=1):
    """Every figure can be read, and has been drawn at the width of all."""
    assert len(figures) >= least
    for figure in figures:
        assert figure.get_figwidth() == picture_style.WIDTH
        assert unreadable(figure) == []


@pytest.mark.parametrize("name", REDRAWN)
def test_a_chart_drawn_from_kept_figures_can_be_read(name, tmp_path, monkeypatch):
    try:
        command = importlib.import_module(f"benchmarks.{name}.command")
    except ModuleNotFoundError:
        command = importlib.import_module(f"benchmarks.{name}")
    monkeypatch.setattr("sys.argv", [name, "--from", "--out", str(tmp_path)])
    with saved_figures() as figures:
        command.main()
    read(figures)
    assert {file.name for file in tmp_path.glob("*.png")} <= {
        file.name for file in (ROOT / "benchmarks/pictures").iterdir()
    }


def test_learning_curves_can_be_read(tmp_path):
    with saved_figures() as figures:
        assert learning_curves.main(["--from", "--out", str(tmp_path / "c.png")]) == 0
    read(figures)


def test_destinations_can_be_read(tmp_path):
    with saved_figures() as figures:
        destinations.draw_figures(
            json.loads((ROOT / "agents/pictures/destinations.json").read_text()), tmp_path / "d.png"
        )
    read(figures)


@pytest.mark.parametrize("module", [layouts_picture, pictures])
def test_a_picture_of_tables_can_be_read(module, tmp_path, monkeypatch):
    monkeypatch.setattr("sys.argv", ["x", "--out", str(tmp_path)])
    monkeypatch.setattr(pictures, "SIZE", (700, 400))
    with saved_figures() as figures:
        module.main()
    read(figures)


def test_labels_beside_points_avoid_each_other(tmp_path):
    with picture_style.drawing() as plt:
        made, axes = picture_style.page(plt, 4.0, "Points", columns=1)
        axes.plot([0, 0.02, 1], [0, 0.0, 1], "o")
        picture_style.label_points(made, [(axes, (x, 0.0), "a long label", {}) for x in (0.0, 0.02)])
        assert unreadable(made) == []
        plt.close(made)


def test_every_picture_has_its_command_written():
    listed = (ROOT / "docs/pictures/README.md").read_text(encoding="utf-8")
    found = [
        file for folder in FOLDERS for file in sorted((ROOT / folder).iterdir()) if file.suffix in PICTURES
    ]
    assert len(found) > 15
    for file in found:
        line = next(
            (line for line in listed.splitlines() if f"`{file.relative_to(ROOT).as_posix()}`" in line), None
        )
        assert line is not None and "python " in line, file


def test_every_command_of_the_list_can_be_run():
    named = {name for name, _ in commands((ROOT / "docs/pictures/README.md").read_text(encoding="utf-8"))}
    assert len(named) > 10
    for name in named:
        if name.endswith(".py"):
            assert (ROOT / name).is_file(), name
        else:
            found = importlib.util.find_spec(name)
            assert found, name
            assert found.submodule_search_locations is None or importlib.util.find_spec(f"{name}.__main__"), (
                name
            )
