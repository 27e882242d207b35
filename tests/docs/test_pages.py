"""Do the pages hold together, name every public name, and print the options and numbers of the code?"""

import ast
import dataclasses
import importlib
import inspect
import re

import pytest

import snooker_env as sn
from snooker_env.tasks import LEVELS, Noise
from tests.docs.pages import DOCS, LINKED, NAMES, PAGES, ROOT, anchors, links, paths


@pytest.mark.parametrize("page", LINKED, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_lead_somewhere(page):
    text = page.read_text(encoding="utf-8")
    for link in links(text):
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        assert target.exists(), link
        if anchor and target.suffix == ".md":
            assert anchor in anchors(target.read_text(encoding="utf-8")), link


def test_files_that_pages_name_exist():
    texts = {name: page.read_text(encoding="utf-8") for name, page in zip(NAMES, PAGES, strict=True)}
    named = [(name, path) for name, text in texts.items() for path in paths(text)]
    assert len(named) > 80
    assert not [(name, path) for name, path in named if not any(ROOT.glob(path))]


SOURCE = "\n".join(path.read_text(encoding="utf-8") for path in sorted((DOCS / "api").glob("*.md")))


@pytest.mark.parametrize(
    "module", ["snooker_env", *re.findall(r"^\* ``(snooker_env[.\w]*)``", str(sn.__doc__), re.MULTILINE)]
)
def test_every_public_name_is_documented_on_an_api_page(module):
    parts = re.findall(rf"^\.\. public:: {re.escape(module)}\n((?:   :.*\n)*)", SOURCE, re.MULTILINE)
    assert parts, f"no page has '.. public:: {module}'"
    chosen = " ".join(re.findall(r":only: (.*)", "".join(parts))).split()
    everything = any(":only:" not in options for options in parts)
    assert everything or set(chosen) == set(importlib.import_module(module).__all__)
    assert len(set(chosen)) == len(chosen) and ":but:" not in "".join(parts)


PAGE = (ROOT / "docs/environment/specification.md").read_text(encoding="utf-8")


def tables(heading):
    """The tables between that heading and the next of any depth: rows of cells, the first one the head."""
    section = re.split(r"^#+ ", PAGE.partition(f"# {heading}\n")[2], maxsplit=1, flags=re.MULTILINE)[0]
    found = re.findall(r"(?:^\|.*\n)+", section, re.MULTILINE)
    cells = lambda line: [cell.strip() for cell in line.strip("|").split("|")]  # noqa: E731
    rows = [list(map(cells, table.splitlines())) for table in found]
    return [[table[0], *table[2:]] for table in rows]


def options_table():
    """The specification's table of options, made from what ``Options`` declares: defaults and docstring.

    ``python -m tests.docs.test_pages`` writes it into the page."""
    text = inspect.cleandoc(sn.Options.__doc__ or "").partition("Parameters\n----------\n")[2]
    said = re.findall(
        r"^(\w+) : .* default (.*)\n((?:    .*\n)+)", text.partition("Attributes")[0], re.MULTILINE
    )
    fields = {field.name: field.default for field in dataclasses.fields(sn.Options) if field.init}
    assert {name: ast.literal_eval(default) for name, default, _ in said} == fields
    lines = ["| name | default | meaning |", "|---|---|---|"]
    for name, default, words in said:
        words = " ".join(words.split()).replace("``", "`")
        words = re.sub(r"docs/environment/(\w+)\.md", r"[\1](\1.md)", words)
        words = re.sub(r"docs/(\w+)/(\w+)\.md", r"[\2](../\1/\2.md)", words)
        lines.append(f"| `{name}` | `{default}` | {words} |")
    return "\n".join(lines) + "\n"


_PRINTED = re.compile(r"(?<=`Table`, an opponent\.\n\n)(?:\|.*\n)+")


def test_the_table_of_options_is_the_one_that_their_declarations_make():
    (printed,) = _PRINTED.findall(PAGE)
    assert printed == options_table(), "run python -m tests.docs.test_pages"
    ((_, *rows),) = tables("Options")[1:]
    signature = inspect.signature(sn.SnookerEnv).parameters
    of_one = {row[0].strip("`"): ast.literal_eval(row[1].strip("`")) for row in rows}
    assert of_one == {name: signature[name].default for name in ("options", "render_mode", "render_size")}


def test_noise_levels_have_the_numbers_that_are_printed():
    ((head, *rows),) = tables("Noise")
    levels = [ast.literal_eval(cell.strip("`")) for cell in head[2:]]
    scales = {"amateur": 2.0, "club": 4.0, "beginner": 8.0}
    assert {*levels, *scales, "none"} == set(LEVELS)
    assert all(LEVELS[name] == LEVELS["professional"].scale(times) for name, times in scales.items())
    assert [row[0].strip("`") for row in rows] == [field.name for field in dataclasses.fields(Noise)]
    for row in rows:
        numbers = [getattr(LEVELS[level], row[0].strip("`")) for level in levels]
        assert [float(cell) for cell in row[2:]] == numbers, row[0]


if __name__ == "__main__":
    path = ROOT / "docs/environment/specification.md"
    path.write_text(_PRINTED.sub(lambda _: options_table(), PAGE), encoding="utf-8")
