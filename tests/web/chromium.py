"""How do the tests get a browser? Debian's Chromium, headless, driven by playwright."""

import shutil
import time

import pytest

from snooker_env.replays.web import table_js

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


class Watched:
    """A page, code run in it, and what went wrong: it may ask for nothing but what begins as ``allowed``."""

    names = "const p = window.player"

    def __init__(self, browser, address, allowed, ready, **options):
        self.page, self.allowed = (
            browser.new_page(**{"viewport": {"width": 1280, "height": 720}, **options}),
            allowed,
        )
        self.errors, self.asked = [], []
        self.page.on("console", lambda message: self.errors.append(message.text))
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on("request", lambda request: self.asked.append(request.url))
        self.page.goto(address)
        self.until(ready)

    def __call__(self, code, argument=None):
        return self.page.evaluate(f"argument => {{ {self.names}; return {code}; }}", argument)

    def until(self, code, argument=None, seconds=120):  # what is not compiled yet takes a while
        """Wait for it from here: the page's policy allows no code from a string."""
        end = time.monotonic() + seconds
        while not self(f"Boolean({code})", argument):
            assert time.monotonic() < end, code
            time.sleep(0.02)

    def close(self):
        self.page.close()
        assert not self.errors
        assert not [url for url in self.asked if not url.startswith(self.allowed)]


def module_page(browser, **options):
    """An empty page in which ``window.table`` is what ``table.js`` exports."""
    page = browser.new_page(**options)
    script = f"{table_js()}\nwindow.table = {{decode, TableView}};"
    page.set_content(f"<!DOCTYPE html><body><script type=module>{script}</script>")
    page.wait_for_function("window.table")
    return page
