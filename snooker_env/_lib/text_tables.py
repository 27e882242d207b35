"""How are tables and figures written, on a terminal and in Markdown? As lines of text."""

from collections.abc import Mapping, Sequence


def text_table(head: Sequence[str], rows: Sequence[Sequence[str]], left: int = 1) -> list[str]:
    """A table for a terminal, line by line: the first ``left`` columns to the left, others to the right."""
    widths = [max(len(row[c]) for row in [head, *rows]) for c in range(len(head))]

    def line(row):
        cells = enumerate(zip(row, widths, strict=True))
        return "  ".join(x.ljust(w) if c < left else x.rjust(w) for c, (x, w) in cells).rstrip()

    return [line(head), "-" * (sum(widths) + 2 * (len(widths) - 1)), *map(line, rows)]


def markdown_table(head: Sequence[str], rows: Sequence[Sequence[str]], left: int = 1) -> list[str]:
    """The same in Markdown."""
    marks = ["---" if c < left else "--:" for c in range(len(head))]
    safe = [[cell.replace("\\", "\\\\").replace("|", "\\|") for cell in row] for row in (head, marks, *rows)]
    return [f"| {' | '.join(row)} |" for row in safe]


def format_figure(figure: Mapping[str, float | None], scale: float = 1.0, form: str = "{:.1f}") -> str:
    """A figure with its interval: "65.8 [61.2, 70.1]", with one bound "65.8 [61.2, ..]"; "" without."""
    numbers = (figure["value"], figure["low"], figure["high"])
    value, low, high = (None if x is None else form.format(scale * x) for x in numbers)
    if value is None or (low is None and high is None):
        return value or ""
    return f"{value} [{low or '..'}, {high or '..'}]"
