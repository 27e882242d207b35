"""Does ``agents.evaluate`` play, report, keep and refuse what it should, whatever stops it?"""

import json
import os
import shutil
import zipfile
from pathlib import Path

import numpy as np
import pytest

from agents import evaluate, report
from agents._lib.physics_option import physics_option, physics_text
from agents.evaluation.visit_figures import FIGURES
from agents.features.observed import training_tables
from agents.learning.hyperparameters import Recipe
from snooker_env.physics.parameters import Physics
from tests.agents.training import interrupted_at

QUICK = str.split("--visits 12 --layouts held_out --noise professional --resamples 200")


def outputs(folder):
    files = (("--json", "r.json"), ("--markdown", "r.md"))
    return [word for option, name in files for word in (option, str(folder / name))]


def read(file):
    return json.loads(file.read_text(), parse_constant=lambda text: pytest.fail(f"{text} is not JSON"))


@pytest.fixture(scope="module")
def models(tmp_path_factory):
    """Two untrained models of one recipe, as run folders."""
    folder = tmp_path_factory.mktemp("runs")
    tables = training_tables(2, action="discrete")
    for seed in (0, 1):
        (folder / f"m-{seed}").mkdir()
        model = Recipe.of("ppo_value").new_model(tables, seed)
        model.imitated = 300 * seed
        model.save(folder / f"m-{seed}" / "model.zip")
    (folder / "m-0" / "results.json").write_text('{"seconds": 2.0}')
    tables.close()
    return folder


def test_json_and_markdown(models, tmp_path, capsys):
    options = "--visits 12 --layouts held_out=20 colours --noise none club --resamples 200 --physics"
    agents = ["--agent", f"model={models / 'm-*'}", "random", "--against", "ghost_ball", "random"]
    files = outputs(tmp_path / "new")
    assert evaluate.main([*agents, *options.split(), "paper,mu_bb=marlow", *files]) == 0
    found = read(tmp_path / "new" / "r.json")
    names = "command commit seed machine load software protocol agents results"
    assert sorted(found) == sorted(names.split())
    assert found["protocol"]["layouts"] == {"held_out": 12, "colours": 12}
    assert [a["label"] for a in found["agents"]] == ["model", "random", "ghost_ball"]
    first, second = found["agents"][0]["runs"]
    assert (first["seconds"], first["imitated"], second["seconds"], second["imitated"]) == (2.0, 0, None, 300)
    assert first["layout"] == "opened" and first["recipe"] == "ppo_value" and first["gamma"] == 0
    assert len(found["results"]) == 3 * 2 * 2
    names = "agent layout noise fidelity physics cue visits runs figures ratios counted longest_break by_run"
    for row in found["results"]:
        assert sorted(row) == sorted(f"{names} strokes ms_a_decision".split())
        assert set(row["figures"]) == {*FIGURES, "points_a_visit_iqm", "pots_a_visit_iqm"}
        assert set(row["ratios"]) == {"ghost_ball", "random"} - {row["agent"]}
        assert len(row["by_run"]["points_a_visit"]) == row["runs"] == (2 if row["agent"] == "model" else 1)
        for f in [*row["figures"].values(), *(r for ratio in row["ratios"].values() for r in ratio.values())]:
            assert set(f) == {"value", "low", "high"}
            assert f["low"] is None or f["low"] <= f["high"]
        mean = row["figures"]["points_a_visit"]["value"]
        assert np.mean(row["by_run"]["points_a_visit"]) == pytest.approx(mean)
    text, printed = (tmp_path / "new" / "r.md").read_text(), capsys.readouterr().out
    assert found["command"] in text and found["machine"] in text
    assert found["command"].startswith("python -m agents.evaluate --agent")
    lines = text.splitlines()
    for k, line in enumerate(lines):
        if set(line) <= set("|:- ") and line:  # under each table's head
            width = line.count("|")
            assert lines[k - 1].count("|") == width == lines[k + 1].count("|")
    points = report._pm(found["results"][0]["figures"]["points_a_visit"])
    assert points in text and points in printed and "2 training seeds, fewer than 5" in printed


def test_held_out_tables_alone_are_played_unless_others_are_named():
    for words, sizes in (
        ([], {"held_out": 2000}),
        (["--visits", "30"], {"held_out": 30}),
        (["--layouts", "colours", "held_out"], {"colours": 500, "held_out": 2000}),
    ):
        _, _, seeds = evaluate.parse_evaluation(evaluate.parser().parse_args(["--agent", "random", *words]))
        assert {name: len(its) for name, its in seeds.items()} == sizes


def test_a_player_of_ones_own_is_compared(tmp_path):
    file, users = tmp_path / "r.json", "tests.agents.user_players"
    agents = ["--agent", f"{users}:Softly", f"me={users}:Softly"]
    assert evaluate.main([*agents, *QUICK, "--json", str(file)]) == 0
    rows = {row["agent"]: row["figures"]["pots_a_visit"]["value"] for row in read(file)["results"]}
    assert rows.keys() == {"Softly", "me", "ghost_ball"}
    assert rows["Softly"] == rows["me"] != rows["ghost_ball"]


def test_a_path_with_a_colon_is_a_path(models, tmp_path):
    (tmp_path / "10:00").symlink_to(models)
    assert len(evaluate.Entrant.of(f"x={tmp_path}/10:00/m-?").runs) == 2
    for path, why in (
        (r"C:\runs\m-0\model.zip", "must be an existing model file"),
        ("a/b:c", "or existing models"),
    ):
        with pytest.raises(ValueError, match=why):
            evaluate.Entrant.of(f"x={path}")
    with pytest.raises(ValueError, match="or existing models"):
        evaluate.Entrant.of("x=10:00")


FOREIGN = "agent = '.*': must be a model saved by Stable-Baselines3"


@pytest.mark.parametrize(
    ("file", "text", "says"),
    [
        *(("model.zip", text, FOREIGN) for text in ("junk", {"data": "junk"}, {})),
        ("results.json", '{"seconds": 2.0', "agent = '.*results.json': must be JSON"),
        ("results.json", "[2.0]", "agent = '.*results.json': must hold seconds"),
        ("results.json", '{"seconds": "2 h"}', "results.json: seconds = '2 h': must be a finite number"),
        ("model.json", '{"imitated": [1]}', "model.json: imitated = \\[1\\]: must be a finite number"),
        ("model.json", "{", "agent = '.*model.json': must be JSON"),
    ],
)
def test_a_broken_file_is_named(file, text, says, models, tmp_path):
    shutil.copy(models / "m-0" / "model.zip", tmp_path)
    if isinstance(text, dict):
        with zipfile.ZipFile(tmp_path / file, "w") as made:
            for name, content in text.items():
                made.writestr(name, content)
    else:
        (tmp_path / file).write_text(text)
    with pytest.raises(ValueError, match=says):
        evaluate.Entrant.of(str(tmp_path / "model.zip" if file == "model.json" else tmp_path)).trained()


BOTH = ["--agent", "random", *QUICK, "--layouts", "held_out", "colours"]


def test_ctrl_c_keeps_what_was_complete(tmp_path, monkeypatch, capsys):
    """And spares a file that is there already."""
    (tmp_path / "r.md").write_text("whole")
    interrupted_at(monkeypatch, evaluate, "play_agent", 4)
    assert evaluate.main([*BOTH, *outputs(tmp_path)]) == 130
    printed = capsys.readouterr()
    lost = "interrupted after 1 of 2 parts (one layout and noise level each): the others are lost"
    assert printed.err.splitlines()[-1] == f"agents.evaluate: {lost}"
    assert f"INCOMPLETE: {lost}." in " ".join(printed.out.split())
    found, part = read(tmp_path / "r.json"), tmp_path / "r.incomplete.md"
    assert found["incomplete"] == lost
    complete = [(row["layout"], row["agent"]) for row in found["results"]]
    assert complete == [("held_out", "random"), ("held_out", "ghost_ball")]
    assert (tmp_path / "r.md").read_text() == "whole" and f"INCOMPLETE: {lost}." in part.read_text()
    assert f"json: {tmp_path / 'r.json'}" in printed.out and f"markdown: {part}" in printed.out
    assert {p.name for p in tmp_path.iterdir()} == {"r.json", "r.md", "r.incomplete.md"}


def test_a_full_disk_loses_one_file_only(tmp_path, monkeypatch, capsys):
    original, full = os.replace, "r.json"

    def replace(source, target):
        if Path(target).name == full:
            raise OSError(28, "No space left on device")
        original(source, target)

    monkeypatch.setattr(os, "replace", replace)
    with pytest.raises(SystemExit) as stop:
        evaluate.main(["--agent", "random", *QUICK, *outputs(tmp_path)])
    assert stop.value.code == f"agents.evaluate: {tmp_path / full} cannot be written: No space left on device"
    assert {p.name for p in tmp_path.iterdir()} == {"r.json", "r.md"} - {full}
    printed = capsys.readouterr().out
    assert "points a visit" in printed and str(tmp_path / full) not in printed


def test_a_terminal_that_is_gone_loses_no_file(tmp_path, monkeypatch):
    def leave(report):
        raise SystemExit(1)

    monkeypatch.setattr(evaluate, "show", leave)
    with pytest.raises(SystemExit):
        evaluate.main(["--agent", "random", *QUICK, *outputs(tmp_path)])
    assert {p.name for p in tmp_path.iterdir()} == {"r.json", "r.md"}


def test_a_physics_is_named_as_it_was_given():
    for text in ("paper", "match", "paper,mu_bb=marlow", "match,mu_bb=0.06"):
        option = physics_option(text)
        assert physics_text(option) == text
        assert Physics.of(option) == Physics.of(physics_option(physics_text(option)))
    assert physics_text("match") == "match" and Physics.of(physics_option("match,mu_bb=0.06")).mu_bb == 0.06
    for wrong in ("nothing", "paper,mu_bb", "paper,colour=1"):
        with pytest.raises(ValueError):
            physics_option(wrong)
