"""What does a file of learning curves hold? One point per row, training seed and number of shots, and its origin."""

import json
from pathlib import Path
from typing import Any

from agents._lib.files import read_json, write_atomic
from snooker_env.checks import refuse

NAME, VERSION = "snooker_env.curves", 1
KEYS = {"levels": ("place", "player"), "points": ("row", "seed", "shots")}
"""Lists of the file (players for comparison, points of the curves) -> the keys that identify an item."""
FIELDS = {"rows": dict, "made": list, **dict.fromkeys(KEYS, list)}
"""All keys of the file: these lists, what each row trains, and the commands with their software."""


def is_curves(content: Any) -> bool:
    """Whether this is the content of a file of curves, not another report."""
    schema = content.get("schema") if isinstance(content, dict) else None
    return isinstance(schema, dict) and schema.get("name") == NAME


def read_curves(file: Path, visits: int) -> dict[str, Any]:
    """Read the file, or make an empty content if there is none. ValueError if it is another kind of file, or has other visits."""
    if not file.exists():
        schema = {"name": NAME, "version": VERSION}
        return {"schema": schema, "visits": visits, **{name: kind() for name, kind in FIELDS.items()}}
    wanted = "must be a file that agents.curves wrote, or a new one"
    content = read_json("out", file, wanted)
    if not is_curves(content) or not all(
        isinstance(content.get(name), kind) for name, kind in FIELDS.items()
    ):
        raise refuse("out", str(file), wanted)
    if content["visits"] != visits:
        raise refuse("visits", visits, f"must be {content['visits']}, as in {file}: or give another --out")
    return content


def keep(file: Path, name: str, one: dict[str, Any], head: dict[str, Any]) -> None:
    """Append an item to a list of the file unless it is there, and write the file; other processes may write it too.

    ``head``: the origin of the item: "visits", "rows" and "made"."""
    from filelock import FileLock  # imported here, because readers of a file do not need it

    with FileLock(file.with_suffix(".lock")):
        content, made = read_curves(file, head["visits"]), head["made"]
        if any(all(other[key] == one[key] for key in KEYS[name]) for other in content[name]):
            return
        content["rows"] |= head["rows"]
        if made not in content["made"]:
            content["made"].append(made)
        content[name].append(one | {"made": content["made"].index(made)})
        lines = ",\n".join(f' "{key}": {_lines(value)}' for key, value in content.items())
        write_atomic(file, f"{{\n{lines}\n}}\n")


def _lines(value: Any) -> str:
    """JSON with one line per item of a list."""
    if not isinstance(value, list):
        return json.dumps(value)
    return "[\n" + ",\n".join(f"  {json.dumps(item)}" for item in value) + "\n ]"
