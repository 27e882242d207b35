"""Do the changes work that docs/develop shows? Each diff applies to a copy of the tree, keeps its layers, and what it adds can be used."""

import os
import re
import shlex
import shutil
import subprocess
import sys

import pytest

from tests.processes import ROOT

NAMES = {"collision_model": "walton", "layout": "arc", "agent": "greedy"}
"""Page -> what its diff adds."""
PAGES = {page: (ROOT / f"docs/develop/{page}.md").read_text(encoding="utf-8") for page in NAMES}
DIFFS = {page: ROOT / f"docs/develop/diffs/{page}.diff" for page in NAMES}
COPIED = ("snooker_env", "agents", "commands", "benchmarks", "tests", "docs", "train.py", "pyproject.toml", "CONTRIBUTING.md")
NO_KERNELS = {"NUMBA_DISABLE_JIT": "1"}
"""A changed package would have to be compiled: plain Python is slow to run and quick to start."""


def copy(to):
    """A copy of the tree without trained weights."""
    for name in COPIED:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, to / name, ignore=shutil.ignore_patterns("__pycache__", "*.zip", "pictures", "results"))
        else:
            shutil.copy(ROOT / name, to / name)
    return to


@pytest.fixture(scope="module")
def changed(tmp_path_factory):
    """Page -> a copy of the tree with its diff applied."""
    trees = {}
    for page, diff in DIFFS.items():
        trees[page] = copy(tmp_path_factory.mktemp(page))
        subprocess.run(["git", "apply", "--whitespace=error", str(diff)], cwd=trees[page], check=True, timeout=60)
    return trees


def run(tree, *arguments, **variables):
    """Python in a tree: exit code, and what it printed on stdout and stderr."""
    env = os.environ | {"PYTHONPATH": str(tree), "SNOOKER_ENV_QUIET": "1", "PYTHONDONTWRITEBYTECODE": "1"} | variables
    done = subprocess.run([sys.executable, *arguments], cwd=tree, env=env, capture_output=True, text=True, timeout=900, check=False)
    return done.returncode, done.stdout + done.stderr


def commands(page):
    """The commands in the page's bash block, but the one that applies the diff."""
    (block,) = re.findall(r"```bash\n(.*?)```", PAGES[page], re.DOTALL)
    applies, *others = block.splitlines()
    assert applies == f"git apply docs/develop/diffs/{page}.diff" and all(line.startswith("python -m ") for line in others)
    return [shlex.split(line)[1:] for line in others]


def python_of(page):
    """The page's Python, or None."""
    return next(iter(re.findall(r"```python\n(.*?)```", PAGES[page], re.DOTALL)), None)


def files_of(page):
    """The files that a diff changes or adds."""
    return re.findall(r"^\+\+\+ b/(\S+)$", DIFFS[page].read_text(encoding="utf-8"), re.MULTILINE)


@pytest.mark.parametrize("page", PAGES)
def test_a_page_shows_its_diff(page):
    assert f"```{{literalinclude}} diffs/{page}.diff\n:language: diff\n```" in PAGES[page]
    changes = files_of(page)
    assert any(name.startswith("tests/") for name in changes) and len(changes) <= 6, "an extension should touch few files"


@pytest.mark.parametrize("page", PAGES)
def test_the_tests_that_a_page_names_pass(changed, page):
    (tests,) = (line for line in commands(page) if line[1] == "pytest")
    variables = {} if page == "agent" else NO_KERNELS  # an agent leaves the kernels as they are: kept machine code fits
    chosen = ["-k", "not generator_decides and not snookered and not pots and not opened"] if page == "layout" else []
    code, output = run(changed[page], *tests, "-p", "no:cacheprovider", *chosen, **variables)
    assert code == 0, output[-3000:]
    assert set(re.findall(r"tests/\S+\.py", " ".join(tests))) & set(files_of(page))


@pytest.mark.parametrize("page", ["collision_model", "layout"])
def test_the_python_of_a_page_runs_with_the_diff_and_not_without(changed, page):
    code, output = run(changed[page], "-W", "error", "-c", python_of(page), **NO_KERNELS)
    assert code == 0 and len(output.splitlines()) >= 2, output[-3000:]
    code, output = run(ROOT, "-c", python_of(page), **NO_KERNELS)
    assert code != 0 and f"'{NAMES[page]}': must be" in output, output[-3000:]


@pytest.mark.slow
@pytest.mark.parametrize("page", ["collision_model", "layout"])
def test_the_python_of_a_page_runs_compiled(changed, page, tmp_path):
    code, output = run(changed[page], "-W", "error", "-c", python_of(page), NUMBA_CACHE_DIR=str(tmp_path))
    assert code == 0 and len(output.splitlines()) >= 2, output[-3000:]


def test_the_new_agent_is_evaluated_by_its_name(changed):
    (command,) = (line for line in commands("agent") if line[1] != "pytest")
    code, output = run(changed["agent"], *command)
    assert code == 0 and NAMES["agent"] in output, output[-3000:]
    code, output = run(ROOT, *command)
    assert code != 0 and f"'{NAMES['agent']}': must be" in output, output[-3000:]
