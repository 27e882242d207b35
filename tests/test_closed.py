"""Does each command end without a word where nobody reads its output on, as in ``... | head``?"""

import json
import os
import subprocess
import sys

import pytest

STROKE = {
    "position": {"cue": [0.1, 0.2], "black": [-0.3, 1.0]},
    "ball": 21,
    "pocket": "top left",
    "potted": True,
}
COMMANDS = {
    "coach": "snooker_env.advice coach mine.json --cue real --physics paper --table match",
    "benchmark": "snooker_env.benchmark tasks",
    "play": "snooker_env.play --help",
    "watch": "snooker_env.watch --help",
    "agents": "agents.report --help",
    "benchmarks": "benchmarks.coach --help",
}


@pytest.mark.parametrize("name", COMMANDS)
def test_a_reader_that_leaves_ends_a_command(name, tmp_path):
    kept = {"format": "snooker-strokes", "version": 1, "strokes": [STROKE]}
    (tmp_path / "mine.json").write_text(json.dumps(kept))
    read, write = os.pipe()
    os.close(read)
    path = os.pathsep.join([os.getcwd(), os.environ.get("PYTHONPATH", "")])
    where = {"cwd": tmp_path, "env": os.environ | {"SNOOKER_ENV_QUIET": "1", "PYTHONPATH": path}}
    try:
        command = [sys.executable, "-m", *COMMANDS[name].split()]
        done = subprocess.run(command, stdout=write, stderr=subprocess.PIPE, text=True, **where)
    finally:
        os.close(write)
    assert done.stderr == "" and done.returncode in (0, 1)  # argparse swallows what it cannot write
