"""Does each command end without a word where nobody reads its output on, as in ``... | head``?"""

import os
import subprocess
import sys

import pytest

import snooker_env as sn
from snooker_env.advice import Recorded, write_strokes

AT = sn.Position(cue=(0.1, 0.2), black=(-0.3, 1.0))
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
    write_strokes(tmp_path / "mine.json", [Recorded(position=AT, ball=21, pocket=4, potted=True)])
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
