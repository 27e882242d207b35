"""Where do random numbers come from inside a kernel? From a counter-based generator.

Philox 4x32-10 [Salmon, Moraes, Dror & Shaw, Parallel random numbers: as easy as 1, 2, 3, SC 2011]: ten rounds
turn a counter of 128 bits and a key of 64 into 128 random bits. A stream is a uint64 array (2,), key and
counter; each draw takes one block. Each table has its key, so its numbers never depend on other tables."""

from math import cos, log, pi, sin, sqrt

import numpy as np

from .._lib.check import refuse
from .._lib.jit import kernel
from .._lib.types import Words

_M0, _M1 = np.uint64(0xD2511F53), np.uint64(0xCD9E8D57)  # multipliers and key steps of Philox 4x32
_W0, _W1 = np.uint64(0x9E3779B9), np.uint64(0xBB67AE85)
_LOW, _32, _11, _1 = np.uint64(0xFFFFFFFF), np.uint64(32), np.uint64(11), np.uint64(1)
_ZERO = np.uint64(0)
_ROUNDS = 10


@kernel
def philox(c0, c1, c2, c3, k0, k1):
    """One block: four words of 32 bits (each in a uint64) from the counter c and the key k, words too."""
    for _ in range(_ROUNDS):
        p0, p1 = _M0 * c0, _M1 * c2
        c0, c1, c2, c3 = (p1 >> _32) ^ c1 ^ k0, p1 & _LOW, (p0 >> _32) ^ c3 ^ k1, p0 & _LOW
        k0, k1 = (k0 + _W0) & _LOW, (k1 + _W1) & _LOW
    return c0, c1, c2, c3


@kernel
def pair(stream):
    """Two independent numbers, uniform in [0, 1): multiples of 2^-53. One block."""
    key, counter = stream[0], stream[1]
    a, b, c, d = philox(counter & _LOW, counter >> _32, _ZERO, _ZERO, key & _LOW, key >> _32)
    stream[1] = counter + _1
    return float(((b << _32) | a) >> _11) * 2.0**-53, float(((d << _32) | c) >> _11) * 2.0**-53


@kernel
def normals(stream):
    """Two independent standard normal numbers [Box & Muller 1958] from one block."""
    u, v = pair(stream)
    far = sqrt(-2.0 * log(1.0 - u))
    return far * cos(2.0 * pi * v), far * sin(2.0 * pi * v)


def stream_of(rng: np.random.Generator) -> Words:
    """A new stream, uint64 (2,), whose key is drawn from a numpy ``Generator``; else ValueError."""
    if not isinstance(rng, np.random.Generator):
        raise refuse("rng", rng, "must be a numpy.random.Generator")
    return np.array([rng.integers(0, 2**64 - 1, dtype=np.uint64, endpoint=True), 0], np.uint64)
