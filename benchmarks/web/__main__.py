"""How fluently does the browser play a replay? Pictures a second of a moving break-off, and what drawing one
costs.

    python -m benchmarks.web [--width 1920] [--height 1080] [--seconds 5] [--json FILE] [--out FOLDER]

A hard break-off, all balls in motion, in a headless Chromium without a graphics card. Pictures a second are
counted by the browser's own clock, that of ``requestAnimationFrame``, which runs at most 60 times a second
and waits for pictures that are late; "late" are those that came 25 ms or more after the one before. What a
picture costs is measured beside it, one after the other: all that the player does for a moment, and reading a
pixel of it back, which makes the browser finish the drawing. "as it opens": spots on the cue ball and ghosts;
"all": paths of all balls, spots and letters on all of them, too.
"""

import shutil
import tempfile
from pathlib import Path

import numpy as np

import snooker_env as sn
from commands import provenance
from commands.tables import text_table
from snooker_env.game import layout

from .._common.command import Command, at_least, run, save_json

FLAGS = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
SETTINGS = {"as it opens": {}, "all": {"paths": True, "spin": "all", "labels": True}}
BEGIN, END = 0.35, 6.0
"""The part of the stroke in which many balls move [s]."""
LATE = 25.0
"""A picture that comes so long after the last one was missed by the clock [ms]."""

RATE = """async ([setting, begin, end, seconds]) => {
  const player = window.player, stamps = [];
  player.pause();
  Object.assign(player.show, setting);
  player.seek(0, begin);
  player.play();
  const first = performance.now();
  await new Promise(done => {
    const tick = now => {
      stamps.push(now);
      if (player.time > end) player.seek(0, begin);
      if (now - first < 1000 * seconds) requestAnimationFrame(tick); else done();
    };
    requestAnimationFrame(tick);
  });
  player.pause();
  return stamps;
}"""
COST = """async ([setting, begin, end, count]) => {
  const player = window.player, pen = player.canvas.getContext("2d"), costs = [];
  Object.assign(player.show, setting);
  for (let k = 0; k < count; k++) {
    const before = performance.now();
    player.seek(0, begin + (end - begin) * k / count);
    pen.getImageData(0, 0, 1, 1);
    costs.push(performance.now() - before);
    if (k % 20 === 0) await new Promise(done => setTimeout(done));
  }
  return costs;
}"""


def break_off():
    """The replay of a break-off at 8 m/s into the middle of the reds."""
    physics = sn.Physics.preset("match")
    r, here = layout("break_off", np.random.default_rng(3))
    r[0] = 0.2, -1.2
    v, w = sn.strike(8.0, np.arctan2(2.085, -0.21), 0.0, 0.1, 0.0, physics)
    velocities, spins = np.zeros((22, 2)), np.zeros((22, 3))
    velocities[0], spins[0] = v[:2], w
    return sn.replay(sn.simulate(r, velocities, spins, "match", physics, on_table=here), title="A break-off")


def browser_of(playwright):
    """A headless Chromium, and which one; ImportError if there is none."""
    found = shutil.which("chromium") or shutil.which("chromium-browser")
    if found is None:
        raise ImportError("benchmarks.web needs chromium; on Debian: apt-get install chromium")
    return playwright.chromium.launch(executable_path=found, args=list(FLAGS))


def measured(page, setting, seconds):
    """Figures of the break-off with one setting of the player."""
    stamps = np.diff(page.evaluate(RATE, [setting, BEGIN, END, seconds]))
    costs = page.evaluate(COST, [setting, BEGIN, END, int(60 * seconds)])[5:]
    return {
        "frames_per_second": 1000.0 / float(stamps.mean()),
        "pictures": len(stamps),
        "late": int((stamps >= LATE).sum()),
        "draw_median_ms": float(np.median(costs)),
        "draw_95_ms": float(np.quantile(costs, 0.95)),
    }


def main():
    """Command line."""
    parser = Command("web", __doc__)
    parser.add_argument("--width", type=at_least(320), default=1920, help="of the page [1920 pixels]")
    parser.add_argument("--height", type=at_least(240), default=1080, help="of the page [1080 pixels]")
    parser.add_argument("--seconds", type=at_least(1), default=5, help="to measure for [5]")
    options = parser.options()
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        raise ImportError("benchmarks.web needs playwright:  pip install playwright") from None
    film = break_off()
    figures = {"machine": provenance.line(), "width": options.width, "height": options.height}
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        file = film.save(Path(folder) / "break_off.html")
        browser = browser_of(playwright)
        page = browser.new_page(viewport={"width": options.width, "height": options.height})
        page.goto(file.as_uri())
        page.evaluate("window.player.pause()")
        figures |= {
            "chromium": browser.version,
            "page_bytes": file.stat().st_size,
            "canvas": page.evaluate("[player.canvas.width, player.canvas.height]"),
        }
        figures["settings"] = {
            name: measured(page, setting, options.seconds) for name, setting in SETTINGS.items()
        }
        browser.close()
    print(figures["machine"])
    print(f"Chromium {figures['chromium']} without a graphics card")
    sizes = f"page {options.width} x {options.height}, table {' x '.join(map(str, figures['canvas']))} pixels"
    print(f"{sizes}; the file has {figures['page_bytes']} bytes\n")
    rows = [
        [
            name,
            f"{one['frames_per_second']:.1f}",
            f"{one['late']} of {one['pictures']}",
            f"{one['draw_median_ms']:.1f}",
            f"{one['draw_95_ms']:.1f}",
        ]
        for name, one in figures["settings"].items()
    ]
    print("\n".join(text_table(["", "pictures/s", "late", "one picture [ms]: median", "95 %"], rows)))
    save_json(options.json, figures)


if __name__ == "__main__":
    run(main)
