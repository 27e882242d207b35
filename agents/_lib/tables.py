"""How is a table of words and numbers written on a terminal and in Markdown? No wider than the terminal."""

from dataclasses import dataclass, replace
from textwrap import fill

from snooker_env._lib.text_tables import format_figure, markdown_table, text_table

__all__ = ["WIDTH", "TextTable", "format_figure", "markdown_table", "page", "show", "text_table"]

WIDTH = 100
"""Maximum width of a table in columns of text."""


@dataclass
class TextTable:
    """Cells as text. The first ``keys`` columns identify a row; the first ``left`` columns hold words, the others
    numbers."""

    title: str
    header: list
    rows: list
    keys: int
    left: int
    grouped: bool = False
    """Whether rows with the same first cell form a group."""

    def tidy(self):
        """The table without empty rows and columns."""
        columns = [k for k in range(len(self.header)) if k < self.keys or any(row[k] for row in self.rows)]
        rows = [[row[k] for k in columns] for row in self.rows if any(row[self.keys :])]
        left = sum(k < self.left for k in columns)
        return replace(self, header=[self.header[k] for k in columns], rows=rows, left=left)

    def narrow(self, width=WIDTH):
        """Split the table into tables within the maximum width, each with the key columns; none if it is empty."""
        widths = [2 + max(len(row[k]) for row in (self.header, *self.rows)) for k in range(len(self.header))]
        groups, room = [], 0
        for k in range(self.keys, len(widths)):
            if not groups or widths[k] > room:
                groups.append([])
                room = width - sum(widths[: self.keys])
            groups[-1].append(k)
            room -= widths[k]
        for n, group in enumerate(groups, 1):
            columns = [*range(self.keys), *group]
            title = self.title + (f" ({n} of {len(groups)})" if len(groups) > 1 else "")
            rows = [[row[k] for k in columns] for row in self.rows]
            left = sum(k < self.left for k in columns)
            yield replace(self, title=title, header=[self.header[k] for k in columns], rows=rows, left=left)

    def text(self):
        """The table for a terminal, with a line between groups."""
        head, rule, *lines = text_table(self.header, self.rows, self.left)
        for k in range(len(lines) - 1, 0, -1):
            if self.grouped and self.rows[k][0] != self.rows[k - 1][0]:
                lines.insert(k, "")
        return "\n".join([fill(self.title, WIDTH), head, rule, *lines])

    def markdown(self):
        """The table in Markdown."""
        return "\n".join([f"**{self.title}**", "", *markdown_table(self.header, self.rows, self.left)])


def show(parts):
    """Print tables and paragraphs."""
    for part in parts:
        print(fill(part, WIDTH) if isinstance(part, str) else part.text(), end="\n\n")


def page(title, command, made, parts):
    """A Markdown page of tables and paragraphs; ``made`` states their origin."""
    head = [f"# {title}", "", "Made by", "", "```bash", command, "```", "", f"with {made}.", ""]
    return "\n".join(
        [
            *head,
            *(line for part in parts for line in (part if isinstance(part, str) else part.markdown(), "")),
        ]
    )
