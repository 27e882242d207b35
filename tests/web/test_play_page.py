"""Does the page for playing hold up in odd moments? Small screens, the end of a frame, drills, links, a held cue."""

import time

import pytest

from tests.play.conftest import line  # noqa: F401
from tests.play.test_page import AWAY, SETTLED, Shown
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


def test_folded_controls_keep_the_stroke(shown):
    shown.set_up(EASY)
    shown.page.click("#fold")
    assert all(seen(shown, name) for name in CONTROLS) and not shown.page.is_visible("#undo")
    shown.page.click("#fold")
    shown.page.evaluate("document.getElementById('panel').scrollTop = 9999")
    assert seen(shown, "last") and seen(shown, "play")


def test_a_match_goes_on_after_a_look_at_the_table_and_is_not_lost_by_a_click(shown):
    shown.set_up(EASY)
    shown.line("api/new", {"layout": "break_off", "best_of": 3, "seed": 1})
    shown.until(f"page.state.best_of === 3 && {SETTLED} && page.aiming")
    shown.page.click("#start summary")
    for button in ("#new", "#concede"):  # though nothing has been played yet
        shown.page.click(button)
        assert shown.page.is_visible("#confirm")
        shown.page.keyboard.press("Escape")
        shown.until("!document.getElementById('confirm').open")
    for go_on in (lambda: shown.page.click("#go"), lambda: shown.page.keyboard.press("Enter")):
        shown.line("api/concede", {})
        shown.until(f"page.state.phase === 'over' && {SETTLED}")
        shown.page.click("#over-close")
        assert shown.page.inner_text("#go") == "Next frame"
        go_on()
        shown.until(f"page.state.phase !== 'over' && {SETTLED} && page.aiming")
    assert sum(shown("page.state.frames")) == 2
    shown.line("api/new", {"layout": "break_off", "best_of": 1})


def test_a_pull_is_cancelled_by_escape_and_ignores_other_fingers(shown):
    shown.set_up(EASY)
    shown("page.aim.set({aim: Math.PI / 2, speed: 2, side: 0, top: 0})")
    x, y = EASY["cue"]
    shown.page.mouse.move(*shown.at(x, y - 0.3))
    shown.page.mouse.down()
    shown.page.mouse.move(*shown.at(x, y - 0.5))
    pulled = shown("page.aim.wish.speed")
    other = "document.getElementById('table').dispatchEvent(new PointerEvent(argument, { pointerId: 99, clientX: 200, clientY: 200 }))"
    for kind in ("pointerdown", "pointermove", "pointerup"):
        shown(other, kind)
    assert shown("[page.aim.held, page.aim.wish.speed]") == ["cue", pulled] and pulled > 2
    shown.page.keyboard.press("Escape")
    shown.page.mouse.up()
    time.sleep(0.2)
    assert shown("[page.aim.wish.speed, page.state.strokes]") == [2, 0]


def test_a_link_is_opened_as_often_as_it_is_pasted_and_errors_are_seen(shown):
    shown.set_up(EASY, scores=[12, 30])
    shown.page.click("#files summary")
    shown.page.click("#share-game")
    shown.until("document.getElementById('link').value.startsWith('#game=')")
    link = shown.page.input_value("#link")
    for seed in (3, 4):
        shown.line("api/new", {"layout": "break_off", "seed": seed})
        shown.until(f"page.state.scores[1] === 0 && {SETTLED}")
        shown.page.fill("#link", link)
        shown.page.locator("#link").dispatch_event("paste")
        shown.until("page.state.scores[1] === 30")
    shown.page.fill("#link", "#nothing")
    shown.page.keyboard.press("Enter")
    shown.until("document.getElementById('last').className === 'trouble'")
    assert seen(shown, "last") and "no link" in shown.page.inner_text("#last")
    for name, text, said in (
        ("null.json", "null", "null.json is no saved game."),
        ("list.json", "[1]", "list.json is no saved game."),
        (
            "replay.html",
            "<!DOCTYPE html>",
            "replay.html is no saved game. A replay opens by itself in a browser.",
        ),
    ):
        shown.page.set_input_files(
            "#file", {"name": name, "mimeType": "application/json", "buffer": text.encode()}
        )
        shown.until("document.getElementById('last').textContent === argument", said)


LATE = """void (fetched => window.fetch = async (what, ...more) => {
  const answer = await fetched(what, ...more);
  if (String(what.url ?? what).includes("api/players")) await new Promise(done => setTimeout(done, 1000));
  return answer;
})(window.fetch)"""
"""The answer of ``api/players`` comes a second late, after the state that it leads to."""


def test_a_drill_outlives_a_reload_and_gives_the_seats_back(shown):
    shown.set_up(EASY)
    before = {"players": ["person", "ghost_ball"], "noise": ["none", "club"], "practice": False}
    shown.line("api/players", before)
    shown.until("page.state.noise[1] === 'club'")
    assert shown.page.inner_text("#side-1 .name") == "Beginner"
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
    assert shown.page.is_visible("#drill") and "2 of 10" in shown.page.inner_text("#drill-words")
    shown.page.click("#drill-end")
    shown.until("!page.state.practice")
    assert {name: shown("page.state")[name] for name in before} == before


def test_the_clock_of_a_first_visitor_is_a_number(chromium, line):  # noqa: F811
    """The tutorial is open before the first state has come."""
    shown = Shown(chromium, line, new=True)
    shown.until(f"{SETTLED} && page.aiming")
    assert shown.page.is_visible("#tour") and shown("Number.isFinite(page.stats.spent)")
    shown.close()


def test_the_shot_clock_stands_while_something_is_read(shown):
    shown.set_up(EASY)
    shown.page.click("#options summary")
    shown.page.select_option("#limit", "15 s")
    shown.page.keyboard.press("Escape")
    shown.page.click("#help-open")
    shown("page.stats.spent += 14")
    shown.until("document.getElementById('clock').className === 'late'")
    left = shown.page.inner_text("#clock")
    time.sleep(1.2)
    assert shown("page.state.strokes") == 0 and shown.page.inner_text("#clock") == left
    shown.page.click("#help-close")
    shown.played(1)


def test_the_shot_clock_is_not_wound_back_but_by_another_table(shown):
    shown.set_up(EASY)
    shown.page.click("#options summary")
    shown.page.select_option("#limit", "15 s")
    shown("page.stats.spent += 6")
    shown.page.click("#set")
    assert not shown.page.is_visible("#clock")
    shown.page.click("#set-cancel")
    assert int(shown.page.inner_text("#clock")) <= 9
    shown.page.click("#set")
    shown.drag(EASY["reds"][1], (-0.3, 0.4))
    shown.page.click("#set-done")
    shown.until(f"{SETTLED} && page.aiming")
    assert 12 <= int(shown.page.inner_text("#clock")) <= 15
    shown("page.stats.spent += 6")
    shown.page.click("#play")
    shown.until("page.moving")
    shown.page.click("#undo")
    shown.until(f"{SETTLED} && page.aiming")
    assert 12 <= int(shown.page.inner_text("#clock")) <= 15


def test_after_a_foul_the_choices_cover_no_words_and_the_next_aim_is_a_new_one(chromium, line):  # noqa: F811
    """The foul's own aim struck nothing. Folded, on a tablet."""
    shown = Shown(chromium, line, viewport={"width": 1180, "height": 820})
    shown.set_up(EASY)
    shown.page.click("#fold")
    shown("page.aim.set({aim: argument, speed: 0.5})", AWAY)
    assert shown("page.aim.words") == "cushion first"
    shown.page.click("#play")
    shown.played(1)
    shown.until("page.state.phase === 'choice'")
    assert all(seen(shown, name) for name in ("choices", "asked", "last", "advise"))
    shown.page.click("#choices button[data-choice=play]")
    shown.until(f"{SETTLED} && page.aiming")
    assert shown("page.aim.words").startswith("red")
    shown.close()


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


def test_after_a_slider_was_clicked_the_keys_are_for_the_stroke(shown):
    shown.set_up(EASY)
    shown.page.click("#speed")
    speed, aim = shown("[page.aim.wish.speed, page.aim.wish.aim]")
    shown.page.keyboard.press("ArrowLeft")
    assert shown("[page.aim.wish.speed, page.aim.wish.aim]") == pytest.approx(
        [speed, aim + 0.1 * 0.017453293]
    )


def test_what_a_stroke_brought_is_not_called_over_set_up(shown):
    shown.set_up(EASY)
    shown.line("api/stroke", {"speed": 2.0, "aim": STRAIGHT})
    shown.until("page.moving")
    shown.page.click("#set")
    shown.until("!page.busy")
    assert shown("page.state.scores[0]") == 1 and not shown.page.is_visible("#call")
    shown.page.click("#set-cancel")
