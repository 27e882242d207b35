"""Do the rooms that name the cache's folder hold all kernels, and are inner kernels only linked?"""

import ast
import json
import operator
import re
from pathlib import Path

import pytest
from numba.core.types.functions import BaseFunction

import snooker_env
from snooker_env import _cache, _inner
from tests.processes import copy_of_package, python, replace

PACKAGE = Path(snooker_env.__file__).resolve().parent
INSIDE = [p for p in sorted(PACKAGE.rglob("*.py")) if p.relative_to(PACKAGE).parts[0] in _cache.KERNEL_ROOMS]
NO_CONSTANTS = {"_cache", "_check", "_files", "_install", "_notices", "_shots", "_tables", "_types", "shot"}
"""What the rooms import besides themselves, of which no kernel takes anything."""


def taken(path):
    """The modules that a file imports names from, as paths: ``from ..game import pots`` is game/pots.py."""
    here = path.relative_to(PACKAGE).parts[:-1]
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = here[: len(here) - node.level + 1]
            names = node.module.split(".") if node.module else [alias.name for alias in node.names]
            yield (*base, *names)


@pytest.mark.parametrize("path", INSIDE, ids=lambda p: p.relative_to(PACKAGE).as_posix())
def test_a_room_takes_constants_and_kernels_from_rooms_alone(path):
    rooms = {Path(room).stem for room in _cache.KERNEL_ROOMS} | NO_CONSTANTS
    assert {module[0] for module in taken(path) if module} <= rooms


def test_every_room_is_there_and_every_kernel_of_more_than_one_file_is_in_one():
    assert all((PACKAGE / room).exists() for room in _cache.KERNEL_ROOMS)
    outside = {p.relative_to(PACKAGE).as_posix(): p.read_text() for p in {*PACKAGE.rglob("*.py")} - {*INSIDE}}
    made = [name for name, text in outside.items() if re.search("_jit import(.|\n)*@(entry|kernel)", text)]
    assert made == ["replays/video_colours.py"]  # it has the folder of the whole package's hash


KERNELS = """
from snooker_env.kernels import entry, kernel

@kernel
def double(x):
    return 2.0 * x

@entry
def outer(x):
    return double(x) + 1.0
"""
"""Not in a file: they are compiled in every process."""
SHOT = """
import json
import snooker_env as sn
from snooker_env import _inner
from snooker_env.physics import cloth
shot = sn.simulate([(0.0, -1.0), (0.05, 0.5)], [(0.1, 3.0), (0.0, 0.0)], [(9.0, 0.0, 4.0), (0.0, 0.0, 0.0)])
machine = [type(one.entry_point).__name__ for one in cloth.begin.overloads.values()]
print(json.dumps([_inner.KNOWN, machine, shot.positions.tolist(), shot.duration, len(shot.events)]))
"""


def test_inner_kernels_are_only_linked_and_numba_finds_the_rest():
    here = {}
    exec(KERNELS, here)
    assert here["outer"](3.0) == 7.0 and _inner.KNOWN
    ((inner,), (outer,)) = (here[name].overloads.values() for name in ("double", "outer"))
    assert isinstance(inner.entry_point, _inner.EntryPoint)
    assert not isinstance(outer.entry_point, _inner.EntryPoint)
    # What was found once is for the types alone: ``max``, compiled for its caller's options, is not kept
    here = {}
    exec(KERNELS.replace("2.0 * x", "max(2.0 * x, 1.0)"), here)
    assert here["outer"](3.0) == 7.0 and here["outer"](0.0) == 2.0
    assert any(called is operator.mul for called, _ in _inner._found)
    assert not any(called is max for called, _ in _inner._found)
    assert getattr(BaseFunction, _inner.FIND) is _inner._find


@pytest.mark.slow
def test_without_the_parts_of_numba_the_results_are_the_same(tmp_path):
    """Both kinds of compiling from an empty cache: half a minute each."""
    results = []
    for k, known in enumerate((True, False)):
        tree = copy_of_package(tmp_path / str(k))
        new = "KNOWN = all(" if known else "KNOWN = False and all("
        replace(tree / "snooker_env" / "_inner.py", "KNOWN = all(", new)
        results.append(json.loads(python(SHOT, at=tree, NUMBA_CACHE_DIR=str(tmp_path / f"cache{k}"))[0]))
    assert results[0][:2] == [True, ["EntryPoint"]]
    assert results[1][0] is False and "EntryPoint" not in results[1][1]
    assert results[0][2:] == results[1][2:]
