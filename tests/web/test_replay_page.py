"""Does a replay's page play? Opened from disk in a real headless Chromium."""

import re

import numpy as np
import pytest

import snooker_env as sn
from tests.web.chromium import Watched, chromium  # noqa: F401
from tests.web.replay_data import page_of, visit

SIZES = [
    (320, 568),
    (360, 640),
    (390, 844),
    (640, 360),
    (844, 390),
    (800, 600),
    (1280, 720),
    (1920, 1080),
    (3840, 2160),
]
PLACES = "Array.from(p.shown.x, (x, k) => [x, p.shown.y[k]])"  # of all balls on screen [m]
OVERLAPS = """() => {
  const isText = one => [...one.childNodes].some(node => node.nodeType === 3 && node.data.trim());
  const words = [...document.querySelectorAll(".sn *")].filter(one => !one.closest("style, svg, [hidden]") && isText(one));
  const boxes = words.map(one => { // of the text, cut off where its element ends
    const range = document.createRange();
    range.selectNodeContents(one);
    const a = range.getBoundingClientRect(), b = one.getBoundingClientRect(), {max, min} = Math;
    const left = max(a.left, b.left), top = max(a.top, b.top), right = min(a.right, b.right), bottom = min(a.bottom, b.bottom);
    return {text: one.textContent, left, top, right, bottom};
  });
  const stage = document.querySelector(".sn-stage").getBoundingClientRect(), found = [];
  boxes.forEach((a, k) => {
    if (a.left < -0.5 || a.top < -0.5 || a.right > innerWidth + 0.5 || a.bottom > innerHeight + 0.5) found.push([a.text, "outside"]);
    if (a.top < stage.bottom - 0.5) found.push([a.text, "on the table"]);
    for (const b of boxes.slice(k + 1))
      if (a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1) found.push([a.text, b.text]);
  });
  return found;
}"""


@pytest.fixture(scope="module")
def shown(tmp_path_factory):
    """The data of a visit, its shots, the places after its second stroke, and its page."""
    data, shots, places = visit()
    file = tmp_path_factory.mktemp("replay") / "visit.html"
    file.write_text(page_of(data), encoding="utf-8")
    return data, shots, places, file


@pytest.fixture
def open_page(chromium, shown):  # noqa: F811
    """Opens the page, and at the end asserts that it said nothing and asked for nothing."""
    opened = []

    def watched(**options):
        options = {"reduced_motion": "reduce"} | options
        opened.append(Watched(chromium, shown[3].as_uri(), ("file:", "data:"), "p", **options))
        return opened[-1]

    yield watched
    for one in opened:
        one.close()
        assert [url for url in one.asked if url.startswith("file:")] == [shown[3].as_uri()]


def test_it_plays_by_itself_and_ends_where_the_simulation_ends(open_page, shown):
    _, shots, _, _ = shown
    p = open_page(reduced_motion="no-preference")
    assert p("p.playing")
    before = p("[p.k, p.t]")
    p.until("p.k > argument[0] || p.t > argument[1] + 0.3", before)
    p("(p.speed = 8, p.seek(2, p.strokes[2].duration - 2))")
    p.until("!p.playing")
    assert p("p.k") == 2 and p("p.t") == shots[2].duration
    assert np.array_equal(p(PLACES), shots[2].positions)
    assert np.array_equal(p("Array.from(p.strokes[2].at(p.strokes[2].duration).x)"), shots[2].positions[:, 0])
    p("p.play()")  # again from the start
    assert p("p.playing && p.k === 0 && p.t < 0.5")


def test_it_steps_by_event(open_page, shown):
    _, shots, _, _ = shown
    p = open_page()
    for time in (-0.9, -0.5, 0.0):  # the cue is seen before the strike and in it
        p("p.seek(0, argument)", time)
        assert p("p.frame().cue.alpha") == 1 and p("p.frame().cue.pull") >= 0
    events = shots[0].events
    stops = np.unique(np.round(events["time"][events["kind"] != sn.EventKind.BEND], 9))
    for expected in stops[stops > 0][:12]:
        p("p.step(1)")
        assert p("p.t") == expected
    assert np.allclose(p(PLACES), shots[0].at(stops[stops > 0][11])[0], rtol=0, atol=1e-9)
    words = p.page.locator(".sn-words").inner_text()
    assert re.fullmatch(r"After \d\.\d\d s (the (cue ball|red|[a-z]+) [a-z ]+)\.", words), words
    assert float(words.split()[1]) == pytest.approx(stops[stops > 0][11], abs=0.006)
    p("p.step(-1)")
    assert p("p.t") == stops[stops > 0][10]
    p("(p.seek(0, p.strokes[0].duration), p.step(1))")
    assert p("[p.k, p.t]") == [1, 0]
    p("(p.step(-1), p.step(-1))")
    assert p("p.k") == 0
    p("p.seek(1, p.strokes[1].duration)")
    assert p.page.locator(".sn-words").inner_text() == "The referee's words after stroke 2."


def test_keys(open_page, shown):
    _, shots, _, _ = shown
    p = open_page()

    def press(key):
        p.page.keyboard.press(key)

    press("Space")
    assert p("p.playing")
    press("Space")
    assert not p("p.playing")
    press("Home")
    assert p("[p.k, p.t]") == pytest.approx([0, p("-p.leads[0]")])
    press("ArrowRight")
    press("ArrowRight")
    assert p("p.t") > 0
    press("ArrowLeft")
    assert p("p.t") == 0
    press("Shift+ArrowRight")
    assert p("p.k") == 1
    press("Shift+ArrowLeft")
    assert p("p.k") == 0
    press("End")
    assert p("[p.k, p.t]") == [2, shots[2].duration]
    for key, speeds in (("ArrowUp", (2, 4, 8, 8)), ("ArrowDown", (4, 2, 1, 0.5, 0.25, 0.1, 0.1))):
        for expected in speeds:
            press(key)
            assert p("p.speed") == expected
    assert p.page.locator(".sn output").inner_text() == "0.1×"
    for key, name, states in (("p", "paths", 2), ("g", "ghosts", 2), ("l", "labels", 2), ("s", "spin", 3)):
        first, seen = p(f"p.show.{name}"), []
        for _ in range(states):
            press(key)
            seen.append(p(f"p.show.{name}"))
        assert seen[-1] == first and len({str(one) for one in seen}) == states
    for key, visible in (("?", True), ("?", False), ("?", True), ("Escape", False), ("Escape", False)):
        press(key)
        assert p.page.locator(".sn-help").is_visible() is visible
    before = p("[p.k, p.t]")
    press("Control+p")
    press("x")
    assert p("[p.k, p.t]") == before


def test_buttons_and_the_table(open_page):
    p = open_page()
    p("p.seek(0, 0)")
    strokes = ("next stroke", "p.k === 1"), ("previous stroke", "p.k === 0")
    for label, after in (("next event", "p.t > 0"), *strokes):
        p.page.get_by_label(label, exact=True).click()
        assert p(after), label
    p.page.get_by_label("faster").click()
    p.page.get_by_label("slower").click()
    assert p("p.speed") == 1
    p.page.get_by_label("play or pause").or_(p.page.get_by_label("play", exact=True)).click()
    assert p("p.playing")
    p.page.locator(".sn-stage canvas").click()
    assert not p("p.playing")
    for name in ("paths", "labels"):
        button = p.page.locator(".sn-keys button", has_text=name)
        before = button.get_attribute("aria-pressed")
        p("p.seek(0, 3)")
        image = p("p.canvas.toDataURL()")
        button.click()
        assert button.get_attribute("aria-pressed") != before and p("p.canvas.toDataURL()") != image
    for button in p.page.locator(".sn-keys button").all():
        assert button.get_attribute("aria-label")
        box = button.bounding_box()
        assert box["width"] >= 40 and box["height"] >= 40
    p.page.keyboard.press("Tab")
    assert p.page.evaluate("getComputedStyle(document.activeElement).outlineStyle") == "solid"


def test_the_score_bar_says_what_the_referee_says(open_page, shown):
    data = shown[0]
    p = open_page()

    for place, scores, balls in (("0, 1", "00", 0), ("1, 0", "10", 1), ("1, p.strokes[1].duration", "80", 2)):
        p(f"p.seek({place})")
        assert [p.page.locator(".sn-who b").nth(k).inner_text() for k in (0, 1)] == [*scores]
        now = " ".join(p.page.locator(".sn-now").inner_text().split())
        assert f"break {scores[0]}" in now and ("on red" in now or balls)
        assert p.page.locator(".sn-now span").first.locator("i").count() == balls
    assert p.page.locator(".sn-words").inner_text() == data["strokes"][1]["words"]
    p("p.seek(2, 0)")
    assert "break 0" in " ".join(p.page.locator(".sn-now").inner_text().split())
    assert "sn-turn" in p.page.locator(".sn-who").nth(1).get_attribute("class")
    # words are words, not HTML
    assert p.page.locator(".sn-who span").first.inner_text() == "Ada <b>Lovelace</b>"
    assert "3.00 m/s" in p.page.locator(".sn-about").inner_text()


@pytest.mark.slow
def test_nothing_overlaps_or_overflows_at_any_size(open_page):
    p = open_page()
    for width, height in SIZES:
        p.page.set_viewport_size({"width": width, "height": height})
        p.until("p.canvas.width === argument", width)
        for moment in ("p.seek(1, 0.5)", "p.seek(1, p.strokes[1].duration)", "(p.seek(0, 0), p.step(1))"):
            p(moment)
            root = "document.documentElement"
            inside = p(f"{root}.scrollWidth <= innerWidth && {root}.scrollHeight <= innerHeight")
            assert inside and p.page.evaluate(OVERLAPS) == [], (width, height, moment)
        ends = p("p.replay.scene.extent[1].map(y => p.view.toScreen(0, y))")
        wide, high = abs(ends[1][0] - ends[0][0]), p("innerHeight")
        if p("p.view.upright"):  # a phone's: the table stands, and is longer than the screen is wide
            assert height > width and ends[0][1] - ends[1][1] > 1.1 * width
            continue
        assert height < 2 * width
        # the table fills the width, or what the bars leave of the height
        assert wide > 0.85 * width or wide > min(1.3, high / 400) * high, (width, height, wide)
