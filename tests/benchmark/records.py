"""How does a test change a result? One value of a copy, by the names and numbers on the way to it."""

import copy


def at(record, path):
    """The value at a path, a text with dots or a tuple of keys."""
    for key in path.split(".") if isinstance(path, str) else path:
        record = record[int(key) if isinstance(record, list) else key]
    return record


def put(record, path, value):
    """A copy of the record with another value there."""
    *way, last = path.split(".") if isinstance(path, str) else path
    record = copy.deepcopy(record)
    inner = at(record, way)
    inner[int(last) if isinstance(inner, list) else last] = value
    return record
