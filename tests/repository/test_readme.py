"""Does the README say what CI does? Its two commands are those that ``.ci/run`` runs. ``tests/docs`` checks it as it checks every page."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_the_two_commands_are_those_that_ci_runs():
    commands = [c.split(" && ") for c in re.findall(r"^python3 -m venv .*$", README, re.M)]
    assert [c[0] for c in commands] == ["python3 -m venv .venv"] * 2  # a system's Python may refuse to be installed into
    assert [c[1].partition(" -e ")[0] for c in commands] == [".venv/bin/pip install"] * 2
    assert [c[2] for c in commands] == [".venv/bin/python train.py", ".venv/bin/python -m pytest"]
    ci = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    assert "command_of 'train\\.py'" in ci and "command_of '-m pytest'" in ci


def test_it_is_short():
    """One screen after another is not read to its end: what is long goes into ``docs/``."""
    lines = README.splitlines()
    assert len(lines) <= 150
    assert not [line for line in lines if len(line) > 120]
