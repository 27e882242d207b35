"""Does the page help where a person decides, and hold up in odd moments? Names, lines, hints, set-up, small screens, drills."""

from math import atan2, hypot, pi

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.advice import POCKET_WORDS
from tests.play.shown import SETTLED, Shown
from tests.playing import EASY, STRAIGHT

CUT = {"cue": [0.0, 0.3], "reds": [[0.3, 1.0], [-0.6, 0.2], [0.5, -0.4]], "black": [0.0, 1.4605]}
PHONE = {"viewport": {"width": 390, "height": 844}, "has_touch": True}


@pytest.mark.parametrize(
    "stroke", [{"side": 0.4, "top": 0.0, "speed": 1.2}, {"side": 0.0, "top": 0.1, "speed": 2.4}]
)
def test_the_object_line_goes_where_the_ball_goes(shown, stroke):
    """Throw included: of a half-ball contact, which throws by degrees."""
    shown.set_up(CUT)
    aim = atan2(0.7, 0.3) + 0.55 * 0.0525 / hypot(0.3, 0.7)
    shown("page.aim.set(argument)", {**stroke, "aim": aim})
    shown.until("page.room.found?.first && !page.room.wait.busy")
    (x, y), (to_x, to_y) = shown("page.aim.overlay().lines[1].points")
    red = shown.line("api/destinations", {**stroke, "aim": aim, "samples": 1})[1]["paths"]["1"]
    path = np.array(red)[1:]  # without where it lay
    drawn = np.array([to_x - x, to_y - y]) / hypot(to_x - x, to_y - y)
    far = np.hypot(*(path - [x, y]).T) > hypot(to_x - x, to_y - y)
    near = path[: far.argmax()]  # until it is past the end of the line
    off = np.abs((near - [x, y]) @ [-drawn[1], drawn[0]])
    assert len(near) > 3 and off.max() < 0.002
    met = shown("(({ x, y }) => [x, y])(page.aim.overlay().met)")
    centres = atan2(y - met[1], x - met[0])
    assert abs(atan2(to_y - y, to_x - x) - centres) > 0.02  # else there was no throw to see


@pytest.mark.slow
def test_on_a_phone_a_hint_covers_nothing_of_the_table(chromium, line):
    shown = Shown(chromium, line, **PHONE)
    shown.set_up(CUT)
    before = shown.page.locator("#stage").bounding_box()
    assert shown.page.inner_text("#advise") == "Hint"
    shown.page.tap("#advise")
    shown.until("document.querySelectorAll('#advice button').length > 1")
    assert shown.page.locator("#stage").bounding_box() == before
    first = shown.page.locator("#advice li:first-child")
    assert first.bounding_box()["y"] >= before["y"] + before["height"]
    assert all(first.locator(part).is_visible() for part in ("b", "small")) and "win " in first.inner_text()
    edge = first.locator("b").bounding_box()
    assert edge["x"] + edge["width"] <= shown.page.locator("#advise").bounding_box()["x"]
    first.locator("button").tap()
    one = shown("page.advisor.list[0]")
    assert shown("page.aim.wish.aim") == one["aim"] and shown.page.is_visible("#play")
    shown.close()
    wide = Shown(chromium, line)
    wide.set_up(CUT)
    assert wide.page.inner_text("#advise") == "Hint"
    wide.close()


def test_a_pocket_has_one_name(shown):
    """On the lying table the words of the advice, beside the pocket itself; that of the chosen stroke stands out."""
    shown.set_up(CUT)
    shown.page.click("#advise")
    shown.until("document.querySelectorAll('#advice button').length")
    k = shown("page.advisor.list.findIndex(one => one.kind === 'pot')")
    pocket = POCKET_WORDS[sn.POCKETS.index(shown("page.advisor.list[argument].pocket", k))]
    assert f"Red to {pocket}" in shown.page.locator("#advice button").nth(k).inner_text()
    shown.page.locator("#advice button").nth(k).click()
    shown.until("document.querySelector('#pockets .meant')")
    assert shown.page.locator("#pockets .meant").all_inner_texts() == [pocket]
    assert shown("[...document.querySelectorAll('#pockets span')].map(one => one.innerText)") == list(
        POCKET_WORDS
    )


def test_set_up_snaps_undoes_and_mirrors(shown):
    shown.set_up({**CUT, "cue": [0.1, -1.2], "in_hand": True})
    shown.page.click("#set")
    place = "[page.setup.balls.x[argument], page.setup.balls.y[argument]]"
    R, edge = shown("page.view.R"), shown("page.scene.extent[0][1]")
    shown.drag(CUT["reds"][1], (-edge + R + 0.005, 0.5))  # nearly touching the cushion
    assert shown(place, 2) == pytest.approx([-edge + R, shown(place, 2)[1]], abs=1e-9)
    shown.drag(CUT["reds"][2], (0.3, 1.0 - 2 * R - 0.005))  # and another red
    assert hypot(*np.subtract(shown(place, 3), shown(place, 1))) == pytest.approx(2 * R, abs=1e-9)
    shown.page.click("#set-undo")
    assert shown(place, 3) == CUT["reds"][2]
    shown.drag(CUT["black"], (0.008, 0.9))  # onto the pink's spot
    assert shown(place, 21) == pytest.approx([0.0, 0.89225], abs=1e-4)
    assert shown.page.is_checked("#set-hand")
    shown.drag((0.1, -1.2), (0.1, -0.8))
    assert not shown.page.is_checked("#set-hand")
    shown.page.click("#set-mirror")
    assert shown(place, 1) == [-CUT["reds"][0][0], CUT["reds"][0][1]]
    shown.until("!document.getElementById('set-done').disabled")
    shown.page.click("#set-done")
    shown.until(f"!page.setup.open && page.state.positions.cue[0] < 0 && {SETTLED}")
    assert not shown("page.state.in_hand")


@pytest.mark.slow
def test_the_agent_that_was_named_stays_in_the_menu(chromium, line):
    seats = line.server.service.seats
    seats.opponents.insert(0, "planner")
    seats.players["planner"] = sn.player("planner")
    shown = Shown(chromium, line)
    shown.set_up(CUT)
    shown.page.click("#start summary")
    for name in ("Rosa", "planner", "Vera"):
        shown.page.select_option("#level", name)
        shown.until(f"page.state.players[1] === argument && page.strength && {SETTLED}", name)
        assert shown.page.input_value("#level") == name
    tables = shown("[...document.querySelectorAll('#layout option')].map(one => one.innerText)")
    assert not [words for words in tables if ":" in words or "_" in words]
    shown.close()


@pytest.mark.slow
def test_loupe_and_tutorial_keep_off_what_matters(chromium, line):
    """The loupe stays in its corner until something is there, and lies on neither cue ball, contact nor object line."""
    shown = Shown(chromium, line, **PHONE)
    shown.set_up(CUT)
    corners, turns = set(), 60
    for k in range(turns):
        shown("page.aim.set({aim: argument})", pi / 2 + (k - turns / 2) * 0.02)
        shown("page.draw(0)")
        if not shown.page.is_visible("#loupe"):
            continue
        corners.add(tuple(shown("page.corner")))
        box = shown.page.locator("#loupe").bounding_box()
        middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        met = shown("page.aim.overlay().met")
        for place in (CUT["cue"], (met["x"], met["y"]), met.get("to", CUT["cue"])):
            assert hypot(*np.subtract(shown.at(*place), middle)) > box["width"] / 2, k
    assert len(corners) <= 2
    shown.page.click("#fold")
    shown.page.click("#tour-open")
    for step in range(6):
        card, target = shown.page.locator("#tour").bounding_box(), shown.page.locator(".shown-now")
        boxes = [target.bounding_box()] if target.count() else []
        boxes += [{"x": px, "y": py, "width": 0, "height": 0} for px, py in [shown.at(*CUT["cue"])]]
        for box in boxes:
            apart = box["y"] >= card["y"] + card["height"] or box["y"] + box["height"] <= card["y"]
            assert apart, step
        shown.page.click("#tour-next")
    shown.close()


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


@pytest.mark.slow
def test_a_phone_shows_the_table_and_the_controls_of_the_stroke(chromium, line):
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


@pytest.mark.slow
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
    shown.page.click("#drills summary")
    shown.page.click("#drill-list button:has-text('Position of the day')")
    shown.until(f"page.drills.now && page.state.practice && {SETTLED} && page.aiming")
    assert shown("page.state.noise[0]") == "amateur"  # the day's own
    shown.page.click("#start summary")
    shown.page.select_option(
        "#level", "Rosa"
    )  # another opponent ends the drill; the person errs as before it
    shown.until("page.state.players[1] === 'Rosa'")
    assert not shown("page.state.practice") and shown("page.state.noise") == ["none", "amateur"]


def test_keys_turn_the_pages_of_the_tutorial_and_play_nothing(chromium, line):
    shown = Shown(chromium, line, new=True)
    shown.until(f"{SETTLED} && page.aiming")
    before = shown("page.state.revision")
    shown.page.keyboard.press("Enter")
    assert shown.page.inner_text("#tour-step") == "2 of 6"
    shown.page.keyboard.press("Escape")
    assert not shown.page.is_visible("#tour") and not shown("page.sending")
    assert shown("page.state.revision") == before
    shown.close()
