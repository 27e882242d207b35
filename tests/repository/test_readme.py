"""Does the README tell the truth? Its Python runs, its commands are known, and what runs them exists."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text()
BLOCKS = re.findall(r"```python\n(.*?)```", README, re.S)


@pytest.mark.parametrize("block", BLOCKS, ids=range(len(BLOCKS)))
def test_python_blocks_run(block, tmp_path):
    env = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")]), "MPLBACKEND": "Agg"}
    subprocess.run([sys.executable, "-W", "error", "-c", block], cwd=tmp_path, env=env, check=True, timeout=300)


def test_the_two_commands_are_those_that_ci_runs():
    commands = [c.split(" && ") for c in re.findall(r"^python3 -m venv .*$", README, re.M)]
    assert [c[0] for c in commands] == ["python3 -m venv .venv"] * 2  # a system's Python may refuse to be installed into
    assert [c[1].partition(" -e ")[0] for c in commands] == [".venv/bin/pip install"] * 2
    assert [c[2] for c in commands] == [".venv/bin/python train.py", ".venv/bin/python -m pytest"]
    ci = (ROOT / ".ci" / "run").read_text()
    assert "command_of 'train\\.py'" in ci and "command_of '-m pytest'" in ci


MODULES = sorted(set(re.findall(r"python -m ((?:benchmarks|agents)\.\w+)", README)))
SHORT = {
    "benchmarks.paper": ["--no-pictures", "--json", "{tmp}/p.json"],
    "benchmarks.tradeoff": ["--impacts", "30", "--shots", "12", "--repeats", "1", "--out", "{tmp}"],
    "benchmarks.scene": ["--shots", "12", "--repeats", "1", "--models", "spin decay", "jaw arcs", "--out", "{tmp}"],
    "benchmarks.pockets": ["--quick", "--out", "{tmp}"],
    "benchmarks.rack": ["--shots", "2", "--orders", "2", "--racks", "2", "--out", "{tmp}"],
    "benchmarks.stability": ["--fuzz", "2000", "--out", "{tmp}"],
    "benchmarks.speed": [
        "--shots", "20", "--repeats", "1", "--parts", "impacts", "shots", "growth", "--largest-batch", "64", "--out", "{tmp}",
    ],
    "benchmarks.fit_cushion": [],
    "benchmarks.nap": [],
    "benchmarks.left_out": [],
    "benchmarks.make_opened": ["--tables", "2", "--out", "{tmp}"],
    "benchmarks.hand": ["--strokes", "40", "--visits", "4", "--levels", "professional", "robot"],
    "benchmarks.frames": ["--frames", "2", "--jobs", "1"],
    "benchmarks.layouts_picture": ["--out", "{tmp}"],
    "benchmarks.pictures": ["--out", "{tmp}"],
    "agents.evaluate": ["--agent", "random", "--visits", "12", "--layouts", "held_out", "--noise", "professional", "--resamples", "200"],
    "agents.watch": ["--agent", "ghost_ball", "--out", "{tmp}/visit.html"],
    "benchmarks.diagrams": ["--out", "{tmp}"],
    "agents.report": ["--show", "agents/results/147.json"],
    "benchmarks.planning": ["--strokes", "100", "--repeats", "2"],
    "benchmarks.fuzz": ["--shots", "300", "--threads", "1"],
    "benchmarks.vector": ["--seconds", "0.1", "--repeats", "1", "--tables", "64", "--ppo-steps", "2048"],
}  # fmt: skip


@pytest.mark.parametrize("module", MODULES)
def test_benchmark_commands_run(module, tmp_path):
    arguments = [a.format(tmp=tmp_path) for a in SHORT[module]]
    command, env = [sys.executable, "-m", module, *arguments], os.environ | {"SDL_VIDEODRIVER": "dummy"}
    done = subprocess.run(command, cwd=ROOT, check=True, timeout=300, capture_output=True, env=env)
    assert done.stdout.strip()


def test_the_rules_cases_run():
    command = re.search(r"python -m (tests\.rules_cases \S+?)`", README)
    assert command is not None
    done = subprocess.run([sys.executable, "-m", *command[1].split()], cwd=ROOT, check=True, timeout=300, capture_output=True, text=True)
    assert done.stdout.splitlines()[-1].endswith(", 0 failed")


def test_the_help_command_runs():
    command = re.search(r'`python -c "(.*?)"`', README)
    assert command is not None
    subprocess.run([sys.executable, "-c", command[1]], cwd=ROOT, check=True, capture_output=True)


def test_pictures_exist():
    for name in re.findall(r"!\[.*?\]\((.*?)\)", README):
        assert (ROOT / name).stat().st_size > 10_000
