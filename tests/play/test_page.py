"""Does the page play? In a real headless Chromium, by mouse, keys and touch."""

import json
import re
import time
from math import pi
from pathlib import Path

import pytest

from snooker_env.play.server import FILES
from tests.play.shown import PERSONS, SETTLED, Shown
from tests.playing import COVERED, EASY, FROZEN, STRAIGHT, served

AWAY = 2.0
"""An aim [rad] along which EASY has no ball."""
VISIT = {**EASY, "reds": [[0.6, 1.4], [-0.6, 1.35], [0.7, 0.9]], "blue": [0.0, 0.0]}
"""Here ghost_ball makes a visit of two reds with the black."""


def test_a_visit_is_played_by_mouse(shown):
    """Aim by dragging, speed by the slider, strike by the button."""
    shown.set_up(EASY)
    shown.drag((0.4, 1.0), (0.6, 1.4))
    assert shown("page.aim.wish.aim") == pytest.approx(STRAIGHT, abs=0.01)
    shown.page.locator("#speed").fill("2")
    assert shown.page.inner_text("#speed-out") == "medium, 2.00 m/s"
    shown.page.click("#play")
    shown.until("page.moving")
    assert shown.page.is_visible("#skip") and not shown.page.is_enabled("#play")
    assert shown.words == "Player 1 is at the table; red is on"
    moved = shown("[page.moving.stroke.at(0.3).x[0], page.moving.stroke.first[0]]")
    assert abs(moved[0] - moved[1]) > 0.05
    shown.page.click("#skip")
    shown.played(1)
    assert shown.words == "Player 1's stroke: any colour is on."
    assert "Red potted, 1" in shown.page.inner_text("#last")
    assert shown.page.inner_text("#side-0 b") == "1" and shown("page.balls.on[1]") == 0
    assert shown.page.is_enabled("#nominate")
    open_to = shown("[...document.querySelectorAll('#nominate option')].map(one => one.value)")
    assert open_to == ["", "pink", "black"]
    shown.page.select_option("#nominate", "pink")
    shown(
        "page.aim.set({aim: Math.atan2(argument[1] - page.balls.y[0], argument[0] - page.balls.x[0]), speed: 1})",
        EASY["pink"],
    )
    shown.page.keyboard.press("Enter")
    shown.played(2)
    state = shown("page.state")
    assert "(pink nominated)" in state["last"] and state["scores"] == [1, 0] and state["striker"] == 1
    assert shown.words == "Player 2's stroke: red is on." and not shown.page.is_enabled("#nominate")
    places = shown(
        "Object.entries(page.state.positions).map(([name, [x, y]]) => {"
        " const i = page.names.indexOf(name); return [page.balls.x[i] - x, page.balls.y[i] - y]; })"
    )
    assert max(abs(value) for place in places for value in place) == 0.0


def test_keys_and_dial_change_the_stroke(shown):
    shown.set_up(EASY)
    shown("page.aim.set({aim: 1, speed: 2, side: 0, top: 0, elevation: 0})")
    for key in ("ArrowLeft", "Shift+ArrowLeft", "ArrowUp", "Shift+ArrowUp", "w", "w", "d", "e"):
        shown.page.keyboard.press(key)
    wish = shown("page.aim.wish")
    assert wish["aim"] == pytest.approx(1 + 1.1 * 0.017453293, abs=1e-6)
    assert wish["speed"] == pytest.approx(2.6)
    assert (wish["side"], wish["top"]) == pytest.approx((0.05, 0.1))
    assert wish["elevation"] == pytest.approx(0.017453293)
    box = shown.page.locator("#dial").bounding_box()
    shown.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    shown.page.mouse.down()
    shown.page.mouse.move(box["x"] - 200, box["y"] + box["height"] / 2, steps=3)
    shown.page.mouse.up()
    assert shown("[page.aim.wish.side, page.aim.wish.top]") == pytest.approx([-0.5, 0.0], abs=1e-9)
    assert shown.page.inner_text("#tip-words") == "left side"
    shown.page.keyboard.press("c")
    assert shown("[page.aim.wish.side, page.aim.wish.top]") == [0, 0]
    shown.page.mouse.move(*shown.at(0.0, 0.0))
    before = shown("page.aim.wish.aim")
    shown.page.mouse.wheel(0, -100)
    assert shown("page.aim.wish.aim") - before == pytest.approx(0.05 * 0.017453293, abs=1e-9)


def test_after_a_foul_the_choices_are_shown(shown):
    shown.set_up(COVERED)
    shown("page.aim.set({aim: 1.5708, speed: 1})")
    shown.page.click("#play")
    shown.played(1)
    assert shown.words == "Foul and a miss by Player 1: Player 2 chooses."
    open_to = shown("[...document.querySelectorAll('#choices button')].map(b => b.dataset.choice)")
    assert open_to == ["play", "play_again", "replace"]
    assert shown.page.is_visible("#choices") and not shown.page.is_visible("#play")
    wins = shown("page.state.choice_wins")
    buttons = (
        "[...document.querySelectorAll('#choices button')].map(b => [b.lastChild.innerText, b.className])"
    )
    best = ["best" if win == max(wins) else "" for win in wins]
    assert shown(buttons) == [[f"win {100 * win:.0f} %", kind] for win, kind in zip(wins, best, strict=True)]
    assert len(set(wins)) == 3
    twice = "[1, 2].forEach(() => document.querySelector(argument).click())"
    shown(twice, "#choices button[data-choice=replace]")  # the second tap is none
    shown.until("page.state.phase === 'stroke' && page.settled === page.state.revision && !page.sending")
    assert shown.page.get_attribute("#last", "class") != "trouble"
    assert not shown.page.is_visible("#choices")
    assert shown("[page.balls.x[0], page.balls.y[0]]") == COVERED["cue"]
    assert shown("page.state.striker") == 0
    shown.page.click("#undo")
    shown.until("page.state.phase === 'choice'")
    assert shown.page.is_visible("#choices")
    shown.page.click("#redo")
    shown.until("page.state.phase === 'stroke'")


def test_a_ball_is_dragged_in_set_up_and_a_wrong_place_is_reported_beside_it(shown):
    shown.set_up(EASY)
    shown.page.click("#files summary")
    shown.page.click("#set")
    shown.drag(EASY["reds"][1], (0.02, 0.90), steps=4)  # onto the pink
    shown.until("!document.getElementById('bubble').hidden")
    assert shown.page.inner_text("#bubble") == "The pink overlaps the red."
    assert not shown.page.is_enabled("#set-done")
    assert shown.page.inner_text("#set-wrong") == ""  # it is reported once
    shown.drag((0.02, 0.90), (-0.3, 0.4))
    shown.until("document.getElementById('bubble').hidden && !document.getElementById('set-done').disabled")
    shown.page.select_option("#set-striker", "1")
    shown.page.locator("#set-score-0").fill("33")
    shown.drag(EASY["black"], (1.3, 1.0))  # off the table
    assert shown.page.locator("#tray button[aria-label=black]").count() == 1
    shown.page.locator("#tray button[aria-label=blue]").click()
    shown.page.mouse.click(*shown.at(0.3, -0.3))
    shown.until("!document.getElementById('set-done').disabled && page.setup.balls.on[19]")
    shown.page.click("#set-done")
    shown.until("page.state.striker === 1 && !page.setup.open && page.settled === page.state.revision")
    state = shown("page.state")
    places = state["positions"]
    assert state["scores"] == [33, 0] and "black" not in places
    assert places["blue"] == pytest.approx([0.3, -0.3], abs=0.003)
    assert places["red 2"] == pytest.approx([-0.3, 0.4], abs=0.003) and places["red 1"] == EASY["reds"][0]


def test_a_cue_ball_in_hand_is_dragged_within_the_d(shown):
    shown.set_up({"reds": [[0.6, 1.4]], "black": [0.0, 1.4605], "in_hand": True})
    cue = shown("[page.balls.x[0], page.balls.y[0]]")
    shown.drag(cue, (0.1, -1.2))
    shown.until("Math.hypot(page.state.positions.cue[0] - 0.1, page.state.positions.cue[1] + 1.2) < 0.004")
    shown.drag(shown("[page.balls.x[0], page.balls.y[0]]"), (0.0, 0.5))
    shown.until("Math.abs(page.state.positions.cue[1] + 1.0475) < 1e-6")
    shown("page.aim.set({aim: -1.5708, speed: 0.5})")
    shown.page.keyboard.press("Enter")
    shown.played(1)
    assert not shown("page.state.in_hand")


def test_advice_is_shown_drawn_and_taken(shown):
    shown.set_up(EASY)
    shown.line("api/players", {"noise": ["professional", "none"]})
    shown.until("page.state.noise[0] === 'professional' && page.settled === page.state.revision")
    shown.page.click("#advise")
    shown.until("document.querySelectorAll('#advice button').length")
    assert "win " in shown.page.inner_text("#advice li:first-child b")
    shown.page.hover("#advice li:first-child button")
    shown.until("page.advisor.hover && page.advisor.found")
    heat = shown(
        "page.advisor.overlay().heat.map(one => [one.nx * one.ny, one.values.length, one.values.reduce((a, b) => a + b, 0)])"
    )
    assert len(heat) == 2 and heat[0][0] == heat[0][1] and heat[1][2] == pytest.approx(500, rel=0.02)
    best = shown("page.advisor.hover")
    shown.page.click("#advice li:first-child button")
    assert shown("page.aim.wish.aim") == best["aim"]
    shown.page.keyboard.press("Enter")
    shown.played(1)
    potted = shown.line("api/strokes")[1]["strokes"][-1]["pots"]
    assert [name for name, _ in best["pots"]] == [f"red {ball}" for ball in potted]
    assert shown("document.querySelectorAll('#advice button').length") == 0  # it was about another table


WATCHED = """(window.drawn = [], page.view.draw = (draw => frame => {
    const text = id => document.getElementById(id).innerText.replace(/\\s+/g, " ");
    window.drawn.push({ k: page.played, moving: Boolean(page.moving), on: [...frame.on].flatMap((on, ball) => (on ? [ball] : [])),
        now: text("now"), asked: text("asked"), last: text("last"),
        score: [0, 1].map(k => Number(document.querySelector(`#side-${k} b`).innerText)) });
    return draw.call(page.view, frame);
})(page.view.draw.bind(page.view)), 0)"""
"""Whatever is drawn from now on, with the words beside it at that time."""


def left_after(balls, on):
    """Points left on a table with these balls, and this on."""
    return sum(8 if ball < 16 else ball - 14 for ball in balls if ball) + 7 * (on == "any colour")


@pytest.mark.slow
def test_an_agents_visit_is_shown_stroke_by_stroke(shown):
    """Between two strokes the table is the one left by the first, with its score, break and reds."""
    shown.set_up(VISIT)
    shown.line("api/players", {"players": ["person", "ghost_ball"], "noise": ["none", "none"]})
    shown.line("api/position", {"position": VISIT, "striker": 1})
    shown.until("page.state.striker === 1 && page.settled === page.state.revision")
    shown(WATCHED)
    shown.page.click("#go")
    shown.until("page.state.strokes >= 3 && page.state.striker === 0")
    while shown("page.behind"):
        if shown("page.moving && page.moving.now"):
            shown.page.keyboard.press(" ")
        time.sleep(0.02)
    shown.until("!page.behind && page.settled === page.state.revision")
    strokes, drawn = shown.line("api/strokes")[1]["strokes"], shown("window.drawn")
    balls, break_, scores = {0, 1, 2, 3, 19, 20, 21}, 0, [0, 0]

    def now(on):
        return (
            f"break {break_} on {on} reds {len(balls & {1, 2, 3})} left {left_after(balls, on)} no mistakes"
        )

    for k, stroke in enumerate(strokes):
        before = [one for one in drawn if one["k"] == k + 1 and one["moving"]]
        assert before, f"stroke {k} was not shown"
        for one in before:
            assert one["now"] == now(stroke["ball_on"]) and one["score"] == scores
            assert one["asked"] == f"ghost ball is at the table; {stroke['ball_on']} is on"
        balls -= {ball for ball in stroke["pots"] if 1 <= ball <= 15}
        break_, scores = stroke["break"], stroke["score"]
        if k + 1 == len(strokes):
            break
        on, after = strokes[k + 1]["ball_on"], [d for d in drawn if d["k"] == k + 1 and not d["moving"]]
        assert after, f"the table after stroke {k} was not shown"
        for one in after:
            assert set(one["on"]) == balls and one["now"] == now(on), f"after stroke {k}"
            assert one["score"] == scores and stroke["words"] in one["last"]
            assert one["asked"] == f"ghost ball's stroke: {on} is on."
    shown.page.keyboard.press("v")  # the last stroke again: from the table before it
    shown.until("page.moving && page.moving.now")
    left = f"left {left_after(balls, strokes[-1]['ball_on'])}"
    assert left in shown.page.inner_text("#now").replace("\n", " ")
    shown("page.skip()")
    shown.until("!page.behind")


def test_the_bar_shows_who_is_likely_to_win_and_moves_with_the_strokes(shown):
    """Before a stroke until the balls rest, then after it; not in practice."""
    shown.set_up(EASY, scores=[20, 40])

    def bar():
        return shown.page.inner_text("#win").split("\n")

    def said(chance):
        first = min(99, max(1, round(100 * chance)))
        return [f"{first} %", "chance to win with an amateur's mistakes", f"{100 - first} %"]

    before = shown("page.state.win_chance")
    assert bar() == said(before)
    shown("page.aim.set({aim: argument, speed: 2})", STRAIGHT)
    shown.page.click("#play")
    shown.until("page.moving && page.moving.now && page.state.strokes === 1")
    after = shown("page.state.win_chance")
    assert said(after) != said(before) == bar()
    edge = "parseFloat(getComputedStyle(document.getElementById('win')).getPropertyValue('--share'))"
    assert shown(edge) == pytest.approx(100 * before)
    shown.played(1)
    assert bar() == said(after) and shown(edge) == pytest.approx(100 * after)
    about = "chance to win with an amateur's mistakes: Player 1 "
    assert shown.page.get_attribute("#win", "aria-label").startswith(about)
    shown.page.click("#undo")
    shown.until("page.state.strokes === 0 && page.settled === page.state.revision")
    assert bar() == said(before)
    shown.line("api/players", {"practice": True})
    shown.until("page.state.practice && page.settled === page.state.revision")
    assert not shown.page.is_visible("#win")
    shown.line("api/players", PERSONS)
    shown.until("!page.state.practice && page.settled === page.state.revision")
    assert shown.page.is_visible("#win")


@pytest.mark.slow
def test_the_end_of_a_frame_is_seen(shown):
    """The winner, the score from the viewer's side, and the next frame, which the other breaks off."""
    shown.set_up(EASY, striker=1, scores=[0, 1])
    state = shown.line("api/players", {"players": ["ghost_ball", "person"]})[1]
    shown.until("page.settled === argument", state["revision"])
    assert not shown.page.is_visible("#over")
    shown.page.click("#start summary")
    shown.page.click("#concede")
    shown.page.click("#confirm-yes")
    shown.until("page.state.phase === 'over' && page.settled === page.state.revision")
    assert shown.page.inner_text("#over-who") == "ghost ball won the frame"
    assert shown.page.inner_text("#over-score") == "You 1 : 0 ghost ball"
    assert shown.page.inner_text("#over-last") == 'You conceded the frame. With "no mistakes".'
    assert shown.words == "Frame over: ghost ball won."
    table, over = shown.page.locator("#stage").bounding_box(), shown.page.locator("#over").bounding_box()
    assert over["y"] >= table["y"] and over["x"] >= table["x"]
    assert over["x"] + over["width"] <= table["x"] + table["width"]
    shown.page.click("#over-close")
    assert not shown.page.is_visible("#over")
    shown.page.click("#undo")
    shown.until("page.aiming")
    shown.page.click("#redo")
    shown.until("page.state.phase === 'over' && page.settled === page.state.revision")
    assert shown.page.is_visible("#over")
    shown("[1, 2].forEach(() => document.querySelector('#next').click())")  # the second tap is none
    shown.until("page.state.phase !== 'over' && !page.sending")
    assert not shown.page.is_visible("#over") and shown("page.state.breaker") == 0
    assert shown.page.get_attribute("#last", "class") != "trouble"


@pytest.mark.slow
def test_two_agents_play_on_by_themselves_until_paused(shown):
    """Each stroke is seen before the other agent plays; Pause stops them, Continue lets them play on."""
    shown.set_up(EASY)
    shown.line("api/players", {"players": ["ghost_ball", "random"], "noise": ["professional", "amateur"]})
    shown.until("page.state.players[0] === 'ghost_ball'")
    for strokes in (1, 2, 3):
        shown.until("page.moving && page.state.strokes >= argument", strokes)
        shown("page.skip()")
    assert shown.page.inner_text("#go") == "Pause"
    shown.page.click("#go")
    shown.until("document.getElementById('go').innerText === 'Continue'")
    end = time.monotonic() + 60
    while not shown("page.state.paused && !page.behind"):
        assert time.monotonic() < end
        shown("page.skip()")
    stopped = shown("page.state.strokes")
    time.sleep(1.0)
    assert shown("page.state.strokes") == stopped >= 3 and "is waiting for Continue" in shown.words
    shown.page.click("#go")
    shown.until("page.moving && page.state.strokes > argument", stopped)
    shown.line("api/players", PERSONS)


@pytest.mark.parametrize(
    "size",
    [
        (390, 844),
        pytest.param((844, 390), marks=pytest.mark.slow),
        pytest.param((820, 1180), marks=pytest.mark.slow),
        (1440, 900),
        pytest.param((3840, 2160), marks=pytest.mark.slow),
    ],
)
def test_it_fits_every_screen_and_can_be_touched(chromium, line, size):
    """The table stands where the screen does, and fills it; buttons are as large as a finger, and grow with the screen."""
    viewport = dict(zip(("width", "height"), size, strict=True))
    shown = Shown(chromium, line, viewport=viewport, has_touch=True, device_scale_factor=1)
    shown.set_up(EASY)
    assert shown("page.view.upright") is (size[1] > size[0])
    (left, top), (right, low) = shown.at(-0.889, 1.7845), shown.at(0.889, -1.7845)
    across, along = abs(right - left), abs(low - top)
    assert max(across, along) >= 0.6 * max(size) and min(across, along) >= 0.42 * min(size)
    page = "document.documentElement"
    assert shown(f"{page}.scrollWidth <= innerWidth && {page}.scrollHeight <= innerHeight")
    shown.page.touchscreen.tap(*shown.at(0.0, 0.89225))
    assert shown("page.aim.wish.aim") == pytest.approx(-2.738, abs=0.02)
    seen = "[...document.querySelectorAll('button, select, input, canvas')].filter(one => one.offsetParent && !one.ariaHidden)"
    height = "one.getBoundingClientRect().height < (one.type === 'range' ? 30 : 44)"
    assert shown(f"{seen}.filter(one => one.type !== 'checkbox' && {height}).map(one => one.id)") == []
    named = "one.textContent.trim() || one.getAttribute('aria-label') || one.title || one.labels?.[0]?.textContent.trim()"
    assert shown(f"{seen}.filter(one => !({named})).map(one => one.id)") == []
    type_ = shown("parseFloat(getComputedStyle(document.body).fontSize)")
    assert type_ >= max(15, min(size[0] / 97, size[1] / 55))
    small = shown("page.view.R * page.view.scale < 9")
    assert shown.page.is_visible("#loupe") is small
    shown.close()


def test_one_press_is_one_stroke(shown):
    """Enter three times before the answer, or held down until the balls rest, plays one stroke."""
    shown.set_up(EASY)
    before = shown("page.state.strokes")
    press = "document.body.dispatchEvent(new KeyboardEvent('keydown', { key: 'Enter', bubbles: true, repeat: argument }))"
    shown.page.evaluate(f"() => {{ const argument = false; for (let k = 0; k < 3; k++) {press}; }}")
    shown.played(before + 1)
    shown.page.evaluate(f"() => {{ const argument = true; for (let k = 0; k < 3; k++) {press}; }}")
    time.sleep(0.5)
    assert shown("page.state.strokes") == before + 1 == shown.line("api/state")[1]["strokes"]


ROOM = "page.room.found && !page.room.wait.busy && page.room.found"


@pytest.mark.slow
def test_the_page_says_and_draws_how_the_cue_finds_room_before_the_stroke(shown):
    """A ball frozen to the cushion: raised over the rail, its tip moved, and free if the players choose so."""
    shown.set_up(FROZEN)
    along = "page.aim.set({aim: argument, speed: 2, side: 0, top: 0, elevation: 0})"
    shown(along, 0.5 * pi)  # along the cushion nothing is in the way
    shown.until(f"{ROOM} && !page.room.found.raised")
    assert shown.page.inner_text("#room") == "" and shown.page.locator("#side .wood").count() == 0
    level = shown("page.aim.overlay().cue.elevation")
    shown.drag((0.3, 0.6), (0.1, 0.6))
    shown.until(f"{ROOM} && page.room.found.raised")
    said = shown.page.inner_text("#room")
    assert said.startswith("Cue raised to 3") and said.endswith("degrees over the rail.")
    assert shown("page.aim.overlay().cue.elevation") > 0.5 > level
    assert shown.page.inner_text("#elevation-out").startswith("3") and shown("page.aim.wish.elevation") == 0
    assert shown.page.is_visible("#side") and shown.page.locator("#side .wood").count() == 1
    # the rail and the cue meet in the drawing: no point of the cue's lower edge is in the wood
    tip, butt = shown("[3, 2].map(k => document.querySelector('#side .cue').points[k]).map(p => [p.x, -p.y])")
    edge = -shown("page.room.found.behind")
    height = tip[1] + (butt[1] - tip[1]) * (edge - tip[0]) / (butt[0] - tip[0])
    assert height == pytest.approx(0.038, abs=2e-4)
    before = shown("document.querySelector('#dial').toDataURL()")
    shown("page.aim.set({top: -0.4})")
    shown.until(f"{ROOM} && page.room.found.moved")
    assert "tip moved to" in shown.page.inner_text("#room")
    assert shown("page.aim.wish.top") == -0.4
    low, mid = shown("document.querySelector('#dial').toDataURL()"), shown("page.room.found.top")
    assert -0.4 < mid < 0 and low != before


@pytest.mark.slow
def test_the_cue_is_pulled_back_and_let_go(shown):
    """The further, the harder; pushed back to the ball it is no stroke, and the power is as before."""
    shown.set_up(EASY)
    shown("page.aim.set({aim: Math.PI / 2, speed: 2, side: 0, top: 0})")
    x, y = EASY["cue"]
    shown.page.mouse.move(*shown.at(x, y - 0.3))
    shown.page.mouse.down()
    powers = []
    for pull in (0.1, 0.2, 0.3):
        shown.page.mouse.move(*shown.at(x + 0.03, y - 0.3 - pull))
        powers.append(shown("page.aim.wish.speed"))
    assert 0.2 < powers[0] < powers[1] < powers[2] < 7
    assert shown.page.inner_text("#power") == f"{powers[2]:.1f} m/s"
    assert shown("page.aim.wish.aim") == pytest.approx(pi / 2)
    shown.page.mouse.move(*shown.at(x, y - 0.3))
    assert shown.page.inner_text("#power") == "no stroke"
    shown.page.mouse.up()
    assert shown("page.aim.wish.speed") == 2 and not shown.page.is_visible("#power")
    assert shown("page.state.strokes") == 0
    shown.drag((x, y - 0.3), (x, y - 0.5))
    wanted = shown("page.aim.wish.speed")
    shown.played(1)
    cue = shown.line("api/strokes")[1]["strokes"][0]["cue"]
    assert cue["speed"] == pytest.approx(wanted, abs=1e-3) and cue["aim"] == pytest.approx(pi / 2)


@pytest.mark.slow
def test_the_strip_aims_finely_and_says_how_full_the_ball_is_struck(shown):
    shown.set_up({"cue": [0.0, 0.0], "reds": [[0.0, 0.8]], "black": [0.0, 1.4605]})
    said = {}
    for offset in (
        0.0,
        0.5,
        -0.5,
        0.95,
        1.2,
    ):  # of the cue ball's path over the ball's diameter, to its right
        aim = f"page.aim.set({{aim: Math.PI / 2 - Math.asin({offset} * 0.0525 / 0.8)}})"
        shown(aim)
        said[offset] = shown.page.inner_text("#aim-out")
    halves = {0.5: "red: half ball, right", -0.5: "red: half ball, left"}
    assert said == {0.0: "red: full ball", **halves, 0.95: "red: thin, right", 1.2: "cushion first"}
    before, box = shown("page.aim.wish.aim"), shown.page.locator("#fine").bounding_box()
    middle = box["y"] + box["height"] / 2
    shown.page.mouse.move(box["x"] + 40, middle)
    shown.page.mouse.down()
    shown.page.mouse.move(box["x"] + 90, middle, steps=5)
    shown.page.mouse.up()
    turned = shown("page.aim.wish.aim") - before
    assert turned == pytest.approx(-50 * 0.01 * pi / 180, abs=1e-6)  # to the right, as the pointer


@pytest.mark.slow
def test_the_first_look_is_calm_and_the_tutorial_is_shown_once(chromium, line):
    shown = Shown(chromium, line, new=True)
    shown.line("api/new", {"layout": "break_off", "seed": 1})
    shown.until(f"{SETTLED} && page.aiming")
    assert shown("page.advisor.overlay().heat.length + page.advisor.overlay().lines.length") == 0
    assert shown.page.is_visible("#tour")
    for step in range(6):
        assert shown.page.inner_text("#tour-step") == f"{step + 1} of 6"
        shown.page.click("#tour-next")
    assert not shown.page.is_visible("#tour")
    shown.page.reload()
    shown.until("page.state")
    assert not shown.page.is_visible("#tour")
    shown.page.click("#tour-open")
    assert shown.page.is_visible("#tour")
    shown.page.click("#tour-skip")
    assert not shown.page.is_visible("#tour")
    shown.close()


@pytest.mark.slow
def test_six_red_and_the_shoot_out_are_played_on_the_page(shown):
    shown.set_up(EASY)
    shown.page.click("#start summary")
    shown.page.select_option("#rules", "six_red")
    shown.page.click("#new")
    shown.until(f"page.state.game === 'six_red' && {SETTLED}")
    for breaker in (1, 0):
        shown.page.click("#start summary")
        shown.page.click("#concede")
        shown.page.click("#confirm-yes")
        shown.until("page.state.phase === 'over' && page.settled === page.state.revision")
        shown.page.click("#next")
        shown.until(f"page.state.phase === 'stroke' && {SETTLED}")
        assert shown("[page.state.reds, page.state.breaker]") == [6, breaker]
        shown.page.click("#start summary")
    shown.page.click("#start summary")
    shown.page.select_option("#rules", "shoot_out")
    shown.page.click("#new")
    shown.until(f"page.state.game === 'shoot_out' && {SETTLED}")
    assert "time 10:00" in shown.page.inner_text("#now").replace("\n", " ")
    shown.line("api/new", {"layout": "break_off", "game": "snooker"})


@pytest.mark.slow
def test_a_drill_counts_and_keeps_its_best(shown):
    shown.set_up(EASY)
    shown.page.click("#drills summary")
    shown.page.click("#drill-list button:has-text('Escapes')")
    shown.until(f"page.drills.now === 'escapes' && page.state.snookered && {SETTLED} && page.aiming")
    assert shown.page.is_visible("#drill") and shown("page.state.practice")
    fair = 0
    for n in range(10):
        shown.until(
            "page.drills.tries === argument && page.aiming && page.settled === page.state.revision", n
        )
        suggested = shown.line("api/advise", {"n": 1, "samples": 20})[1]["suggestions"]
        stroke = {name: suggested[0][name] for name in ("speed", "aim", "side", "top", "elevation")}
        played = shown.line("api/stroke", stroke)[1]["stroke"]
        fair += not played["fouls"]
        shown.until("page.moving")
        shown("page.skip()")
    shown.until("page.drills.over")
    assert (
        shown.page.inner_text("#drill-words") == f"Escapes: {fair} of 10 fair. Your best is {fair}."
        and fair > 0
    )
    assert json.loads(shown("localStorage.getItem('snooker')"))["best"] == {"escapes": fair}
    shown.page.click("#drills summary")
    assert f"Your best: {fair}" in shown.page.inner_text("#drill-list button:has-text('Escapes')")
    shown.page.click("#drill-end")
    shown.until(f"!page.state.practice && {SETTLED}")
    assert not shown.page.is_visible("#drill")


@pytest.mark.slow
def test_a_whole_replay_is_passed_on_as_a_link(shown):
    """It is shown from its first stroke, and gone on with; it meets the same errors as when it was played."""
    shown.set_up(VISIT)
    shown.line("api/players", {"noise": ["club", "amateur"]})
    for aim_at in (
        ["red 1", "top right"],
        ["black", "top left"],
        ["red 2", "top left"],
        ["blue", "middle left"],
    ):
        if shown.line("api/state")[1]["phase"] == "choice":
            shown.line("api/stroke", {"choice": "play"})
        status, _, _ = shown.line("api/stroke", {"speed": 1.6, "aim_at": {"pot": aim_at}})
        if status == 422:  # that ball is gone
            shown.line("api/stroke", {"speed": 3.0, "aim": 1.0})
    strokes, state = (shown.line(f"api/{name}")[1] for name in ("strokes", "state"))
    assert len(strokes["strokes"]) == 4 and strokes["strokes"][0]["cue"]["speed"] != 1.6
    shown.until("page.moving")
    shown.played(4)
    shown.page.click("#files summary")
    shown.page.click("#share")
    shown.until("document.getElementById('link').value.startsWith('#replay=')")
    link = shown.page.input_value("#link")
    assert 150 < len(link) < 300
    with shown.page.expect_download() as saved:
        shown.page.click("#save")
    assert Path(saved.value.path()).read_text() == link
    shown.line("api/new", {"layout": "break_off", "seed": 3})
    shown.line("api/stroke", {"speed": 4.0, "aim": 1.5})
    shown.page.goto("about:blank")
    shown.page.goto(shown.line.server.address + link)
    shown.until("document.getElementById('confirm').open")
    shown.page.click("#confirm-yes")
    for n in (1, 2):
        shown.until("page.moving && page.played === argument", n)
        first, second = shown("[page.moving.stroke.cue, page.state.strokes]")
        assert first == strokes["strokes"][n - 1]["cue"] and second == 4
        shown.page.click("#skip")
    shown.until("page.moving && page.played === 3")
    shown.page.click("#turn")
    shown.until(f"page.played === 4 && !page.behind && {SETTLED}")
    again, now = (shown.line(f"api/{name}")[1] for name in ("strokes", "state"))
    for one, last in ((strokes, "Position set up."), (again, "Game loaded.")):
        assert one["strokes"][0]["tables"][0].pop("last") == last
    assert again["strokes"] == strokes["strokes"]
    changing = ("revision", "begun", "undo", "redo")
    assert {k: v for k, v in now.items() if k not in changing} == {
        k: v for k, v in state.items() if k not in changing
    }
    assert not shown("page.hurried || page.replay")
    shown.page.click("#undo")
    shown.until(f"page.state.strokes === 3 && {SETTLED}")
    shown.line("api/players", PERSONS)


LONG = """void (fetched => window.fetch = async (what, ...more) => String(what).includes("api/link")
    ? new Response(JSON.stringify({ link: "A".repeat(30001) })) : fetched(what, ...more))(window.fetch)"""
"""The server makes a link that is too long."""


def test_a_link_that_cannot_be_made_or_opened_is_refused_in_one_sentence(shown):
    shown.set_up(EASY)
    shown.page.click("#files summary")
    shown(LONG)
    shown.page.click("#share")
    said = "A game can have 30 kB, but this one needs 31 kB: use Replay file instead."
    shown.until("document.getElementById('last').textContent === argument", said)
    shown.page.reload()
    shown.until(f"page.state && {SETTLED}")
    shown.page.click("#files summary")
    for link, words in (
        ("#constructor=AAAA", "This is not a game: a link ends with #replay= and its text."),
        ("#replay=AAAA", "link = 4 characters: must be whole: this one is damaged, copy it again"),
    ):
        shown.page.fill("#link", link)
        shown.page.keyboard.press("Enter")
        shown.until("document.getElementById('last').textContent === argument", words)
    shown.line("api/new", {"layout": "colours"})
    link = shown.line("api/link", {})[1]["link"]
    shown.page.set_input_files(
        "#file", {"name": "a", "mimeType": "text/plain", "buffer": f"#replay={link}".encode()}
    )
    shown.until("page.state.last === 'Game loaded.'")
    assert [text for text in shown.errors if "422" not in text] == []  # the refusal, which Chromium reports
    shown.errors.clear()


@pytest.mark.slow
def test_a_friend_by_link_watches_the_visit_and_plays_the_other_seat(shown, chromium):
    """Begun, played and sent by one browser, opened and answered by another, which knows nothing of it; and opened again."""
    line = shown.line
    shown.page.click("#start summary")
    shown.page.select_option("#layout", "colours")
    shown.page.click("#friend-new")
    shown.until(f"page.state.by_link && page.aiming && {SETTLED}")
    assert shown.page.is_disabled("#noise-0") and not shown.page.is_visible("#friend")
    assert "Play first, then send" in shown.page.inner_text("#last")
    shown("page.aim.set({aim: argument, speed: 1})", -pi / 2)
    shown.page.keyboard.press("Enter")
    shown.played(1)
    shown.until("!document.getElementById('friend').hidden")
    assert "Your move, stroke 2." in shown.page.inner_text("#friend-words")
    assert not shown.page.is_visible("#play") and not shown.page.is_enabled("#undo")
    shown.page.click("#friend-copy")
    shown.until("document.getElementById('friend-words').textContent.includes('pastes it')")
    first = shown("page.friend.text")
    assert re.fullmatch(
        r"Your move, stroke 2\. Paste this message into Link,.* #friend=[\w-]{100,300}", first
    )
    line("api/new", {"layout": "break_off", "seed": 3})
    friend = Shown(chromium, line)
    friend.page.click("#files summary")
    friend.page.fill("#link", first)
    friend.page.keyboard.press("Enter")
    friend.until("page.moving && page.moving.stroke.player === 0")  # the visit is shown
    friend.played(1)
    assert friend("page.state.by_link.seat") == 1 and friend.page.inner_text("#side-0 .name") == "Friend"
    friend.page.click("#choices button[data-choice=play]")
    friend.until(f"page.aiming && {SETTLED}")
    friend("page.aim.set({aim: argument, speed: 1})", -pi / 2)
    friend.page.keyboard.press("Enter")
    friend.played(2)
    friend.until("!document.getElementById('friend').hidden")
    answer = friend("page.friend.text")
    friend.close()
    shown.page.click("#files summary")
    shown.page.fill("#link", answer)
    shown.page.keyboard.press("Enter")
    shown.until(
        "page.state.by_link?.seat === 0 && page.state.strokes === 2"
    )  # its own seat, which it has kept
    shown.played(2)
    assert shown.page.is_visible("#choices")
    line("api/new", {"layout": "break_off", "seed": 3})
    shown.until("!page.state.by_link")
    shown.page.click("#start summary")
    assert (
        shown("[...document.getElementById('friend-games').options].map(one => one.text)")[1]
        == "stroke 3, your move"
    )
    shown.page.select_option("#friend-games", index=1)
    shown.until("page.state.by_link?.seat === 0 && page.state.strokes === 2")
    shown("page.friend.open(argument)", first.split("=")[1])  # an older link of the same game
    shown.until("document.getElementById('last').textContent.includes('older')")
    assert [text for text in shown.errors if "422" not in text] == []  # the refusal, which Chromium reports
    shown.errors.clear()
    line("api/new", {"layout": "break_off", "seed": 3})
    line("api/players", PERSONS)


@pytest.mark.slow
def test_a_shot_clock_plays_the_stroke_as_it_is_aimed(shown):
    shown.set_up(EASY)
    assert not shown.page.is_visible("#clock")
    shown("page.aim.set({aim: argument, speed: 0.5})", AWAY)
    shown("page.clock.spent += 20")  # long thought before there is a clock, and before another one
    shown.page.click("#options summary")
    for limit, before in (("15 s", 14.5), ("40 s", 30), ("off", 30), ("25 s", 20), ("15 s", 14)):
        shown.page.select_option("#limit", limit)
        if limit != "off":
            full = int(limit[:2])
            assert full - 3 <= int(shown.page.inner_text("#clock")) <= full
        assert shown("page.state.strokes") == 0 and not shown("page.sending")
        shown("page.clock.spent += argument", before)
    shown.until("document.getElementById('clock').className === 'late' || page.state.strokes")
    shown.played(1)
    cue = shown.line("api/strokes")[1]["strokes"][0]["cue"]
    assert (cue["speed"], cue["aim"]) == pytest.approx((0.5, AWAY))


def test_the_page_is_small(line):
    """What a browser loads beside the table's drawing and the game's data: under 170 kB."""
    names = [name for name in FILES if name != "table.js"]
    files = [body for name in names for status, body, _ in [line(name)] if status == 200]
    assert len(files) == len(names) and sum(map(len, files)) < 170_000


@pytest.mark.slow
def test_a_friend_plays_from_a_phone_and_a_third_person_watches(chromium):
    with served("127.0.0.1") as line:
        line.server.service.seats.sit(["person", "ghost_ball"])
        line("api/players", {"noise": ["amateur", "club"]})
        host = Shown(chromium, line)
        assert host.page.inner_text("#side-1 .name") == "ghost ball"
        host.page.click("#invite-open")
        host.until("[...document.querySelectorAll('#invites img')].every(one => one.naturalWidth)")
        sources = host("[...document.querySelectorAll('#invites section')].map(one => one.innerText)")
        mine, theirs, only = (re.findall(r"http://\S+", words.replace("\n", " "))[0] for words in sources)
        assert mine == line.server.address
        host.page.keyboard.press("Escape")
        phone = {"viewport": {"width": 390, "height": 844}, "has_touch": True}
        friend = Shown(chromium, line, address=theirs, **phone)
        assert friend.page.inner_text("#seat").startswith("You are watching until your host chooses you")
        host.page.click("#start summary")
        host.page.select_option("#level", "friend")
        friend.until("page.door.seated")
        watcher = Shown(chromium, line, address=only)
        host.until("page.state.labels[1] === 'Friend'")
        assert friend("page.state.noise") == ["amateur", "amateur"]
        assert friend("page.state.labels") == ["Friend", "You"] and not friend("page.aiming")
        assert friend.page.inner_text("#seat") == "Friend is playing." and not friend.page.is_visible("#play")
        assert watcher.page.inner_text("#seat") == "You are watching. Player 1 is playing."
        for one in ("#stroke", "#ask", "#undo", "#start", "#set", "#concede"):
            assert not watcher.page.is_visible(one)
        line("api/position", {"position": EASY, "striker": 1})
        for one in (host, friend, watcher):
            one.until("page.state.striker === 1 && page.settled === page.state.revision")
        assert host.page.inner_text("#seat") == "Friend is playing." and not host("page.aiming")
        friend("page.aim.set({aim: argument, speed: 2})", STRAIGHT)
        friend.page.click("#play")
        for one in (friend, host, watcher):
            one.played(1)
        assert "You: Red potted" in friend.page.inner_text("#last") and friend("page.aiming")
        assert "Friend: Red potted" in host.page.inner_text("#last") and not host("page.aiming")
        assert "Player 2: Red potted" in watcher.page.inner_text("#last")
        friend("page.fold(false)")
        friend.page.click("#concede")
        friend.page.click("#confirm-yes")
        for one, words in ((host, "You"), (friend, "Friend"), (watcher, "Player 1")):
            one.until("!document.getElementById('over').hidden")
            assert one.page.inner_text("#over-who") == f"{words} won the frame"
            assert one.page.is_visible("#next") is (one is host)
        for one in (host, friend, watcher):
            one.close()


def test_a_frame_is_reviewed_on_the_page_and_played_again_from_its_costliest_stroke(shown):
    """By keys: the list, both strokes on the table, the position again with all that belongs to it; the review waits."""
    shown.set_up(EASY)
    for aim in (1.5, 2.0):
        status, _, _ = shown.line(
            "api/stroke", {"speed": 2.0, "aim": aim, **({"choice": "play"} if aim == 2.0 else {})}
        )
        assert status == 200
    shown.played(2)
    shown("page.fold(false)")
    shown.page.click("#review-open")
    shown.until("page.review.found?.costliest?.length === 2 && !page.review.found.running")
    assert shown.page.is_hidden("#stroke") and shown("page.aiming") is False
    rows = shown.page.locator("#review-list button")
    assert rows.count() == 2 and shown.page.locator("#review-graph svg").count() == 1
    first = shown("page.review.found.costliest[0]")
    assert f"{first}. " in rows.first.inner_text()
    rows.first.focus()
    shown.page.keyboard.press("Enter")
    shown.until("page.review.shown !== null && page.review.chosen === argument", first)
    assert "lost by the choice; the best was" in shown.page.inner_text("#review-said")
    lines = shown("page.review.overlay().lines.map(one => [one.colour, one.points.length > 1])")
    assert {colour for colour, _ in lines} == {"#ffffff", "#ffd75e"} and all(long for _, long in lines)
    best = shown("page.review.shown.best.paths")
    assert len(best) <= 2 and "0" in best
    cells = shown(
        "[...document.querySelectorAll('#review-sides tr')].slice(1).map(row => [...row.cells].map(cell => cell.textContent))"
    )
    whole = [[int(re.sub(r"[^\d-]", "", cell.replace("−", "-"))) for cell in row[1:]] for row in cells]
    last = [row[0] for row in cells].index("end")
    for own in zip(*whole[: last + 1], strict=True):  # from start to end
        assert sum(own[:-1]) == own[-1]
    assert whole[0][0] == round(100 * shown("page.review.found.win_chance[0]"))
    table = shown("page.table")
    shown.page.click("#review-again")
    shown.until(f"page.state.strokes === argument && page.aiming && {SETTLED}", first - 1)
    state = shown("page.state")
    for name in ("positions", "scores", "striker", "ball_on", "break"):
        assert state[name] == table[name], name
    assert state["redo"] and shown("page.review.kept") is True
    shown("page.fold(false)")
    shown.page.click("#review-open")
    assert rows.count() == 2 and shown("page.review.found.total") == 4
    shown.page.keyboard.press("Escape")
    shown.until("page.aiming && !page.review.open")
