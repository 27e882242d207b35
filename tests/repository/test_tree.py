"""Is the tree of agents, benchmarks and commands what docs/develop/architecture.md says? Layers, class names, what players do not load."""

import ast
from collections import defaultdict
from pathlib import Path

import pytest

from tests.processes import ROOT, python

FOLDERS = ("agents", "benchmarks", "commands")
FILES = sorted(path for folder in FOLDERS for path in (ROOT / folder).rglob("*.py"))
NAMES = [path.relative_to(ROOT).as_posix() for path in FILES]
LAYERS = ("commands", "agents.cluster", "agents.features", "agents.learning", "agents.players", "agents.evaluation", "agents", "benchmarks")
"""From the lowest: each imports itself and what stands before it; "agents" are the commands at the top of that folder."""


def layer_of(module):
    """The layer of a dotted name; None outside the three folders."""
    return next((layer for layer in sorted(LAYERS, key=len, reverse=True) if f"{module}.".startswith(f"{layer}.")), None)


def imports(path):
    """The dotted names that a file imports, wherever in it."""
    here = list(path.relative_to(ROOT).parent.parts)
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = here[: len(here) - node.level + 1] if node.level else []
            stem = ".".join([*base, *([node.module] if node.module else [])])
            yield from (f"{stem}.{alias.name}" for alias in node.names)


def test_the_reader_of_imports_sees_every_kind():
    seen = set(imports(ROOT / "agents/players/by_name.py"))
    assert {"agents.players.built_in.Random", "agents.players.trained.load_player", "importlib", "pathlib.Path"} <= seen
    assert "benchmarks._common.provenance" not in seen and "commands.provenance" in set(imports(ROOT / "benchmarks/scene/command.py"))
    assert [layer_of(m) for m in ("agents.players.search", "agents.curves.main", "numpy")] == ["agents.players", "agents", None]
    assert len(FILES) > 80


@pytest.mark.parametrize("name", NAMES)
def test_each_file_imports_only_what_stands_below_it(name):
    """And nobody imports train.py or the tests."""
    own = LAYERS.index(layer_of(name.removesuffix(".py").replace("/", ".")))
    for target in imports(ROOT / name):
        assert target.split(".")[0] not in ("train", "tests"), f"{name} imports {target}"
        layer = layer_of(target)
        assert layer is None or LAYERS.index(layer) <= own, f"{name} imports {target}"


def test_benchmarks_are_apart_from_each_other_but_for_what_they_share():
    """Of another benchmark only its functions are used, never its drawing or its ``main``."""
    for name in NAMES:
        if name.startswith("benchmarks/"):
            wrong = [t for t in imports(ROOT / name) if t.startswith("benchmarks.") and t.endswith(".main") and "__main__" not in name]
            assert not wrong, (name, wrong)


def test_no_two_classes_have_one_name():
    where = defaultdict(list)
    for path in [*FILES, ROOT / "train.py", *(ROOT / "snooker_env").rglob("*.py")]:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ClassDef):
                where[node.name].append(path.relative_to(ROOT).as_posix())
    assert not {name: files for name, files in where.items() if len(files) > 1}


@pytest.mark.parametrize("name", NAMES)
def test_each_file_says_first_which_question_it_answers(name):
    path = Path(ROOT, name)
    first = (ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or "").partition("\n")[0]
    assert len(first) > 20 and (path.name == "__init__.py" or "?" in first), f"{name} starts with {first!r}"
    assert len(path.read_text(encoding="utf-8").splitlines()) <= 400


def test_the_built_in_players_load_no_learning_library():
    """Neither torch nor Stable-Baselines3, nor what reads the recipes: not even to play."""
    code = """if True:
        import sys
        from agents.players.by_name import NAMES, player_of
        for name in NAMES:
            player_of(name)
        ours = ("agents.learning.hyperparameters", "agents.learning.models", "agents.players.trained")
        print([name for name in ("torch", "stable_baselines3", "sb3_contrib", *ours) if name in sys.modules])
    """
    assert python(code, at=ROOT)[0].strip() == "[]"
