"""Where are the pages' files, and how is ``table.js`` made? Of the files of ``table/``, one after the
other."""

import json
from pathlib import Path

WEB = Path(__file__).resolve().parent
"""The folder of what a browser is sent."""
_TABLE = WEB / "table"


def table_js() -> str:
    """The JavaScript module that draws a table and plays a replay; it imports nothing, so that a page can
    hold it."""
    style = json.dumps((_TABLE / "player.css").read_text("utf-8"))
    names = ("decode", "pen", "paint", "draw", "chance", "play")
    parts = [(_TABLE / f"{name}.js").read_text("utf-8") for name in names]
    return "\n".join([*parts, f"const STYLE = {style};\n"])
