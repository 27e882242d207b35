"""Does a replay's page show who is likely to win? In a real headless Chromium."""

import pytest

from tests.web.chromium import Watched, chromium  # noqa: F401
from tests.web.replay_data import page_of, visit

CHANCES = [0.5, 0.3, 0.9961, 1.0]


@pytest.fixture
def p(chromium, tmp_path):  # noqa: F811
    data, _, _ = visit()
    file = tmp_path / "judged.html"
    file.write_text(page_of(data | {"win_chance": CHANCES}), encoding="utf-8")
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
