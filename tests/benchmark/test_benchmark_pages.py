"""Do the benchmark's pages say what the code does, and is the leaderboard as the command makes it?"""

import re

import pytest

from snooker_env.benchmark import TASKS, faults
from snooker_env.benchmark.__main__ import main
from snooker_env.benchmark.leaderboard import page
from snooker_env.benchmark.provenance import arithmetic
from snooker_env.benchmark.results import read_result
from snooker_env.benchmark.schema import FIELDS, NUMBER, UNPROVED
from snooker_env.benchmark.tasks import FREE
from tests.processes import ROOT

TEXT, HOLDS = (
    (ROOT / f"docs/{name}.md").read_text(encoding="utf-8") for name in ("benchmark", "benchmark_files")
)
FILES = sorted((ROOT / "results/leaderboard").glob("*.json"))
KINDS = {str: "text", int: "integer", bool: "boolean", list: "list", dict: "object", NUMBER: "number"}


@pytest.mark.parametrize("name", TASKS)
def test_the_table_of_tasks(name):
    task = TASKS[name]
    more = [f"{key}={value}" for key, value in task.changes.items() if key not in ("noise", "layout")]
    row = [
        f"`{name}`",
        task.frozen_options["noise"],
        ", ".join(more),
        task.changes["layout"],
        task.judged_layout,
    ]
    assert f"| {' | '.join([*row, task.measure, f'{task.episodes:,}'])} |" in TEXT


def test_every_option_is_called_free_or_frozen():
    section = TEXT.split("### What is free and what is frozen")[1].split("### Tables")[0]
    free, frozen = section.split("Everything else is frozen:")
    assert all(f"`{name}`" in free for name in FREE)
    assert all(f"`{name}`" in frozen.split("Passing")[0] for name in TASKS["SnookerBreak-v0"].frozen_options)


@pytest.mark.parametrize("name", FIELDS)
def test_the_table_of_fields(name):
    kind, empty, meaning = FIELDS[name]
    assert f"| `{name}` | {KINDS[kind]}{' or null' if empty else ''} | {meaning} |" in HOLDS


def test_the_list_of_what_nothing_proves():
    words = HOLDS.split("that they fit each other:")[1]
    assert re.findall(r"`([\w.]+)`", words) == list(UNPROVED)


SLOW = ("SnookerFrame-v0", "SnookerSafety-v0")
"""Tasks whose strokes are checked by asking the opponent again: minutes a file."""
USUAL = (".strokes",)
"""Ends of the names of files that the usual run checks; the weekly one checks all."""


@pytest.mark.parametrize(
    "file",
    [
        pytest.param(
            one,
            id=one.stem,
            marks=[pytest.mark.slow] * (one.stem.startswith(SLOW) or not one.stem.endswith(USUAL)),
        )
        for one in FILES
    ],
)
def test_what_stands_on_the_leaderboard_is_sound_and_official(file):
    record = read_result(file)
    if record["machine"]["arithmetic"] != arithmetic():
        pytest.skip("this machine rounds otherwise than the one that made the file")
    assert faults(record, asking=False) == [] and record["protocol"]["official"]
    assert file.name == f"{record['task']}.{record['agent']['label']}.json"


@pytest.mark.slow
@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_known_players_play_again_what_stands_on_the_leaderboard(file):
    record = read_result(file)
    if record["machine"]["arithmetic"] != arithmetic():
        pytest.skip("this machine rounds otherwise than the one that made the file")
    assert faults(record) == []


def test_the_leaderboard_has_the_tables_of_its_files():
    text = (ROOT / "docs/leaderboard.md").read_text(encoding="utf-8")
    assert text == page(text, [*map(read_result, FILES)])
    with pytest.raises(ValueError, match=r"must hold the lines <!-- tables --> and"):
        page(text.replace("<!-- tables -->", ""), [])


def test_the_examples_on_the_page_run(tmp_path, monkeypatch):
    """The environments, and the model that it trains, judged by the command that stands beside it."""
    pytest.importorskip("stable_baselines3")
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)
    for block in blocks:
        exec(compile(block.replace("num_envs=64", "num_envs=4"), "benchmark.md", "exec"), {})
    assert len(blocks) == 2 and (tmp_path / "model.zip").is_file()
    (command,) = [one for one in re.findall(r"^\$ ((?:.*\\\n)*.*)", TEXT, re.MULTILINE) if "model.zip" in one]
    words = command.replace("\\\n", " ").split()
    assert words[:3] == ["python", "-m", "snooker_env.benchmark"]
    assert main([*words[3:], "--episodes", "10"]) == 0
    assert faults(read_result(tmp_path / "SnookerEscape-v0.model.json")) == []
