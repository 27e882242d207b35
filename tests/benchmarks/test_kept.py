"""Does a benchmark run what it made itself? Not what another user put in the temporary folder."""

import importlib
from pathlib import Path

import pytest

from benchmarks._common import kept, package_copies


@pytest.fixture
def build(tmp_path, monkeypatch):
    monkeypatch.setattr(kept, "BUILD", tmp_path / "build")
    return tmp_path / "build"


def test_folders_are_made_once_and_whole(build):
    made = []

    def make(folder):
        made.append(folder)
        (folder / "file").write_text("whole")
        if len(made) == 1:
            raise OSError(28, "No space left on device")

    with pytest.raises(OSError, match="No space"):
        kept.kept_folder("x", make)
    assert not list(build.iterdir())
    for _ in range(2):
        assert (kept.kept_folder("x", make) / "file").read_text() == "whole"
    assert len(made) == 2 and [file.name for file in build.iterdir()] == ["x"] and build / "x" not in made


def test_the_faster_of_two_processes_counts(build):
    def make(folder):
        (folder / "file").write_text("slower")
        (build / "x").mkdir()
        (build / "x" / "file").write_text("faster")

    assert (kept.kept_folder("x", make) / "file").read_text() == "faster"
    assert [file.name for file in build.iterdir()] == ["x"]


def test_commits_and_copies_of_the_package_are_kept_there(build):
    learner = importlib.import_module("benchmarks.learner")
    tree = learner.tree_of("HEAD")
    assert tree.parent == build and (tree / "train.py").is_file()
    (module,) = package_copies.load("snooker_env_copy", {"__init__.py": "", "here.py": "VALUE = 3"}, ["here"])
    assert module.VALUE == 3 and build in Path(module.__file__).parents
