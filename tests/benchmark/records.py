"""How does a test change a result? One value of a copy, by the names and numbers on the way to it, or every value in turn."""

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


def leaves(value, path=()):
    """The paths of all values inside, of lists and objects of results alike."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [leaf for key, one in inner for leaf in leaves(one, (*path, key))] or [path]


def others(value):
    """Other values: of the same type, and of another."""
    tried = [None, not value if isinstance(value, bool) else True, "other", 7, -1, 0.5, [], {}, ["a"]]
    if type(value) is int:
        tried += [value + 1, value - 1, 0, 10**400]
    if isinstance(value, float):
        tried += [value * (1 + 2**-52) + 5e-324, float("nan"), 1e999]
    if isinstance(value, str):
        tried += [value + "x", value[1:], value.upper(), "two\nlines", "\x1b[2J", "\ud800", "x" * 2001]
    return [one for one in tried if type(one) is not type(value) or one != value]


def resized(value):
    """A list or an object with an entry more, and with one less."""
    if isinstance(value, dict):
        return [value | {"more": None}, *({k: v for k, v in value.items() if k != key} for key in value)]
    return [[*value, *value[-1:]], value[:-1]] if value else [[*value, "a"]]


def inner(value, path=()):
    """The paths of all lists and objects inside."""
    if not isinstance(value, dict | list):
        return []
    parts = value.items() if isinstance(value, dict) else enumerate(value)
    return [path, *(one for key, part in parts for one in inner(part, (*path, key)))]
