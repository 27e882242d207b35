"""Does each command of the documentation run? In a short form, or in the test named beside it."""

import os
import re
import shlex
import subprocess
import sys

import pytest

from tests.docs.named_commands import ELSEWHERE, NOT_RUN, SHORT
from tests.docs.pages import PAGES, ROOT, commands

GIVEN = {name: set() for page in PAGES for name, _ in commands(page.read_text(encoding="utf-8"))}
"""Module or file -> the options that some page gives it."""
for _page in PAGES:
    for _name, _words in commands(_page.read_text(encoding="utf-8")):
        GIVEN[_name].update(found[0] for word in _words if (found := re.match(r"--[a-z][\w-]*", word)))


def test_every_command_is_known():
    known = [*SHORT, *ELSEWHERE, *NOT_RUN]
    assert len(GIVEN) > 20 and not set(GIVEN) - set(known)
    assert len(set(known)) == len(known)
    assert set(NOT_RUN) <= set(GIVEN) and all(NOT_RUN.values())


@pytest.mark.parametrize(
    "name", sorted(set(GIVEN) - set(NOT_RUN) - {"pytest", "sphinx", "venv", "rl_zoo3.train"})
)
def test_commands_have_the_options_that_are_given(name):
    """They stand in the source of the command, or in what all commands of its kind share."""
    top = name.split("/")[0] if name.endswith(".py") else name.split(".")[0]
    shared = {
        top: (top.replace("train.py", "agents"), "commands") for top in ("train.py", "agents", "benchmarks")
    }
    files = [file for folder in shared.get(top, (top,)) for file in (ROOT / folder).rglob("*.py")]
    files += [ROOT / name] if name.endswith(".py") else []
    source = "\n".join(file.read_text(encoding="utf-8") for file in files)
    for option in GIVEN[name]:
        field = option[2:].replace("-", "_")
        assert re.search(rf'"{option}"|^    {field}: ', source, re.MULTILINE), option


@pytest.mark.parametrize("name", sorted(set(GIVEN) & set(SHORT)))
def test_commands_run(name, tmp_path):
    arguments = shlex.split(SHORT[name].format(tmp=tmp_path))
    command = [sys.executable, name] if name.endswith(".py") else [sys.executable, "-m", name]
    path = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    env = os.environ | {"SDL_VIDEODRIVER": "dummy", "PYTHONPATH": path}
    printed = subprocess.check_output([*command, *arguments], cwd=ROOT, timeout=300, text=True, env=env)
    assert printed.strip()
    if name == "tests.rules_cases":
        assert printed.splitlines()[-1].endswith(", 0 failed")
    if name == "docs/films/make.py":
        assert (tmp_path / "pot_easy.mp4").stat().st_size > 5_000
