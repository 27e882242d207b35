"""Do the workflow and CI run what exists?"""

import re
import shlex
import sys

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.version import Version

from tests.processes import ROOT

if sys.version_info >= (3, 11):
    import tomllib
else:
    tomllib = pytest.importorskip("tomli")

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
EXTRAS = PROJECT["project"]["optional-dependencies"]
LOWEST = PROJECT["project"]["requires-python"].removeprefix(">=")
JOBS = yaml.safe_load((ROOT / ".github/workflows/tests.yml").read_text(encoding="utf-8"))["jobs"]


def test_the_ends_of_the_python_versions_are_tested():
    lowest, newest = JOBS["tests"]["strategy"]["matrix"]["python"]
    classified = [
        name.rpartition(" ")[2] for name in PROJECT["project"]["classifiers"] if "Python :: 3." in name
    ]
    assert (classified[0], classified[-1]) == (lowest, newest) and lowest == LOWEST
    assert classified == sorted(classified, key=Version)
    assert PROJECT["tool"]["ruff"]["target-version"] == "py" + LOWEST.replace(".", "")
    assert PROJECT["tool"]["pyright"]["pythonVersion"] == LOWEST


def test_every_library_has_a_lowest_version():
    declared = [*PROJECT["project"]["dependencies"], *(line for extra in EXTRAS.values() for line in extra)]
    for requirement in map(Requirement, declared):
        assert requirement.name == "snooker-env" or ">=" in str(requirement.specifier), requirement


@pytest.mark.parametrize("job", JOBS)
def test_commands_name_paths_and_extras_that_exist(job):
    commands = [step["run"] for step in JOBS[job]["steps"] if "run" in step]
    parts = [row["parts"] for row in JOBS[job].get("strategy", {}).get("matrix", {}).get("include", [])]
    words = [word for line in (*commands, *parts) for word in shlex.split(line)]
    assert len(words) > 3
    for word in words:
        assert not word.startswith("tests/") or (ROOT / word).exists(), word
        extras = re.fullmatch(r"\.\[([\w,]+)\]", word)
        assert not extras or set(extras[1].split(",")) <= set(EXTRAS), word


def test_the_readmes_two_commands_are_those_that_ci_runs():
    readme, ci = ((ROOT / name).read_text(encoding="utf-8") for name in ("README.md", ".ci/run"))
    commands = [c.split(" && ") for c in re.findall(r"^python3 -m venv .*$", readme, re.M)]
    # a system's Python may refuse to be installed into
    assert [c[0] for c in commands] == ["python3 -m venv .venv"] * 2
    assert [c[1].partition(" -e ")[0] for c in commands] == [".venv/bin/pip install"] * 2
    assert [c[2] for c in commands] == [".venv/bin/python train.py", ".venv/bin/python -m pytest"]
    assert "command_of 'train\\.py'" in ci and "command_of '-m pytest'" in ci
