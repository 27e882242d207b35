"""The screenshots in the documentation: the page of ``snooker_env.play`` with advice, and the replay of a frame, each as a
browser shows it.
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
QUIET = (
    "--no-sandbox",
    "--disable-gpu",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
)


def shoot(page, file):
    """A screenshot in this file."""
    page.screenshot(path=file, type="jpeg", quality=82)
    print(file)


def page_to_play(browser, out):
    """The page to play: at a desk as it answers *Hint*, on a phone as a stroke is aimed."""
    command = [
        sys.executable,
        "-m",
        "snooker_env.play",
        "--no-browser",
        "--layout",
        "opened",
        "--seed",
        "6",
        "--person",
        str(Path(tempfile.mkdtemp()) / "person.json"),
    ]
    server = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
    try:
        address = next(found[0] for line in server.stdout if (found := re.search(r"http://\S+", line)))
        page = browser.new_page(viewport={"width": 1280, "height": 720})
        page.goto(address)
        page.locator("#tour-skip").click()
        page.locator("#options summary").click()
        page.locator("#noise-0").select_option("professional")
        page.locator("#options summary").click()
        page.get_by_role("button", name="Hint").click()
        page.locator("#advice button").first.wait_for(timeout=120_000)
        page.locator("#advice button").first.hover()
        time.sleep(1.5)
        shoot(page, out / "page.jpg")
        phone = browser.new_page(viewport={"width": 390, "height": 844}, has_touch=True)
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
        for name, width, height in (("replay.jpg", 1280, 720), ("replay_phone.jpg", 390, 844)):
            page = browser.new_page(viewport={"width": width, "height": height})
            page.goto(file.as_uri())
            page.keyboard.press("p")
            for _ in range(12):
                page.keyboard.press("Shift+ArrowRight")
            time.sleep(3.5)
            shoot(page, out / name)


def make(folder):
    """Take them all; needs Chromium."""
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=list(QUIET))
        page_to_play(chromium, folder)
        replay(chromium, folder)
