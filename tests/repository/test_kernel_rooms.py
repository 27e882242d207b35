"""Do the rooms that name the cache's folder hold all kernels, and are inner kernels only linked?"""

import ast
import re
from pathlib import Path

import pytest

import snooker_env
from snooker_env._lib import cache

PACKAGE = Path(snooker_env.__file__).resolve().parent
INSIDE = [p for p in sorted(PACKAGE.rglob("*.py")) if p.relative_to(PACKAGE).parts[0] in cache.KERNEL_ROOMS]
NO_CONSTANTS = {"render"}
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
    rooms = {Path(room).stem for room in cache.KERNEL_ROOMS} | NO_CONSTANTS
    assert {module[0] for module in taken(path) if module} <= rooms


def test_every_room_is_there_and_every_kernel_is_in_one():
    assert all((PACKAGE / room).exists() for room in cache.KERNEL_ROOMS)
    outside = {p: p.read_text() for p in sorted(PACKAGE.rglob("*.py")) if p not in INSIDE}
    assert [p for p, text in outside.items() if re.search(r"^@(entry|kernel)", text, re.MULTILINE)] == []
