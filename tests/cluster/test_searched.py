"""Does ``python -m agents.search`` write the same data in one go, interrupted, and by more positions later?"""

import numpy as np
import pytest

from agents.evaluation import search_data, searched
from snooker_env.planning import Planner, Positions
from tests.agents.training import interrupted_at

COMMAND = ["--agent", "search_30", "--noise", "club", "--layout", "random:6"]


@pytest.fixture(autouse=True)
def small(monkeypatch):
    for module in (searched, search_data):
        monkeypatch.setattr(module, "TABLES", 4)
        monkeypatch.setattr(module, "ROUNDS", 3)


def search(out, positions, *more):
    return search_data.main([*COMMAND, "--positions", str(positions), "--out", str(out), *more])


def test_an_interrupted_search_goes_on_to_the_same_data(tmp_path, monkeypatch, capsys):
    whole, parted = tmp_path / "whole", tmp_path / "parted"
    assert search(whole, 30) == 0  # rounded up to 36
    calls = interrupted_at(monkeypatch, searched, "arrived", 2)
    assert search(parted, 36) == 130
    assert "12 of 36 positions are kept" in capsys.readouterr().err
    with pytest.raises(ValueError, match="must hold complete data"):
        search_data.read(str(parted))
    assert search(parted, 36) == 0 and len(calls) == 4
    one, two = search_data.read(str(whole)), search_data.read(str(parted))
    assert len(one["scores"]) == 36
    assert all(np.array_equal(one[name], two[name], equal_nan=True) for name in one)
    # only what is new
    assert search(parted, 48) == 0 and len(calls) == 5
    assert np.array_equal(search_data.read(str(parted))["positions"][:36], one["positions"])
    with pytest.raises(SystemExit):
        search(parted, 36, "--seed", "1")
    assert "its seed is 0, and 1 is asked for" in capsys.readouterr().err


def test_data_are_what_the_search_plays(tmp_path):
    """No table is like another, no decision is without a stroke, and the best strokes score."""
    assert search(tmp_path, 24) == 0
    found = search_data.read(str(tmp_path))
    assert found["strokes"].shape == (24, searched.KEPT, 5) and not np.isnan(found["strokes"][:, 0]).any()
    assert np.array_equal(np.isnan(found["scores"]), np.isnan(found["strokes"]).all(axis=2))
    assert len(np.unique(found["positions"].reshape(24, -1), axis=0)) == 24
    at = Positions(found["positions"], found["on_table"], found["game"])
    played = Planner({}).play_strokes(at, np.arange(24), found["strokes"][:, 0].astype(float))
    assert (played.points > 0).mean() > 0.6


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (["--agent", "random"], "must be one player that searches"),
        (["--positions", "0"], "positions = 0"),
        (["--layout", "held_out"], "held-out tables are kept"),
        (["--ray", "x"], "must be local, auto, or HOST:PORT"),
    ],
)
def test_wrong_options_are_refused(change, says, tmp_path, capsys):
    with pytest.raises(SystemExit):
        search(tmp_path, 12, *change)
    assert says in capsys.readouterr().err and not list(tmp_path.iterdir())


def test_reading_writes_nothing(tmp_path):
    with pytest.raises(ValueError, match="must hold complete data"):
        search_data.read(str(tmp_path / "nothing"))
    assert not (tmp_path / "nothing").exists()


def test_a_damaged_part_is_searched_again(tmp_path):
    assert search(tmp_path, 24) == 0
    whole, part = search_data.read(str(tmp_path)), next((tmp_path / "parts").iterdir())
    part.write_bytes(part.read_bytes()[:-40])
    with pytest.raises(ValueError, match="must hold complete data"):
        search_data.read(str(tmp_path))
    assert search(tmp_path, 24) == 0
    again = search_data.read(str(tmp_path))
    assert all(np.array_equal(whole[name], again[name], equal_nan=True) for name in whole)
