"""Does a replay play in a notebook? The widget's module in a real Chromium, its host imitated."""

import json
import sys

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.widget import _widget_class, module, replay_widget
from tests.refusals import refused
from tests.web.chromium import chromium  # noqa: F401

pytest.importorskip("anywidget")

HOST = """
async ([source, state]) => {
  const { default: widget } = await import(URL.createObjectURL(new Blob([source], { type: "text/javascript" })));
  const handlers = {}, sent = [];
  let dirty = {};
  const model = {  // as Backbone's: a change is announced at once, to whoever listens; save_changes sends what was set
    get: name => state[name],
    set(name, value) {
      if (state[name] === value) return;
      state[name] = dirty[name] = value;
      (handlers[`change:${name}`] ?? []).forEach(act => act());
    },
    save_changes() { sent.push(dirty); dirty = {}; },
    on(name, act) { (handlers[name] ??= []).push(act); },
    off(name, act) { handlers[name] = handlers[name].filter(one => one !== act); },
  };
  const el = document.body.appendChild(document.createElement("div"));
  el.style.width = "800px";
  const clean = await widget.render({ model, el });
  window.host = { model, el, clean, sent, state, handlers };
}
"""
"""What anywidget does: imports the module from a blob, and calls render with the model and an element."""


@pytest.fixture(scope="module")
def shots():
    made, places = [], np.array([(0.0, -0.5), (0.1, 0.6), (-0.3, 1.0)])
    for aim in (1.4, 1.9):
        v, w = sn.strike(2.5, aim, side=0.2)
        made.append(sn.simulate(places, [v[:2], (0, 0), (0, 0)], [w, (0, 0, 0), (0, 0, 0)]))
    return made


def hosted(browser, widget):
    """A page in which the widget is shown, its state having gone through JSON."""
    page = browser.new_page()
    page.faults = []
    page.on("pageerror", lambda error: page.faults.append(str(error)))
    page.set_content("<!DOCTYPE html><body></body>")
    state, wanted = widget.get_state(), ("data", "options", "stroke", "time", "playing")
    page.evaluate(HOST, [module(), json.loads(json.dumps({name: state[name] for name in wanted}))])
    return page


def shown_by(page):
    return page.evaluate("(({stroke, time, playing}) => ({stroke, time, playing}))(host.state)")


def cloth_share(page):
    """How much of the canvas is as green as cloth, and a picture of it."""
    return page.evaluate("""() => {
        const canvas = host.el.querySelector("canvas"), { width, height } = canvas;
        const rgba = canvas.getContext("2d").getImageData(0, 0, width, height).data;
        let green = 0, sum = 0;
        for (let k = 0; k < rgba.length; k += 4) {
          green += rgba[k + 1] > 1.3 * rgba[k] && rgba[k + 1] > 1.3 * rgba[k + 2];
          sum = (31 * sum + 7 * rgba[k] + 3 * rgba[k + 1] + rgba[k + 2]) % 1000003;
        }
        return [4 * green / rgba.length, sum];
    }""")


def test_the_state_is_json_and_the_module_is_whole(shots):
    widget = replay_widget(shots, speed=2.0, labels=True, spin="off")
    state = widget.get_state()
    assert json.loads(json.dumps(state["data"])) == sn.replay(shots).to_dict()
    assert state["options"] == {"speed": 2.0, "spin": "off", "paths": True, "ghosts": True, "labels": True}
    assert (state["stroke"], state["time"], state["playing"]) == (0, 0.0, False)
    assert "export default { render }" in state["_esm"]
    assert "http" not in state["_esm"].replace("http://www.w3.org", "")


def test_it_shows_the_time_that_python_sets_and_reports_what_a_viewer_does(shots, chromium):  # noqa: F811
    page = hosted(chromium, replay_widget(shots))
    share, at_start = cloth_share(page)
    assert share > 0.4 and page.evaluate("host.el.querySelectorAll('button').length") > 5
    page.evaluate("host.model.set('time', 0.8)")
    assert cloth_share(page)[1] != at_start and shown_by(page) == {"stroke": 0, "time": 0.8, "playing": False}
    page.evaluate("host.model.set('time', 99)")  # beyond the end
    assert shots[0].duration <= shown_by(page)["time"] < shots[0].duration + 3  # some time is left to see it
    page.evaluate("host.model.set('stroke', 1)")
    assert shown_by(page) == {"stroke": 1, "time": 0.0, "playing": False}
    page.locator("button[aria-label='next event']").click()
    first = next(t for t in shots[1].events["time"] if t > 0)
    assert shown_by(page)["time"] == pytest.approx(first, abs=1e-8)
    assert page.evaluate("host.sent.at(-1).time") == shown_by(page)["time"]
    page.locator("button[aria-label='previous stroke']").click()
    assert shown_by(page)["stroke"] in (0, 1)
    assert not page.faults


def test_play_and_pause_go_both_ways(shots, chromium):  # noqa: F811
    page = hosted(chromium, replay_widget(shots))
    page.evaluate("host.model.set('playing', true)")
    page.wait_for_timeout(400)
    assert shown_by(page)["playing"]
    assert shown_by(page)["time"] == page.evaluate("host.sent.filter(one => 'time' in one).at(-1)?.time ?? 0")
    messages = page.evaluate("host.sent.length")
    page.wait_for_timeout(300)
    assert page.evaluate("host.sent.length") <= messages + 1  # not one a frame
    page.locator("button[aria-label='pause']").click()
    assert not shown_by(page)["playing"] and page.evaluate("host.sent.at(-1).playing") is False
    assert shown_by(page)["time"] != 0.0
    page.locator("button[aria-label='play']").click()
    assert shown_by(page)["playing"]
    page.evaluate("host.model.set('playing', false)")
    before = shown_by(page)
    page.wait_for_timeout(200)
    assert shown_by(page) == before and not page.faults


def test_it_starts_where_the_traits_say_and_ends_cleanly(shots, chromium):  # noqa: F811
    widget = replay_widget(shots)
    widget.stroke, widget.time = 1, 0.5
    page = hosted(chromium, widget)
    assert shown_by(page) == {"stroke": 1, "time": 0.5, "playing": False}
    assert page.evaluate("host.el.dataset.lmSuppressShortcuts") == "true"
    page.evaluate("host.clean()")
    assert page.evaluate("host.el.childElementCount") == 0
    assert page.evaluate("Object.values(host.handlers).every(acts => !acts.length)")
    page.evaluate("host.model.set('time', 0.1)")
    assert not page.faults


def test_what_is_wrong_is_refused(shots):
    refused(lambda: replay_widget(shots, speed=99), "speed", "99", "must be a finite number in [0.1, 8]")
    refused(lambda: replay_widget(shots, spin="some"), "spin", "'some'", "must be one of 'off', 'cue', 'all'")
    refused(lambda: replay_widget(shots, paths=1), "paths", "1", "must be True or False")
    refused(lambda: replay_widget([]), "strokes", "[]", "must hold at least one")
    widget = replay_widget(shots)
    with pytest.raises(Exception, match=r"stroke = 2: must be in \[0, 1\]"):
        widget.stroke = 2
    assert widget.stroke == 0


def test_without_anywidget_the_line_that_installs_it_is_said(shots, monkeypatch):
    _widget_class.cache_clear()
    monkeypatch.setitem(sys.modules, "anywidget", None)
    with pytest.raises(ImportError, match=r'widgets need anywidget; .* pip install -e "\.\[notebook\]"'):
        replay_widget(shots)
