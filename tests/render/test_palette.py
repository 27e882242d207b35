"""Do the colours stand out from the cloth and each other, by CIEDE2000, and does the JSON hold them all?"""

import itertools
import json

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game.balls import NAMES, SPOTS, VALUES
from snooker_env.geometry import BAULK_Y, D_RADIUS
from snooker_env.render import COLOURS, PALETTE, outline, scene_data


def lab(rgb):
    """CIELAB of sRGB, under D65."""
    c = np.asarray(rgb, float) / 255
    c = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    red, green = (0.4124564, 0.2126729, 0.0193339), (0.3575761, 0.7151522, 0.119192)
    x = c @ np.array([red, green, (0.1804375, 0.072175, 0.9503041)])
    f = [np.cbrt(v) if v > 216 / 24389 else (24389 / 27 * v + 16) / 116 for v in x / (0.95047, 1.0, 1.08883)]
    return 116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])


def ciede2000(one, two):
    """The difference of two colours in CIELAB: Sharma, Wu, Dalal, Color Res. Appl. 30 (2005) 21."""
    (l1, a1, b1), (l2, a2, b2) = one, two
    mean = (np.hypot(a1, b1) + np.hypot(a2, b2)) / 2
    grey = 1.5 - 0.5 * np.sqrt(mean**7 / (mean**7 + 25.0**7))
    a1, a2 = a1 * grey, a2 * grey
    c1, c2 = np.hypot(a1, b1), np.hypot(a2, b2)
    h1, h2 = np.degrees(np.arctan2(b1, a1)) % 360, np.degrees(np.arctan2(b2, a2)) % 360
    turn = (h2 - h1 + 180) % 360 - 180 if c1 * c2 else 0.0
    far = 2 * np.sqrt(c1 * c2) * np.sin(np.radians(turn / 2))
    level, chroma, hue = (l1 + l2) / 2, (c1 + c2) / 2, (h1 + turn / 2) % 360 if c1 * c2 else h1 + h2
    cosines = zip((-0.17, 0.24, 0.32, -0.20), (1, 2, 3, 4), (-30, 0, 6, -63), strict=True)
    t = 1 + sum(w * np.cos(np.radians(k * hue + by)) for w, k, by in cosines)
    s_l = 1 + 0.015 * (level - 50) ** 2 / np.sqrt(20 + (level - 50) ** 2)
    s_c, s_h = 1 + 0.045 * chroma, 1 + 0.015 * chroma * t
    turned = np.sin(np.radians(60 * np.exp(-(((hue - 275) / 25) ** 2))))
    rotated = -2 * np.sqrt(chroma**7 / (chroma**7 + 25.0**7)) * turned
    parts = (l2 - l1) / s_l, (c2 - c1) / s_c, far / s_h
    return np.sqrt(sum(p * p for p in parts) + rotated * parts[1] * parts[2])


def test_balls_stand_out_from_the_cloth_and_each_other():
    cloth = lab(PALETTE["cloth"])
    for ball in (0, 1, *range(16, 22)):
        assert ciede2000(lab(COLOURS[ball]), cloth) >= 25, NAMES[ball]
    kinds = [COLOURS[ball] for ball in (0, 1, *range(16, 22))]
    assert min(ciede2000(lab(one), lab(two)) for one, two in itertools.combinations(kinds, 2)) >= 15
    assert len({tuple(c) for c in COLOURS[1:16].tolist()}) == 1


@pytest.mark.parametrize("name", ["match", "tight", "uk8", "pool9", "carom"])
def test_the_json_is_the_table(name):
    table = sn.Table.preset(name)
    data, parts = json.loads(json.dumps(scene_data(name))), outline(table)
    for key in ("cushions", "noses"):
        assert len(data[key]) == len(getattr(parts, key))
        for given, own in zip(data[key], getattr(parts, key), strict=True):
            assert np.array(given) == pytest.approx(own, abs=5.1e-7)
    for key in ("falls", "throats"):
        own = getattr(parts, key)
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
