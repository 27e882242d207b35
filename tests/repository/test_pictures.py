"""Can every chart of the repository be read at README width, and is every picture's command written down?"""

import importlib
import importlib.util

import matplotlib as mpl
import pytest

from agents._lib import picture_style
from tests.pictures import saved_figures, unreadable
from tests.processes import ROOT

mpl.use("Agg")
REDRAWN = ("paper", "scene", "tradeoff")
"""Benchmarks whose figures are kept in results/physics."""
COMPUTED = ("paper", "scene")
"""Those that compute more than they read."""


def read(figures, least=1):
    """Every figure can be read, and has been drawn at the width of all."""
    assert len(figures) >= least
    for figure in figures:
        assert figure.get_figwidth() == picture_style.WIDTH
        assert unreadable(figure) == []


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] if name in COMPUTED else []) for name in REDRAWN]
)
def test_a_chart_drawn_from_kept_figures_can_be_read(name, tmp_path, monkeypatch):
    try:
        command = importlib.import_module(f"benchmarks.{name}.__main__")
    except ModuleNotFoundError:
        command = importlib.import_module(f"benchmarks.{name}")
    monkeypatch.setattr("sys.argv", [name, "--from", "--out", str(tmp_path)])
    with saved_figures() as figures:
        command.main()
    read(figures)
    kept = {file.name for file in (ROOT / "results/pictures").iterdir()}
    assert {file.name for file in tmp_path.glob("*.png")} <= kept


def test_charts_of_figures_that_results_keeps_can_be_read(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "results"))
    with saved_figures() as figures:
        importlib.import_module("charts").make(tmp_path)
    read(figures, least=3)


def test_labels_beside_points_avoid_each_other(tmp_path):
    with picture_style.drawing() as plt:
        made, axes = picture_style.page(plt, 4.0, "Points", columns=1)
        axes.plot([0, 0.02, 1], [0, 0.0, 1], "o")
        picture_style.label_points(made, [(axes, (x, 0.0), "a long label", {}) for x in (0.0, 0.02)])
        assert unreadable(made) == []
        plt.close(made)
