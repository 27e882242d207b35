"""Does each measured figure of a page say where it comes from? And each file of results what made it?

A measured figure is one with its interval or error: ``27.0 [25.7, 28.2]``, ``5.15 ± 0.33``. A file of results/ gives it, or
its section names a command or a commit.
"""

import json
import re
from itertools import pairwise

import pytest

from tests.docs.pages import PAGES, ROOT

NUMBER = r"[-+−]?\d[\d,]*(?:\.\d+)?"
FIGURE = re.compile(
    rf"({NUMBER}) *%? *(?:\[({NUMBER}) *%?, *({NUMBER}) *%?\]|(?:±|\+-) *({NUMBER}))",
)
SOURCE = re.compile(
    r"python3? -m \w|\bpython [\w/.]+\.py|results/make\.sh|\bpytest\b|`(?:agents|benchmarks|tests|snooker_env)\.\w"
    r"|\bcommit [0-9a-f]{7,40}\b"
)


def results():
    """Numbers that stand together in an object of a JSON file of results/, and the lines of its Markdown."""
    found, lines = [], []

    def collect(node):
        if isinstance(node, dict):
            numbers = [
                one for one in node.values() if isinstance(one, int | float) and not isinstance(one, bool)
            ]
            if len(numbers) > 1:
                found.append(numbers)
        for one in node.values() if isinstance(node, dict) else node if isinstance(node, list) else ():
            collect(one)

    for file in sorted((ROOT / "results").glob("*/*.json")):
        collect(json.loads(file.read_text(encoding="utf-8")))
    for file in sorted((ROOT / "results").glob("*/*.md")):
        lines += file.read_text(encoding="utf-8").splitlines()
    return found, "\n".join(lines)


NUMBERS, LINES = results()


def is_kept(figure):
    """Whether results/ give a figure as it is printed: its numbers, or these in percent; an error also as a half-width of
    95 %."""
    if figure[0] in LINES:
        return True
    value, *ends, error = figure.groups()
    if len(re.findall(r"\d", value.lstrip("0.-+−"))) < 3 and not (any(ends) and "." in value):
        return False  # so short a number is found somewhere by chance

    def near(printed, numbers, *times):
        text = printed.replace(",", "").replace("−", "-")
        least = 0.5001 * 10.0 ** -len(text.partition(".")[2])
        return any(abs(number * by - float(text)) <= least for number in numbers for by in times)

    return any(
        near(value, numbers, by)
        and all(near(end, numbers, by) for end in ends if end)
        and (error is None or near(error, numbers, by, 1.96 * by))
        for numbers in NUMBERS
        for by in (1.0, 100.0)
    )


def sections(text):
    """(heading, text) of each part of a page, from one heading to the next; code blocks belong to their part."""
    code = [found.span() for found in re.finditer(r"^(`{3,}).*?^\1", text, re.DOTALL | re.MULTILINE)]
    heads = [
        found
        for found in re.finditer(r"^#+ +(.*)$", text, re.MULTILINE)
        if not any(a <= found.start() < b for a, b in code)
    ]
    places = [0, *(found.start() for found in heads), len(text)]
    names = ["", *(found[1] for found in heads)]
    return [(name, text[a:b]) for name, (a, b) in zip(names, pairwise(places), strict=True)]


def unsourced(text):
    """heading: figure, for each figure of a page that neither a file nor a command nor a commit gives."""
    wrong = []
    for name, part in sections(text):
        if not SOURCE.search(part):
            prose = re.sub(r"^(`{3,}).*?^\1", "", part, flags=re.DOTALL | re.MULTILINE)
            prose = re.sub(r"`[^`\n]*`", "", prose)
            figures = [found for found in FIGURE.finditer(prose) if not is_kept(found)]
            wrong += [f"{name}: {found[0]}" for found in figures]
    return wrong


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_measured_figures_have_a_source(page):
    assert unsourced(page.read_text(encoding="utf-8")) == []


KEPT = "27.0 [25.7, 28.2]"
"""A figure of results/agents/visits.json."""


@pytest.mark.parametrize(
    ("page", "wrong"),
    [
        ("# A\n\nIt makes 61.3 [60.2, 64.1] points.\n", ["A: 61.3 [60.2, 64.1]"]),
        ("# A\n\n61.31 ± 0.17 %\n\n## B\n\n`python -m agents.evaluate`\n", ["A: 61.31 ± 0.17"]),
        ("# A\n\n`python -m agents.evaluate`: 61.31 ± 0.17 %\n", []),
        ("# A\n\n61.3 [60.2, 64.1], at commit 934232a0\n", []),
        ("# A\n\n```bash\n# no heading\npython train.py\n```\n\n61.3 [60.2, 64.1]\n", []),
        (f"# A\n\n{KEPT}\n", []),
        ("# A\n\n61 ± 1 points, 12 [10, 14]\n", ["A: 61 ± 1", "A: 12 [10, 14]"]),
        ("# A\n\n27.0 [25.7, 28.3]\n", ["A: 27.0 [25.7, 28.3]"]),
        ("# A\n\nshape (3, 4), `x[0, 1]`, Box(-1, 1), [0, 1]\n", []),
    ],
)
def test_a_figure_without_a_source_is_found(page, wrong):
    assert unsourced(page) == wrong


MADE = {"command": str, "commit": str, "machine": str | dict}
FILES = sorted((ROOT / "results").glob("*/*.json"))


def missing(content):
    """What a file of results/ does not say of itself."""
    found = []
    for made in content.get("made") or [content]:
        found += [
            name for name, kind in MADE.items() if not made.get(name) or not isinstance(made[name], kind)
        ]
        if not re.fullmatch("[0-9a-f]{40}", str(made.get("commit"))):
            found.append("a commit without changes")
    # curves have the seed of each point, tournaments that of their first match; a task of the benchmark fixes its seeds
    seeds = [content, content.get("protocol", {}), *content.get("points", [])[:1]]
    return found + ([] if any({"seed", "first_seed", "task"} & one.keys() for one in seeds) else ["seed"])


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.relative_to(ROOT).as_posix())
def test_a_file_of_results_says_what_made_it(file):
    assert missing(json.loads(file.read_text(encoding="utf-8"))) == []
