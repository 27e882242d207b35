"""How does a test damage a file? One bit at a time, at places drawn at random."""

import random


def flipped(file, many=100):
    """Yield so many times, each with another bit of the file flipped; it is as it was afterwards."""
    whole, rng = file.read_bytes(), random.Random(len(file.name))
    for _ in range(many):
        data, at = bytearray(whole), rng.randrange(8 * len(whole))
        data[at // 8] ^= 1 << at % 8
        file.write_bytes(data)
        yield at
    file.write_bytes(whole)
