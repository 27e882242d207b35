"""Where are the pages' files, and how is ``table.js`` made? Of the files of ``table/``, one after the other."""

import json
from pathlib import Path

WEB = Path(__file__).resolve().parent  # the folder of what a browser is sent
_TABLE = WEB / "table"


def table_js(*, player: bool = True) -> str:
    """The JavaScript module that draws a table and, with ``player``, plays a replay; it imports nothing."""
    names = ("decode", "pen", "paint", "draw", "chance", *(("play",) if player else ()))
    parts = [(_TABLE / f"{name}.js").read_text("utf-8") for name in names]
    if player:
        parts.append(f"const STYLE = {json.dumps((_TABLE / 'player.css').read_text('utf-8'))};\n")
    return "\n".join(parts)
