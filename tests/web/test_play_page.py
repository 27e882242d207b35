"""Does the page for playing hold up in odd moments? Small screens, the end of a frame, drills, links, a held cue."""

import pytest

from tests.play.conftest import line  # noqa: F401
from tests.play.shown import SETTLED, Shown
from tests.playing import EASY, STRAIGHT
from tests.web.chromium import chromium  # noqa: F401


@pytest.fixture
def shown(chromium, line):  # noqa: F811
    one = Shown(chromium, line)
    yield one
    one.close()


def seen(shown, name):
    """Is the whole element on the screen, with nothing over its middle?"""
    return shown(
        "(one => { const { left, right, top, bottom } = one.getBoundingClientRect();"
        " return left >= 0 && top >= 0 && right <= innerWidth && bottom <= innerHeight"
        " && one.contains(document.elementFromPoint((left + right) / 2, (top + bottom) / 2)); })"
        "(document.getElementById(argument))",
        name,
    )


CONTROLS = ("dial", "fine", "speed", "play", "advise")


def test_a_phone_shows_the_table_and_the_controls_of_the_stroke(chromium, line):  # noqa: F811
    """Upright, turned and turned back; in the tutorial, in set up, and while a stroke moves."""
    shown = Shown(chromium, line, viewport={"width": 390, "height": 844}, has_touch=True)
    shown.set_up(EASY)
    assert all(seen(shown, name) for name in CONTROLS)
    shown.page.click("#fold")
    assert not seen(shown, "table")
    shown.page.click("#tour-open")
    for _ in range(6):
        assert seen(shown, "tour-next") and seen(shown, "play")
        shown.page.click("#tour-next")
    shown.page.click("#fold")
    shown.page.click("#set")
    assert seen(shown, "table") and seen(shown, "set-done")
    shown.page.click("#set-cancel")
    shown.page.click("#fold")
    shown.page.set_viewport_size({"width": 844, "height": 390})
    shown.page.click("#fold")
    assert all(seen(shown, name) for name in ("table", *CONTROLS))
    shown.page.set_viewport_size({"width": 390, "height": 844})
    assert all(seen(shown, name) for name in ("table", *CONTROLS))
    shown.page.click("#fold")
    shown.line("api/stroke", {"speed": 2.0, "aim": STRAIGHT})
    shown.until("page.moving")
    assert seen(shown, "table")
    shown.played(1)
    shown.close()


LATE = """void (fetched => window.fetch = async (what, ...more) => {
  const answer = await fetched(what, ...more);
  if (String(what.url ?? what).includes("api/players")) await new Promise(done => setTimeout(done, 1000));
  return answer;
})(window.fetch)"""
"""The answer of ``api/players`` comes a second late, after the state that it leads to."""


def test_a_drill_outlives_a_reload_and_gives_the_seats_back(shown):
    shown.set_up(EASY)
    before = {"players": ["person", "ghost_ball"], "noise": ["none", "beginner"], "practice": False}
    shown.line("api/players", before)
    shown.until("page.state.noise[1] === 'beginner'")
    assert shown.page.inner_text("#side-1 .name") == "ghost ball"
    shown(LATE)  # the state is known before the answer: no stroke on the table before the drill
    shown.page.click("#drills summary")
    shown.page.click("#drill-list button:has-text('Long pots')")
    shown.until(f"page.drills.now && page.state.practice && {SETTLED} && page.aiming")
    assert -1.36 < shown("page.state.positions.cue[1]") < -1.09  # the drill's own table
    assert not shown.page.is_enabled("#undo") and not shown.page.is_enabled("#set")
    shown("page.aim.set({speed: 0.3})")
    shown("document.activeElement.blur()")  # Enter is for the table, not for a button that was clicked
    shown.page.keyboard.press("Enter")
    shown.until("page.moving || page.drills.tries === 1")
    shown("page.skip()")
    shown.until(f"page.drills.tries === 1 && {SETTLED} && page.aiming")
    assert not shown.page.is_enabled("#undo")  # or the try could be played again
    shown.page.reload()
    shown.until(f"page.state && {SETTLED}")
    assert shown.page.is_visible("#drill") and "0 of 1 potted" in shown.page.inner_text("#drill-words")
    shown.page.click("#drill-end")
    shown.until("!page.state.practice")
    assert {name: shown("page.state")[name] for name in before} == before


def test_keys_turn_the_pages_of_the_tutorial_and_play_nothing(chromium, line):  # noqa: F811
    shown = Shown(chromium, line, new=True)
    shown.until(f"{SETTLED} && page.aiming")
    before = shown("page.state.revision")
    shown.page.keyboard.press("Enter")
    assert shown.page.inner_text("#tour-step") == "2 of 6"
    shown.page.keyboard.press("Escape")
    assert not shown.page.is_visible("#tour") and not shown("page.sending")
    assert shown("page.state.revision") == before
    shown.close()
