"""How long does the page of ``snooker_env.play`` take from a drag to the picture that shows where the balls
would stop?

    python -m benchmarks.play [--width 1600] [--height 900] [--inputs 60] [--seed 1] [--json FILE] [--out
    FOLDER]

A real server and a headless Chromium without a graphics card, on one machine. The aim is dragged by the
mouse, and speed and tip are changed by keys, one input every 25 ms; each question is 500 strokes with a
professional's errors. Measured in the browser, by its own clock: from the time stamp of the input event to
the end of the drawing of the picture with the clouds of exactly that stroke. An input that was overtaken by a
later one has no picture of its own; ``pictures`` says how many had one.
"""

import re
import subprocess
import sys
import time

import numpy as np

from commands import provenance

from ._common.command import Command, at_least, run, save_json
from .web.command import browser_of

EVERY = 25
"""Between two inputs [ms]."""


def until(page, code, seconds=300):
    """Wait until some JavaScript is true; the page's own policy allows it no code from a string."""
    end = time.monotonic() + seconds
    while not page.evaluate(f"Boolean({code})"):
        if time.monotonic() > end:
            raise RuntimeError(f"the page did not come to {code}")
        time.sleep(0.05)


def times(page, act, inputs):
    """From input to picture [ms], of so many calls of ``act(k)``."""
    page.evaluate("page.advisor.times.length = 0")
    for k in range(inputs):
        act(k)
        page.wait_for_timeout(EVERY)
    until(page, "!page.advisor.wait.busy")
    page.wait_for_timeout(200)
    found = np.array(page.evaluate("page.advisor.times"))
    return {
        "pictures": len(found),
        "median_ms": float(np.median(found)),
        "95_ms": float(np.quantile(found, 0.95)),
        "most_ms": float(found.max()),
    }


def measured(page, inputs):
    """Figures of the aim, the speed and the tip."""
    box = page.locator("#table").bounding_box()
    middle = (box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    page.mouse.move(*middle)
    page.mouse.down()
    figures = {
        "aim, dragged": times(page, lambda k: page.mouse.move(middle[0] + 4 * k, middle[1] + 2 * k), inputs)
    }
    page.mouse.up()
    page.locator("#table").focus()
    figures["speed, by key"] = times(
        page, lambda k: page.keyboard.press("ArrowUp" if k % 2 else "ArrowDown"), inputs
    )
    figures["tip, by key"] = times(page, lambda k: page.keyboard.press("w" if k % 4 < 2 else "s"), inputs)
    return figures


def main():
    """Command line."""
    parser = Command("play", __doc__, seed=1)
    parser.add_argument("--width", type=at_least(320), default=1600, help="of the page [1600 pixels]")
    parser.add_argument("--height", type=at_least(240), default=900, help="of the page [900 pixels]")
    parser.add_argument("--inputs", type=at_least(2), default=60, help="of each kind [60]")
    options = parser.options()
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        raise ImportError("benchmarks.play needs playwright:  pip install playwright") from None
    command = [
        sys.executable,
        "-m",
        "snooker_env.play",
        "--no-browser",
        "--layout",
        "opened",
        "--seed",
        str(options.seed),
    ]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        assert server.stdout is not None
        address = next(found[0] for line in server.stdout if (found := re.search(r"http://\S+/", line)))
        with sync_playwright() as playwright:
            browser = browser_of(playwright)
            page = browser.new_page(viewport={"width": options.width, "height": options.height})
            page.goto(address)
            until(page, "window.page?.aiming")
            page.locator("summary").click()
            page.get_by_label("Errors").first.select_option("professional")
            until(page, "page.advisor.found?.samples === 500")
            figures = {
                "machine": provenance.line(),
                "width": options.width,
                "height": options.height,
                **measured(page, options.inputs),
            }
            browser.close()
    finally:
        server.terminate()
        server.wait()
    print(
        f"From an input to the picture of where the balls would stop, 500 strokes each, {options.width} x {options.height} pixels:\n"
    )
    for name, row in figures.items():
        if isinstance(row, dict):
            spread = f"median {row['median_ms']:4.0f} ms   95 % {row['95_ms']:4.0f} ms   most {row['most_ms']:4.0f} ms"
            print(f"  {name:<14} {spread}   {row['pictures']} pictures of {options.inputs}")
    print(f"\n{figures['machine']}")
    save_json(options.json, figures)


if __name__ == "__main__":
    run(main)
