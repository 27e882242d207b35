"""How is a table of words and numbers written, on a terminal and in Markdown? No wider than a terminal is."""

from dataclasses import dataclass, replace

WIDTH = 100
"""Columns of text that no table is wider than."""


@dataclass
class TextTable:
    """Cells as text; the first ``keys`` columns say what a row is about, the first ``left`` are words, the others numbers."""

    title: str
    header: list
    rows: list
    keys: int
    left: int
    grouped: bool = False
    """Whether rows with the same first cell belong together."""

    def tidy(self):
        """The table without rows and columns that have nothing to say."""
        columns = [k for k in range(len(self.header)) if k < self.keys or any(row[k] for row in self.rows)]
        rows = [[row[k] for k in columns] for row in self.rows if any(row[self.keys :])]
        left = sum(k < self.left for k in columns)
        return replace(self, header=[self.header[k] for k in columns], rows=rows, left=left)

    def narrow(self):
        """The same as tables that are no wider than ``WIDTH``, each with the key columns; none if it is empty."""
        widths = [3 + max(len(row[k]) for row in (self.header, *self.rows)) for k in range(len(self.header))]
        groups, room = [], 0
        for k in range(self.keys, len(widths)):
            if not groups or widths[k] > room:
                groups.append([])
                room = WIDTH - 1 - sum(widths[: self.keys])
            groups[-1].append(k)
            room -= widths[k]
        for n, group in enumerate(groups, 1):
            columns = [*range(self.keys), *group]
            title = self.title + (f" ({n} of {len(groups)})" if len(groups) > 1 else "")
            rows = [[row[k] for k in columns] for row in self.rows]
            left = sum(k < self.left for k in columns)
            yield replace(self, title=title, header=[self.header[k] for k in columns], rows=rows, left=left)

    def show(self):
        """Print it."""
        import rich.box
        import rich.console
        import rich.table

        table = rich.table.Table(box=rich.box.SIMPLE, pad_edge=False)
        for k, name in enumerate(self.header):
            table.add_column(name, justify="left" if k < self.left else "right", no_wrap=k >= self.keys, overflow="fold")
        for k, row in enumerate(self.rows):
            if k and self.grouped and row[0] != self.rows[k - 1][0]:
                table.add_section()
            table.add_row(*(cell.replace("[", "\\[") for cell in row))
        console = rich.console.Console(width=WIDTH)
        console.print(self.title, highlight=False, markup=False, style="italic")
        console.print(table)

    def markdown(self):
        """The same in Markdown."""
        marks = [":--" if k < self.left else "--:" for k in range(len(self.header))]
        rows = ["| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in (self.header, marks, *self.rows)]
        return "\n".join([f"**{self.title}**", "", *rows])


def say(text):
    """Print a paragraph, as wide as the terminal."""
    import rich.console

    rich.console.Console().print(text, highlight=False, markup=False)
