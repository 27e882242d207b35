"""Is a file what was written under its name? A checksum at its end, over all its bytes and the name."""

import hashlib

_SIZE = hashlib.sha256().digest_size


def _digest(data: bytes, name: str) -> bytes:
    return hashlib.sha256(name.encode() + b"\0" + data).digest()


def seal(data: bytes, name: str) -> bytes:
    """The bytes of a file of that name, with their checksum."""
    return data + _digest(data, name)


def unseal(data: bytes, name: str) -> bytes:
    """The bytes that ``seal`` was given with that name; ValueError for any others."""
    if data[-_SIZE:] != _digest(data[:-_SIZE], name):
        raise ValueError("it is damaged, or was written under another name")
    return data[:-_SIZE]
