"""Do the pages for developers agree with the code? Layers, words, names, and commands that exist."""

import re

import pytest

import snooker_env
from tests.processes import ROOT
from tests.repository import test_layers, test_tree

PAGES = {path.stem: path.read_text(encoding="utf-8") for path in sorted((ROOT / "docs/develop").glob("*.md"))}


def rows(text):
    """The cells of a page's tables, without their heads."""
    found = [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines() if line.startswith("|")]
    lines = [k for k, row in enumerate(found) if set("".join(row)) <= set("-:")]  # between head and body
    return [row for k, row in enumerate(found) if k not in lines and k + 1 not in lines]


def test_architecture_names_every_layer():
    text = PAGES["architecture"]
    for part in test_layers.ALLOWED:
        if part not in ("__init__", "_registration", "_autoregister", "_warmup", "_shots", "checks", "kernels", "widget", "match"):
            assert re.search(rf"`{part}/?`", text), part
    for layer in test_tree.LAYERS:
        assert f"`{layer.replace('.', '/')}/" in text, layer


def test_architecture_names_files_that_exist():
    names = re.findall(r"`((?:\w+/)*\w+\.py)`", PAGES["architecture"])
    places = [ROOT, ROOT / "snooker_env", ROOT / "snooker_env/physics", ROOT / "tests/repository"]
    assert len(names) > 20
    assert not [name for name in names if not any((place / name).is_file() for place in places)]


@pytest.mark.parametrize("section", ["Snooker", "Reinforcement learning", "Physics", "This project's words"])
def test_the_glossary_is_in_order_and_says_what_each_word_means(section):
    (text,) = re.findall(rf"^## {section}\n(.*?)(?=^## |\Z)", PAGES["glossary"], re.MULTILINE | re.DOTALL)
    words = [word for word, _ in rows(text)]
    assert words == sorted(words, key=str.lower) and len(set(words)) == len(words) > 14
    for word, meaning in rows(text):
        assert meaning[0].isupper() or meaning[0] in "`e", word
        assert meaning.endswith("."), word


def test_the_glossary_has_the_names_of_options():
    text = PAGES["glossary"]
    for word in ("layout", "fidelity", "noise level", "task", "preset"):
        assert f"\n| {word} |" in text, word


def test_public_names_are_where_the_page_on_versions_says():
    assert 'python -c "import snooker_env; help(snooker_env)"' in PAGES["versions"]
    listed = re.findall(r"^\* ``(snooker_env\.[\w.]+)``", snooker_env.__doc__, re.MULTILINE)
    for name in re.findall(r"`(snooker_env\.\w+)`", PAGES["versions"]):
        assert name in listed, name


@pytest.mark.parametrize("page", [*PAGES, "CONTRIBUTING"])
def test_paths_and_links_on_a_page_exist(page):
    here = ROOT if page == "CONTRIBUTING" else ROOT / "docs/develop"
    text = PAGES.get(page) or (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    links = [link for link in re.findall(r"\]\(([^)#]+)\)", text) if "://" not in link]
    assert not [link for link in links if not (here / link).exists()]
    paths = re.findall(
        r"(?<![\w/])((?:tests|snooker_env|agents|benchmarks|docs|\.github)/[\w./-]*\w)",
        re.sub(r"```\{literal.*?```", "", text, flags=re.DOTALL),
    )
    added = ("walton", "greedy")
    assert not [path for path in paths if not (ROOT / path).exists() and not any(word in path for word in added)]
