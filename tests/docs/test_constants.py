"""Is the table of constants that of the code: every field of every preset once, with its value and provenance?"""

import dataclasses
import importlib
import re

import pytest

import snooker_env as sn
from snooker_env.physics.parameters import PRESETS
from tests.docs.pages import DOCS

PAGE = (DOCS / "physics" / "constants.md").read_text(encoding="utf-8")
ROWS = [
    [cell.strip() for cell in line.strip("|").split("|")] for line in PAGE.splitlines() if line[:3] == "| `"
]
KNOWN = re.findall(r"^\* \*\*(\w+)\*\*:", PAGE, re.MULTILINE)
FIELDS = [field.name for field in dataclasses.fields(sn.Physics) if field.name not in ("tables", "flight")]


def values(text):
    return [None if x == "None" else x.strip('"') if '"' in x else float(x) for x in text.split(", ")]


@pytest.mark.parametrize("preset", PRESETS)
def test_every_constant_of_a_preset_is_there_once_with_its_value(preset):
    said = {}
    for name, presets, value, _, _ in ROWS:
        if preset in presets.split(", "):
            field = re.findall(r"`(\w+)`", name)[0]
            assert field not in said
            (said[field],) = values(value)
    assert said == {field: getattr(sn.Physics.preset(preset), field) for field in FIELDS}


def test_the_others_have_the_values_of_their_files():
    others = [row for row in ROWS if not row[1]]
    assert len(others) == 9
    for name, _, value, _, _ in others:
        *names, file = re.findall(r"`([\w/.]+)`", name)
        module = importlib.import_module(file.removesuffix(".py").replace("/", "."))
        held = [getattr(module, one) for one in names]
        assert values(value) == (list(held[0]) if isinstance(held[0], tuple) else held), name


def test_every_row_says_how_it_is_known_and_by_what():
    assert len(KNOWN) == 5 and {row[3] for row in ROWS} == set(KNOWN)
    for name, *_, known, source in ROWS:
        assert len(source) > 10, name
        if known == "fitted":
            assert re.search(r"python -m benchmarks\.|at commit [0-9a-f]{8}|by \[MJP1", source), name
