"""Is every public name there once, documented as numpy does it, and nothing else used by agents?"""

import ast
import dataclasses
import doctest
import importlib
import inspect
import re

import pytest

import snooker_env as sn
from tests.processes import ROOT, python

PACKAGE = ROOT / "snooker_env"
FOLDERS = ("agents", "examples")
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


TRAINED_FOR = """
benchmark.luck_counter; benchmark.playing; benchmark.provenance; benchmark.results; benchmark.schema: faults_of_fields;
benchmark.statistics; benchmark.tasks; game.layouts: plan_of; players; planning.learned; planning.worth;
game: frame_columns; tasks.frames; players.saved_models; tasks.threads
"""


@pytest.mark.parametrize("path", USERS, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_agents_and_examples_use_public_names_only(path):
    """But for what ``agents._lib`` passes on, and for the rooms that ``agents`` trains for."""
    passed_on = {
        "agents/_lib/files.py": (
            "snooker_env._lib.files",
            "snooker_env._lib.seal",
            "snooker_env._lib: files",
        ),
        "agents/_lib/lifecycle.py": ("snooker_env._lib.command",),
        "agents/_lib/tables.py": ("snooker_env._lib.text_tables",),
    }
    rooms = (f"snooker_env.{room.strip()}" for room in TRAINED_FOR.split(";"))
    known = (*rooms, *passed_on.get(path.relative_to(ROOT).as_posix(), ()))
    assert [name for name in private(path.read_text(encoding="utf-8")) if not name.startswith(known)] == []


def examples(page):
    """The Python of a page, that of its notebook cells included."""
    fence = r"```(?:python|\{code-cell\}[^\n]*)\n(?::\w.*?\n)*(.*?)```"
    return re.findall(fence, page.read_text(encoding="utf-8"), re.DOTALL)


def test_the_readme_and_the_documentation_use_public_names_only():
    shown = {page.relative_to(ROOT).as_posix(): examples(page) for page in PAGES}
    used = {page: [name for block in blocks for name in private(block)] for page, blocks in shown.items()}
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


NAMES = sorted({(module, name) for module, names in ALL.items() for name in names})


def sections(text):
    """Heading -> the text below it; the text before the first heading is under ""."""
    first, *parts = re.split(r"^(\w[\w ]*)\n-{3,}$", text, flags=re.MULTILINE)
    return {"": first} | dict(zip(parts[::2], parts[1::2], strict=True))


def entries(text):
    """The names that a section such as Parameters describes, in order; ``a, b : float`` are two names."""
    lines = re.findall(r"^([*\w][\w*, ]*)(?: : .*)?\n(?= +\S)", text + "\n", re.MULTILINE)
    return [name.strip() for line in lines for name in line.split(",")]


def plain(thing):
    """The function below a kernel, a class method or a cache."""
    thing = getattr(thing, "__func__", thing)
    return inspect.unwrap(getattr(thing, "py_func", thing))


def parameters(thing):
    """The names of a function's parameters, with their stars, without the receiver."""
    stars = {inspect.Parameter.VAR_POSITIONAL: "*", inspect.Parameter.VAR_KEYWORD: "**"}
    every = inspect.signature(plain(thing)).parameters.items()
    names = [(stars.get(p.kind, ""), name) for name, p in every if name not in ("self", "cls")]
    return [star + name for star, name in names if not name.startswith("_")]


def class_faults(thing, parts):
    """What a class's docstring lacks, and those of its public methods and properties."""
    described = entries(parts.get("Parameters", "")) + entries(parts.get("Attributes", ""))
    wanted = []
    if members := getattr(thing, "__members__", ()):
        described, wanted = re.findall(r"\w+", thing.__doc__), list(members)
    elif dataclasses.is_dataclass(thing) or hasattr(thing, "_fields"):
        fields = getattr(thing, "_fields", None) or [field.name for field in dataclasses.fields(thing)]
        wanted = [*parameters(thing), *(name for name in fields if not name.startswith("_"))]
    elif "__init__" in vars(thing) and not issubclass(thing, BaseException):
        wanted = [] if getattr(thing, "_is_protocol", False) else parameters(thing.__init__)
    if missing := set(wanted) - set(described):
        yield f"does not describe {sorted(missing)}"
    for name, member in vars(thing).items():
        ours = inspect.isfunction(plain(member)) and plain(member).__module__.startswith("snooker_env")
        if not name.startswith("_") and (ours or isinstance(member, property)) and not inspect.getdoc(member):
            yield f".{name} has no docstring"


def faults(module, name):
    """What is wrong with the documentation of a public name."""
    thing = getattr(importlib.import_module(module), name)
    function = callable(thing) and inspect.isfunction(plain(thing))
    if not (function or inspect.isclass(thing) or inspect.ismodule(thing)):
        return []
    text = inspect.cleandoc((plain(thing) if function else thing).__doc__ or "")
    if not text or inspect.ismodule(thing):
        return [] if text else ["has no docstring"]
    parts = sections(text)
    direct = [] if function else list(class_faults(thing, parts))
    # only kernels can call an inner kernel, so no example can
    exempt = type(thing).__name__ == "Inner" or (not function and issubclass(thing, BaseException))
    if not exempt and ">>> " not in parts.get("Examples", ""):
        direct.append("has no example")
    if function and entries(parts.get("Parameters", "")) != parameters(thing):
        direct.append(f"has Parameters {entries(parts.get('Parameters', ''))}, not {parameters(thing)}")
    returned = inspect.signature(plain(thing)).return_annotation if function else None
    if returned not in (None, "None", inspect.Signature.empty) and not {"Returns", "Yields"} & set(parts):
        direct.append("does not say what it returns")
    return direct


@pytest.mark.parametrize(("module", "name"), NAMES, ids=[f"{module}.{name}" for module, name in NAMES])
def test_each_public_name_is_there_once_and_documented_as_numpy_does_it(module, name):
    assert faults(module, name) == [] and ALL[module].count(name) == 1
