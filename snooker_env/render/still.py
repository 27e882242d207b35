"""How is a table drawn without a drawing library? From above, as a PNG; reds bear their numbers."""

import struct
import zlib

import numpy as np

from .._lib.types import Bools, Floats
from ..game.balls import N_REDS
from ..geometry import BALL_RADIUS
from ..physics.table import Table
from .palette import COLOURS
from .table_picture import View, table_picture

SIZE = (1280, 720)  # of the picture, with the score bar that is cut off below
_ROWS = (
    *("75557", "26227", "71747", "71717", "55711"),
    *("74717", "74757", "71122", "75757", "75717"),
)  # of each digit five rows of three bits, the left one first


def draw_png(table: Table, positions: Floats, on_table: Bools) -> tuple[bytes, View]:
    """The PNG of a table with balls (22, 2), and where its points lie in the picture."""
    view = View.of(table, SIZE)
    image = table_picture(table, view)[: view.height - view.bar].astype(np.float32)
    image = 8 * np.rint(image / 8)  # what a packer can do more with
    radius = BALL_RADIUS * view.scale
    for ball in np.flatnonzero(on_table).tolist():
        x, y = view(positions[ball]).tolist()
        top, left = int(y - radius) - 1, int(x - radius) - 1
        around = image[top : int(y + radius) + 2, left : int(x + radius) + 2]
        rows, columns = np.ogrid[: around.shape[0], : around.shape[1]]
        away = np.hypot(columns + left + 0.5 - x, rows + top + 0.5 - y)
        ink = COLOURS[ball] * np.where(away > radius - 1.5, 0.4, 1.0)[..., None]
        around += (ink - around) * np.clip(radius + 0.5 - away, 0.0, 1.0)[..., None]
        if 0 < ball <= N_REDS:
            number = _number(ball)
            top, left = round(y - number.shape[0] / 2), round(x - number.shape[1] / 2)
            image[top : top + number.shape[0], left : left + number.shape[1]][number] = 255
    return _png(np.clip(image, 0, 255).astype(np.uint8)), view


def _number(ball: int) -> Bools:
    """The pixels of a number, twice as large as its digits."""
    digits = [[[int(row) >> bit & 1 for bit in (2, 1, 0)] for row in _ROWS[int(d)]] for d in str(ball)]
    drawn = [np.pad(np.array(one, np.bool_), ((0, 0), (0, 1))) for one in digits]
    return np.concatenate(drawn, axis=1)[:, :-1].repeat(2, axis=0).repeat(2, axis=1)


def _png(image: np.ndarray) -> bytes:
    """An image (H, W, 3) as a PNG."""
    height, width, _ = image.shape
    lines = np.pad(image.reshape(height, -1), ((0, 0), (1, 0)))  # a byte before each line: no filter

    def part(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    packed = zlib.compress(lines.tobytes(), 6)
    return b"\x89PNG\r\n\x1a\n" + part(b"IHDR", head) + part(b"IDAT", packed) + part(b"IEND", b"")
