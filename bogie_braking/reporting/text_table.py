"""Tables as text."""

from __future__ import annotations

from collections.abc import Container, Iterator, Sequence


def text_table(rows: Sequence[Sequence[str]], words: Container[int] = (), ruled: Container[int] = ()) -> Iterator[str]:
    """Yield rows of equal length in columns, those of words on the left; ruled: rows below a line."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for number, row in enumerate(rows):
        if number in ruled:
            yield "-" * (sum(widths) + 2 * (len(widths) - 1))
        cells = enumerate(zip(row, widths, strict=True))
        texts = (text.ljust(width) if place in words else text.rjust(width) for place, (text, width) in cells)
        yield "  ".join(texts).rstrip()
