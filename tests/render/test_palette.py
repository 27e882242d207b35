"""Do the colours stand out from the cloth and each other, by CIEDE2000, and does the JSON hold them all?"""

import json
import re
from importlib.resources import files

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game.balls import NAMES, SPOTS, VALUES
from snooker_env.geometry import BAULK_Y, D_RADIUS
from snooker_env.render.palette import COLOURS, PALETTE
from snooker_env.render.scene import outline, scene_data


@pytest.mark.parametrize("name", ["match", "tight", "uk8", "pool9", "carom"])
def test_the_json_is_the_table(name):
    table = sn.Table.preset(name)
    data, parts = json.loads(json.dumps(scene_data(name))), outline(table)
    for key in ("cushions", "noses"):
        assert len(data[key]) == len(getattr(parts, key))
        for given, own in zip(data[key], getattr(parts, key), strict=True):
            assert np.array(given) == pytest.approx(own, abs=5.1e-7)
    for key, own in (("falls", table.falls), ("throats", parts.throats)):
        assert np.array(data[key]).reshape(own.shape) == pytest.approx(own, abs=5.1e-7)
    assert data["extent"] == pytest.approx(table.bounds, abs=5.1e-7)
    assert data["ball_radius"] == table.ball_radius
    assert data["palette"] == {key: list(rgb) for key, rgb in PALETTE.items()}
    assert [ball["rgb"] for ball in data["balls"]] == COLOURS.tolist()
    assert [ball["value"] for ball in data["balls"]] == VALUES.tolist()
    assert [ball["name"] for ball in data["balls"]] == list(NAMES)
    if name in ("match", "tight"):
        assert data["lines"]["spots"] == pytest.approx(SPOTS[16:], abs=5.1e-7)
        away = np.hypot(*(np.array(data["lines"]["d"]) - (0, BAULK_Y)).T)
        assert away == pytest.approx(np.full(65, D_RADIUS), abs=1e-6)
        assert max(y for _, y in data["lines"]["d"]) <= BAULK_Y + 1e-9
    else:
        assert data["lines"] is None


def test_the_pages_draw_with_colours_that_exist():
    """A name that is missing is drawn as nothing, without an error."""
    web = files("snooker_env.replays") / "web" / "table"
    drawn = "".join(file.read_text("utf-8") for file in web.iterdir() if file.suffix == ".js")
    used = {*re.findall(r"\b(?:ink|colours)\.(\w+)", drawn)} - {"length", "slice"}
    used |= {*re.findall(r"var\(--(\w+)\)", (web / "player.css").read_text("utf-8"))} - {"share"}
    assert len(used) > 15 and used <= PALETTE.keys(), used - PALETTE.keys()
