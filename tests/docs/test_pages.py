"""Do the pages hold together?"""

import pytest

from tests.docs.pages import DOCS, LINKED, NAMES, PAGES, ROOT, anchors, links, paths

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


def test_files_that_pages_name_exist():
    found = [
        (page.relative_to(ROOT).as_posix(), path)
        for page in PAGES
        for path in paths(page.read_text(encoding="utf-8"))
    ]
    assert len(found) > 80
    assert not [(page, path) for page, path in found if not any(ROOT.glob(path))]
    assert paths(
        "`tests/a.py`, `agents/b/*.json` `snooker_env/` `docs/NAME.md` tests/c.py `snooker_env.d`"
    ) == ["tests/a.py", "agents/b/*.json"]


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_pictures_and_films_are_no_stubs(page):
    for link in links(page.read_text(encoding="utf-8")):
        if link.endswith((".png", ".jpg", ".gif", ".mp4")):
            assert (page.parent / link).stat().st_size > 10_000, link


def test_every_film_is_shown_and_small():
    films = sorted((DOCS / "_static" / "films").iterdir())
    shown = {
        (page.parent / link).resolve() for page in PAGES for link in links(page.read_text(encoding="utf-8"))
    }
    assert films and set(films) <= shown
    assert max(film.stat().st_size for film in films) <= LARGEST_FILM
