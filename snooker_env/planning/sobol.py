"""Which points fill a cube evenly? Sobol points, scrambled: of any number, each part gets its share.

Sobol's sequence in base 2, with the direction numbers of Joe & Kuo (2008), scrambled as Owen (1995) proposed:
each bit of a coordinate is flipped depending on the bits above it, here by a hash (Burley 2020, Vegdahl
2021). A scramble is one seed; each point by itself is uniform, so that means over the points are unbiased."""

from statistics import NormalDist

import numpy as np

from .._lib.jit import entry, kernel
from .._lib.types import Floats

DIMENSIONS = 6  # largest number of coordinates of a point
_BITS, _ALL = 32, 0xFFFFFFFF
# primitive polynomials (degree, inner coefficients) and first direction numbers of dimensions 2 to 6 [Joe &
# Kuo 2008, table new-joe-kuo-6]
_POLYNOMIALS = ((1, 0, (1,)), (2, 1, (1, 3)), (3, 1, (1, 3, 1)), (3, 2, (1, 1, 1)), (4, 1, (1, 1, 3, 3)))


def _directions():
    """Direction numbers (DIMENSIONS, _BITS)."""
    out = np.empty((DIMENSIONS, _BITS), np.int64)
    out[0] = [1 << (31 - k) for k in range(_BITS)]
    for d, (degree, inner, first) in enumerate(_POLYNOMIALS, start=1):
        m = list(first)
        for k in range(degree, _BITS):
            new = m[k - degree] ^ (m[k - degree] << degree)
            for j in range(1, degree):
                if (inner >> (degree - 1 - j)) & 1:
                    new ^= m[k - j] << j
            m.append(new)
        out[d] = [m[k] << (31 - k) for k in range(_BITS)]
    return out


_DIRECTIONS = _directions()


@kernel
def _reversed_bits(x):
    """The bits of a 32-bit number in opposite order."""
    x = ((x >> 1) & 0x55555555) | ((x & 0x55555555) << 1)
    x = ((x >> 2) & 0x33333333) | ((x & 0x33333333) << 2)
    x = ((x >> 4) & 0x0F0F0F0F) | ((x & 0x0F0F0F0F) << 4)
    x = ((x >> 8) & 0x00FF00FF) | ((x & 0x00FF00FF) << 8)
    return (x >> 16) | ((x & 0xFFFF) << 16)


@kernel
def _mix(x):
    """A 32-bit hash with good avalanche [Wellons 2018, "lowbias32"]."""
    x = ((x ^ (x >> 16)) * 0x7FEB352D) & _ALL
    x = ((x ^ (x >> 15)) * 0x846CA68B) & _ALL
    return x ^ (x >> 16)


@kernel
def _scramble(x, seed):
    """Owen's nested scrambling of the bits of x by the hash of Vegdahl (2021)."""
    x = _reversed_bits(x)
    x ^= (x * 0x3D20ADEA) & _ALL
    x = ((x + seed) * ((seed >> 16) | 1)) & _ALL
    x ^= (x * 0x05526C56) & _ALL
    x ^= (x * 0x53A22864) & _ALL
    return _reversed_bits(x)


@kernel
def sobol(index, dimension, seed):
    """Coordinate ``dimension`` of point ``index`` of the scramble ``seed``: a number in (0, 1)."""
    bits, k, left = 0, 0, index
    while left:
        if left & 1:
            bits ^= _DIRECTIONS[dimension, k]
        left >>= 1
        k += 1
    return (_scramble(bits, _mix(seed ^ _mix(dimension + 1))) + 0.5) * 2.0**-32


@entry
def _points(seed, out):
    for i in range(out.shape[0]):
        for d in range(out.shape[1]):
            out[i, d] = sobol(i, d, seed)


def sobol_points(n: int, dimensions: int, seed: int) -> Floats:
    """The first n points, each in (0, 1), of a scrambled sequence of up to 6 dimensions: (n, dimensions)."""
    out = np.empty((n, dimensions))
    _points(seed & _ALL, out)
    return out


_NORMAL = np.vectorize(NormalDist().inv_cdf, otypes=[np.float64])
_AIM_FIRST = [1, 2, 3, 0, 4, 5]  # the first coordinate, the most even one, is the aim's: it matters most


def normal_points(n: int, seed: int) -> Floats:
    """n evenly spread standard normal numbers: errors of speed, side, top, aim and elevation, and a lapse's: float64 (n, 6)."""
    return _NORMAL(sobol_points(n, DIMENSIONS, seed ^ 0x5EED))[:, _AIM_FIRST]
