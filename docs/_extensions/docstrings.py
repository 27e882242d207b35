"""How do docstrings with Markdown tables come into a page? Rows ``| a | b |`` become a table of reStructuredText, which all
else is already."""

import re

SEPARATOR = re.compile(r"^\s*\|[\s:|-]+\|\s*$")
ROW = re.compile(r"^\s*\|.*\|\s*$")
SINGLE = re.compile(r"(?<![`:\w])`([^`\n]+)`(?!`|_)")


def cells(row):
    """The cells of a row of a Markdown table."""
    return [cell.strip() for cell in row.strip().strip("|").split("|")]


def table(rows):
    """A Markdown table's rows as the lines of a ``list-table``."""
    head = len(rows) > 1 and SEPARATOR.match(rows[1]) is not None
    kept = [cells(row) for row in rows if not SEPARATOR.match(row)]
    width = max(map(len, kept))
    yield ""
    yield ".. list-table::"
    if head and any(kept[0]):
        yield "   :header-rows: 1"
    elif head:
        kept = kept[1:]
    yield ""
    for row in kept:
        for k in range(width):
            yield f"   {'*' if k == 0 else ' '} - {row[k] if k < len(row) else ''}".rstrip()
    yield ""


def converted(lines):
    """The lines of a docstring, its Markdown tables as reStructuredText."""
    out, rows = [], []
    for line in [*lines, ""]:
        if ROW.match(line):
            rows.append(line)
            continue
        if rows:
            out += table(rows)
            rows = []
        out.append(SINGLE.sub(r"``\1``", line))
    return out[:-1]


def process(app, what, name, obj, options, lines):
    """Sphinx's event ``autodoc-process-docstring``."""
    lines[:] = converted(lines)


def setup(app):
    """Register with Sphinx, before napoleon sees the lines."""
    app.connect("autodoc-process-docstring", process, priority=100)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
