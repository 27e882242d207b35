"""Does the PNG of a table show every ball where it lies, in its colour, and a red's number?"""

import struct
import zlib

import numpy as np

import snooker_env as sn
from snooker_env.physics.table import Table
from snooker_env.render import COLOURS
from snooker_env.render.still import draw_png


def read(png):
    """The image (H, W, 3), by the format's own checks."""
    assert png[:8] == b"\x89PNG\r\n\x1a\n"
    at, parts = 8, {}
    while at < len(png):
        (length,), kind = struct.unpack(">I", png[at : at + 4]), png[at + 4 : at + 8]
        data = png[at + 8 : at + 8 + length]
        assert struct.unpack(">I", png[at + 8 + length : at + 12 + length])[0] == zlib.crc32(kind + data)
        at, parts[kind] = at + 12 + length, data
    width, height, *rest = struct.unpack(">IIBBBBB", parts[b"IHDR"])
    lines = np.frombuffer(zlib.decompress(parts[b"IDAT"]), np.uint8).reshape(height, 1 + 3 * width)
    assert rest == [8, 2, 0, 0, 0] and not lines[:, 0].any() and b"IEND" in parts
    return lines[:, 1:].reshape(height, width, 3)


def test_balls_are_seen_in_their_colours_and_reds_tell_which_they_are():
    position = sn.Position(cue=(0.3, -1.2), reds=[(0.5, 0.5), (-0.5, 1.2)], blue=(-0.7, 0.1), black=(0, 1.46))
    positions, on_table, _ = position.arrays()
    png, view = draw_png(Table.of(None), positions, on_table)
    image = read(png)
    for ball in np.flatnonzero(on_table):
        column, row = view(positions[ball]).round().astype(int)
        around = image[row - 6 : row + 7, column - 6 : column + 7]
        assert (around == COLOURS[ball]).all(axis=-1).sum() > 40, ball
    one, other = (
        (image[row - 5 : row + 6, column - 5 : column + 6] == 255).all(axis=-1)
        for column, row in view(positions[1:3]).round().astype(int)
    )
    assert one.any() and other.any() and (one != other).any()
    gone = on_table & (np.arange(22) != 20 - 2)  # without the blue one
    column, row = view(positions[18]).round().astype(int)
    assert (read(draw_png(Table.of(None), positions, gone)[0])[row, column] != COLOURS[18]).any()
