"""Do agents, commands and examples get along with what the package promises?"""

import ast
import doctest
import importlib
import re
from pathlib import Path

import pytest

import snooker_env as sn
from tests.processes import python

ROOT = Path(sn.__file__).resolve().parents[1]
PACKAGE = ROOT / "snooker_env"
FOLDERS = ("agents", "commands", "examples")
USERS = sorted([ROOT / "train.py", *(path for name in FOLDERS for path in (ROOT / name).rglob("*.py"))])
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]


def promised(path):
    """The names in ``__all__`` of a file, or None if it has none."""
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__":
            return ast.literal_eval(node.value)
    return None


def dotted(path):
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


ALL = {dotted(path): names for path in PACKAGE.rglob("*.py") if (names := promised(path)) is not None}
"""Module -> its public names; a module without ``__all__`` has none."""


def private(source):
    """What some code uses of the package that is not public: lines like "snooker_env.tasks.visit: Visits"."""
    direct, aliases = [], {"snooker_env"}
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            aliases |= {alias.asname or alias.name for alias in node.names if alias.name == "snooker_env"}
            names = [alias.name for alias in node.names if alias.name.startswith("snooker_env.")]
            direct += [name for name in names if name not in ALL]
        elif isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "snooker_env":
            public = {*ALL.get(node.module, ()), "__version__"}
            names = [alias.name for alias in node.names if f"{node.module}.{alias.name}" not in ALL]
            direct += [f"{node.module}: {name}" for name in names if name not in public]
        elif isinstance(node, ast.Attribute) and getattr(node.value, "id", "") in aliases:
            public = {*ALL["snooker_env"], "__version__", "__file__"}
            if node.attr not in public and f"snooker_env.{node.attr}" not in ALL:
                direct.append(f"snooker_env.{node.attr}")
    # what environments are made of
    return direct + re.findall(r"\b(?:env|tables|venv)\.(?:frames|shooter|visits)\b", source)


TRAINED_FOR = (
    "snooker_env.players",
    "snooker_env.planning.learned",
    "snooker_env.planning.sobol: EVEN_SAMPLES",
    "snooker_env.tasks.noise: errors_of",
)


@pytest.mark.parametrize("path", USERS, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_agents_commands_and_examples_use_public_names_only(path):
    """But for what ``commands`` passes on, and for the rooms that ``agents`` trains for."""
    passed_on = {"commands/files.py": "snooker_env._files", "commands/tables.py": "snooker_env._tables"}
    known = (*TRAINED_FOR, passed_on.get(path.relative_to(ROOT).as_posix(), "?"))
    assert [name for name in private(path.read_text(encoding="utf-8")) if not name.startswith(known)] == []


def examples(page):
    """The Python of a page, that of its notebook cells included."""
    fence = r"```(?:python|\{code-cell\}[^\n]*)\n(?::\w.*?\n)*(.*?)```"
    return re.findall(fence, page.read_text(encoding="utf-8"), re.DOTALL)


def test_the_readme_and_the_documentation_use_public_names_only():
    shown = {page.relative_to(ROOT).as_posix(): examples(page) for page in PAGES}
    used = {page: [name for block in blocks for name in private(block)] for page, blocks in shown.items()}
    assert "snooker_env.physics.impact: inertia" in used.pop("docs/physics/derivation.md")
    assert {page: names for page, names in used.items() if names} == {}
    assert len(USERS) > 40 and len(shown["README.md"]) >= 3 and sum(map(len, shown.values())) > 40


def test_environments_and_planning_are_reached_from_the_package_and_loaded_when_asked():
    out, _ = python(
        "import sys, snooker_env as sn\n"
        "heavy = lambda: [n for n in sys.modules if n.startswith(('snooker_env.envs', 'snooker_env.planning', 'snooker_env.tasks'))]\n"
        "print(heavy(), 'SnookerEnv' in dir(sn), 'planning' in dir(sn))\n"
        "print(sn.planning.Planner is sn.Planner, sn.SnookerEnv.__module__, sn.SnookerVectorEnv.__module__)\n"
        "from snooker_env import *\n"
        "print(Position is sn.Position, SnookerEnv is sn.SnookerEnv)\n"
    )
    modules = "True snooker_env.envs.snooker snooker_env.envs.vector"
    assert out.splitlines() == ["[] True True", modules, "True True"]
    with pytest.raises(AttributeError, match=r"module 'snooker_env' has no attribute 'Snooker'"):
        _ = sn.Snooker


EXAMPLES = sorted(
    dotted(path) for path in PACKAGE.rglob("*.py") if ">>> " in path.read_text(encoding="utf-8")
)


@pytest.mark.parametrize("module", EXAMPLES)
def test_examples_in_docstrings_run(module):
    failed, tried = doctest.testmod(importlib.import_module(module))
    assert failed == 0 and tried > 0
