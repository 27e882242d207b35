"""Does a replay's page show who is likely to win, and who was lucky? In a real headless Chromium."""

import pytest

from tests.web.chromium import Watched, chromium  # noqa: F401
from tests.web.replay_data import page_of, visit

CHANCES = [0.5, 0.3, 0.9961, 1.0]
LUCK = [-0.104, 0.2, 0.0621]  # of strokes by the first player, by the first and by the other


@pytest.fixture
def p(chromium, tmp_path):  # noqa: F811
    data, _, _ = visit()
    file = tmp_path / "judged.html"
    file.write_text(page_of(data | {"win_chance": CHANCES, "luck": LUCK}), encoding="utf-8")
    page = Watched(chromium, file.as_uri(), ("file:", "data:"), "p", reduced_motion="reduce")
    yield page
    page.close()


def test_the_bar_changes_once_the_balls_rest(p):
    bar = p.page.locator(".sn-win")
    for place, first, other in (
        ("0, 1", 50, 50),
        ("0, p.strokes[0].duration", 30, 70),
        ("1, 0", 30, 70),
        ("1, p.strokes[1].duration", 99, 1),  # the frame goes on: nothing is certain yet
        ("2, p.strokes[2].duration", 100, 0),
    ):
        p(f"p.seek({place})")
        assert bar.inner_text().split("\n") == [f"{first} %", "chance to win", f"{other} %"]
        assert bar.get_attribute("aria-label").startswith(f"chance to win: Ada <b>Lovelace</b> {first} %, ")
    p("p.seek(0, p.strokes[0].duration)")
    edge = p("getComputedStyle(document.querySelector('.sn-win')).backgroundImage")
    assert "30%" in edge


def test_the_graph_shows_each_share_until_the_next_stroke_is_over(p):
    box = p.page.locator(".sn-graph svg").bounding_box()
    assert box["height"] > 30 and box["width"] == p.page.locator(".sn-bar").bounding_box()["width"]
    inside = """(() => {
      const path = document.querySelector(".sn-first"), svg = path.ownerSVGElement;
      return (time, share) => path.isPointInFill(Object.assign(svg.createSVGPoint(), { x: time, y: 1 - share }));
    })()"""
    ends = p("p.strokes.map((stroke, k) => p.starts[k] + stroke.duration)")
    times = [0.1, ends[0] - 0.1, ends[0] + 0.1, ends[1] - 0.1, ends[1] + 0.1, ends[2] - 0.1]
    for time, chance in zip(times, [0.5, 0.5, 0.3, 0.3, 0.9961, 0.9961], strict=True):
        found = p(f"[-0.02, 0.002].map(more => ({inside})(argument[0], argument[1] + more))", [time, chance])
        assert found == [True, False], time
    p("p.seek(1, 2)")
    assert p("document.querySelector('.sn-moment').getBBox().x") == pytest.approx(
        p("p.starts[1] + 2"), abs=1e-3
    )


def test_the_graph_shows_the_luck_of_each_stroke_and_the_sums(p):
    bars = p(
        "[...document.querySelectorAll('.sn-lucky')].map(one => one.getBBox())"
        ".map(box => [box.x, box.width, 0.5 - box.y, box.height])"
    )
    for k, up in enumerate((-0.104, 0.2, -0.0621)):  # up: good for the first player
        x, wide, top, high = bars[k]
        assert [x, wide] == pytest.approx(
            p("[p.starts[argument], p.strokes[argument].duration]", k), abs=1e-3
        )
        assert [top, high] == pytest.approx([max(up, 0.0), abs(up)], abs=1e-6)
    line = p.page.locator(".sn-luck")
    assert line.inner_text().split("\n") == ["+10 %", "luck", "+6 %"] and line.bounding_box()["height"] > 8
    assert line.get_attribute("aria-label").startswith("luck: Ada <b>Lovelace</b> +10 %, Someone")
    box = p.page.locator(".sn-graph").bounding_box()
    p.page.mouse.move(box["x"] + 0.02 * box["width"], box["y"] + 20)
    assert p.page.locator(".sn-graph").get_attribute("title").endswith("30 : 70 %, luck -10 %")


def test_without_known_luck_none_is_shown(chromium, tmp_path):  # noqa: F811
    file = tmp_path / "judged.html"
    file.write_text(page_of(visit()[0] | {"win_chance": CHANCES}), encoding="utf-8")
    page = Watched(chromium, file.as_uri(), ("file:", "data:"), "p", reduced_motion="reduce")
    assert page.page.locator(".sn-graph svg").count() == 1
    assert page.page.locator(".sn-lucky, .sn-luck").count() == 0
    page.close()
