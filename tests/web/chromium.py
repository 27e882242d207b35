"""How do the tests get a browser? Debian's Chromium, headless, driven by playwright."""

import shutil

import pytest

from snooker_env.web import table_js

FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-sync"]
FLAGS += ["--disable-background-networking", "--disable-component-update"]


@pytest.fixture(scope="module")
def chromium():
    """A running browser."""
    found = shutil.which("chromium") or shutil.which("chromium-browser")
    if found is None:
        pytest.skip("no chromium here; on Debian: apt-get install chromium")
    sync_api = pytest.importorskip("playwright.sync_api", reason="no playwright here: pip install playwright")
    with sync_api.sync_playwright() as player:
        browser = player.chromium.launch(executable_path=found, args=FLAGS)
        yield browser
        browser.close()


def module_page(browser, **options):
    """An empty page in which ``window.table`` is what ``table.js`` exports."""
    page = browser.new_page(**options)
    script = f"{table_js()}\nwindow.table = {{decode, TableView, Player, mount}};"
    page.set_content(f"<!DOCTYPE html><body><script type=module>{script}</script>")
    page.wait_for_function("window.table")
    return page
