"""The screenshots in the documentation: the page of ``snooker_env.play`` with advice, and the replay of a frame, each as a
browser shows it. Needs Chromium.
"""

import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from playwright.sync_api import sync_playwright

ROOT = Path(__file__).resolve().parents[1]
QUIET = "--no-sandbox --disable-gpu --no-first-run --disable-background-networking --disable-component-update"
DESK, PHONE = {"width": 1280, "height": 880}, {"width": 390, "height": 844}


def shoot(page, file):
    """A screenshot in this file."""
    page.screenshot(path=file, type="jpeg", quality=82)
    print(file, flush=True)


def play(browser, out):
    """The page to play: at a desk with the best suggestion taken over, on a phone as a stroke is aimed."""
    person = Path(tempfile.mkdtemp()) / "person.json"
    options = ["--no-browser", "--layout", "opened", "--seed", "6", "--person"]
    command = [sys.executable, "-m", "snooker_env.play", *options, str(person)]
    server = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
    try:
        address = next(found[0] for line in server.stdout if (found := re.search(r"http://\S+", line)))
        page = browser.new_page(viewport=DESK)
        page.goto(address)
        page.locator("#tour-skip").click()
        page.locator("#options summary").click()
        page.locator("#noise-0").select_option(
            "professional"
        )  # those of the chance to win, so that both agree
        page.locator("#guide").select_option("spread")
        page.locator("#options summary").click()
        page.get_by_role("button", name="Hint").click()
        best = page.locator("#advice button").first
        best.wait_for(timeout=300_000)
        best.click()
        page.mouse.move(300, 850)
        page.locator("#panel").evaluate("panel => panel.scrollTo(0, 0)")
        page.locator("#odds", has_text="potted").wait_for(timeout=60_000)
        time.sleep(1.5)
        shoot(page, out / "page.jpg")
        phone = browser.new_page(viewport=PHONE, has_touch=True)
        phone.goto(address)
        phone.locator("#tour-skip").click()
        time.sleep(1.5)
        shoot(phone, out / "page_phone.jpg")
    finally:
        server.terminate()


def replay(browser, out):
    """The replay of a frame, paths on, at a desk and on a phone."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "frame.html"
        command = [sys.executable, "-m", "snooker_env.watch", "--frame", "--seed", "3", "--out", str(file)]
        subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
        for name, size in (("replay.jpg", {"width": 1280, "height": 720}), ("replay_phone.jpg", PHONE)):
            page = browser.new_page(viewport=size)
            page.goto(file.as_uri())
            page.keyboard.press("p")
            for _ in range(12):
                page.keyboard.press("Shift+ArrowRight")
            time.sleep(3.5)
            shoot(page, out / name)


def make(folder):
    """Take them all."""
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=QUIET.split())
        play(chromium, folder)
        replay(chromium, folder)
