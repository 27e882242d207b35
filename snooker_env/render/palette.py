"""Colours. Every ball differs from the cloth by at least 25 in CIEDE2000, so that it is easy to see."""

import numpy as np

from .._lib.types import Bytes

PALETTE: dict[str, tuple[int, int, int]] = {
    "floor": (17, 18, 21),
    "cloth": (36, 148, 76),
    "cloth_edge": (15, 78, 40),
    "line": (214, 226, 190),
    "cushion": (30, 124, 64),
    "nose": (86, 186, 118),
    "wood": (92, 44, 24),
    "wood_edge": (44, 20, 11),
    "leather": (58, 40, 30),
    "leather_edge": (132, 100, 74),
    "hole": (5, 5, 6),
    "aim": (255, 240, 150),
    "path_edge": (10, 46, 24),
    "shadow": (0, 14, 5),
    "lamp": (255, 252, 240),
    "bar": (16, 20, 31),
    "bar_edge": (62, 70, 94),
    "bar_accent": (196, 32, 48),
    "text": (240, 240, 236),
    "text_quiet": (164, 170, 184),
    "first": (44, 104, 180),
    "other": (178, 88, 14),
}
"""Colours by name, (red, green, blue), 0 to 255. ``cloth_edge``: the cloth over a fall; ``nose``: the edge that balls meet;
``path_edge``: a path's outline; ``lamp``: its reflection; ``bar``: the score bar; ``bar_accent``: marks on the pages;
``first``, ``other``: the two players' shares of the chance to win, light text on both."""

COLOURS: Bytes = np.array(
    [(252, 248, 234)]
    + [(196, 18, 24)] * 15
    + [(252, 214, 36), (0, 74, 62), (118, 62, 22), (20, 72, 206), (244, 138, 166), (18, 18, 21)],
    dtype=np.uint8,
)
"""Colours of the balls by id: uint8 (22, 3), red, green, blue; read-only."""
PALE: Bytes = ((COLOURS.astype(np.int64) * 2 + 255) // 3).astype(np.uint8)  # lighter, for paths
LETTERS = "W" + "r" * 15 + "YGNBPK"  # by ball id: W the cue ball, r a red; N is brown and K black, B is blue
COLOURS.setflags(write=False)
