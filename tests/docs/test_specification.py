"""Does the specification print the options and noise levels of the code?"""

import ast
import dataclasses
import inspect
import re

import snooker_env as sn
from snooker_env.tasks import LEVELS, Noise
from snooker_env.tasks.options import options_table
from tests.docs.pages import ROOT

PAGE = (ROOT / "docs/environment/specification.md").read_text(encoding="utf-8")


def tables(heading):
    """The tables between that heading and the next of any depth: rows of cells, the first one the head."""
    section = re.split(r"^#+ ", PAGE.partition(f"# {heading}\n")[2], maxsplit=1, flags=re.MULTILINE)[0]
    found = re.findall(r"(?:^\|.*\n)+", section, re.MULTILINE)
    cells = lambda line: [cell.strip() for cell in line.strip("|").split("|")]  # noqa: E731
    rows = [list(map(cells, table.splitlines())) for table in found]
    return [[table[0], *table[2:]] for table in rows]


def defaults(table):
    """Name -> default, of a table of options; a row may have several names."""
    rows = [(re.findall(r"`(\w+)`", row[0]), ast.literal_eval(row[1].strip("`"))) for row in table[1:]]
    return {name: default for names, default in rows for name in names}


def test_options_have_the_defaults_that_are_printed():
    of_all, of_one = map(defaults, tables("Options"))
    fields = {field.name: field.default for field in dataclasses.fields(sn.Options) if field.init}
    assert of_all == fields and options_table() in PAGE and options_table() in str(sn.SnookerEnv.__doc__)
    signature = inspect.signature(sn.SnookerEnv).parameters
    assert of_one == {name: signature[name].default for name in ("options", "render_mode", "render_size")}


def test_noise_levels_have_the_numbers_that_are_printed():
    ((head, *rows),) = tables("Noise")
    levels = [ast.literal_eval(cell.strip("`")) for cell in head[2:]]
    assert {*levels, "none"} == set(LEVELS)
    assert [row[0].strip("`") for row in rows] == [field.name for field in dataclasses.fields(Noise)]
    for row in rows:
        numbers = [getattr(LEVELS[level], row[0].strip("`")) for level in levels]
        assert [float(cell) for cell in row[2:]] == numbers, row[0]
