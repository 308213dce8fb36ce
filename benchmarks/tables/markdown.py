"""Markdown tables."""

from collections.abc import Sequence


def markdown_table(head: Sequence[str], rows: Sequence[Sequence[str]], *, words: int) -> str:
    """Return a Markdown table.

    Args:
        head: Titles of the columns.
        rows: Of as many cells each.
        words: How many columns have words, which stand on the left; the others have numbers.
    """
    rule = ["---"] * words + ["---:"] * (len(head) - words)
    lines = [_line(head), "|" + "|".join(rule) + "|", *map(_line, rows)]
    return "\n".join(lines)


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"
