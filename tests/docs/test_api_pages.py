"""Do the API pages hold every public name? Each public module has a page that documents its ``__all__``."""

import importlib
import re

import pytest

import snooker_env as sn
from tests.docs.pages import DOCS

PUBLIC = ["snooker_env", *re.findall(r"^\* ``(snooker_env[.\w]*)``", str(sn.__doc__), re.MULTILINE)]
SOURCE = "\n".join(path.read_text(encoding="utf-8") for path in sorted((DOCS / "api").glob("*.md")))


@pytest.mark.parametrize("module", PUBLIC)
def test_every_public_name_is_documented(module):
    found = re.findall(rf"^\.\. public:: {re.escape(module)}\n((?:   :.*\n)*)", SOURCE, re.MULTILINE)
    assert found, f"no page has '.. public:: {module}'"
    chosen = [
        name for options in found for name in re.findall(r":only: (.*)", options) for name in name.split()
    ]
    everything = any(":only:" not in options for options in found)
    assert everything or set(chosen) == set(importlib.import_module(module).__all__)
    assert len(set(chosen)) == len(chosen) and ":but:" not in "".join(found)


def test_every_api_page_is_in_the_contents():
    contents = (DOCS / "api" / "index.md").read_text(encoding="utf-8")
    assert {path.stem for path in (DOCS / "api").glob("*.md")} - {"index"} <= set(contents.split())
