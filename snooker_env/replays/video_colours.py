"""How are pictures converted for a video encoder? To luma and halved chroma: half the bytes, and what the
encoder would compute itself.

ITU-R BT.709, limited range: Y' = 16 + 219 (0.2126 R + 0.7152 G + 0.0722 B) / 255, Cb = 128 + 224 (B - Y) /
(1.8556 * 255) and Cr = 128 + 224 (R - Y) / (1.5748 * 255), where Y is the sum in brackets; as integers with
16 fractional bits.
"""

import numpy as np
from numpy.typing import NDArray

from .._jit import entry

_HALF = 1 << 15


@entry(what="the colours of films", seconds=1)
def _fill(rgb, luma, cb, cr):
    """Fill luma (h, w), cb and cr (h/2, w/2) uint8 from the picture rgb (h, w, 3) uint8; h and w even."""
    for i in range(cb.shape[0]):
        for j in range(cb.shape[1]):
            red = green = blue = 0
            for di in range(2):
                for dj in range(2):
                    row, column = 2 * i + di, 2 * j + dj
                    r, g, b = int(rgb[row, column, 0]), int(rgb[row, column, 1]), int(rgb[row, column, 2])
                    luma[row, column] = 16 + ((11966 * r + 40254 * g + 4064 * b + _HALF) >> 16)
                    red, green, blue = red + r, green + g, blue + b
            cb[i, j] = 128 + ((-6596 * red - 22188 * green + 28784 * blue + 4 * _HALF) >> 18)
            cr[i, j] = 128 + ((28784 * red - 26145 * green - 2639 * blue + 4 * _HALF) >> 18)


def to_video(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """The bytes (3 h w / 2,) of a picture (h, w, 3), one plane after the other: ffmpeg's format yuv420p."""
    height, width = picture.shape[:2]
    out = np.empty(3 * height * width // 2, np.uint8)
    luma, chroma = out[: height * width], out[height * width :].reshape(2, height // 2, width // 2)
    _fill(np.ascontiguousarray(picture), luma.reshape(height, width), chroma[0], chroma[1])
    return out
