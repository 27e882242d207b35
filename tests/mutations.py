"""How does a test spoil a saved state?"""

import copy
import json
import math
import re

NAN, INF = math.nan, math.inf
ROWS = (0, 1, 4, 21)
"""Of the 22 balls, only these are spoilt one by one."""


def fields(node, path=()):
    """The paths of all parts of a state, the whole one first."""
    yield path
    parts = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    for key, part in parts:
        if not isinstance(key, int) or len(node) < 22 or key in ROWS:
            yield from fields(part, (*path, key))


def at(state, path):
    """The part of a state there."""
    for key in path:
        state = state[key]
    return state


def spoilt(value):
    """Other things to stand in the place of a value, None among them where it was not."""
    wrong = [None, NAN, INF, -INF, -1, 2**70, 10**400, 1e300, 1.5, "x", "", True, False, [], {}]
    wrong += [[value], {"a": 1}, 3]
    if isinstance(value, str):
        wrong += ["over", "stroke", "choice", "lot", "off", "clear_path"]
    elif isinstance(value, bool):
        wrong += [0, 1, 0.0]
    elif isinstance(value, int | float):
        wrong += [value + 1, value - 1, -value, value + 2**64, str(value), value + 0.25, 0, 1, 2, 7, 155]
    elif isinstance(value, list):
        wrong += [value[:-1], [*value, *value[-1:]], [None, *value[1:]], value[::-1], tuple(value)]
        wrong.append(dict.fromkeys(map(str, range(len(value)))))
    elif isinstance(value, dict):
        wrong += [{k: v for k, v in value.items() if k != key} for key in value]
        wrong += [value | {"more": 1}, value | {7: 1}, list(value)]
    as_text = repr(value)
    return [other for other in wrong if repr(other) != as_text]


def mutations(state):
    """(path, value put there, the state with it) for every way to spoil every part."""
    for path in fields(state):
        for wrong in spoilt(at(state, path)):
            new = copy.deepcopy(state)
            if path:
                at(new, path[:-1])[path[-1]] = wrong
            yield path, wrong, (new if path else wrong)


KINDS = {bool: "truth", int: "integer", float: "number", str: "text", dict: "dict", type(None): "null"}


def kind_of(value):
    """What JSON calls the type of a value; a tuple is as good as a list."""
    return "list" if isinstance(value, list | tuple) else KINDS[type(value)]


def keys_of(field):
    """``state.positions[3, 0]`` as the way to it: ("state", "positions", 3, 0)."""
    return tuple(int(key) if key.isdigit() else key for key in re.findall(r"\w+", field))


def layout(keys):
    """Positions and on_table are one layout: a ball that cannot lie where it does may be either's fault."""
    if keys[:2] in (("state", "positions"), ("state", "on_table")):
        return ("state", "layout", *keys[2:])
    return tuple(key for k, key in enumerate(keys) if k == 0 or keys[k - 1] != "layout")


def names_it(message, root, path):
    """Does a complaint name the part that was spoilt?

    It names that part, what it is a part of, or a part of it; or another that does not fit it, and then its
    text says which it is.
    """
    field = message.split(" = ")[0]
    field_way, way = layout(keys_of(field)), layout((root, *path))
    if field_way == way[: len(field_way)] or way == field_way[: len(way)]:
        return True
    return [key for key in path if isinstance(key, str)][-1] in message[len(field) :]


def frozen(state):
    """A state as text, to compare it with another."""
    return json.dumps(state)
