"""Does ``agents.tournament`` play, keep, check and refuse what it should, whatever stops it?"""

import json
import re

import pytest

from agents import report, tournament
from agents.evaluation import tournament_play
from agents.evaluation.tournament_figures import COLUMNS, figures_of
from agents.evaluation.tournament_file import FIELDS, PLAYER, faults
from snooker_env.benchmark.results import read_result
from tests.agents.training import interrupted_at
from tests.benchmark.records import at, inner, leaves, others, put, resized
from tests.processes import ROOT

UNPROVED = r"command|commit|incomplete|(game|machine|software)\.\w+|players\.(decisions|seconds|shots|source)"
UNPROVED += r"|protocol\.(chunk|resamples|tables)|best_(first|second)"
"""Fields on which nothing else in the file depends; of a player's best breaks only the highest shows."""
USERS = "tests.agents.user_players"
PLAYERS = ("ghost_ball", "random", f"{USERS}:Softly")
QUICK = str.split("--frames 6 --resamples 100 --max-strokes 120 --threads 1")


@pytest.fixture
def parts(monkeypatch):
    """Two seeds are played in one go, so that there are several parts of each pair."""
    monkeypatch.setattr(tournament, "CHUNK", 2)


def played(tmp_path, *more, name="t.json", players=PLAYERS, code=0):
    file = tmp_path / name
    assert tournament.main([*players, *QUICK, "--out", str(file), *more]) == code
    return read_result(file)


def test_json_markdown_check_and_report(tmp_path, capsys):
    found = played(tmp_path, "--markdown", str(tmp_path / "t.md"))
    assert faults(found) == [] and found["incomplete"] is None
    assert [p["label"] for p in found["players"]] == ["ghost_ball", "random", "Softly"]
    assert found["protocol"]["anchor"] == "ghost_ball" and found["game"]["noise"] == "professional"
    assert found["game"]["cue"] == "real"
    assert len(found["rows"]) == 3 * 6
    assert {(row[2], row[3]) for row in found["rows"]} == {(s, o) for s in range(3) for o in (0, 1)}
    first, second = COLUMNS.index("strokes_first"), COLUMNS.index("strokes_second")
    for k, player in enumerate(found["players"]):
        own = sum(row[first if row[0] == k else second] for row in found["rows"] if k in row[:2])
        # an opponent also decides where nothing is counted any more
        assert 1.5 * own > player["decisions"] >= own > 0 and player["seconds"] > 0
        assert player["shots"] == 0  # none of these three simulates
    text, printed = (tmp_path / "t.md").read_text(), capsys.readouterr()
    assert printed.err == "" and "Who wins" in printed.out and found["command"] in text
    for label in ("ghost_ball", "random", "Softly"):
        assert label in text and label in printed.out
    for p in found["figures"]["players"].values():
        assert f"{p['elo']['value']:.0f}" in text and f"{p['average_break']['value']:.2f}" in text
    for line, under in zip(text.splitlines(), text.splitlines()[1:], strict=False):
        if under and set(under) <= set("|:- "):
            assert line.count("|") == under.count("|")
    file = str(tmp_path / "t.json")
    assert tournament.main(["--check", file]) == 0
    assert capsys.readouterr().out == f"{file}: complete, 3 players, 18 frames\n"
    assert report.main([file]) == 0 and text == (tmp_path / "t.md").read_text()


def test_the_simulated_shots_of_each_player_are_counted(tmp_path):
    found = played(tmp_path, players=["ghost_ball", "search_8"])
    plain, searches = found["players"]
    assert plain["shots"] == 0 and 0.9 * 8 < searches["shots"] / searches["decisions"] <= 8


@pytest.mark.slow
def test_resumed_is_as_if_it_had_never_stopped(tmp_path, monkeypatch, capsys, parts):
    whole = played(tmp_path, name="whole.json")
    with monkeypatch.context() as patch:
        interrupted_at(patch, tournament_play, "play_pair", 4)
        part = played(tmp_path, code=130)
    assert capsys.readouterr().err == "agents.tournament: interrupted after 10 of 18 frames: these are kept\n"
    assert part["incomplete"] == "interrupted after 10 of 18 frames: these are kept" and faults(part) == []
    assert part["rows"] == whole["rows"][:10] and part["figures"] != whole["figures"]
    calls = interrupted_at(monkeypatch, tournament_play, "play_pair", 99)
    again = played(tmp_path, "--resume")
    assert len(calls) == 3  # of 6 parts
    for key in ("rows", "figures", "incomplete"):
        assert again[key] == whole[key]
    assert [p["decisions"] for p in again["players"]] == [p["decisions"] for p in whole["players"]]
    before = (tmp_path / "t.json").read_bytes()
    played(tmp_path, "--resume")  # a complete one is left as it is
    assert (tmp_path / "t.json").read_bytes() == before and len(calls) == 3


def test_what_a_player_fails_at_keeps_what_was_played(tmp_path, monkeypatch, parts):
    interrupted_at(monkeypatch, tournament_play, "play_pair", 3, RuntimeError("no chalk"))
    with pytest.raises(RuntimeError, match="no chalk"):
        played(tmp_path)
    found = read_result(tmp_path / "t.json")
    assert found["incomplete"] == "RuntimeError: no chalk" and len(found["rows"]) == 6 and faults(found) == []


def test_ctrl_c_at_once_keeps_nothing(tmp_path, monkeypatch, capsys):
    interrupted_at(monkeypatch, tournament_play, "play_pair", 1)
    assert tournament.main([*PLAYERS, *QUICK, "--out", str(tmp_path / "t.json")]) == 130
    assert not (tmp_path / "t.json").exists() and "nothing is kept" in capsys.readouterr().err


@pytest.mark.slow
def test_frames_do_not_depend_on_the_company(tmp_path):
    whole = played(tmp_path, name="a.json")
    pair = played(tmp_path, name="b.json", players=PLAYERS[:2])
    rows = [[row[2:] for row in found["rows"] if row[:2] == [0, 1]] for found in (whole, pair)]
    assert [one["label"] for one in whole["players"][:2]] == [one["label"] for one in pair["players"]]
    assert rows[0] == rows[1] and len(rows[0]) == 6


def test_another_tournament_is_not_gone_on_with(tmp_path, refused, parts, monkeypatch):
    with monkeypatch.context() as patch:
        interrupted_at(patch, tournament_play, "play_pair", 2)
        played(tmp_path, code=130)
    again = [tournament.main, *QUICK, "--out", tmp_path / "t.json", "--resume"]
    for change, what in (("--noise club", "game"), ("--seed 5", "protocol"), ("--max-strokes 9", "game")):
        error = refused(*again, *PLAYERS, *change.split())
        assert f"must be a file with the same {what} to continue" in error
    assert "same players" in refused(*again, *PLAYERS[:2])


def sound():
    """The content of a file of two players, without playing."""
    counted = [60, 30, 50, 30, 10, 10, 30, 20, 0, 2, 20, 12]
    lucks = iter((300, 200, -100, 50, -400, -250))
    rows = [[0, 1, s, o, 0, int(s + o > 1), *counted, next(lucks)] for s in range(3) for o in (0, 1)]
    found = read_result(ROOT / "results" / "agents" / "ladder.json")
    players = [found["players"][k] | {"label": label} for k, label in enumerate("ab")]
    protocol = found["protocol"] | {"matches": 6, "anchor": "a", "resamples": 100}
    figures = figures_of(["a", "b"], rows, "a", 100)
    found |= {"players": players, "protocol": protocol, "rows": rows, "figures": figures}
    return json.loads(json.dumps(found))


@pytest.mark.slow
def test_a_change_of_any_value_of_a_file_is_a_fault_but_for_what_nothing_proves(tmp_path, capsys):
    """None may be missing, none may be more."""
    record, passed = sound(), set()
    assert faults(record) == []
    for path in leaves(record):
        for value in others(at(record, path)):
            was = at(record, path)
            near = value == was or (type(value) is type(was) is float and abs(value - was) < 1e-9)
            if not near and faults(put(record, path, value)) == []:
                row = path[0] == "rows"
                passed.add(
                    COLUMNS[path[2]] if row else ".".join(part for part in path if isinstance(part, str))
                )
    assert [name for name in sorted(passed) if not re.fullmatch(UNPROVED, name)] == []
    for path in inner(record):
        free = not {"game", "software", "training"}.isdisjoint(path)  # as many options as there are
        for value in () if free else resized(at(record, path)):
            assert faults(put(record, path, value) if path else value), (path, value)
    (tmp_path / "t.json").write_text(json.dumps(put(record, "rows.2.5", 3)))
    assert tournament.main(["--check", str(tmp_path / "t.json"), str(tmp_path / "none.json")]) == 1
    printed = capsys.readouterr().out
    assert "winner = 3" in printed and "cannot be read" in printed


def test_the_ladder_of_the_repository_is_sound(capsys):
    """And its page is what its figures say."""
    folder = ROOT / "results" / "agents"
    assert tournament.main(["--check", str(folder / "ladder.json")]) == 0
    assert "complete" in capsys.readouterr().out
    found = json.loads((folder / "ladder.json").read_text())
    from agents.evaluation.tournament_report import markdown

    assert (folder / "ladder.md").read_text() == markdown(found)
    names = "random ghost_ball best_pot search planner tactician"
    assert {p["label"] for p in found["players"]}.issuperset(names.split())


def test_the_page_names_every_part_of_a_file():
    text = (ROOT / "docs" / "agents" / "tournament.md").read_text()
    rooms = {name.partition(".")[0] for name in FIELDS} - {"schema"}
    columns = {name.rpartition("_")[0] + "_" if "_" in name else name for name in COLUMNS}
    named = rooms | set(PLAYER) | columns | {"schema.name", "schema.version"}
    assert not [name for name in sorted(named) if f"`{name}`" not in text]
