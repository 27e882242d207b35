"""Do the pages hold together? Links, anchors, pictures and films are there, films are small, and the words are the field's."""

import re

import pytest

from tests.docs.pages import DOCS, LINKED, NAMES, PAGES, ROOT, WORDS, anchors, links, paths, prose

LARGEST_FILM = 400_000
"""Bytes."""


@pytest.mark.parametrize("page", LINKED, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_lead_somewhere(page):
    text = page.read_text(encoding="utf-8")
    for link in links(text):
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        assert target.exists(), link
        if anchor and target.suffix == ".md":
            assert anchor in anchors(target.read_text(encoding="utf-8")), link


def test_the_reader_of_links_sees_every_kind():
    text = (
        '[a](b.md#c) ![d](e.png)\n<video\n src="f.mp4"></video>\n`[g](h)` [i](https://j)\n```{image} k.gif\n```\n```python\n[l](m)\n```\n'
        "[n]: o.md\n[`p` q]: r.md#s\n[t]: https://u\n[^v]: a note\n"
    )
    assert sorted(links(text)) == ["b.md#c", "e.png", "f.mp4", "k.gif", "o.md", "r.md#s"]
    assert anchors("# A `b.c` d, e\n(f-g)=\n") == {"a-bc-d-e", "f-g"}


def test_files_that_pages_name_exist():
    found = [(page.relative_to(ROOT).as_posix(), path) for page in PAGES for path in paths(page.read_text(encoding="utf-8"))]
    assert len(found) > 80
    assert not [(page, path) for page, path in found if not any(ROOT.glob(path))]
    assert paths("`tests/a.py`, `agents/b/*.json` `snooker_env/` `docs/NAME.md` tests/c.py `snooker_env.d`") == [
        "tests/a.py",
        "agents/b/*.json",
    ]


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_pictures_and_films_are_no_stubs(page):
    for link in links(page.read_text(encoding="utf-8")):
        if link.endswith((".png", ".jpg", ".gif", ".mp4")):
            assert (page.parent / link).stat().st_size > 10_000, link


def test_every_film_is_shown_and_small():
    films = sorted((DOCS / "_static" / "films").iterdir())
    shown = {(page.parent / link).resolve() for page in PAGES for link in links(page.read_text(encoding="utf-8"))}
    assert films and set(films) <= shown
    assert max(film.stat().st_size for film in films) <= LARGEST_FILM


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_pages_use_the_words_of_the_field(page):
    found = []
    for number, line in enumerate(prose(page.read_text(encoding="utf-8")).split("\n"), 1):
        found += [(number, word[0], instead) for banned, instead in WORDS.items() if (word := re.search(banned, line, re.IGNORECASE))]
    assert not found


@pytest.mark.parametrize("line", ["two looks ahead", "it was Taught", "in this world", "the code asks it", "chosen by hand", "it tells"])
def test_words_of_our_own_are_found(line):
    assert any(re.search(banned, line, re.IGNORECASE) for banned in WORDS)
    assert not any(re.search(banned, prose(f"`{line}`"), re.IGNORECASE) for banned in WORDS)


def test_every_page_has_one_title_and_short_lines():
    for page in PAGES[1:]:
        text = page.read_text(encoding="utf-8")
        assert len(re.findall(r"^# ", re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE), re.MULTILINE)) == 1, page
        wide = [line for line in text.split("\n") if len(line) > 120 and not line.startswith(("|", "!")) and "](" not in line]
        assert not wide, (page.relative_to(ROOT), wide)
