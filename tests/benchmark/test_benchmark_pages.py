"""Do the benchmark's pages say what the code does? The tables of tasks and fields, and the leaderboard as the command makes it."""

import re
from pathlib import Path

import pytest

from snooker_env.benchmark import FREE, TASKS, faults, page, read_result
from snooker_env.benchmark.__main__ import main
from snooker_env.benchmark.schema import FIELDS, NUMBER

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs/benchmark.md").read_text(encoding="utf-8")
FILES = sorted((ROOT / "leaderboard").glob("*.json"))
KINDS = {str: "text", int: "integer", bool: "boolean", list: "list", dict: "object", NUMBER: "number"}


@pytest.mark.parametrize("name", TASKS)
def test_the_table_of_tasks(name):
    task = TASKS[name]
    others = ", ".join(f"{key}={value}" for key, value in task.changes.items() if key not in ("noise", "layout"))
    row = [f"`{name}`", task.frozen["noise"], others, task.changes["layout"], task.judged_layout, task.measure, f"{task.episodes:,}"]
    assert f"| {' | '.join(row)} |" in TEXT


def test_every_option_is_called_free_or_frozen():
    free, frozen = TEXT.split("### What is free and what is frozen")[1].split("### Tables")[0].split("Everything else is frozen:")
    assert all(f"`{name}`" in free for name in FREE)
    assert all(f"`{name}`" in frozen.split("Passing")[0] for name in TASKS["SnookerBreak-v0"].frozen)


@pytest.mark.parametrize("name", FIELDS)
def test_the_table_of_fields(name):
    kind, empty, meaning = FIELDS[name]
    assert f"| `{name}` | {KINDS[kind]}{' or null' if empty else ''} | {meaning} |" in TEXT


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_what_stands_on_the_leaderboard_is_sound_and_official(file):
    found = read_result(file)
    assert faults(found) == [] and found["protocol"]["official"]
    assert file.name == f"{found['task']}.{found['agent']['label']}.json"


def test_the_leaderboard_is_what_the_command_prints(tmp_path):
    assert FILES
    made = tmp_path / "leaderboard.md"
    assert main(["table", *map(str, FILES), "--markdown", str(made)]) == 0
    assert made.read_text(encoding="utf-8") == (ROOT / "docs/leaderboard.md").read_text(encoding="utf-8")
    assert page([read_result(file) for file in FILES]) == made.read_text(encoding="utf-8")


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
    assert words[:3] == ["python", "-m", "snooker_env.benchmark"] and main([*words[3:], "--episodes", "10"]) == 0
    assert faults(read_result(tmp_path / "SnookerPotHard-v0.model.json")) == []
